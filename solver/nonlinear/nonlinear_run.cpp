#include "solver/nonlinear/nonlinear_run.hpp"

#include "format/model/errors.hpp"
#include "solver/analysis/run_settings.hpp"
#include "solver/base/run_tables.hpp"
#include "solver/explicit/run/run_parts.hpp"
#include "solver/mechanics/incompressible.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

void read_material(io::SettingsTable& root, NonlinearRun& run) {
  if (root.holds_text("material"))
    refuse(
        root, "material",
        "a name alone says nothing of the law; write material = { law = \"neo-hookean\", name = \"…\" }, or E and nu");
  io::SettingsTable table = root.table("material");
  auto defaults = named_material(table, root.text("unit_system"), root.path("materials"), run.model, run.words)
                      .value_or(MaterialDefaults{});
  const bool has_density = table.holds("rho") || defaults.rho;
  if (!has_density) defaults.rho = 1; // statics do not use it
  run.material = solve::read_material(table, defaults);
  if (table.holds_text("yield_curve")) run.inputs.push_back(*table.path("yield_curve"));
  run.warnings = run.material.warnings;
  for (const char* key : {"bulk_viscosity", "damping", "rate_law"})
    if (table.holds(key))
      run.warnings.push_back(fmt::format("{}: has no effect: load steps have no duration", table.where(key)));
  if (run.material.inversion.action != InvertedPoints::Clamp)
    refuse(table, "inversion", "statics know \"clamp\" alone: a point that is taken out never comes into equilibrium");
  for (const NonlinearLoad& load : run.loads)
    if (load.load.kind == LoadKind::Acceleration && !has_density)
      refuse(table, "rho", fmt::format("missing, but load '{}' is an acceleration; give the density", load.load.name));
}

LightTreatment read_light(io::SettingsTable& root) {
  const std::array<std::string, 4> names{"none", "remove", "linear", "degree-p"};
  constexpr std::array remedies{LightFunctions::None, LightFunctions::Remove, LightFunctions::Linear,
                                LightFunctions::DegreeP};
  LightTreatment light = default_light_treatment(MassType::Consistent);
  const auto threshold = root.number("light_threshold");
  if (const auto name = root.text("light_functions")) {
    light.remedy = remedies[choose(root, "light_functions", *name, names)];
    if (light.remedy == LightFunctions::Remove) light.threshold = 1e-8;
  }
  if (threshold) {
    if (!(*threshold >= 0 && *threshold < 1))
      refuse(root, "light_threshold", fmt::format("found {:g}, expected a mass fraction 0 … 1", *threshold));
    light.threshold = *threshold;
    light.threshold_with_gap_ends = -1;
  }
  return light;
}

Locking read_locking(io::SettingsTable& root, const Law& law) {
  const std::array<std::string, 2> names{"none", "fbar"};
  constexpr std::array treatments{Locking::None, Locking::FBar};
  const bool small_strains = std::holds_alternative<LinearElastic>(law);
  if (const auto name = root.text("locking")) {
    const Locking locking = treatments[choose(root, "locking", *name, names)];
    if (locking == Locking::FBar && small_strains)
      refuse(root, "locking",
             "found \"fbar\", expected \"none\": linear-elastic is a law of small strains, whose volume is not det F; "
             "take neo-hookean");
    return locking;
  }
  if (!std::holds_alternative<NeoHookean>(law) && !std::holds_alternative<StVenantKirchhoff>(law)) return Locking::None;
  return is_nearly_incompressible(small_strain(law)) ? Locking::FBar : Locking::None;
}

void refuse_body(io::SettingsTable& table) {
  if (table.holds("body")) refuse(table, "body", "there is one body; leave it out");
  table.expect("body");
}

