#include "solver/mechanics/temperature.hpp"

#include "format/io/results_io.hpp"
#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/run_tables.hpp"
#include "solver/base/scattered_values.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace iga::solve {

namespace {

// A given point may be this far from any place of the part, in diagonals of the part's box: beyond it the fit would go
// on where nobody has said anything.
constexpr double farthest = 0.1;

/// T(x) of the position alone.
class PlacedTemperature : public TemperatureField {
 public:
  PlacedTemperature(const SplineGrid& grid, std::function<double(const Point3&)> value)
      : grid_(grid), value_(std::move(value)) {}

  Eigen::VectorXd at(std::int64_t, std::span<const double> parameters) const override {
    Eigen::VectorXd all(static_cast<Eigen::Index>(parameters.size() / 3));
    for (Eigen::Index q = 0; q < all.size(); ++q) {
      const double* u = &parameters[3 * static_cast<std::size_t>(q)];
      all[q] = value_(grid_.to_position({u[0], u[1], u[2]}));
    }
    return all;
  }

 private:
  const SplineGrid& grid_;
  std::function<double(const Point3&)> value_;
};

class SplineTemperature : public TemperatureField {
 public:
  SplineTemperature(const TrimmedModel& model, std::vector<double> coefficients)
      : model_(model), coefficients_(std::move(coefficients)) {}

  Eigen::VectorXd at(std::int64_t cell, std::span<const double> parameters) const override {
    const auto a = static_cast<std::size_t>(cell);
    const SplineGrid& grid = model_.grid;
    const Index3 span = grid.span_index(model_.cells.span[a]);
    const auto p = grid.degree();
    const auto functions = model_.functions_of(a);
    std::array<std::array<double, max_degree + 1>, 3> N{};
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size() / 3));
    for (Eigen::Index q = 0; q < all.size(); ++q) {
      for (std::size_t d = 0; d < 3; ++d)
        evaluate_basis(grid.knots(static_cast<int>(d)), span[d], parameters[3 * static_cast<std::size_t>(q) + d],
                       {N[d].data(), static_cast<std::size_t>(p[d]) + 1});
      std::size_t f = 0;
      for (int k = 0; k <= p[2]; ++k)
        for (int j = 0; j <= p[1]; ++j)
          for (int i = 0; i <= p[0]; ++i, ++f)
            all[q] += N[0][static_cast<std::size_t>(i)] * N[1][static_cast<std::size_t>(j)] *
                      N[2][static_cast<std::size_t>(k)] * coefficients_[static_cast<std::size_t>(functions[f])];
    }
    return all;
  }

 private:
  const TrimmedModel& model_;
  std::vector<double> coefficients_; // by active function
};

// Range of a field at the points that the analysis uses.
void measure(const TrimmedModel& model, BodyTemperature& temperature) {
  temperature.least = std::numeric_limits<double>::infinity();
  temperature.most = -temperature.least;
  for (std::int64_t a = 0; a < static_cast<std::int64_t>(model.num_cells()); ++a)
    for (const auto parameters : {cell_parameters(model, a), surface_parameters(model, a)}) {
      if (parameters.empty()) continue;
      const Eigen::VectorXd T = temperature.field->at(a, parameters);
      if (!T.allFinite()) {
        Eigen::Index q = 0;
        while (std::isfinite(T[q])) ++q;
        const double* u = &parameters[3 * static_cast<std::size_t>(q)];
        const Point3 x = model.grid.to_position({u[0], u[1], u[2]});
        throw InputError(
            fmt::format("the temperature at ({:.6g}, {:.6g}, {:.6g}) is no finite number", x[0], x[1], x[2]));
      }
      temperature.least = std::min(temperature.least, T.minCoeff());
      temperature.most = std::max(temperature.most, T.maxCoeff());
    }
}

