#include "solver/space/body_tables.hpp"

#include "solver/base/run_tables.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

// [bodies.place]
Placement read_placement(io::SettingsTable&& table) {
  Placement place;
  place.shift = read_vector(table, "shift").value_or(Point3{});
  place.about = read_vector(table, "about").value_or(Point3{});
  const auto axis = read_vector(table, "axis");
  const auto degrees = table.number("degrees");
  if (axis.has_value() != degrees.has_value())
    refuse(table, axis ? "axis" : "degrees", "a turn needs both axis = [x, y, z] and degrees");
  if (axis) place.R = rotation_about(unit_vector(table, "axis", *axis), *degrees * std::numbers::pi / 180);
  return place;
}

} // namespace

BodyFile read_body_file(io::SettingsTable& table, const std::vector<std::string>& names) {
  BodyFile body;
  const auto model = table.path("model");
  if (!model) refuse(table, "model", "missing; give a model file made by igaprep");
  body.model = *model;
  body.where = place_of(table, "model");
  body.place = read_placement(table.table("place"));
  if (!std::filesystem::exists(body.model))
    refuse(table, "model", fmt::format("there is no file {}", body.model.string()));
  body.name = read_name(table, "name", body.model.stem().string());
  if (std::find(names.begin(), names.end(), body.name) != names.end())
    refuse(table, "name", fmt::format("there is another body '{}'; give each a name", body.name));
  return body;
}

std::vector<io::TableKeys> body_file_keys() {
  return {{"bodies", {"name", "model"}}, {"bodies.place", {"shift", "about", "axis", "degrees"}}};
}

} // namespace iga::solve