void read_supports(io::SettingsTable& root, NonlinearRun& run) {
  run.supports = solve::read_supports(root);
  auto tables = root.tables("support");
  for (std::size_t s = 0; s < run.supports.size(); ++s) {
    Support& support = run.supports[s];
    if (support.method == SupportMethod::Lagrange)
      refuse(tables[s], "method",
             "found \"lagrange\", expected \"penalty\": this analysis holds all supports by penalty");
    if (tables[s].text("method") == "nitsche")
      refuse(tables[s], "method",
             "found \"nitsche\", expected \"penalty\": Nitsche's method as this program has it is linear");
    if (support.radial)
      refuse(tables[s], "fixed",
             "\"pinned\" and \"radial\" hold small displacements only: at large ones the part turns away from its "
             "undeformed normals; fix components");
    refuse_body(tables[s]);
    read_name(tables[s], "name", support.name); // it is a name in the results file too
    support.method = SupportMethod::Penalty;
    for (std::size_t t = 0; t < s; ++t)
      if (run.supports[t].name == support.name)
        refuse(tables[s], "name", fmt::format("there is another support '{}'; give each a name", support.name));
  }
}

void read_loads(io::SettingsTable& root, NonlinearRun& run) {
  for (io::SettingsTable& table : root.tables("load")) {
    NonlinearLoad load{read_load(table, run.loads.size() + 1), false};
    refuse_body(table);
    const bool pressure = load.load.kind == LoadKind::Pressure;
    const auto follower = table.boolean("follower");
    if (follower && !pressure) refuse(table, "follower", "only a pressure follows the surface; leave it out");
    load.follower = follower.value_or(pressure);
    if (load.load.kind == LoadKind::Remote)
      refuse(table,
             table.holds("spread")   ? "spread"
             : table.holds("remote") ? "remote"
                                     : "moment",
             "moments and forces beside the part are those of small displacements only: their arms change as the part "
             "moves; give force, traction or pressure on a region");
    if (load.load.kind == LoadKind::Centrifugal)
      refuse(
          table, "name",
          "a part that turns is one of small displacements only: its forces grow with the radius; give a body_force");
    run.loads.push_back(std::move(load));
  }
  for (io::SettingsTable& table : root.tables("probe")) {
    Probe probe;
    probe.name = read_name(table, "name", fmt::format("probe {}", run.probes.size() + 1));
    probe.position = need_vector(table, "position", "the position");
    refuse_body(table);
    run.probes.push_back(std::move(probe));
  }
  auto probes = root.tables("probe");
  for (std::size_t k = 0; k < run.probes.size(); ++k)
    for (std::size_t j = 0; j < k; ++j)
      if (run.probes[j].name == run.probes[k].name)
        refuse(probes[k], "name", fmt::format("there is another probe '{}'; give each a name", run.probes[k].name));
}

// One run file for both kinds of runs: tools and contacts are read as those of explicit runs, then what has no meaning
// without time is refused.
void read_tools(io::SettingsTable& root, NonlinearRun& run) {
  ExplicitRun both;
  both.bodies.emplace_back();
  both.bodies.back().body.name = nonlinear_body;
  auto tools = root.tables("rigid_bodies");
  for (io::SettingsTable& table : tools)
    if (table.text("motion") == "free")
      refuse(table, "motion",
             "found \"free\", expected \"fixed\" or \"driven\": statics know no inertia; drive the tool");
  read_rigid_bodies(root, {}, both);
  read_contacts(root, both);
  io::SettingsTable search = root.table("contact");
  if (search.holds("skin")) refuse(search, "skin", "every point is looked at in each iteration; leave it out");
  auto tables = root.tables("contacts");
  for (std::size_t c = 0; c < both.contacts.size(); ++c) {
    io::SettingsTable& table = tables[c];
    const ContactPair& pair = both.contacts[c].pair;
    if (pair.second.kind != ContactSide::Kind::Rigid)
      refuse(table, table.holds("self") ? "self" : "bodies",
             "statics know contact of the part with rigid tools; igasolve explicit has bodies that touch themselves");
    for (const char* key : {"friction_dynamic", "friction_decay", "damping"})
      if (table.holds(key)) refuse(table, key, "statics know no velocities; leave it out");
    if (table.holds("edges")) refuse(table, "edges", "points of the part touch here, no edges; leave it out");
    ToolContactSettings contact;
    contact.name = pair.name;
    contact.where = pair.where;
    contact.tool = pair.second.number;
    contact.regions = pair.first.regions;
    contact.friction = pair.friction.static_coefficient;
    contact.rough = table.boolean("rough").value_or(false);
    if (contact.rough && table.holds("friction"))
      refuse(table, "friction", "given together with rough = true, which sticks at any force; leave one out");
    contact.stiffness = number_from(table, "stiffness", contact.stiffness, 0, true);
    contact.swapped = both.contacts[c].swapped;
    run.contacts.push_back(std::move(contact));
  }
  for (std::size_t r = 0; r < both.rigid.size(); ++r) {
    const bool touched = std::ranges::any_of(run.contacts, [r](const auto& contact) { return contact.tool == r; });
    if (!touched)
      run.warnings.push_back(fmt::format("{}: no [[contacts]] names it: it touches nothing", tools[r].where("shape")));
  }
  run.rigid = std::move(both.rigid);
  for (const RunInput& input : both.inputs) run.inputs.push_back(input.file);
  io::SettingsTable watch = root.table("watch");
  run.depth_warning = number_from(watch, "depth_warning", run.depth_warning, 0);
}