std::function<double(const Point3&)> from_points(const ScatteredValues& values, const TrimmedModel& model,
                                                 const std::string& file) {
  Point3 low = model.surface.mesh.vertices.at(0), high = low;
  for (const Point3& x : model.surface.mesh.vertices)
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  const double allowed = farthest * norm(minus(high, low));
  for (const Point3& x : model.surface.mesh.vertices)
    if (const double distance = values.distance_to_nearest(x); distance > allowed)
      throw InputError(fmt::format(
          "{}: the part reaches to ({:.6g}, {:.6g}, {:.6g}), where the nearest point with a temperature is {:.4g} "
          "away, "
          "more than a tenth of the part's diagonal ({:.4g}); add points there, and check that the points are in the "
          "model's length unit and axes",
          file, x[0], x[1], x[2], distance, allowed));
  auto shared = std::make_shared<const ScatteredValues>(values);
  return [shared](const Point3& x) { return shared->at(x); };
}

std::shared_ptr<const TemperatureField> from_results(const std::filesystem::path& file, const TrimmedModel& model) {
  Results results = io::read_results(file);
  if (!results.heat)
    throw InputError(fmt::format("{}: these are results of the analysis {}, not of igasolve heat", file.string(),
                                 results.header.analysis));
  if (results.active_functions != model.functions.number)
    throw InputError(fmt::format("{}: these temperatures are those of another model, {}; run igasolve heat on this one",
                                 file.string(), results.header.model_file));
  return spline_temperature(model, std::move(results.heat->temperature));
}

} // namespace

std::vector<io::TableKeys> temperature_keys() {
  return {{"temperature", {"uniform", "formula", "file", "results", "reference"}}};
}

std::optional<TemperatureSettings> read_temperature(io::SettingsTable& root) {
  io::SettingsTable table = root.table("temperature");
  TemperatureSettings settings;
  settings.uniform = table.number("uniform");
  const auto formula = table.text("formula");
  settings.file = table.path("file");
  settings.results = table.path("results");
  const auto reference = table.number("reference");
  if (!root.holds("temperature")) return std::nullopt;
  settings.where = place_of(table, "reference");
  const char* first = nullptr;
  for (const char* key : {"uniform", "formula", "file", "results"}) {
    if (!table.holds(key)) continue;
    if (first) refuse(table, key, fmt::format("given together with {}; give one of them", first));
    first = key;
  }
  if (!first)
    refuse(table, "uniform",
           "missing; give the temperature by one of uniform = 80, formula = \"20 + 3*x\", file = \"points.csv\", "
           "results = "
           "\"heat.h5\"");
  if (!reference)
    refuse(table, "reference", "missing; give the temperature at which the bodies have no thermal strain");
  settings.reference = *reference;
  if (formula) {
    try {
      settings.formula = Formula(*formula);
    } catch (const InputError& error) {
      refuse(table, "formula", error.what());
    }
  }
  return settings;
}

BodyTemperature make_temperature(const TemperatureSettings& settings, const SolutionSpace& space,
                                 const std::string& body) {
  const TrimmedModel& model = space.model();
  BodyTemperature temperature;
  try {
    if (settings.results) {
      temperature.field = from_results(*settings.results, model);
      temperature.source = settings.results->filename().string();
    } else if (settings.file) {
      const ScatteredValues values = read_scattered_values(*settings.file);
      temperature.source = fmt::format("{} points of {}", values.size(), settings.file->filename().string());
      temperature.field =
          std::make_shared<PlacedTemperature>(model.grid, from_points(values, model, settings.file->string()));
    } else if (settings.formula) {
      temperature.source = fmt::format("formula {}", settings.formula->text());
      temperature.field = std::make_shared<PlacedTemperature>(model.grid, *settings.formula);
    } else {
      temperature.source = "uniform";
      temperature.field =
          std::make_shared<PlacedTemperature>(model.grid, [T = *settings.uniform](const Point3&) { return T; });
    }
    measure(model, temperature);
  } catch (const InputError& error) {
    throw InputError(
        fmt::format("{}: {}{}", settings.where, body.empty() ? "" : fmt::format("body '{}': ", body), error.what()));
  }
  return temperature;
}

std::shared_ptr<const TemperatureField> spline_temperature(const TrimmedModel& model,
                                                           std::vector<double> coefficients) {
  return std::make_shared<SplineTemperature>(model, std::move(coefficients));
}

} // namespace iga::solve
