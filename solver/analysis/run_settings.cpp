#include "solver/analysis/run_settings.hpp"

#include "format/io/settings_reader.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/model/errors.hpp"
#include "solver/base/run_tables.hpp"
#include "solver/supports/read_attached.hpp"
#include "solver/ties/read_ties.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

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

/// Whose material it is, for messages.
struct MaterialPlace {
  std::string subject = "material", rho = "--rho or rho in [material], or a name: --material steel",
              E_nu = "--E and --nu, or E and nu in [material], or a matrix C there, or a name: --material steel";
};

MaterialPlace place_of_material(const TypedBody& body) {
  return {fmt::format("{}: material of body '{}'", body.file.where, body.file.name),
          "rho in its material or in [material], or a name: material = \"steel\"",
          "E and nu, a name, or a matrix C, in its material, or in [material]"};
}

void need_density(const TypedRun& typed, Analysis analysis, const std::string& body, const MaterialPlace& place) {
  if (analysis == Analysis::Heat) return;
  if (analysis == Analysis::Eigen || analysis == Analysis::Timestep)
    throw InputError(fmt::format("{}: the density is missing; give {}", place.subject, place.rho));
  if (typed.statics.inertia_relief)
    throw InputError(
        fmt::format("{}: the density is missing, which inertia_relief needs; give {}", place.subject, place.rho));
  for (const Load& load : typed.statics.loads)
    if ((load.kind == LoadKind::Acceleration || load.kind == LoadKind::Centrifugal) &&
        (load.body.empty() || load.body == body))
      throw InputError(fmt::format("{}: the density is missing, but load '{}' ({}) acts on it; give {}", place.subject,
                                   load.name, name_of(load.kind), place.rho));
}

ElasticMaterial elastic_material(const TypedMaterial& typed, const MaterialPlace& place, Analysis analysis) {
  const double rho = typed.rho.value_or(1); // statics do not use it
  if (typed.C) {
    if (typed.E || typed.nu) throw InputError(fmt::format("{}: give either C or E and nu, not both", place.subject));
    return anisotropic(voigt_matrix(*typed.C), rho);
  }
  if (analysis == Analysis::Heat && !typed.E && !typed.nu) return isotropic(1, 0, rho); // heat does not use them
  if (!typed.E || !typed.nu)
    throw InputError(fmt::format("{}: {} missing; give {}", place.subject,
                                 !typed.E && !typed.nu ? "E and nu are"
                                 : typed.E             ? "nu is"
                                                       : "E is",
                                 place.E_nu));
  return isotropic(*typed.E, *typed.nu, rho);
}

ElasticMaterial material_of(const TypedMaterial& typed, const MaterialPlace& place, Analysis analysis) {
  ElasticMaterial material = elastic_material(typed, place, analysis);
  material.expansion = typed.expansion;
  material.conductivity = typed.conductivity;
  return material;
}

MaterialWords words_of(const TypedMaterial& material, const UnitSystem* units) {
  return {material.found.name, material.found.source, material.E,    material.nu, material.rho, units,
          material.expansion,  material.conductivity, material.yield};
}

void complete(TypedMaterial& material, const TypedRun& typed) {
  if (!material.name) return;
  if (material.C)
    throw InputError(fmt::format("material: give either a name, \"{}\", or a matrix C, not both", *material.name));
  material.found = find_material(*material.name, typed.materials);
  if (!material.E) material.E = material.found.E / typed.unit->pascal();
  if (!material.nu) material.nu = material.found.nu;
  if (!material.rho) material.rho = material.found.rho / typed.unit->kg_per_m3();
  if (!material.yield && material.found.yield) material.yield = *material.found.yield / typed.unit->pascal();
  if (!material.expansion) material.expansion = material.found.expansion;
  if (!material.conductivity && material.found.conductivity)
    material.conductivity = *material.found.conductivity / typed.unit->watt_per_m_k();
}

// Turns per minute become radians per unit of time.
void resolve_speeds(const TypedRun& typed, std::vector<Load>& loads) {
  constexpr double seconds_per_minute = 60;
  for (Load& load : loads) {
    if (!load.spin.rpm) continue;
    if (!typed.unit)
      throw InputError(fmt::format("load '{}': rpm needs a unit of time; add unit_system = \"t-mm-s\", \"kg-mm-ms\" or "
                                   "\"SI\" to the run file, or give speed in radians per time",
                                   load.name));
    load.spin.speed = 2 * std::numbers::pi * *load.spin.rpm / seconds_per_minute * typed.unit->s;
    load.spin.rpm.reset();
  }
}

