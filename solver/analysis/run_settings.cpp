#include "solver/analysis/run_settings.hpp"

#include "format/io/settings_reader.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"

#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

namespace {

constexpr std::array<std::pair<const char*, MassType>, 4> mass_names{{{"consistent", MassType::Consistent},
                                                                      {"lumped", MassType::Lumped},
                                                                      {"two-pass", MassType::TwoPass},
                                                                      {"three-pass", MassType::ThreePass}}};
constexpr std::array<std::pair<const char*, LightFunctions>, 4> remedy_names{{{"none", LightFunctions::None},
                                                                              {"remove", LightFunctions::Remove},
                                                                              {"linear", LightFunctions::Linear},
                                                                              {"degree-p", LightFunctions::DegreeP}}};

template <class Names> auto from_name(const Names& names, const std::string& key, const std::string& word) {
  std::vector<std::string> known;
  for (const auto& [name, value] : names) {
    if (word == name) return value;
    known.emplace_back(name);
  }
  const auto near = io::nearest_name(word, known);
  throw InputError(fmt::format("{}: found \"{}\", expected one of {}{}", key, word, fmt::join(known, ", "),
                               near ? fmt::format("; did you mean {}?", *near) : ""));
}

template <class Names, class Value> const char* to_name(const Names& names, Value value) {
  for (const auto& [name, candidate] : names)
    if (candidate == value) return name;
  return "";
}

ElasticMaterial material_of(const TypedRun& typed, Analysis analysis) {
  if (!typed.rho && analysis != Analysis::Static)
    throw InputError("material: the density is missing; give --rho or rho in [material], or a name: --material steel");
  for (const Load& load : typed.statics.loads)
    if (!typed.rho && analysis == Analysis::Static && load.kind == LoadKind::Acceleration)
      throw InputError(fmt::format("material: the density is missing, but load '{}' is an acceleration; give --rho or "
                                   "rho in [material]",
                                   load.name));
  const double rho = typed.rho.value_or(1); // statics do not use it
  if (typed.C) {
    if (typed.E || typed.nu) throw InputError("material: give either C or E and nu, not both");
    return anisotropic(voigt_matrix(*typed.C), rho);
  }
  if (!typed.E || !typed.nu)
    throw InputError(fmt::format(
        "material: {} missing; give --E and --nu, or E and nu in [material], or a matrix C there, or a name: "
        "--material steel",
        !typed.E && !typed.nu ? "E and nu are"
        : typed.E             ? "nu is"
                              : "E is"));
  return isotropic(*typed.E, *typed.nu, rho);
}

int whole(const char* key, std::int64_t value, std::int64_t least, std::int64_t most) {
  if (value < least || value > most)
    throw InputError(fmt::format("{}: found {}, expected {} … {}", key, value, least, most));
  return static_cast<int>(value);
}

// Every key that a run file of eigen, timestep and static may hold.
std::vector<io::TableKeys> run_keys() {
  std::vector<io::TableKeys> keys{
      {"",
       {"model", "output", "units", "unit_system", "material", "materials", "mass", "light_functions",
        "light_threshold"}},
      {"material", {"name", "E", "nu", "rho", "C"}},
      {"eigen", {"modes", "largest", "sturm"}},
      {"results", {"subdivide", "viewer"}},
      {"support", {"name", "fixed", "rotation", "rotate_axis_angle", "value", "gradient", "method", "penalty_factor"}},
      {"probe", {"name", "position"}}};
  for (const auto& more : {load_keys("load"), region_keys("support"), place_keys("support")})
    keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

} // namespace

const char* name_of(MassType mass) {
  return to_name(mass_names, mass);
}
const char* name_of(LightFunctions remedy) {
  return to_name(remedy_names, remedy);
}

LightTreatment default_light_treatment(MassType mass) {
  if (mass == MassType::Consistent) return {LightFunctions::DegreeP, 1e-3, 1e-6};
  // More costs time step: at 0.05 it is a quarter on the foam part, at 0.01 nothing. And the series of two passes may
  // lose its positivity.
  return {LightFunctions::Linear, 0.01};
}

TypedRun read_run_file(const std::filesystem::path& file) {
  io::SettingsTable root = io::SettingsTable::read(file);
  root.expect_only(run_keys());
  TypedRun t;
  t.model = root.path("model");
  t.output = root.path("output");
  t.units = root.text("units");
  t.mass = root.text("mass");
  t.light_functions = root.text("light_functions");
  t.light_threshold = root.number("light_threshold");
  t.unit_system = root.text("unit_system");
  t.materials = root.path("materials");
  if (root.holds_text("material")) {
    t.material = root.text("material");
  } else {
    io::SettingsTable material = root.table("material");
    t.material = material.text("name");
    t.E = material.number("E");
    t.nu = material.number("nu");
    t.rho = material.number("rho");
    t.C = material.numbers("C", {21, 36});
  }
  io::SettingsTable eigen = root.table("eigen");
  t.modes = eigen.integer("modes");
  t.largest = eigen.boolean("largest");
  t.sturm = eigen.boolean("sturm");
  io::SettingsTable results = root.table("results");
  t.subdivide = results.integer("subdivide");
  t.viewer = results.boolean("viewer");
  t.supports = read_supports(root);
  t.statics = read_static_settings(root);
  root.refuse_unknown_keys();
  return t;
}

TypedRun override_run(TypedRun t, const TypedRun& flags) {
  const auto take = [](auto& target, const auto& flag) {
    if (flag) target = flag;
  };
  take(t.model, flags.model);
  take(t.output, flags.output);
  take(t.units, flags.units);
  take(t.mass, flags.mass);
  take(t.light_functions, flags.light_functions);
  take(t.light_threshold, flags.light_threshold);
  take(t.unit_system, flags.unit_system);
  take(t.materials, flags.materials);
  if (flags.material) { // in the place of the file's material
    t.material = flags.material;
    t.E = t.nu = t.rho = std::nullopt;
    t.C.reset();
  }
  if (flags.E || flags.nu) t.C.reset(); // an isotropic material by flag replaces the file's matrix
  take(t.E, flags.E);
  take(t.nu, flags.nu);
  take(t.rho, flags.rho);
  take(t.modes, flags.modes);
  take(t.largest, flags.largest);
  take(t.sturm, flags.sturm);
  take(t.subdivide, flags.subdivide);
  take(t.viewer, flags.viewer);
  return t;
}

CompletedRun complete_material(TypedRun typed) {
  CompletedRun run;
  if ((typed.material || typed.unit_system) && typed.model) {
    run.units = &choose_units(typed.unit_system, io::read_length_unit(*typed.model), typed.model->string());
    if (typed.material) {
      if (typed.C)
        throw InputError(fmt::format("material: give either a name, \"{}\", or a matrix C, not both", *typed.material));
      run.named = find_material(*typed.material, typed.materials);
      if (!typed.E) typed.E = run.named.E / run.units->pascal();
      if (!typed.nu) typed.nu = run.named.nu;
      if (!typed.rho) typed.rho = run.named.rho / run.units->kg_per_m3();
    }
  }
  if (typed.materials && !typed.material)
    throw InputError(fmt::format("materials: {} is given, but no name of a material in it; add material = \"…\"",
                                 typed.materials->string()));
  run.typed = std::move(typed);
  return run;
}

RunSettings validate_run(const TypedRun& typed, Analysis analysis) {
  RunSettings run;
  run.analysis = analysis;
  if (!typed.model)
    throw InputError("no model file is given; give one made by igaprep, or model = \"…\" in the run file");
  run.model = *typed.model;
  if (typed.output) run.output = *typed.output;
  run.units = typed.units;
  run.material = material_of(typed, analysis);
  run.words.E = typed.E;
  run.words.nu = typed.nu;
  run.words.rho = typed.rho;
  run.mass = analysis == Analysis::Timestep ? MassType::Lumped : MassType::Consistent;
  run.eigen.largest = typed.largest.value_or(false);
  if (run.eigen.largest) run.mass = MassType::Lumped;
  if (typed.mass) run.mass = from_name(mass_names, "mass", *typed.mass);
  run.light = default_light_treatment(run.mass);
  if (typed.light_functions) {
    run.light.remedy = from_name(remedy_names, "light_functions", *typed.light_functions);
    if (run.light.remedy == LightFunctions::Remove && !typed.light_threshold) run.light.threshold = 1e-8;
  }
  if (typed.light_threshold) {
    if (!(*typed.light_threshold >= 0 && *typed.light_threshold < 1))
      throw InputError(
          fmt::format("light_threshold: found {}, expected a mass fraction 0 … 1", *typed.light_threshold));
    run.light.threshold = *typed.light_threshold;
    run.light.threshold_with_gap_ends = -1;
  }
  run.supports = typed.supports;
  run.statics = typed.statics;
  if (typed.modes) run.eigen.modes = whole("modes", *typed.modes, 1, 1'000'000);
  run.eigen.sturm = typed.sturm;
  if (typed.subdivide) run.subdivide = whole("subdivide", *typed.subdivide, 1, 64);
  run.viewer = typed.viewer.value_or(true);
  return run;
}

} // namespace iga::solve
