#include "solver/explicit/run/run_parts.hpp"

#include "format/model/errors.hpp"
#include "solver/explicit/laws/curve.hpp"

#include <fmt/format.h>

namespace iga::solve {

std::optional<TimeCurve> read_curve(io::SettingsTable& table, const char* key, bool smooth,
                                    std::vector<RunInput>& files) {
  const auto between = smooth ? TimeCurve::Between::Smooth : TimeCurve::Between::Linear;
  if (table.holds_text(key)) {
    const auto file = *table.path(key);
    files.push_back({file, table.where(key)});
    try {
      const Curve curve = Curve::read_csv(file);
      return TimeCurve(curve.x(), curve.y(), between, file.string());
    } catch (const InputError& error) {
      refuse(table, key, error.what());
    }
  }
  if (table.holds_number(key)) return TimeCurve(*table.number(key));
  const auto rows = table.rows(key, 2);
  if (!rows) return std::nullopt;
  std::vector<double> times, values;
  for (const auto& row : *rows) {
    times.push_back(row[0]);
    values.push_back(row[1]);
  }
  return TimeCurve(std::move(times), std::move(values), between, table.where(key));
}

DriveCurves read_drive(io::SettingsTable& table, bool may_turn, std::vector<RunInput>& files) {
  io::SettingsTable drive = table.table("drive");
  const std::array<std::string, 2> kinds{"displacement", "velocity"};
  DriveCurves curves;
  curves.are_velocities = choose(drive, "kind", drive.text("kind").value_or(kinds[0]), kinds) == 1;
  const bool smooth = drive.boolean("smooth").value_or(false);
  const std::array<const char*, 3> axes{"x", "y", "z"};
  for (std::size_t d = 0; d < 3; ++d) curves.along[d] = read_curve(drive, axes[d], smooth, files);
  if (!may_turn) return curves;
  curves.rotation = read_curve(drive, "rotation", smooth, files);
  if (const auto axis = read_vector(drive, "axis")) curves.axis = unit_vector(drive, "axis", *axis);
  return curves;
}

std::size_t body_by_name(io::SettingsTable& table, const char* key, const ExplicitRun& run) {
  const auto name = table.text(key);
  if (!name && run.bodies.size() == 1) return 0;
  if (!name) refuse(table, key, "missing; there are several bodies, name the one that is meant");
  std::vector<std::string> known;
  for (const BodyRun& body : run.bodies) known.push_back(body.body.name);
  return choose(table, key, *name, known);
}

} // namespace iga::solve
