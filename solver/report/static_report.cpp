#include "solver/report/static_report.hpp"

#include "format/model/vec3.hpp"
#include "solver/report/analysis_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tuple>

namespace iga::solve {

namespace {

using io::JsonObject;

std::string text(const Point3& v, double unit = 0) {
  Point3 shown = v;
  for (double& c : shown)
    if (std::abs(c) <= 1e-12 * std::max(unit, norm(v))) c = 0; // rounding of a much larger number
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", shown[0], shown[1], shown[2]);
}

Point3 point(const std::vector<double>& values, std::size_t k) {
  return {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
}

// The largest force of the run: what is small against it is rounding.
double force_unit(const StaticSolution& s) {
  double unit = 0;
  for (const SupportResult& support : s.result.supports) unit = std::max(unit, norm(support.force));
  for (const SpringResult& spring : s.result.springs) unit = std::max(unit, norm(spring.force));
  for (const LoadResult& load : s.result.loads) unit = std::max(unit, norm(load.force));
  // Thermal stress may hold itself: then reactions are rounding of it.
  for (const SupportResult& support : s.result.supports)
    if (!s.temperatures.empty()) unit = std::max(unit, s.largest_von_mises.value * support.area);
  return unit;
}

std::vector<double> slice(const std::vector<double>& values, std::size_t k, std::size_t width) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(k * width);
  return {first, first + static_cast<std::ptrdiff_t>(width)};
}

std::string size_of(const RegionReport& region, const Point3& centroid) {
  if (region.extent == Extent::Line) return fmt::format("length {:.6g}, centroid {}", region.length, text(centroid));
  return region.area > 0 ? fmt::format("area {:.6g}, centroid {}", region.area, text(centroid))
                         : fmt::format("acts about {}", text(centroid));
}

// The bodies that move together, where the run has several.
std::string of_bodies(const RigidAcceleration& a) {
  return a.bodies.empty() ? "" : fmt::format(" of '{}'", fmt::join(a.bodies, "', '"));
}

std::vector<JsonObject> json_of(const std::vector<RigidAcceleration>& relief) {
  std::vector<JsonObject> list;
  for (const RigidAcceleration& a : relief) {
    list.emplace_back();
    if (!a.bodies.empty()) list.back().add("bodies", a.bodies);
    list.back().add("mass", a.mass).add("centre", a.centre).add("acceleration", a.acceleration);
    list.back().add("angular_acceleration", a.angular).add("inertia_force", a.inertia_force);
    list.back().add("inertia_moment_about_origin", a.inertia_moment);
  }
  return list;
}

std::vector<JsonObject> json_of(const std::vector<TemperatureReport>& temperatures) {
  std::vector<JsonObject> list;
  for (const TemperatureReport& t : temperatures) {
    list.emplace_back();
    if (!t.body.empty()) list.back().add("body", t.body);
    list.back().add("source", t.source).add("least", t.least).add("most", t.most);
    list.back().add("reference", t.reference).add("factor", t.factor);
  }
  return list;
}

JsonObject named(const std::string& name, const std::string& body) {
  JsonObject object;
  object.add("name", name);
  if (!body.empty()) object.add("body", body);
  return object;
}

std::vector<JsonObject> json_of(const std::vector<BoltReport>& bolts) {
  std::vector<JsonObject> list;
  for (const BoltReport& b : bolts) {
    list.push_back(named(b.name, b.body));
    list.back().add("preload", b.preload).add("factor", b.factor).add("section", b.section);
    list.back().add("shortening", b.shortening).add("force", b.force);
  }
  return list;
}

JsonObject json_of(const RegionMotion& motion) {
  return JsonObject().add("at", motion.at).add("displacement", motion.displacement).add("rotation", motion.rotation);
}

// A body's name, where it has to be said.
std::string on(const std::string& body) {
  return body.empty() ? "" : fmt::format(" on '{}'", body);
}

void add_largest(JsonObject& report, const std::string& name, const LargestValue& largest, const BodySystem& system) {
  report.add(name, largest.value).add(name + "_at", largest.at);
  if (system.size() > 1) report.add(name + "_body", system[largest.body].name);
}

std::vector<JsonObject> json_of_ties(const StaticSolution& s) {
  std::vector<JsonObject> ties = json_of(s.ties);
  for (std::size_t k = 0; k < ties.size(); ++k)
    ties[k]
        .add("force", s.tie_forces[k].force)
        .add("moment_about_origin", s.tie_forces[k].moment)
        .add("largest_jump", s.tie_forces[k].largest_jump);
  return ties;
}

} // namespace

std::string static_text(const StaticSolution& s, const BodySystem& system) {
  std::string out;
  const double unit = force_unit(s);
  const auto line = [&](const std::string& words) { out += words + "\n"; };
  line(fmt::format("system: {} constraints, {} {:.3g} MiB", s.num_constraints, s.solver.multigrid ? "levels" : "factor",
                   s.cost.bytes / (1024.0 * 1024.0)));
  line("solver: " + text_of(s.solver));
  const auto note = [&](const RegionReport& region) {
    if (!region.note.empty()) line("  " + region.note);
  };
  for (std::size_t k = 0; k < s.ties.size(); ++k) {
    const TieReport& t = s.ties[k];
    line(fmt::format("tie '{}' of '{}' and '{}': area {:.6g} of {:.6g} and {:.6g} chosen, largest gap {:.3g}", t.name,
                     t.bodies[0], t.bodies[1], t.area, t.chosen[0], t.chosen[1], t.largest_gap));
    line(fmt::format("  force on '{}' {}, largest jump of the displacement {:.3g}", t.bodies[0],
                     text(s.tie_forces[k].force, unit), s.tie_forces[k].largest_jump));
  }
  for (std::size_t k = 0; k < s.result.supports.size(); ++k) {
    const SupportResult& r = s.result.supports[k];
    line(fmt::format("support '{}'{} ({}): {}", r.name, on(s.regions[k].body), r.method,
                     size_of(s.regions[k], r.centroid)));
    note(s.regions[k]);
    line(fmt::format("  reaction {}, moment about the centroid {}", text(r.force, unit), text(r.moment)));
  }
  for (std::size_t k = 0; k < s.result.springs.size(); ++k) {
    const SpringResult& r = s.result.springs[k];
    line("spring " + text_of(s.attached.springs[k]));
    line(fmt::format("  force {}, moment about the centroid {}, energy {:.8g}", text(r.force, unit), text(r.moment),
                     r.energy));
  }
  for (const auto& mass : s.attached.masses) line("added mass " + text_of(mass));
  for (std::size_t k = 0; k < s.result.loads.size(); ++k) {
    const LoadResult& r = s.result.loads[k];
    const std::string times = s.factors.at(k) == 1 ? "" : fmt::format(" × {:g}", s.factors[k]);
    line(fmt::format("load '{}'{} ({}){}: {}", r.name, on(s.loads[k].region.body), r.kind, times,
                     size_of(s.loads[k].region, r.centroid)));
    note(s.loads[k].region);
    line(fmt::format("  resultant {}, moment about it {}", text(r.force, unit), text(r.moment)));
    for (const auto& [load, motion] : s.motions)
      if (load == k)
        line(fmt::format("  its region stays rigid: {} moves by {}, turns by {} rad", text(motion.at),
                         text(motion.displacement), text(motion.rotation)));
  }
  for (const TemperatureReport& t : s.temperatures)
    line(fmt::format("temperature{} ({}): {:.6g} … {:.6g}, no thermal strain at {:.6g}{}", on(t.body), t.source,
                     t.least, t.most, t.reference,
                     t.factor == 1 ? "" : fmt::format("; thermal strain × {:g}", t.factor)));
  for (const BoltReport& b : s.bolts) {
    line(fmt::format("bolt '{}'{}: preload {:.6g}, section {:.6g}, shortened by {:.6g}{}", b.name, on(b.body),
                     b.preload, b.section, b.shortening, b.factor == 1 ? "" : fmt::format(" × {:g}", b.factor)));
    line(fmt::format("  tension under all that acts {:.6g}, mean stress {:.6g}", b.force, b.force / b.section));
  }
  for (const RigidAcceleration& a : s.relief) {
    line(fmt::format("inertia relief{}: mass {:.6g} accelerates by {} at its centre {}", of_bodies(a), a.mass,
                     text(a.acceleration), text(a.centre)));
    line(fmt::format("  turns by {} rad/time²; force of inertia {}, displacements without rigid motion",
                     text(a.angular), text(a.inertia_force, unit)));
  }
  line(fmt::format("balance of forces {}, relative residual {:.2g}", text(s.force_balance, unit), s.residual));
  const StaticResult& r = s.result;
  const char* const holders = s.ties.empty() ? "the supports" : "supports and ties";
  line(fmt::format("strain energy {:.8g} +{} penalty energy of {} {:.8g}", r.strain_energy,
                   r.springs.empty() ? "" : fmt::format(" energy of the springs {:.8g} +", r.spring_energy), holders,
                   r.penalty_energy));
  line(fmt::format(
      "  = work of the loads {:.8g} + of the reactions on prescribed displacements {:.8g} + of the stress on "
      "what {} give way {:.8g}{}; off by {:.2g}",
      r.external_work, r.support_work, holders, r.gap_work,
      r.initial_strain_work == 0
          ? ""
          : fmt::format(" + of the stress on thermal and bolts' strain {:.8g}", r.initial_strain_work),
      energy_defect(r)));
  if (const auto errors = relative_errors(s))
    line(fmt::format(
        "estimated errors on this grid: strain energy {:.2g} %, stresses {:.2g} % in the mean over the part "
        "(energy norm), from what\n  the solution leaves of the equations; peaks of stress may be farther off",
        100 * errors->strain_energy, 100 * errors->energy_norm));
  else if (!s.no_energy_error.empty())
    line("no estimate of errors: " + s.no_energy_error);
  line(fmt::format("largest displacement {:.6g} at {}{}", s.largest_displacement.value, text(s.largest_displacement.at),
                   of_body(system, s.largest_displacement.body)));
  const auto singular = [&](const std::string& body, const Point3& x) {
    if (const auto place = singular_place_near(s, body, x))
      line(
          fmt::format("  no stress to rely on: within two spans of {}, where it has no limit as spans shrink", *place));
  };
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    line(fmt::format("probe '{}'{} at {}", p.names[k], on(s.probe_bodies[k]), text(point(p.positions, k))));
    line(fmt::format("  displacement {}, von Mises {:.6g}", text(point(p.fields.displacement, k)),
                     p.fields.von_mises[k]));
    line(fmt::format("  stress xx yy zz xy yz zx: {:.6g}", fmt::join(slice(p.fields.stress, k, 6), "  ")));
    singular(s.probe_bodies[k], point(p.positions, k));
  }
  return out;
}

