#include "solver/space/places.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/locate.hpp"
#include "solver/space/solution_space.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

// How many names a message lists before it says "…".
constexpr std::size_t listed_names = 20;
// Pieces shorter than this share of their line are rounding of the cuts.
constexpr double negligible_share = 1e-12;

std::size_t find_name(const std::vector<std::string>& names, const std::string& name, const char* kind,
                      const std::string& what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  if (names.empty())
    throw InputError(fmt::format("{}: there is no {} '{}': the model has none; make it from a CAD file, or give "
                                 "coordinates",
                                 what, kind, name));
  const auto near = io::nearest_name(name, names);
  const std::size_t shown = std::min(names.size(), listed_names);
  throw InputError(fmt::format("{}: there is no {} '{}'{}; the model has {}{}", what, kind, name,
                               near ? fmt::format(", did you mean '{}'?", *near) : "",
                               fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                               shown < names.size() ? fmt::format(", … {} in all", names.size()) : ""));
}

struct LinePoint {
  Point3 position{};
  double weight = 0; ///< length
  LocatedPoint place{};
};

// Shares of a straight piece at which it crosses span faces, with both ends.
std::vector<double> cuts(const SplineGrid& grid, const Point3& from, const Point3& to) {
  std::vector<double> at{0, 1};
  const Point3 a = grid.to_parameter(from), b = grid.to_parameter(to), A = grid.A(), h = grid.span_size();
  for (std::size_t d = 0; d < 3; ++d) {
    const double first = (a[d] - A[d]) / h[d], last = (b[d] - A[d]) / h[d];
    for (double plane = std::ceil(std::min(first, last)); plane <= std::max(first, last); ++plane)
      if (const double share = (plane - first) / (last - first); share > 0 && share < 1) at.push_back(share);
  }
  std::sort(at.begin(), at.end());
  return at;
}

void add_line(const SplineGrid& grid, std::span<const Point3> line, std::vector<LinePoint>& points) {
  const auto degree = grid.degree();
  const Eigen::MatrixX2d rule = gauss_rule(*std::max_element(degree.begin(), degree.end()) + 1);
  const double negligible = negligible_share * polyline_length(line);
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Point3 way = minus(line[i], line[i - 1]);
    const double length = norm(way);
    if (!(length > negligible)) continue;
    const std::vector<double> at = cuts(grid, line[i - 1], line[i]);
    for (std::size_t c = 1; c < at.size(); ++c) {
      const double share = at[c] - at[c - 1];
      if (!(share * length > negligible)) continue;
      for (Eigen::Index q = 0; q < rule.rows(); ++q)
        points.push_back({plus(line[i - 1], times(way, at[c - 1] + share * rule(q, 0))), share * length * rule(q, 1)});
    }
  }
}

std::vector<LinePoint> line_points(const TrimmedModel& model, const PlaceChoice& choice, const std::string& what) {
  std::vector<LinePoint> points;
  for (std::size_t k = 0; k < choice.curves.size(); ++k) {
    const std::string& name = choice.curves[k];
    if (std::find(choice.curves.begin(), choice.curves.begin() + static_cast<std::ptrdiff_t>(k), name) !=
        choice.curves.begin() + static_cast<std::ptrdiff_t>(k))
      throw InputError(fmt::format("{}: the curve '{}' is named twice; name it once", what, name));
    add_line(model.grid, model.curves.points_of(find_name(model.curves.names, name, "curve", what)), points);
  }
  if (!choice.line.empty()) add_line(model.grid, choice.line, points);
  if (points.empty()) throw InputError(fmt::format("{}: the line has no length; give two points apart", what));
  return points;
}

// The first place that is refused is the one that is named, whatever the number of threads.
void locate_all(const TrimmedModel& model, std::vector<LinePoint>& points, const std::string& what) {
  const Locator locator(model);
  std::vector<std::exception_ptr> refused(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t k) {
    try {
      points[k].place = locator.locate(points[k].position, what);
    } catch (const InputError&) {
      refused[k] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : refused)
    if (error) std::rethrow_exception(error);
}

} // namespace

Point3 position_of(const TrimmedModel& model, const PlaceChoice& choice, const std::string& what) {
  return choice.at ? *choice.at
                   : model.markers.positions[find_name(model.markers.names, choice.marker, "marker", what)];
}

SurfaceRegion choose_places(const TrimmedModel& model, const PlaceChoice& choice, const std::string& what) {
  std::vector<LinePoint> points;
  if (choice.is_line())
    points = line_points(model, choice, what);
  else
    points = {{position_of(model, choice, what), 1}};
  locate_all(model, points, what);
  std::stable_sort(points.begin(), points.end(),
                   [](const LinePoint& a, const LinePoint& b) { return a.place.cell < b.place.cell; });
  SurfaceRegion region;
  region.report.extent = choice.is_line() ? Extent::Line : Extent::Point;
  Point3 first{};
  double total = 0;
  for (const LinePoint& point : points) {
    if (region.cells.empty() || region.cells.back() != point.place.cell) {
      region.offsets.push_back(static_cast<std::int64_t>(region.weights.size()));
      region.cells.push_back(point.place.cell);
    }
    region.parameters.insert(region.parameters.end(), point.place.parameter.begin(), point.place.parameter.end());
    region.weights.push_back(point.weight);
    region.report.places.push_back(point.place.position);
    first = plus(first, times(minus(point.position, points.front().position), point.weight));
    total += point.weight;
  }
  region.offsets.push_back(static_cast<std::int64_t>(region.weights.size()));
  region.normals.resize(region.weights.size());
  if (choice.is_line()) region.report.length = total;
  const Point3 h = model.grid.span_size();
  region.report.reach = 2 * std::max({h[0], h[1], h[2]});
  region.report.points = static_cast<std::int64_t>(region.weights.size());
  region.report.centroid = plus(points.front().position, times(first, 1 / total));
  return region;
}

std::vector<std::string> region_warnings(const RegionReport& report, const std::string& subject) {
  std::vector<std::string> warnings;
  if (!report.warning.empty()) warnings.push_back(fmt::format("{}: {}", subject, report.warning));
  if (report.extent != Extent::Surface)
    warnings.push_back(fmt::format(
        "{} acts {}, which has no area: the stress beside it has no limit as spans shrink, and how far the part gives "
        "way "
        "there depends on the span size too. Read no stress nearer than two spans ({:.4g}), compare two span sizes, or "
        "choose the strip of surface that it acts on in reality",
        subject, report.extent == Extent::Line ? "along a line" : "at a point", report.reach));
  return warnings;
}

} // namespace iga::solve