LightTreatment light_treatment(MassType mass, const std::optional<std::string>& functions,
                               const std::optional<double>& threshold) {
  LightTreatment light = default_light_treatment(mass);
  if (functions) {
    light.remedy = from_name(remedy_names, "light_functions", *functions);
    if (light.remedy == LightFunctions::Remove && !threshold) light.threshold = 1e-8;
  }
  if (threshold) {
    if (!(*threshold >= 0 && *threshold < 1))
      throw InputError(fmt::format("light_threshold: found {}, expected a mass fraction 0 … 1", *threshold));
    light.threshold = *threshold;
    light.threshold_with_gap_ends = -1;
  }
  return light;
}

// Anisotropy turns with the body.
RunBody run_body(const TypedRun& typed, const TypedBody& body, Analysis analysis, MassType mass) {
  const MaterialPlace place = place_of_material(body);
  const TypedMaterial material = body.material.value_or(typed.material);
  if (!material.rho) need_density(typed, analysis, body.file.name, place);
  // Units are told from modulus and density together.
  const bool has_density = material.rho.has_value() && (material.E.has_value() || material.C.has_value());
  RunBody of_run{body.file, {}, {}, has_density, words_of(material, typed.unit)};
  try {
    of_run.material = turned(material_of(material, place, analysis), body.file.place.R);
    of_run.light = light_treatment(mass, body.light_functions ? body.light_functions : typed.light_functions,
                                   body.light_threshold ? body.light_threshold : typed.light_threshold);
  } catch (const InputError& error) { // values that make no sense do not know whose they are
    const std::string text = error.what();
    throw InputError(text.starts_with(body.file.where)
                         ? text
                         : fmt::format("{}: body '{}': {}", body.file.where, body.file.name, text));
  }
  return of_run;
}

void refuse_two_kinds_of_bodies(const TypedRun& typed) {
  if (typed.bodies.empty()) {
    if (!typed.ties.empty())
      throw InputError(fmt::format("{}: a tie joins two bodies; name them in [[bodies]]", typed.ties.front().where));
    return;
  }
  if (typed.model)
    throw InputError(fmt::format("{}: the run has [[bodies]], and a model of its own, {}; leave one of them out",
                                 typed.bodies.front().file.where, typed.model->string()));
}

// What a static run would leave out without a word.
void refuse_variations(const TypedRun& typed) {
  if (const auto& base = typed.response.base)
    throw InputError(
        fmt::format("{}: a static analysis knows no [base]; leave it out, or run igasolve harmonic, random "
                    "or transient",
                    base->acceleration.where));
  for (const Variation& load : typed.response.loads)
    if (load.given())
      throw InputError(fmt::format("{}: this load has a spectrum, phase, psd or history, which a static analysis would "
                                   "leave out; run igasolve harmonic, random or transient",
                                   load.where));
}

// Length/time² of one g in the units of the run.
double gravity_of(const TypedRun& typed, const BaseMotion& base) {
  constexpr double standard_gravity = 9.80665; // m/s², exact
  if (base.gravity) return *base.gravity;
  if (!typed.unit)
    throw InputError(fmt::format("{}: accelerations in g, but the units of the run are not known; give gravity = … "
                                 "(length/time² of one g) in [base], or unit_system",
                                 base.acceleration.where));
  return standard_gravity * typed.unit->s * typed.unit->s / typed.unit->m;
}

ResponseSettings response_of(const TypedRun& typed) {
  ResponseSettings response = typed.response;
  response.choose_modes = !typed.modes && !typed.modes_below;
  if (response.base && response.base->in_g) response.base->gravity = gravity_of(typed, *response.base);
  return response;
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
        "light_threshold", "inertia_relief", "solver"}},
      {"material", {"name", "E", "nu", "rho", "C", "yield", "expansion", "conductivity"}},
      {"bodies", {"light_functions", "light_threshold"}},
      {"bodies.material", {"law", "name", "E", "nu", "rho", "C", "yield", "expansion", "conductivity"}},
      {"eigen", {"modes", "modes_below", "largest", "sturm", "errors", "prestress"}},
      {"buckling", {"factors", "negative", "constant", "sturm"}},
      {"results", {"subdivide", "viewer", "stress"}}};
  for (const auto& more :
       {static_keys(), body_file_keys(), tie_keys(), response_keys(), stress_line_keys(), attached_keys()})
    keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

// @param statics  of the run, to know the loads that stay constant
TypedBuckling read_buckling(io::SettingsTable table, const StaticSettings& statics) {
  TypedBuckling buckling;
  buckling.factors = table.integer("factors");
  buckling.negative = table.boolean("negative");
  buckling.sturm = table.boolean("sturm");
  if (table.holds_text("constant"))
    buckling.constant = {*table.text("constant")};
  else if (const auto names = table.texts("constant"))
    buckling.constant = *names;
  std::vector<std::string> known;
  for (const Load& load : statics.loads) known.push_back(load.name);
  for (const Bolt& bolt : statics.bolts) known.push_back(bolt.name);
  for (const std::string& name : buckling.constant) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto near = io::nearest_name(name, known);
    refuse(table, "constant",
           fmt::format("found \"{}\", which no [[load]] and no [[bolt]] has for its name; expected some of: {}{}", name,
                       fmt::join(known, ", "), near ? fmt::format("; did you mean {}?", *near) : ""));
  }
  return buckling;
}

