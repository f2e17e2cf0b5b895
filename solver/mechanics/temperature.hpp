// [temperature] of a run file: the temperature of the bodies, and the one at which they are free of thermal strain.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/base/formula.hpp"
#include "solver/mechanics/initial_strain.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace iga::solve {

/// One of uniform, formula, file and results is given.
struct TemperatureSettings {
  std::string where;    ///< "run.toml:12", opens messages
  double reference = 0; ///< without thermal strain
  std::optional<double> uniform;
  std::optional<Formula> formula;               ///< of the position, the part's frame
  std::optional<std::filesystem::path> file;    ///< points with temperatures (read_scattered_values)
  std::optional<std::filesystem::path> results; ///< of `igasolve heat` on the same model
};

/// Keys of the table, for SettingsTable::expect_only.
std::vector<io::TableKeys> temperature_keys();
/// None where the run file has no [temperature]. @throws InputError for values that make no sense
std::optional<TemperatureSettings> read_temperature(io::SettingsTable& root);

/// The temperature of one body, checked at its quadrature points.
struct BodyTemperature {
  std::shared_ptr<const TemperatureField> field;
  double least = 0, most = 0; ///< at the quadrature points of volume and surface
  std::string source;         ///< "uniform", "formula 20 + 3*x", "heat.h5", "120 points of t.csv"
};
/// @param space  of the body; must outlive the field
/// @param body   its name for messages; empty where there is one
/// @throws InputError where a formula gives no finite number, points are too far from the part, or the results are
/// those of another model
BodyTemperature make_temperature(const TemperatureSettings& settings, const SolutionSpace& space,
                                 const std::string& body);

/// T = Σ N_i c_i with coefficients of the model's active functions. (n_f)
std::shared_ptr<const TemperatureField> spline_temperature(const TrimmedModel& model, std::vector<double> coefficients);

} // namespace iga::solve
