#include "solver/stress/singular_places.hpp"

#include "format/model/vec3.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

namespace iga::solve {

namespace {

// scripts/igatools/driver/singular.py judges grids of a series by the same numbers.
constexpr double degrees = std::numbers::pi / 180;
// Turn between facets from which on their edge counts as sharp; facets of CAD faces turn by 20 at most.
constexpr double sharp = 25 * degrees;
// Where a support that lets its face slide ends at a convex edge of 90 degrees or more, the part goes on beyond it by
// symmetry without a re-entrant edge; facets of round faces turn by up to 20 less.
constexpr double sliding_end = 70 * degrees;
constexpr double near_spans = 2;
// Needles have no normal to rely on: edges count from this length on, in roots of the surface's area.
constexpr double least_length = 0.5e-3;

double distance(const Point3& x, const Point3& from, const Point3& to) {
  const Point3 along = minus(to, from), way = minus(x, from);
  const double length2 = dot(along, along);
  const double share = length2 > 0 ? std::clamp(dot(way, along) / length2, 0.0, 1.0) : 0;
  return norm(minus(way, times(along, share)));
}

} // namespace

SingularPlaces::SingularPlaces(const TrimmedModel& model, std::span<const Support> supports,
                               std::span<const std::pair<std::string, RegionReport>> regions) {
  const Point3 h = model.grid.span_size();
  reach_ = near_spans * std::max({h[0], h[1], h[2]});
  add_edges(model, supports);
  for (const auto& [what, region] : regions)
    for (const Point3& place : region.places) lines_.push_back({what, place, place});
  std::vector<Box3> boxes;
  for (const Line& line : lines_) {
    Box3 box{line.from, line.from};
    for (std::size_t d = 0; d < 3; ++d) {
      box.lower[d] = std::min(line.from[d], line.to[d]);
      box.upper[d] = std::max(line.from[d], line.to[d]);
    }
    boxes.push_back(grown(box, reach_));
  }
  boxes_ = Bvh(boxes);
}

void SingularPlaces::add_edges(const TrimmedModel& model, std::span<const Support> supports) {
  const TriangleMesh& mesh = model.surface.mesh;
  const auto vertex = [&](std::int32_t v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
  std::vector<Point3> normals;
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Point3 n = cross(minus(vertex(t[1]), vertex(t[0])), minus(vertex(t[2]), vertex(t[0])));
    const double size = norm(n);
    area += 0.5 * size;
    normals.push_back(size > 0 ? times(n, 1 / size) : Point3{});
  }
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> triangle_of; // of directed edges
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) triangle_of[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = t;
  std::vector<Line> sliding, reentrant;
  double length = 0;
  for (const auto& [edge, t] : triangle_of) {
    const auto back = triangle_of.find({edge.second, edge.first});
    if (edge.first > edge.second || back == triangle_of.end()) continue;
    const Point3 &a = normals[t], &b = normals[back->second];
    if (dot(a, a) == 0 || dot(b, b) == 0) continue;
    const Point3 from = vertex(edge.first), to = vertex(edge.second), along = minus(to, from);
    const double turn = std::atan2(dot(cross(a, b), along) / norm(along), dot(a, b));
    if (turn > sliding_end) sliding.push_back({"", from, to});
    if (turn > -sharp) continue;
    reentrant.push_back({"a sharp re-entrant edge", from, to});
    length += norm(along);
  }
  if (length > least_length * std::sqrt(area)) lines_ = std::move(reentrant);
  for (const Support& support : supports)
    if (!support.place.given() && !support.region.patch) add_end(model, support, sliding);
}

// Edges that belong to one polygon of the support alone.
void SingularPlaces::add_end(const TrimmedModel& model, const Support& support, std::span<const Line> sliding) {
  const double snap = std::max(surface_depth(model), 1e-12);
  const auto number = [snap](const Point3& x) {
    return std::array<std::int64_t, 3>{std::llround(x[0] / snap), std::llround(x[1] / snap), std::llround(x[2] / snap)};
  };
  using Corner = std::array<std::int64_t, 3>;
  std::map<std::pair<Corner, Corner>, std::pair<int, Line>> edges;
  for (const ChosenPolygon& polygon : choose_polygons(model, support.region, fmt::format("support '{}'", support.name)))
    for (std::size_t a = 0; a < polygon.corners.size(); ++a) {
      const Point3 &from = polygon.corners[a], &to = polygon.corners[(a + 1) % polygon.corners.size()];
      const Corner p = number(from), q = number(to);
      if (p == q) continue;
      auto& [count, line] = edges[std::minmax(p, q)];
      ++count;
      line = {fmt::format("the end of support '{}'", support.name), from, to};
    }
  const auto slides = [&](const Line& line) {
    return std::any_of(sliding.begin(), sliding.end(), [&](const Line& edge) {
      return distance(line.from, edge.from, edge.to) < snap && distance(line.to, edge.from, edge.to) < snap;
    });
  };
  for (auto& [corners, entry] : edges)
    if (entry.first == 1 && !(support.along_normal && slides(entry.second))) lines_.push_back(std::move(entry.second));
}

std::optional<std::string> SingularPlaces::near(const Point3& x) const {
  double least = reach_;
  std::optional<std::string> what;
  boxes_.each_overlap(Box3{x, x}, [&](std::int32_t item) {
    const Line& line = lines_[static_cast<std::size_t>(item)];
    const double far = distance(x, line.from, line.to);
    if (far >= least) return;
    least = far;
    what = line.what;
  });
  return what;
}

} // namespace iga::solve
