// One plane after the other.
#include "solver/space/surface_cut.hpp"

#include "format/model/triangle_rule.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/convex_clip.hpp"

#include <algorithm>
#include <cmath>

namespace iga::solve {

namespace {

// Pieces smaller than this share of their polygon are rounding of the cuts.
constexpr double negligible_share = 1e-15;

using Polygon = ConvexPolygon;

Polygon in_span_units(const SplineGrid& grid, const Polygon& polygon) {
  const Point3 A = grid.A(), h = grid.span_size();
  Polygon in_spans;
  for (const Point3& x : polygon) {
    Point3 xi = grid.to_parameter(x);
    for (std::size_t d = 0; d < 3; ++d) xi[d] = (xi[d] - A[d]) / h[d];
    in_spans.push_back(xi);
  }
  return in_spans;
}

// Parameter of a place in span units.
Point3 from_span_units(const SplineGrid& grid, const Point3& xi) {
  Point3 u = grid.A();
  const Point3 h = grid.span_size();
  for (std::size_t d = 0; d < 3; ++d) u[d] += h[d] * xi[d];
  return u;
}

// Cuts a polygon in span units into slabs along axes d, d - 1, …, 0 and hands each piece on.
template <class Use> void for_each_piece(const Polygon& polygon, std::size_t axes, const Index3& spans, Use&& use) {
  if (polygon.size() < 3) return;
  if (axes == 0) return use(polygon);
  const std::size_t d = axes - 1;
  const auto [low, high] = std::minmax_element(polygon.begin(), polygon.end(),
                                               [&](const Point3& a, const Point3& b) { return a[d] < b[d]; });
  const auto last_span = static_cast<double>(spans[d] - 1);
  const double first = std::clamp(std::floor((*low)[d]), 0.0, last_span);
  const double last = std::clamp(std::ceil((*high)[d]) - 1, first, last_span);
  if (first == last) return for_each_piece(polygon, d, spans, use);
  for (double c = first; c <= last; ++c) {
    const Polygon above = c == first ? polygon : clip_convex(polygon, [&](const Point3& x) { return c - x[d]; });
    for_each_piece(c == last ? above : clip_convex(above, [&](const Point3& x) { return x[d] - (c + 1); }), d, spans,
                   use);
  }
}

} // namespace

CutTriangle cut_triangle(const TriangleMesh& mesh, std::size_t triangle, const std::vector<HalfSpace>& half_spaces,
                         double snap) {
  const auto height = [](const HalfSpace& side, const Point3& x) {
    return dot(minus(x, side.point), side.normal) - side.offset;
  };
  CutTriangle cut;
  std::vector<const HalfSpace*> crossing;
  for (const std::int32_t v : mesh.triangles[triangle])
    cut.polygon.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  for (const HalfSpace& side : half_spaces) {
    double least = INFINITY, most = -INFINITY;
    for (const Point3& x : cut.polygon) {
      least = std::min(least, height(side, x));
      most = std::max(most, height(side, x));
    }
    if (most <= snap) continue;
    if (least >= -snap) return {};
    crossing.push_back(&side);
  }
  cut.part = crossing.empty() ? CutTriangle::Part::Whole : CutTriangle::Part::Some;
  for (const HalfSpace* side : crossing)
    cut.polygon = clip_convex(cut.polygon, [&](const Point3& x) {
      const double h = height(*side, x);
      return std::abs(h) <= snap ? 0 : h;
    });
  if (cut.polygon.size() < 3) return {};
  return cut;
}

void for_span_pieces(const SplineGrid& grid, const std::vector<Point3>& polygon,
                     const std::function<void(const std::vector<Point3>&)>& use) {
  const double negligible = negligible_share * norm(area_vector(polygon));
  for_each_piece(in_span_units(grid, polygon), 3, grid.spans(), [&](const Polygon& piece) {
    Polygon corners;
    for (const Point3& xi : piece) corners.push_back(grid.to_position(from_span_units(grid, xi)));
    if (norm(area_vector(corners)) > negligible) use(corners);
  });
}

void add_polygon_points(const TrimmedModel& model, const SurfaceCells& surface, std::size_t triangle,
                        const std::vector<Point3>& polygon, std::vector<SurfacePoint>& points) {
  const SplineGrid& grid = model.grid;
  const auto degree = grid.degree();
  const auto rule = triangle_rule(3 * *std::max_element(degree.begin(), degree.end()));
  const auto parameter = [&](const Point3& xi) { return from_span_units(grid, xi); };
  const double negligible = negligible_share * norm(area_vector(polygon));
  for_each_piece(in_span_units(grid, polygon), 3, grid.spans(), [&](const Polygon& piece) {
    Point3 middle{};
    for (const Point3& xi : piece) middle = plus(middle, times(xi, 1.0 / static_cast<double>(piece.size())));
    const std::int64_t cell = surface.find(triangle, parameter(middle)).cell;
    const Box3 box = grid.span_box(grid.span_index(model.cells.span[static_cast<std::size_t>(cell)]));
    for (std::size_t a = 1; a + 1 < piece.size(); ++a) {
      const Point3 corner[3]{parameter(piece[0]), parameter(piece[a]), parameter(piece[a + 1])};
      const double area = 0.5 * norm(cross(minus(corner[1], corner[0]), minus(corner[2], corner[0])));
      if (!(area > negligible)) continue;
      for (const TrianglePoint& q : rule) {
        Point3 u{};
        for (std::size_t c = 0; c < 3; ++c) u = plus(u, times(corner[c], q.barycentric[c]));
        for (std::size_t d = 0; d < 3; ++d) u[d] = std::clamp(u[d], box.lower[d], box.upper[d]);
        points.push_back({cell, u, area * q.weight});
      }
    }
  });
}

} // namespace iga::solve
