#include "solver/report/static_report.hpp"

#include "format/model/vec3.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  for (const LoadResult& load : s.result.loads) unit = std::max(unit, norm(load.force));
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

JsonObject json_of(const RigidMotion& motion) {
  return JsonObject().add("at", motion.at).add("displacement", motion.displacement).add("rotation", motion.rotation);
}

} // namespace

std::string static_text(const StaticSolution& s, const SplineGrid& grid) {
  std::string out;
  const double unit = force_unit(s);
  const auto line = [&](const std::string& words) { out += words + "\n"; };
  line(fmt::format("system: {} constraints, factor {:.3g} MiB", s.num_constraints, s.cost.bytes / (1024.0 * 1024.0)));
  const auto note = [&](const RegionReport& region) {
    if (!region.note.empty()) line("  " + region.note);
  };
  for (std::size_t k = 0; k < s.result.supports.size(); ++k) {
    const SupportResult& r = s.result.supports[k];
    line(fmt::format("support '{}' ({}): {}", r.name, r.method, size_of(s.regions[k], r.centroid)));
    note(s.regions[k]);
    line(fmt::format("  reaction {}, moment about the centroid {}", text(r.force, unit), text(r.moment)));
  }
  for (std::size_t k = 0; k < s.result.loads.size(); ++k) {
    const LoadResult& r = s.result.loads[k];
    line(fmt::format("load '{}' ({}): {}", r.name, r.kind, size_of(s.loads[k].region, r.centroid)));
    note(s.loads[k].region);
    line(fmt::format("  resultant {}, moment about it {}", text(r.force, unit), text(r.moment)));
    for (const auto& [load, motion] : s.motions)
      if (load == k)
        line(fmt::format("  its region stays rigid: {} moves by {}, turns by {} rad", text(motion.at),
                         text(motion.displacement), text(motion.rotation)));
  }
  line(fmt::format("balance of forces {}, relative residual {:.2g}", text(s.force_balance, unit), s.residual));
  const StaticResult& r = s.result;
  line(fmt::format("strain energy {:.8g} + penalty energy of the supports {:.8g}", r.strain_energy, r.penalty_energy));
  line(fmt::format(
      "  = work of the loads {:.8g} + of the reactions on prescribed displacements {:.8g} + of the stress on "
      "what the supports give way {:.8g}; off by {:.2g}",
      r.external_work, r.support_work, r.gap_work, energy_defect(r)));
  const auto singular = [&](const Point3& x) {
    if (const auto place = singular_place_near(s, grid, x))
      line(
          fmt::format("  no stress to rely on: within two spans of {}, where it has no limit as spans shrink", *place));
  };
  line(fmt::format("largest displacement {:.6g} at {}", s.largest_displacement, text(s.largest_displacement_at)));
  line(fmt::format("largest von Mises stress {:.6g} at {}", s.largest_von_mises, text(s.largest_von_mises_at)));
  singular(s.largest_von_mises_at);
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    line(fmt::format("probe '{}' at {}", p.names[k], text(point(p.positions, k))));
    line(fmt::format("  displacement {}, von Mises {:.6g}", text(point(p.fields.displacement, k)),
                     p.fields.von_mises[k]));
    line(fmt::format("  stress xx yy zz xy yz zx: {:.6g}", fmt::join(slice(p.fields.stress, k, 6), "  ")));
    singular(point(p.positions, k));
  }
  return out;
}

JsonObject static_json(const StaticSolution& s, const SplineGrid& grid) {
  std::vector<JsonObject> supports, loads, probes;
  for (std::size_t k = 0; k < s.result.supports.size(); ++k) {
    const SupportResult& r = s.result.supports[k];
    supports.push_back({});
    supports.back().add("name", r.name).add("method", r.method).add("area", r.area).add("centroid", r.centroid);
    supports.back().add("length", s.regions[k].length).add("note", s.regions[k].note);
    supports.back().add("force", r.force).add("moment", r.moment);
  }
  for (std::size_t k = 0; k < s.result.loads.size(); ++k) {
    const LoadResult& r = s.result.loads[k];
    loads.push_back({});
    loads.back().add("name", r.name).add("kind", r.kind).add("area", r.area).add("centroid", r.centroid);
    loads.back().add("length", s.loads[k].region.length).add("note", s.loads[k].region.note);
    loads.back().add("force", r.force).add("moment", r.moment);
    for (const auto& [load, motion] : s.motions)
      if (load == k) loads.back().add("motion", json_of(motion));
  }
  const ProbeResult& p = s.result.probes;
  for (std::size_t k = 0; k < p.names.size(); ++k) {
    probes.push_back({});
    probes.back().add("name", p.names[k]).add("position", point(p.positions, k));
    probes.back().add("displacement", point(p.fields.displacement, k));
    probes.back().add("strain", slice(p.fields.strain, k, 6)).add("stress", slice(p.fields.stress, k, 6));
    probes.back().add("von_mises", p.fields.von_mises[k]);
    if (const auto place = singular_place_near(s, grid, point(p.positions, k)))
      probes.back().add("no_limit_beside", *place);
  }
  JsonObject timings, report;
  for (const auto& [stage, seconds] : s.timings) timings.add(stage, seconds);
  report.add("unknowns", s.unknowns.size()).add("constraints", s.num_constraints).add("residual", s.residual);
  report.add("supports", supports).add("loads", loads).add("probes", probes);
  report.add("force_balance", s.force_balance).add("moment_balance", s.moment_balance);
  report.add("strain_energy", s.result.strain_energy).add("external_work", s.result.external_work);
  report.add("support_work", s.result.support_work).add("gap_work", s.result.gap_work);
  report.add("penalty_energy", s.result.penalty_energy).add("energy_defect", energy_defect(s.result));
  report.add("largest_displacement", s.largest_displacement).add("largest_displacement_at", s.largest_displacement_at);
  report.add("largest_von_mises", s.largest_von_mises).add("largest_von_mises_at", s.largest_von_mises_at);
  if (const auto place = singular_place_near(s, grid, s.largest_von_mises_at)) report.add("no_limit_beside", *place);
  report.add("factor_bytes", s.cost.bytes).add("timings", timings);
  return report;
}

} // namespace iga::solve
