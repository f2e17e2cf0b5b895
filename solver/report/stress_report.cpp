#include "solver/report/stress_report.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/space/locate.hpp"
#include "solver/stress/principal.hpp"
#include "solver/stress/singular_places.hpp"
#include "solver/supports/body_choice.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace iga::solve {

namespace {

using io::JsonObject;

Voigt stress_of(const std::vector<double>& stress, std::size_t k) {
  return Eigen::Map<const Voigt>(&stress[6 * k]);
}

std::array<double, 6> entries(const Voigt& s) {
  return {s[0], s[1], s[2], s[3], s[4], s[5]};
}

std::vector<double> column(const Voigt& s) {
  return {s.data(), s.data() + 6};
}

// Loads on the volume are scaled where they act: turning is no linear one.
Load scaled(Load load, double factor) {
  load.vector = times(load.vector, factor);
  load.moment = times(load.moment, factor);
  load.pressure *= factor;
  return load;
}

/// One body on its way.
class BodyStress {
 public:
  BodyStress(const AnalysisRun& run, const BodySystem& system, const StaticSolution& solution, std::size_t b)
      : body_(system[b]), number_(b), model_(body_.space->model()), unknowns_(system.part(solution.unknowns, b)) {
    const std::string name = system.name_among_several(b);
    SurfaceConditions conditions;
    std::vector<std::pair<std::string, RegionReport>> regions;
    for (std::size_t k = 0; k < run.settings.supports.size(); ++k) {
      if (solution.regions[k].body != name) continue;
      conditions.supports.push_back(run.settings.supports[k]);
      regions.emplace_back(fmt::format("support '{}'", solution.regions[k].name), solution.regions[k]);
    }
    const auto attach = [&](const RegionReport& region, const char* kind) {
      if (region.body == name) regions.emplace_back(fmt::format("{} '{}'", kind, region.name), region);
    };
    for (const auto& spring : solution.attached.springs) attach(spring.region, "spring");
    for (const auto& mass : solution.attached.masses) attach(mass.region, "added mass");
    std::vector<BodyForce> forces;
    for (std::size_t k = 0; k < run.settings.statics.loads.size(); ++k) {
      Load load = scaled(run.settings.statics.loads[k], solution.factors.empty() ? 1 : solution.factors[k]);
      if (const auto volume = volume_force(load, body_.material.density)) {
        const double factor = solution.factors.empty() ? 1 : solution.factors[k];
        if (load.body.empty() || load.body == body_.name)
          forces.push_back([force = *volume, by = load.kind == LoadKind::Centrifugal ? factor : 1](const Point3& x) {
            return times(force(x), by);
          });
        continue;
      }
      if (solution.loads[k].region.body != name) continue;
      regions.emplace_back(fmt::format("load '{}'", load.name), solution.loads[k].region);
      conditions.loads.push_back(std::move(load));
    }
    for (const RigidAcceleration& free : solution.relief)
      if (free.bodies.empty() || std::find(free.bodies.begin(), free.bodies.end(), body_.name) != free.bodies.end())
        forces.push_back([free, density = body_.material.density](const Point3& x) {
          return times(plus(free.acceleration, cross(free.angular, minus(x, free.centre))), -density);
        });
    BodyForce force;
    if (!forces.empty())
      force = [forces](const Point3& x) {
        Point3 sum{};
        for (const BodyForce& one : forces) sum = plus(sum, one(x));
        return sum;
      };
    singular_ = std::make_unique<SingularPlaces>(model_, conditions.supports, regions);
    // A bolt's shortening jumps at its ends: no polynomial follows the stress there.
    const auto& initial = body_.material.initial_strain;
    if (run.settings.raw_stress || (initial && !initial->is_smooth())) return;
    for (const Tie& tie : run.settings.ties) add_tied(tie, conditions.unknown);
    const auto& attached = solution.attached.triangles;
    if (!attached.empty()) conditions.unknown.insert(conditions.unknown.end(), attached[b].begin(), attached[b].end());
    recovery_ = std::make_unique<StressRecovery>(RecoveryProblem{body_.space.get(), &body_.material, unknowns_, force,
                                                                 known_tractions(*body_.space, conditions)});
  }