void read_newton(io::SettingsTable& root, NonlinearRun& run) {
  io::SettingsTable table = root.table("nonlinear");
  NewtonSettings& s = run.newton;
  const auto whole = [&](const char* key, int otherwise, std::int64_t most) {
    const std::int64_t value = table.integer(key).value_or(otherwise);
    if (value < 1 || value > most) refuse(table, key, fmt::format("found {}, expected 1 … {}", value, most));
    return static_cast<int>(value);
  };
  s.steps = whole("steps", s.steps, 100'000);
  s.max_iterations = whole("max_iterations", s.max_iterations, 1000);
  s.tolerance = number_from(table, "tolerance", s.tolerance, 0, true);
  if (s.tolerance > 1e-2)
    refuse(table, "tolerance", fmt::format("found {:g}, expected at most 0.01 of the forces", s.tolerance));
  s.smallest_step = number_from(table, "smallest_step", s.smallest_step, 0, true);
  if (s.smallest_step > 1)
    refuse(table, "smallest_step",
           fmt::format("found {:g}, expected a share of a load step, at most 1", s.smallest_step));
}

void read_results(io::SettingsTable& root, NonlinearRun& run) {
  io::SettingsTable table = root.table("results");
  run.subdivide = static_cast<int>(table.integer("subdivide").value_or(run.subdivide));
  if (run.subdivide < 1 || run.subdivide > 64)
    refuse(table, "subdivide", fmt::format("found {}, expected 1 … 64", run.subdivide));
  run.viewer = table.boolean("viewer").value_or(true);
  run.points = table.boolean("points").value_or(false);
}

} // namespace

std::vector<io::TableKeys> nonlinear_keys() {
  std::vector<io::TableKeys> keys{{"",
                                   {"model", "output", "units", "unit_system", "materials", "material",
                                    "light_functions", "light_threshold", "locking"}},
                                  {"material", material_keys()},
                                  {"nonlinear", {"steps", "tolerance", "max_iterations", "smallest_step"}},
                                  {"results", {"subdivide", "viewer", "points"}},
                                  {"load", {"follower"}},
                                  {"contacts", {"rough"}},
                                  {"watch", {"depth_warning"}}};
  for (const auto& more : {tool_keys(), static_keys()}) keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

NonlinearRun read_nonlinear_run(const std::filesystem::path& file) {
  io::SettingsTable root = io::SettingsTable::read(file);
  if (root.holds("bodies"))
    refuse(root, "bodies",
           "nonlinear statics know one body; give model = \"…\" and [material], or use explicit runs for several");
  root.expect_only(nonlinear_keys());
  NonlinearRun run;
  run.file = file;
  run.settings = root.entries();
  const auto model = root.path("model");
  if (!model) refuse(root, "model", "missing; give a file made by igaprep");
  run.model = *model;
  run.inputs.push_back(run.model);
  run.output = root.path("output").value_or("");
  run.units = root.text("units");
  read_supports(root, run);
  read_loads(root, run);
  read_tools(root, run);
  read_material(root, run);
  run.light = read_light(root);
  run.locking = read_locking(root, run.material.law);
  read_newton(root, run);
  read_results(root, run);
  for (const Support& support : run.supports)
    if (support.region.patch) run.inputs.push_back(support.region.patch->file);
  for (const NonlinearLoad& load : run.loads)
    if (load.load.region.patch) run.inputs.push_back(load.load.region.patch->file);
  root.refuse_unknown_keys();
  return run;
}

} // namespace iga::solve
