#include "preprocessor/program/gates.hpp"

#include "format/model/rounded_down.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::prep {

namespace {

constexpr std::size_t leaks_shown = 5;
// A part that loses more of its volume to snapping lies, as a whole, within the sliver depth.
constexpr double snapped_share = 1e-3;

std::string text(const Point3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]);
}

// What spans of a size do, or, where the solid would fill too many of them, something else.
std::string span_advice(double size, double num_spans, const SplineGrid& grid, const char* effect,
                        const std::string& instead) {
  constexpr double too_many = 1e6;
  if (!(num_spans <= too_many)) return fmt::format("; that would take about {:.0e} spans: {}", num_spans, instead);
  return fmt::format("; spans of at most {:.3g} {} (--span-size; about {:.2g} of them, now {:.4g})",
                     rounded_down(size, 3), effect, num_spans, fmt::join(grid.span_size(), " × "));
}

// Position of a span's centre.
Point3 centre_of(const SplineGrid& grid, const Index3& ijk) {
  const Box3 box = grid.span_box(ijk);
  Point3 u;
  for (std::size_t d = 0; d < 3; ++d) u[d] = 0.5 * (box.lower[d] + box.upper[d]);
  return grid.to_position(u);
}

std::string leak_list(const SplineGrid& grid, const Trimming& trimming) {
  std::string list;
  for (std::size_t i = 0; i < std::min(leaks_shown, trimming.leaks.size()); ++i) {
    const Leak& leak = trimming.leaks[i];
    list += fmt::format("\n  row of span ({}, {}, {}) near {}: the volume is off by {:.3g} spans", leak.span[0],
                        leak.span[1], leak.span[2], text(centre_of(grid, leak.span)), leak.error);
  }
  return list;
}

// The next step for a surface that bounds no solid.
std::string next_step(const SurfaceTreatment& treatment) {
  if (treatment.wrapped)
    return "The surface has been wrapped already: choose another span size or --wrap-alpha, or mend the part where it "
           "was made.";
  if (treatment.repair)
    return "--repair did not mend this. Mend the part where it was made; as the last resort --wrap makes a closed "
           "surface around everything, which only approximates the part.";
  return "Mend it with --repair: it closes holes, drops free sheets and keeps what is enclosed at least once.";
}

// Leaks are the user's choice under --accept-leaks and an error otherwise.
void refuse_or_warn(bool accept, std::vector<std::string>& warnings, const std::string& finding,
                    const SurfaceTreatment& treatment) {
  if (!accept) throw SurfaceFault(finding + "\n" + next_step(treatment));
  warnings.push_back(finding + "\naccepted as asked (--accept-leaks): volumes near these places are not exact");
}

bool leaks(const Trimming& trimming) {
  return trimming.worst_leak > volume_tolerance;
}

} // namespace

std::vector<std::string> judge_trimming(const SplineGrid& grid, const Trimming& trimming, double mesh_volume,
                                        const SurfaceTreatment& treatment) {
  std::vector<std::string> warnings;
  if (leaks(trimming))
    refuse_or_warn(
        treatment.accept_leaks, warnings,
        fmt::format("the surface leaks in {} row(s) of spans:{}", trimming.num_leaks, leak_list(grid, trimming)),
        treatment);
  const double difference = std::abs(trimming.exact_volume - mesh_volume);
  if (!(difference <= volume_tolerance * std::abs(mesh_volume)))
    refuse_or_warn(
        treatment.accept_leaks, warnings,
        fmt::format("the spans hold the volume {:.10g}, the surface encloses {:.10g} (relative difference {:.3g}, "
                    "allowed {:.0e}): it is not closed, or its facets disagree about the outside",
                    trimming.exact_volume, mesh_volume, difference / std::abs(mesh_volume), volume_tolerance),
        treatment);
  if (std::abs(trimming.snapped_volume) > snapped_share * std::abs(mesh_volume))
    throw InputError(
        fmt::format("snapping slivers would change the part's volume by {:.3g} of {:.6g}: the part is thinner "
                    "than the sliver depth of its spans\nChoose smaller spans (--span-size) or a smaller "
                    "--sliver-tolerance.",
                    trimming.snapped_volume, mesh_volume));
  if (trimming.active.empty() && trimming.dropped_spans == 0)
    throw SurfaceFault("no span holds material: the surface is open where the rows of spans leave it\n" +
                       next_step(treatment));
  if (trimming.active.empty())
    throw InputError(fmt::format("no span holds material ({} trimmed span(s) of volume {:.3g} were dropped by "
                                 "--min-fraction): choose smaller spans or a smaller --min-fraction",
                                 trimming.dropped_spans, trimming.dropped_volume));
  return warnings;
}