  const TrimmedModel& model() const { return model_; }

  RecoveredStress at(const SamplePoints& points) {
    if (recovery_) return recovery_->at(points);
    FieldSamples raw = sample_fields(*body_.space, body_.material, points, unknowns_, Fields::All);
    return {std::move(raw.stress), std::move(raw.von_mises), {}};
  }

  /// The largest von Mises stresses: of all places, and of those where it has a limit.
  std::pair<PeakStress, std::optional<PeakStress>> peaks() {
    std::vector<std::size_t> triangles;
    const SamplePoints points = surface_places(triangles);
    const RecoveredStress stress = at(points);
    std::vector<std::size_t> order(points.cell.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return stress.von_mises[a] > stress.von_mises[b]; });
    std::pair<PeakStress, std::optional<PeakStress>> found;
    for (const std::size_t k : order) {
      const double* u = &points.parameters[3 * k];
      PeakStress peak;
      peak.at = model_.grid.to_position({u[0], u[1], u[2]});
      peak.near = singular_->near(peak.at);
      const bool is_first = k == order.front();
      if (!is_first && peak.near) continue;
      peak.von_mises = stress.von_mises[k];
      if (!stress.error.empty()) peak.error = stress.error[k];
      peak.principal = principal_stresses(stress_of(stress.stress, k));
      peak.body = number_;
      const TriangleMesh& mesh = model_.surface.mesh;
      peak.face = mesh.region_names[static_cast<std::size_t>(mesh.region[triangles[k]])];
      if (is_first) found.first = peak;
      if (!peak.near) {
        if (!is_first) found.second = peak;
        break;
      }
    }
    return found;
  }

  /// In place of what the surface has.
  void replace(FieldSamples& fields, const OutputMesh& mesh) {
    if (!recovery_) return;
    RecoveredStress stress = at({mesh.cell, mesh.parameters});
    if (!fields.stress.empty()) fields.stress = std::move(stress.stress);
    if (fields.von_mises.empty()) return;
    fields.von_mises = std::move(stress.von_mises);
    fields.von_mises_error = std::move(stress.error);
  }

  /// In place of what the k-th probe has. @returns the estimated error, none where nothing is recovered
  std::optional<double> replace_probe(ProbeResult& probes, std::size_t k) {
    if (!recovery_) return std::nullopt;
    const LocatedPoint place =
        locate(model_, {probes.positions[3 * k], probes.positions[3 * k + 1], probes.positions[3 * k + 2]},
               fmt::format("probe '{}'", probes.names[k]));
    const RecoveredStress stress = at({{place.cell}, {place.parameter[0], place.parameter[1], place.parameter[2]}});
    std::copy(stress.stress.begin(), stress.stress.end(),
              probes.fields.stress.begin() + static_cast<std::ptrdiff_t>(6 * k));
    probes.fields.von_mises[k] = stress.von_mises[0];
    return stress.error[0];
  }

 private:
  // Which part of a surface is tied is not known here: all that the tie may choose.
  void add_tied(const Tie& tie, std::vector<std::int64_t>& unknown) const {
    for (std::size_t side = 0; side < 2; ++side) {
      if (tie.bodies && (*tie.bodies)[side] != body_.name) continue;
      const SurfaceRegion region = choose_region(model_, tie.choice[side], fmt::format("tie '{}'", tie.name));
      unknown.insert(unknown.end(), region.triangles.begin(), region.triangles.end());
    }
  }

  // The model's vertices and surface points, each with a triangle that it lies on.
  SamplePoints surface_places(std::vector<std::size_t>& triangles) const {
    const EmbeddedSurface& surface = model_.surface;
    SamplePoints points{surface.vertex_cell, surface.vertex_parameters};
    triangles.assign(points.cell.size(), 0);
    for (std::size_t t = surface.mesh.triangles.size(); t-- > 0;)
      for (const std::int32_t v : surface.mesh.triangles[t]) triangles[static_cast<std::size_t>(v)] = t;
    const SurfacePoints& q = surface.quadrature;
    points.parameters.insert(points.parameters.end(), q.parameters.begin(), q.parameters.end());
    for (std::size_t a = 0; a < model_.num_cells(); ++a)
      points.cell.insert(points.cell.end(), static_cast<std::size_t>(q.offsets[a + 1] - q.offsets[a]),
                         static_cast<std::int64_t>(a));
    for (const std::int32_t t : q.triangle) triangles.push_back(static_cast<std::size_t>(t));
    return points;
  }

