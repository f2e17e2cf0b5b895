// [[bodies]] of a run file.
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/explicit/run/run_parts.hpp"
#include "solver/mechanics/material_table.hpp"
#include "solver/space/body_tables.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

MassType read_mass(io::SettingsTable& table) {
  const std::array<std::string, 3> names{"lumped", "two-pass", "three-pass"};
  constexpr std::array types{MassType::Lumped, MassType::TwoPass, MassType::ThreePass};
  return types[choose(table, "mass", table.text("mass").value_or(names[0]), names)];
}

LightTreatment read_light(io::SettingsTable& table, MassType mass) {
  const std::array<std::string, 4> names{"none", "remove", "linear", "degree-p"};
  constexpr std::array remedies{LightFunctions::None, LightFunctions::Remove, LightFunctions::Linear,
                                LightFunctions::DegreeP};
  LightTreatment light = default_light_treatment(mass);
  const auto threshold = table.number("light_threshold");
  if (const auto name = table.text("light_functions")) {
    light.remedy = remedies[choose(table, "light_functions", *name, names)];
    if (light.remedy == LightFunctions::Remove) light.threshold = 1e-8;
  }
  if (threshold) {
    if (!(*threshold >= 0 && *threshold < 1))
      refuse(table, "light_threshold", fmt::format("found {:g}, expected a mass fraction 0 … 1", *threshold));
    light.threshold = *threshold;
    light.threshold_with_gap_ends = -1;
  }
  return light;
}

// Whether the law sees the mean volume ratio of each cell.
bool read_locking(io::SettingsTable& table, const Law& law) {
  const std::array<std::string, 2> names{"none", "fbar"};
  const std::optional<std::string> name = table.text("locking");
  if (!name || choose(table, "locking", *name, names) == 0) return false;
  if (std::holds_alternative<LinearElastic>(law))
    refuse(table, "locking",
           "found \"fbar\", expected \"none\": linear-elastic is a law of small strains, whose volume is not det F; "
           "take neo-hookean");
  return true;
}

BodyRun read_body(io::SettingsTable& table, const Point3& gravity, ExplicitRun& run) {
  std::vector<std::string> names;
  for (const BodyRun& other : run.bodies) names.push_back(other.body.name);
  const BodyFile file = read_body_file(table, names);
  BodyRun body;
  body.model = file.model;
  body.where = file.where;
  body.place = file.place;
  run.inputs.push_back({body.model, table.where("model")});
  BodySettings& s = body.body;
  s.name = file.name;
  io::SettingsTable material = table.table("material");
  body.material =
      read_material(material, named_material(material, run.unit_system, run.materials, body.model, body.words));
  if (material.holds_text("yield_curve"))
    run.inputs.push_back({*material.path("yield_curve"), material.where("yield_curve")});
  for (const std::string& warning : body.material.warnings)
    run.warnings.push_back(fmt::format("body '{}': {}", s.name, warning));
  s.kernel.erode_inverted = body.material.inversion.action == InvertedPoints::Erode;
  s.stop_at_inverted = body.material.inversion.action == InvertedPoints::Stop;
  s.kernel.erosion_J = number_from(table, "erosion_volume_ratio", 0, 0);
  s.kernel.mean_volume = read_locking(table, body.material.law);
  s.mass = read_mass(table);
  s.light = read_light(table, s.mass);
  s.damping = number_from(table, "damping", 0, 0);
  s.acceleration = gravity;
  body.velocity = read_vector(table, "velocity").value_or(Point3{});
  body.spin = read_vector(table, "spin").value_or(Point3{});
  body.centre = read_vector(table, "spin_centre");
  body.edge_length = number_from(table, "edge_length", 0, 0);
  body.merge_length = number_from(table, "merge_length", 0, 0);
  return body;
}

} // namespace

std::optional<MaterialDefaults> named_material(io::SettingsTable& table, const std::optional<std::string>& unit_system,
                                               const std::optional<std::filesystem::path>& materials,
                                               const std::filesystem::path& model,
                                               std::optional<MaterialWords>& words) {
  const auto name = table.text("name");
  if (!name) return std::nullopt;
  try {
    const UnitSystem& units = choose_units(unit_system, io::read_length_unit(model), model.string());
    const NamedMaterial found = find_material(*name, materials);
    const double E = found.E / units.pascal(), rho = found.rho / units.kg_per_m3();
    words = MaterialWords{found.name,
                          found.source,
                          table.number("E").value_or(E),
                          table.number("nu").value_or(found.nu),
                          table.number("rho").value_or(rho),
                          &units};
    return MaterialDefaults{E, found.nu, rho};
  } catch (const InputError& error) {
    refuse(table, "name", error.what());
  }
}

void read_bodies(io::SettingsTable& root, const Point3& gravity, ExplicitRun& run) {
  for (io::SettingsTable& table : root.tables("bodies")) run.bodies.push_back(read_body(table, gravity, run));
}

} // namespace iga::solve