std::vector<std::string> judge_winding(const WindingReport& winding, const Trimming& trimming,
                                       const SurfaceTreatment& treatment) {
  std::vector<std::string> warnings;
  if (winding.bad_lines == 0) return warnings;
  const bool only_open = winding.worst_winding == 1;
  const std::string found =
      only_open
          ? fmt::format("the surface is open: {} of {} test lines enter the solid and do not leave it (first near {})",
                        winding.bad_lines, winding.num_lines, text(winding.where))
          : fmt::format("the surface does not bound one solid: {} of {} test lines meet a winding number other "
                        "than 0 or 1 (worst {}, near {}), over a length of {:.3g} in all: bodies overlap or the "
                        "surface crosses itself, and volume would count twice",
                        winding.bad_lines, winding.num_lines, winding.worst_winding, text(winding.where),
                        winding.bad_length);
  refuse_or_warn(treatment.accept_leaks && (treatment.open || leaks(trimming)), warnings, found, treatment);
  return warnings;
}

std::vector<std::string> judge_cells(const CellTable& cells, const SplineGrid& grid) {
  if (cells.unclear_spans == 0) return {};
  const Box3 box = grid.span_box(grid.span_index(cells.first_unclear));
  Point3 middle;
  for (std::size_t d = 0; d < 3; ++d) middle[d] = 0.5 * (box.lower[d] + box.upper[d]);
  return {
      fmt::format("in {} span{} (first near {}) the surface leaks or crosses itself, so that what is connected with "
                  "what cannot be told: walls in {} are treated as one and move together; mend the part where it "
                  "was made",
                  cells.unclear_spans, cells.unclear_spans == 1 ? "" : "s", text(grid.to_position(middle)),
                  cells.unclear_spans == 1 ? "it" : "them")};
}

std::vector<std::string> judge_walls(const ThinWalls& walls, const SplineGrid& grid) {
  constexpr double edge = 10;            // degrees: faces that lean more towards each other meet in an edge nearby
  constexpr double little_volume = 1e-3; // of the solid
  if (!walls.thinnest) return {};
  const ThinWall& w = *walls.thinnest;
  if (w.taper > edge && walls.volume_share < little_volume) return {};
  const double wanted = spans_across_wall(grid);
  const std::string found = fmt::format(
      "walls too thin for their spans hold {:.3g} % of the solid's volume; the thinnest is {:.4g} thick, {:.2g} spans, "
      "near {}: a wall wants {} span{} across its thickness, with less its stiffness is inaccurate",
      100 * walls.volume_share, w.thickness, w.spans, text(w.where), wanted, wanted == 1 ? "" : "s");
  if (w.taper > edge)
    return {found +
            fmt::format("; this one tapers to an edge of {:.0f} degrees, which no span size resolves to its tip: "
                        "compare the results of two span sizes",
                        w.taper)};
  return {found + span_advice(w.span_size, w.num_spans, grid, "would do",
                              "give small spans across the wall only (--span-size with three numbers, the grid turned "
                              "by --rotate-axis-angle), or compare the results of two span sizes")};
}