  const SystemBody& body_;
  std::size_t number_;
  const TrimmedModel& model_;
  Eigen::VectorXd unknowns_;
  std::unique_ptr<SingularPlaces> singular_;
  std::unique_ptr<StressRecovery> recovery_;
};

std::vector<double> safety_factors(const FieldSamples& fields, double yield) {
  std::vector<double> factors;
  factors.reserve(fields.von_mises.size());
  for (const double stress : fields.von_mises)
    factors.push_back(stress * largest_safety_factor > yield ? yield / stress : largest_safety_factor);
  return factors;
}

LineStress along(const StressLine& line, const BodySystem& system, std::vector<BodyStress>& bodies) {
  LineStress found;
  found.line = line;
  found.body = chosen_body(system, line.body, fmt::format("{}: line '{}'", line.where, line.name),
                           [&](std::size_t b) { points_of(bodies[b].model(), line); });
  found.points = points_of(bodies[found.body].model(), line);
  found.stress = bodies[found.body].at(found.points.points);
  if (found.stress.error.empty()) found.stress.error.assign(found.stress.von_mises.size(), 0);
  found.linear = linearise(found.points, found.stress);
  return found;
}

std::string text(const Point3& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
}

std::string value(double von_mises, const std::optional<double>& error) {
  if (!error) return fmt::format("{:.6g}", von_mises);
  return fmt::format("{:.6g} ± {:.2g} %", von_mises, 100 * *error / std::max(von_mises, 1e-300));
}

std::string place(const PeakStress& peak, const BodySystem& system) {
  return fmt::format("at {}{}, face '{}'", text(peak.at), of_body(system, peak.body), peak.face);
}

std::string principal(const Eigen::Vector3d& p) {
  return fmt::format("{:.6g}, {:.6g}, {:.6g}", p[0], p[1], p[2]);
}

JsonObject json_of(const PeakStress& peak, const BodySystem& system) {
  JsonObject object;
  object.add("von_mises", peak.von_mises);
  if (peak.error) object.add("error", *peak.error);
  object.add("at", peak.at).add("face", peak.face);
  if (system.size() > 1) object.add("body", system[peak.body].name);
  object.add("principal", Point3{peak.principal[0], peak.principal[1], peak.principal[2]});
  if (peak.near) object.add("no_limit_beside", *peak.near);
  return object;
}

// Numbers of the points of a line from its start to its end.
std::vector<std::size_t> in_order(const LinePoints& points) {
  std::vector<std::size_t> order(points.distance.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return points.distance[a] < points.distance[b]; });
  return order;
}

JsonObject json_of(const LineStress& line) {
  const LinearisedStress& l = line.linear;
  JsonObject object;
  object.add("name", line.line.name).add("from", line.line.from).add("to", line.line.to);
  object.add("length", line.points.length).add("membrane", column(l.membrane)).add("bending", column(l.bending));
  object.add("peak_from", column(l.peak[0])).add("peak_to", column(l.peak[1]));
  object.add("von_mises_membrane", l.von_mises_membrane);
  object.add("von_mises_membrane_bending", std::vector<double>(l.von_mises_linear.begin(), l.von_mises_linear.end()));
  object.add("von_mises_total", std::vector<double>(l.von_mises_total.begin(), l.von_mises_total.end()));
  object.add("error", l.error);
  std::vector<double> distance, stress;
  for (const std::size_t k : in_order(line.points)) {
    distance.push_back(line.points.distance[k]);
    const auto s = entries(stress_of(line.stress.stress, k));
    stress.insert(stress.end(), s.begin(), s.end());
  }
  return object.add("distance", distance).add("stress", stress);
}

} // namespace