TypedMaterial read_material(io::SettingsTable& table) {
  TypedMaterial material;
  material.name = table.text("name");
  material.E = table.number("E");
  material.nu = table.number("nu");
  material.rho = table.number("rho");
  material.yield = table.number("yield");
  if (material.yield && !(*material.yield > 0))
    refuse(table, "yield", fmt::format("found {}, expected a stress above 0", *material.yield));
  material.C = table.numbers("C", {21, 36});
  material.expansion = table.number("expansion");
  material.conductivity = table.number("conductivity");
  if (material.conductivity && !(*material.conductivity > 0))
    refuse(table, "conductivity", fmt::format("found {}, expected a number above 0", *material.conductivity));
  return material;
}

void read_bodies(io::SettingsTable& root, TypedRun& run) {
  std::vector<std::string> names;
  for (io::SettingsTable& table : root.tables("bodies")) {
    TypedBody body;
    body.file = read_body_file(table, names);
    names.push_back(body.file.name);
    io::SettingsTable material = table.table("material");
    const auto law = material.text("law"); // as explicit runs have it
    if (law && *law != "linear-elastic")
      refuse(material, "law",
             fmt::format("found \"{}\", expected \"linear-elastic\" or none: this analysis is linear", *law));
    const TypedMaterial typed = read_material(material);
    if (typed.name || typed.E || typed.nu || typed.rho || typed.C || typed.expansion || typed.conductivity)
      body.material = typed;
    body.light_functions = table.text("light_functions");
    body.light_threshold = table.number("light_threshold");
    run.bodies.push_back(std::move(body));
  }
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
  std::vector<io::TableKeys> keys = run_keys();
  for (const auto& more : {case_keys(root), temperature_keys(), bolt_keys(), heat_keys()})
    keys.insert(keys.end(), more.begin(), more.end());
  root.expect_only(keys);
  TypedRun t;
  t.model = root.path("model");
  t.output = root.path("output");
  t.units = root.text("units");
  t.mass = root.text("mass");
  t.light_functions = root.text("light_functions");
  t.light_threshold = root.number("light_threshold");
  t.solver = root.text("solver");
  if (t.solver) solver_kind(*t.solver);
  t.unit_system = root.text("unit_system");
  t.materials = root.path("materials");
  if (root.holds_text("material")) {
    t.material.name = root.text("material");
  } else {
    io::SettingsTable material = root.table("material");
    t.material = read_material(material);
  }
  read_bodies(root, t);
  t.ties = read_ties(root);
  io::SettingsTable eigen = root.table("eigen");
  t.modes = eigen.integer("modes");
  t.modes_below = eigen.number("modes_below");
  if (t.modes && t.modes_below) refuse(eigen, "modes_below", "given together with modes; give one of them");
  t.largest = eigen.boolean("largest");
  t.sturm = eigen.boolean("sturm");
  t.errors = eigen.boolean("errors");
  t.prestress = eigen.boolean("prestress");
  io::SettingsTable results = root.table("results");
  t.subdivide = results.integer("subdivide");
  t.viewer = results.boolean("viewer");
  t.stress = results.text("stress");
  if (t.stress && *t.stress != "recovered" && *t.stress != "raw")
    refuse(results, "stress", fmt::format("found \"{}\", expected \"recovered\" or \"raw\"", *t.stress));
  t.supports = read_supports(root);
  t.springs = read_springs(root);
  t.masses = read_masses(root);
  t.statics = read_static_settings(root);
  t.heat = read_heat(root);
  t.response = read_response_settings(root);
  t.buckling = read_buckling(root.table("buckling"), t.statics);
  t.lines = read_stress_lines(root);
  root.refuse_unknown_keys();
  return t;
}