void judge_surface_points(const TrimmedModel& model, const SurfaceTreatment& treatment) {
  if (model.quadrature.dropped_spans > 0 || model.surface.accepted_leak > 0) return;
  const SurfacePoints& points = model.surface.quadrature;
  const TriangleMesh& mesh = model.surface.mesh;
  const double allowed = surface_depth(model);
  std::int64_t astray = 0;
  double area = 0;
  Point3 where{};
  for (std::size_t q = 0; q < points.weights.size(); ++q) {
    const Point3 x =
        model.grid.to_position({points.parameters[3 * q], points.parameters[3 * q + 1], points.parameters[3 * q + 2]});
    if (distance_to_triangle(mesh, static_cast<std::size_t>(points.triangle[q]), x) <= allowed) continue;
    if (astray == 0) where = x;
    ++astray;
    area += points.weights[q];
  }
  if (astray == 0) return;
  const char* const rest = treatment.wrapped ? "mend the part where it was made"
                                             : "mend the part where it was made; as the last resort --wrap makes one "
                                               "closed surface around everything, which only approximates the part";
  throw SurfaceFault(
      fmt::format("the surface has a wall without material: facets of {:.4g} area bound nothing thicker than {:.3g} "
                  "spans (first one near {})\nWhere the wall is thin on purpose, choose a smaller --sliver-tolerance; "
                  "where it is not (a sheet, or a cavity that touches the outside), {}.",
                  area, model.quadrature.sliver_tolerance, text(where), rest));
}

void judge_weights(double point_volume, const QuadratureInfo& info) {
  const double expected = info.part_volume + info.snapped_volume - info.dropped_volume;
  const double error = std::abs(point_volume - expected) / std::abs(info.part_volume);
  const double allowed = std::max(volume_tolerance, info.tolerance);
  if (!(error <= allowed))
    throw InputError(fmt::format("the quadrature weights sum to {:.10g}, expected {:.10g} (surface {:.10g}, snapped "
                                 "{:+.3g}, dropped {:.3g}): relative difference {:.3g}, allowed {:.0e}\nChoose a "
                                 "smaller --tolerance or another span size.",
                                 point_volume, expected, info.part_volume, info.snapped_volume, info.dropped_volume,
                                 error, allowed));
}

VolumeMoments point_moments(const SplineGrid& grid, const IntegrationPoints& points, const Point3& about) {
  constexpr std::array<std::array<std::size_t, 2>, 6> pairs{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  VolumeMoments m;
  Point3 first{};
  std::array<double, 6> second{};
  // Sums per span first: rounding then grows with the number of spans, not of points.
  for (std::size_t a = 0; a + 1 < points.offsets.size(); ++a) {
    double w = 0;
    Point3 wx{};
    std::array<double, 6> wxx{};
    for (auto q = static_cast<std::size_t>(points.offsets[a]); q < static_cast<std::size_t>(points.offsets[a + 1]);
         ++q) {
      const Point3 x =
          grid.to_position({points.parameters[3 * q], points.parameters[3 * q + 1], points.parameters[3 * q + 2]});
      const Point3 r{x[0] - about[0], x[1] - about[1], x[2] - about[2]};
      w += points.weights[q];
      for (std::size_t d = 0; d < 3; ++d) wx[d] += points.weights[q] * r[d];
      for (std::size_t e = 0; e < 6; ++e) wxx[e] += points.weights[q] * r[pairs[e][0]] * r[pairs[e][1]];
    }
    m.volume += w;
    for (std::size_t d = 0; d < 3; ++d) first[d] += wx[d];
    for (std::size_t e = 0; e < 6; ++e) second[e] += wxx[e];
  }
  if (m.volume == 0) return m;
  for (std::size_t d = 0; d < 3; ++d) m.centroid[d] = about[d] + first[d] / m.volume;
  for (std::size_t e = 0; e < 6; ++e)
    m.second_moments[e] = second[e] - first[pairs[e][0]] * first[pairs[e][1]] / m.volume;
  return m;
}

} // namespace iga::prep
