// Stress along straight lines through walls: its mean, its linear part and the rest, as pressure vessel codes judge
// them.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/stress/stress_recovery.hpp"

namespace iga::solve {

/// One [[line]] of a run file.
struct StressLine {
  std::string name, body;
  std::string where; ///< "file:line", opens messages
  Point3 from{}, to{};
};
/// @throws InputError with file and line for a line without length
std::vector<StressLine> read_stress_lines(io::SettingsTable& root);
std::vector<io::TableKeys> stress_line_keys();

/// Gauss points of a line: pieces between span faces, exact for the stress that is recovered; first the two ends.
struct LinePoints {
  SamplePoints points;
  std::vector<double> distance; ///< (n) from the start, length
  std::vector<double> weight;   ///< (n), length; 0 at the ends
  Point3 along{};               ///< unit
  double length = 0;
};
/// @throws InputError for a line of which a point lies outside the part, with the place
LinePoints points_of(const TrimmedModel& model, const StressLine& line);

/// ASME BPVC VIII-2 (2021), annex 5-A.4.1: membrane σ_m = 1/t ∫ σ ds, bending ±σ_b with σ_b = 6/t² ∫ σ (t/2 - s) ds at
/// the start. Bending is taken of the components along the wall alone (none of the normal stress along the line and of
/// the shears with it).
struct LinearisedStress {
  Voigt membrane, bending;                  ///< bending at the start
  std::array<Voigt, 2> total, peak;         ///< at start and end; peak = total - membrane - bending
  double von_mises_membrane = 0;            ///< force/length²
  std::array<double, 2> von_mises_linear{}; ///< of membrane ± bending
  std::array<double, 2> von_mises_total{};
  double error = 0; ///< estimated, of the von Mises stress, the largest along the line
};
LinearisedStress linearise(const LinePoints& line, const RecoveredStress& stress);

} // namespace iga::solve