std::vector<RunBody> bodies_of(const RunSettings& run) {
  if (!run.bodies.empty()) return run.bodies;
  return {{{{}, {}, run.model, {}}, run.material, run.light, run.has_density, run.words}};
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
  take(t.solver, flags.solver);
  take(t.unit_system, flags.unit_system);
  take(t.materials, flags.materials);
  TypedMaterial& material = t.material;
  if (flags.material.name) material = {}; // in the place of the file's material
  take(material.name, flags.material.name);
  if (flags.material.E || flags.material.nu) material.C.reset(); // an isotropic one by flag replaces the file's matrix
  take(material.E, flags.material.E);
  take(material.nu, flags.material.nu);
  take(material.rho, flags.material.rho);
  if (flags.modes && flags.modes_below) throw InputError("--modes and --modes-below are both given; give one of them");
  if (flags.modes || flags.modes_below) { // in the place of the file's choice
    t.modes = flags.modes;
    t.modes_below = flags.modes_below;
  }
  take(t.largest, flags.largest);
  take(t.sturm, flags.sturm);
  take(t.errors, flags.errors);
  take(t.prestress, flags.prestress);
  take(t.buckling.factors, flags.buckling.factors);
  take(t.buckling.negative, flags.buckling.negative);
  take(t.buckling.sturm, flags.buckling.sturm);
  take(t.subdivide, flags.subdivide);
  take(t.viewer, flags.viewer);
  return t;
}

TypedRun complete_materials(TypedRun typed) {
  bool named = typed.material.name.has_value();
  for (const TypedBody& body : typed.bodies) named = named || (body.material && body.material->name);
  if (typed.materials && !named)
    throw InputError(fmt::format("materials: {} is given, but no name of a material in it; add material = \"…\"",
                                 typed.materials->string()));
  // All models of a run have one length unit.
  const auto model = typed.bodies.empty() ? typed.model : std::optional(typed.bodies.front().file.model);
  if (!model || (!named && !typed.unit_system)) return typed;
  typed.unit = &choose_units(typed.unit_system, io::read_length_unit(*model), model->string());
  complete(typed.material, typed);
  for (TypedBody& body : typed.bodies)
    if (body.material) complete(*body.material, typed);
  return typed;
}

RunSettings validate_run(const TypedRun& typed, Analysis analysis) {
  RunSettings run;
  run.analysis = analysis;
  refuse_two_kinds_of_bodies(typed);
  if (!typed.model && typed.bodies.empty())
    throw InputError("no model file is given; give one made by igaprep, or model = \"…\" in the run file");
  if (typed.output) run.output = *typed.output;
  run.units = typed.units;
  run.mass = analysis == Analysis::Timestep ? MassType::Lumped : MassType::Consistent;
  run.eigen.largest = typed.largest.value_or(false);
  if (run.eigen.largest) run.mass = MassType::Lumped;
  if (typed.mass) run.mass = from_name(mass_names, "mass", *typed.mass);
  for (const TypedBody& body : typed.bodies) run.bodies.push_back(run_body(typed, body, analysis, run.mass));
  if (run.bodies.empty()) {
    run.model = *typed.model;
    if (!typed.material.rho) need_density(typed, analysis, "", {});
    run.material = material_of(typed.material, {}, analysis);
    run.words = words_of(typed.material, typed.unit);
    run.has_density = typed.material.rho.has_value() && (typed.material.E.has_value() || typed.material.C.has_value());
    run.light = light_treatment(run.mass, typed.light_functions, typed.light_threshold);
  }
  run.ties = typed.ties;
  run.supports = typed.supports;
  run.springs = typed.springs;
  run.masses = typed.masses;
  run.statics = typed.statics;
  run.heat = typed.heat;
  resolve_speeds(typed, run.statics.loads);
  if (analysis == Analysis::Static) refuse_variations(typed);
  if (is_response(analysis)) run.response = response_of(typed);
  run.lines = typed.lines;
  if (typed.solver) run.solver = solver_kind(*typed.solver);
  if (run.solver == SolverKind::Multigrid && analysis != Analysis::Static && analysis != Analysis::Eigen)
    throw InputError("solver = \"multigrid\": only static and eigen have it; use \"auto\" or \"direct\"");
  run.raw_stress = typed.stress == "raw";
  if (typed.modes) run.eigen.modes = whole("modes", *typed.modes, 1, 1'000'000);
  if (typed.modes_below && !(*typed.modes_below > 0))
    throw InputError(fmt::format("modes_below: found {:g}, expected a frequency above 0", *typed.modes_below));
  run.eigen.modes_below = typed.modes_below;
  run.eigen.sturm = typed.sturm;
  run.eigen.errors = typed.errors;
  run.eigen.prestress = typed.prestress.value_or(false);
  if (typed.buckling.factors) run.buckling.factors = whole("factors", *typed.buckling.factors, 1, 1000);
  run.buckling.negative = typed.buckling.negative.value_or(false);
  run.buckling.constant = typed.buckling.constant;
  run.buckling.sturm = typed.buckling.sturm;
  if (typed.subdivide) run.subdivide = whole("subdivide", *typed.subdivide, 1, 64);
  run.viewer = typed.viewer.value_or(true);
  return run;
}

} // namespace iga::solve