StressReport recover_stress(const AnalysisRun& run, StaticSolution& solution, Results* results) {
  const BodySystem& system = solution.system;
  StressReport report;
  std::vector<BodyStress> bodies;
  bodies.reserve(system.size());
  for (std::size_t b = 0; b < system.size(); ++b) bodies.emplace_back(run, system, solution, b);
  std::vector<PeakStress> regular;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const auto [all, limited] = bodies[b].peaks();
    if (all.von_mises > report.largest.von_mises) report.largest = all;
    const PeakStress& safe = all.near && limited ? *limited : all;
    regular.push_back(safe);
    if (const auto yield = run.bodies[b].words.yield) {
      const double factor = *yield / std::max(safe.von_mises, 1e-300);
      if (!report.safety || factor < report.safety->factor) report.safety = StressReport::Safety{factor, *yield, safe};
    }
    SurfaceResult* const surface = !results            ? nullptr
                                   : system.size() > 1 ? &results->parts[b].surface
                                   : results->surface  ? &*results->surface
                                                       : nullptr;
    if (!surface) continue;
    bodies[b].replace(surface->fields, surface->output);
    if (const auto yield = run.bodies[b].words.yield)
      surface->fields.safety_factor = safety_factors(surface->fields, *yield);
  }
  const PeakStress& most = *std::max_element(regular.begin(), regular.end(), [](const auto& a, const auto& b) {
    return (a.near ? -1 : a.von_mises) < (b.near ? -1 : b.von_mises);
  });
  if (report.largest.near && !most.near) report.regular = most;
  solution.largest_von_mises = {report.largest.von_mises, report.largest.at, report.largest.body};
  for (std::size_t k = 0; k < solution.result.probes.names.size(); ++k)
    for (std::size_t b = 0; b < system.size(); ++b)
      if (system.name_among_several(b) == solution.probe_bodies[k])
        if (const auto error = bodies[b].replace_probe(solution.result.probes, k))
          report.probe_errors.push_back(*error);
  for (const StressLine& line : run.settings.lines) report.lines.push_back(along(line, system, bodies));
  return report;
}

std::vector<ResultTable> line_tables(const StressReport& report, const std::string& case_name) {
  const std::string before = case_name.empty() ? "" : case_name + "_";
  std::vector<ResultTable> tables;
  const auto add_columns = [](ResultTable& table, const std::string& name, std::initializer_list<const char*> suffixes,
                              const char* unit) {
    for (const char* suffix : suffixes) {
      table.columns.push_back(name + suffix);
      table.units.emplace_back(unit);
    }
  };
  const char* const pressure = "force/length^2";
  const std::initializer_list<const char*> voigt{"_xx", "_yy", "_zz", "_xy", "_yz", "_zx"};
  const auto append = [](ResultTable& table, const auto& values) {
    table.values.insert(table.values.end(), values.begin(), values.end());
  };
  for (const LineStress& l : report.lines) {
    ResultTable& all = tables.emplace_back();
    all.name = fmt::format("{}line_{}", before, l.line.name);
    all.description = fmt::format("stress along line '{}'", l.line.name);
    add_columns(all, "distance", {""}, "length");
    add_columns(all, "position", {"_x", "_y", "_z"}, "length");
    add_columns(all, "stress", voigt, pressure);
    add_columns(all, "von_mises", {"", "_error"}, pressure);
    add_columns(all, "principal_stress", {"_1", "_2", "_3"}, pressure);
    for (const std::size_t k : in_order(l.points)) {
      const Voigt stress = stress_of(l.stress.stress, k);
      const double distance = l.points.distance[k];
      all.values.push_back(distance);
      append(all, plus(l.line.from, times(l.points.along, distance)));
      append(all, entries(stress));
      append(all, std::array{l.stress.von_mises[k], l.stress.error[k]});
      append(all, principal_stresses(stress));
    }
    ResultTable& ends = tables.emplace_back();
    ends.name = fmt::format("{}linearised_{}", before, l.line.name);
    ends.description = fmt::format("membrane, bending and peak stress at the two ends of line '{}'", l.line.name);
    add_columns(ends, "distance", {""}, "length");
    for (const char* part : {"membrane", "bending", "peak"}) add_columns(ends, part, voigt, pressure);
    add_columns(ends, "von_mises", {"_membrane", "_membrane_bending", "_total", "_error"}, pressure);
    for (std::size_t end = 0; end < 2; ++end) {
      ends.values.push_back(end == 0 ? 0 : l.points.length);
      append(ends, entries(l.linear.membrane));
      append(ends, entries(end == 0 ? l.linear.bending : Voigt(Voigt::Zero() - l.linear.bending)));
      append(ends, entries(l.linear.peak[end]));
      append(ends, std::array{l.linear.von_mises_membrane, l.linear.von_mises_linear[end],
                              l.linear.von_mises_total[end], l.linear.error});
    }
  }
  return tables;
}