std::string envelope_text(std::span<const StaticSolution> cases, const BodySystem& system) {
  const CaseEnvelope envelope = envelope_of(cases);
  std::string out = "all cases:\n";
  for (const auto& [what, number, largest] :
       {std::tuple{"displacement", envelope.displacement, &StaticSolution::largest_displacement},
        std::tuple{"von Mises stress", envelope.von_mises, &StaticSolution::largest_von_mises}}) {
    const LargestValue& value = cases[number].*largest;
    out += fmt::format("  largest {} {:.6g} in case '{}' at {}{}\n", what, value.value, cases[number].case_name,
                       text(value.at), of_body(system, value.body));
  }
  return out;
}

CaseEnvelope envelope_of(std::span<const StaticSolution> cases) {
  CaseEnvelope envelope;
  for (std::size_t c = 1; c < cases.size(); ++c) {
    if (cases[c].largest_displacement.value > cases[envelope.displacement].largest_displacement.value)
      envelope.displacement = c;
    if (cases[c].largest_von_mises.value > cases[envelope.von_mises].largest_von_mises.value) envelope.von_mises = c;
  }
  return envelope;
}

JsonObject static_json(const StaticSolution& s, const BodySystem& system) {
  std::vector<JsonObject> supports, springs, loads, probes;
  for (std::size_t k = 0; k < s.result.supports.size(); ++k) {
    const SupportResult& r = s.result.supports[k];
    supports.push_back(named(r.name, s.regions[k].body));
    supports.back().add("method", r.method).add("area", r.area).add("centroid", r.centroid);
    supports.back().add("length", s.regions[k].length).add("note", s.regions[k].note);
    supports.back().add("force", r.force).add("moment", r.moment);
  }
  for (std::size_t k = 0; k < s.result.springs.size(); ++k) {
    const SpringResult& r = s.result.springs[k];
    springs.push_back(named(r.name, s.attached.springs[k].region.body));
    springs.back().add("area", r.area).add("centroid", r.centroid).add("force", r.force).add("moment", r.moment);
    springs.back().add("energy", r.energy);
  }
  for (std::size_t k = 0; k < s.result.loads.size(); ++k) {
    const LoadResult& r = s.result.loads[k];
    loads.push_back(named(r.name, s.loads[k].region.body));
    loads.back().add("kind", r.kind).add("factor", s.factors.at(k)).add("area", r.area).add("centroid", r.centroid);
    loads.back().add("length", s.loads[k].region.length).add("note", s.loads[k].region.note);
    loads.back().add("force", r.force).add("moment", r.moment);
    for (const auto& [load, motion] : s.motions)
      if (load == k) loads.back().add("motion", json_of(motion));
  }
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    probes.push_back(named(p.names[k], s.probe_bodies[k]));
    probes.back().add("position", point(p.positions, k));
    probes.back().add("displacement", point(p.fields.displacement, k));
    probes.back().add("strain", slice(p.fields.strain, k, 6)).add("stress", slice(p.fields.stress, k, 6));
    probes.back().add("von_mises", p.fields.von_mises[k]);
    if (const auto place = singular_place_near(s, s.probe_bodies[k], point(p.positions, k)))
      probes.back().add("no_limit_beside", *place);
  }
  JsonObject timings, report;
  for (const auto& [stage, seconds] : s.timings) timings.add(stage, seconds);
  if (!s.case_name.empty()) report.add("case", s.case_name);
  report.add("unknowns", s.unknowns.size()).add("constraints", s.num_constraints).add("residual", s.residual);
  report.add("supports", supports).add("loads", loads).add("probes", probes);
  add_attached(report, {{}, s.attached.masses});
  if (!springs.empty()) report.add("springs", springs).add("spring_energy", s.result.spring_energy);
  report.add("force_balance", s.force_balance).add("moment_balance", s.moment_balance);
  report.add("strain_energy", s.result.strain_energy).add("external_work", s.result.external_work);
  report.add("support_work", s.result.support_work).add("gap_work", s.result.gap_work);
  report.add("penalty_energy", s.result.penalty_energy).add("energy_defect", energy_defect(s.result));
  if (!s.temperatures.empty()) {
    report.add("temperatures", json_of(s.temperatures));
    report.add("initial_strain_work", s.result.initial_strain_work);
  }
  if (!s.bolts.empty()) report.add("bolts", json_of(s.bolts));
  if (!s.relief.empty()) report.add("inertia_relief", json_of(s.relief));
  if (const auto errors = relative_errors(s))
    report.add("error_estimate",
               JsonObject().add("strain_energy", errors->strain_energy).add("energy_norm", errors->energy_norm));
  else if (!s.no_energy_error.empty())
    report.add("no_error_estimate", s.no_energy_error);
  add_largest(report, "largest_displacement", s.largest_displacement, system);
  add_largest(report, "largest_von_mises", s.largest_von_mises, system);
  if (const auto place =
          singular_place_near(s, system.name_among_several(s.largest_von_mises.body), s.largest_von_mises.at))
    report.add("no_limit_beside", *place);
  if (!s.ties.empty()) report.add("ties", json_of_ties(s));
  report.add("solver", json_of(s.solver)).add("factor_bytes", s.cost.bytes).add("timings", timings);
  return report;
}

} // namespace iga::solve