std::string stress_text(const StressReport& report, const StaticSolution& solution, const BodySystem& system) {
  std::string out;
  const auto line = [&](const std::string& words) { out += words + "\n"; };
  const PeakStress& largest = report.largest;
  line(fmt::format("largest von Mises stress {} {}", value(largest.von_mises, largest.error), place(largest, system)));
  line(fmt::format("  principal stresses {}", principal(largest.principal)));
  if (largest.near)
    line(fmt::format("  no stress to rely on: within two spans of {}, where it has no limit as spans shrink",
                     *largest.near));
  if (report.regular)
    line(fmt::format("  away from such places the largest is {} {}; principal stresses {}",
                     value(report.regular->von_mises, report.regular->error), place(*report.regular, system),
                     principal(report.regular->principal)));
  if (report.safety) {
    const PeakStress& at = report.safety->where;
    line(fmt::format("least safety factor against yield at {:.6g}: {:.4g}{} {}", report.safety->yield,
                     report.safety->factor,
                     at.error ? fmt::format(" ± {:.2g} %", 100 * *at.error / std::max(at.von_mises, 1e-300)) : "",
                     place(at, system)));
  }
  const ProbeResult& p = solution.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k)
    line(fmt::format("stress at probe '{}': von Mises {}, principal stresses {}", p.names[k],
                     value(p.fields.von_mises[k],
                           report.probe_errors.empty() ? std::nullopt : std::optional(report.probe_errors[k])),
                     principal(principal_stresses(stress_of(p.fields.stress, k)))));
  for (const LineStress& l : report.lines) {
    line(fmt::format("line '{}'{} from {} to {}, length {:.6g}", l.line.name, of_body(system, l.body),
                     text(l.line.from), text(l.line.to), l.points.length));
    line(fmt::format("  von Mises of the membrane stress {:.6g}, of membrane and bending {:.6g} and {:.6g} at the two "
                     "ends, of all {:.6g} and {:.6g}",
                     l.linear.von_mises_membrane, l.linear.von_mises_linear[0], l.linear.von_mises_linear[1],
                     l.linear.von_mises_total[0], l.linear.von_mises_total[1]));
    line(fmt::format("  membrane xx yy zz xy yz zx: {:.6g}", fmt::join(entries(l.linear.membrane), "  ")));
    line(fmt::format("  bending at the start:       {:.6g}", fmt::join(entries(l.linear.bending), "  ")));
  }
  return out;
}

JsonObject stress_json(const StressReport& report, const StaticSolution& solution, const BodySystem& system) {
  JsonObject object;
  object.add("largest", json_of(report.largest, system));
  if (report.regular) object.add("largest_with_limit", json_of(*report.regular, system));
  if (report.safety)
    object.add("safety_factor", JsonObject()
                                    .add("value", report.safety->factor)
                                    .add("yield", report.safety->yield)
                                    .add("where", json_of(report.safety->where, system)));
  std::vector<JsonObject> probes, lines;
  const ProbeResult& p = solution.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    const Eigen::Vector3d values = principal_stresses(stress_of(p.fields.stress, k));
    probes.push_back(JsonObject()
                         .add("name", p.names[k])
                         .add("von_mises", p.fields.von_mises[k])
                         .add("principal", Point3{values[0], values[1], values[2]})
                         .add("largest_shear", 0.5 * (values[0] - values[2])));
    if (!report.probe_errors.empty()) probes.back().add("error", report.probe_errors[k]);
  }
  for (const LineStress& line : report.lines) lines.push_back(json_of(line));
  return object.add("probes", probes).add("lines", lines);
}

} // namespace iga::solve
