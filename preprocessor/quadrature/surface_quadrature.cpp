// Two passes over the pieces: the first counts points per owning cell, the second writes them at their final places, so
// that the result is sorted by cell and does not depend on the number of threads.
#include "preprocessor/quadrature/surface_quadrature.hpp"

#include "format/model/box.hpp"
#include "format/model/errors.hpp"
#include "format/model/triangle_rule.hpp"
#include "format/model/vec3.hpp"
#include "preprocessor/base/gauss_rule.hpp"
#include "preprocessor/trim/span_owner.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

// Fan triangles smaller than this share of their parent triangle are rounding of the cuts, not surface.
constexpr double negligible_share = 1e-15;

constexpr std::size_t pieces_per_task = 2048;

/// Unit normal and area of a mesh triangle; a triangle without area has a zero normal.
struct Facet {
  Point3 normal{};      ///< in space
  Point3 grid_normal{}; ///< in the grid's frame
  double area = 0;      ///< length²
};

Facet make_facet(const SplineGrid& grid, const TriangleMesh& mesh, std::int32_t triangle) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto corner = [&](std::size_t a) { return mesh.vertices[static_cast<std::size_t>(t[a])]; };
  Facet f;
  f.normal = cross(minus(corner(1), corner(0)), minus(corner(2), corner(0)));
  const double twice_area = std::hypot(f.normal[0], f.normal[1], f.normal[2]);
  f.area = 0.5 * twice_area;
  if (twice_area > 0)
    for (double& c : f.normal) c /= twice_area;
  f.grid_normal = grid.along_axes(f.normal);
  return f;
}

/// Rules for the parts that a piece is cut into, all exact to the same total degree; none for one point a piece.
struct PartRules {
  std::span<const TrianglePoint> triangle;
  const LineRule* line; ///< both ways over a quadrilateral: the bilinear map's Jacobian adds one degree

  PartRules() : line(nullptr) {}
  explicit PartRules(int degree) : triangle(triangle_rule(degree)), line(&gauss_legendre((degree + 3) / 2)) {}
};

// Reduced rules: one point on pieces up to a quarter of a span wide, exact to this degree on those up to this width.
// What varies as fast as functions do within a span is then integrated to a few per cent.
constexpr double one_point_width = 0.25, some_points_width = 0.6;
constexpr int some_points_degree = 4;

// Largest extent along an axis, in spans.
double width_of(std::span<const Point3> polygon) {
  const auto [low, high] = bounding_box(polygon);
  return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

/// Rules of pieces by their width.
class PieceRules {
 public:
  PieceRules(SurfaceRule rule, int degree) : rule_(rule), some_(std::min(some_points_degree, degree)), exact_(degree) {}

  const PartRules& of(std::span<const Point3> polygon) const {
    if (rule_ == SurfaceRule::Exact) return exact_;
    const double width = width_of(polygon);
    return width <= one_point_width ? one_ : width <= some_points_width ? some_ : exact_;
  }

 private:
  SurfaceRule rule_;
  PartRules one_, some_, exact_;
};

/// A piece seen from its first vertex: areas of the fan's triangles (length²).
class PieceAreas {
 public:
  PieceAreas(std::span<const Point3> polygon, const Facet& facet, const Point3& h)
      : polygon_(polygon), facet_(facet), h_(h) {}

  double triangle(std::size_t a, std::size_t b, std::size_t c) const {
    return 0.5 * dot(cross(edge(a, b), edge(a, c)), facet_.grid_normal);
  }
  bool counts(double area) const { return area > negligible_share * facet_.area; }

 private:
  Point3 edge(std::size_t from, std::size_t to) const {
    const Point3 e = minus(polygon_[to], polygon_[from]);
    return {h_[0] * e[0], h_[1] * e[1], h_[2] * e[2]};
  }
  std::span<const Point3> polygon_;
  const Facet& facet_;
  const Point3& h_;
};

Point3 combine(std::span<const Point3> polygon, const std::array<std::size_t, 4>& corner,
               const std::array<double, 4>& l) {
  Point3 xi{};
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t d = 0; d < 3; ++d) xi[d] += l[c] * polygon[corner[c]][d];
  return xi;
}

// Bilinear map of the unit square. Its Jacobian is linear, so it follows from the corners' values: twice the area of
// the triangle at each corner.
template <class Use>
void for_each_quadrilateral_point(std::span<const Point3> polygon, const PieceAreas& areas,
                                  const std::array<std::size_t, 4>& corner, const LineRule& rule, Use&& use) {
  std::array<double, 4> jacobian;
  for (std::size_t c = 0; c < 4; ++c)
    jacobian[c] = 2 * std::max(areas.triangle(corner[(c + 3) % 4], corner[c], corner[(c + 1) % 4]), 0.0);
  for (std::size_t i = 0; i < rule.nodes.size(); ++i)
    for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
      const double s = rule.nodes[i], t = rule.nodes[j];
      const std::array<double, 4> l{(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
      const double J = l[0] * jacobian[0] + l[1] * jacobian[1] + l[2] * jacobian[2] + l[3] * jacobian[3];
      use(combine(polygon, corner, l), J * rule.weights[i] * rule.weights[j]);
    }
}

template <class Use> void for_centroid(std::span<const Point3> polygon, const PieceAreas& areas, Use&& use) {
  Point3 moment{};
  double area = 0;
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a) {
    const double part = areas.triangle(0, a, a + 1);
    if (!areas.counts(part)) continue;
    area += part;
    for (std::size_t d = 0; d < 3; ++d)
      moment[d] += part * ((polygon[a][d] - polygon[0][d]) + (polygon[a + 1][d] - polygon[0][d])) / 3;
  }
  if (!(area > 0)) return;
  // Relative to the first corner: in a grid plane the centroid lies exactly in that plane.
  Point3 centroid = polygon[0];
  for (std::size_t d = 0; d < 3; ++d) centroid[d] += moment[d] / area;
  use(centroid, area);
}

/// Calls use(xi, weight) for the points of a piece: its fan taken two triangles at a time (a quadrilateral needs fewer
/// points than two triangles), a single one where the number is odd or a neighbour has no area.
template <class Use>
void for_each_point(std::span<const Point3> polygon, const Facet& facet, const Point3& h, const PieceRules& of_pieces,
                    Use&& use) {
  const PieceAreas areas(polygon, facet, h);
  const PartRules& rules = of_pieces.of(polygon);
  if (!rules.line) return for_centroid(polygon, areas, use);
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a) {
    const double area = areas.triangle(0, a, a + 1);
    if (!areas.counts(area)) continue;
    if (a + 2 < polygon.size() && areas.counts(areas.triangle(0, a + 1, a + 2))) {
      for_each_quadrilateral_point(polygon, areas, {0, a, a + 1, a + 2}, *rules.line, use);
      ++a;
      continue;
    }
    for (const TrianglePoint& q : rules.triangle) {
      const auto& l = q.barycentric;
      use(combine(polygon, {0, a, a + 1, 0}, {l[0], l[1], l[2], 0}), area * q.weight);
    }
  }
}

/// Where a piece goes.
struct Placement {
  std::int64_t cell = 0;  ///< that owns it
  std::int64_t first = 0; ///< number of its points, later its first point
};

Point3 mean(std::span<const Point3> polygon) {
  Point3 c{};
  for (std::size_t d = 0; d < 3; ++d) {
    // Relative to the first vertex: a polygon in a grid plane has its mean exactly in that plane.
    for (const Point3& v : polygon) c[d] += v[d] - polygon[0][d];
    c[d] = polygon[0][d] + c[d] / static_cast<double>(polygon.size());
  }
  return c;
}

void fill_piece(const SpanOwner& owner, std::int64_t cell, const PieceRules& rules, const Facet& facet, const Point3& h,
                std::span<const Point3> polygon, std::int32_t triangle, std::int64_t first, SurfacePoints& out) {
  auto q = static_cast<std::size_t>(first);
  for_each_point(polygon, facet, h, rules, [&](const Point3& xi, double weight) {
    const Point3 u = owner.parameters_in(cell, xi);
    std::copy(u.begin(), u.end(), out.parameters.begin() + static_cast<std::ptrdiff_t>(3 * q));
    std::copy(facet.normal.begin(), facet.normal.end(), out.normals.begin() + static_cast<std::ptrdiff_t>(3 * q));
    out.weights[q] = weight;
    out.triangle[q] = triangle;
    ++q;
  });
}

SurfacePoints make_points(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                          const SpanOwner& owner, SurfaceRule rule) {
  const SurfacePieces& pieces = trimming.pieces;
  const auto degree = grid.degree();
  const PieceRules rules(rule, 3 * *std::max_element(degree.begin(), degree.end()));
  const Point3 h = grid.span_size();
  const auto num_pieces = static_cast<std::size_t>(pieces.num_pieces());
  const tbb::blocked_range<std::size_t> all(0, num_pieces, pieces_per_task);

  std::vector<Placement> placement(num_pieces);
  tbb::parallel_for(all, [&](const auto& range) {
    auto touched =
        std::upper_bound(pieces.offsets.begin(), pieces.offsets.end(), static_cast<std::int64_t>(range.begin())) -
        pieces.offsets.begin() - 1;
    for (std::size_t q = range.begin(); q != range.end(); ++q) {
      while (pieces.offsets[static_cast<std::size_t>(touched) + 1] <= static_cast<std::int64_t>(q)) ++touched;
      const auto polygon = pieces.polygon(static_cast<std::int64_t>(q));
      const Facet facet = make_facet(grid, mesh, pieces.triangle[q]);
      std::int64_t count = 0;
      for_each_point(polygon, facet, h, rules, [&](const Point3&, double) { ++count; });
      if (count == 0) continue;
      placement[q] = {owner.cell_of_polygon(touched, static_cast<std::int64_t>(q), mean(polygon), facet.grid_normal),
                      count};
    }
  });

  SurfacePoints out;
  out.offsets.assign(trimming.active.size() + 1, 0);
  for (const Placement& p : placement) out.offsets[static_cast<std::size_t>(p.cell) + 1] += p.first;
  for (std::size_t a = 0; a < trimming.active.size(); ++a) out.offsets[a + 1] += out.offsets[a];
  std::vector<std::int64_t> next(out.offsets.begin(), out.offsets.end() - 1);
  for (Placement& p : placement) {
    const std::int64_t count = p.first;
    p.first = next[static_cast<std::size_t>(p.cell)];
    next[static_cast<std::size_t>(p.cell)] += count;
  }

  const auto num_points = static_cast<std::size_t>(out.offsets.back());
  out.parameters.resize(3 * num_points);
  out.normals.resize(3 * num_points);
  out.weights.resize(num_points);
  out.triangle.resize(num_points);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t q = range.begin(); q != range.end(); ++q)
      fill_piece(owner, placement[q].cell, rules, make_facet(grid, mesh, pieces.triangle[q]), h,
                 pieces.polygon(static_cast<std::int64_t>(q)), pieces.triangle[q], placement[q].first, out);
  });
  return out;
}

// Σ of the area vectors of the triangles around each vertex, grid's frame.
std::vector<Point3> vertex_normals(const SplineGrid& grid, const TriangleMesh& mesh) {
  std::vector<Point3> normals(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Facet f = make_facet(grid, mesh, static_cast<std::int32_t>(t));
    for (const std::int32_t v : mesh.triangles[t])
      for (std::size_t d = 0; d < 3; ++d) normals[static_cast<std::size_t>(v)][d] += f.area * f.grid_normal[d];
  }
  return normals;
}

} // namespace

SurfaceRule surface_rule(const std::string& name) {
  if (name == "exact") return SurfaceRule::Exact;
  if (name == "reduced") return SurfaceRule::Reduced;
  throw InputError(fmt::format("surface rule '{}' is not known; choose exact or reduced", name));
}

EmbeddedSurface make_embedded_surface(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                                      SurfaceRule rule) {
  if (trimming.active.empty())
    throw InputError("no span of the grid holds material: the part is thinner than the sliver tolerance everywhere, or "
                     "every span was dropped by the smallest fraction; use smaller spans or a smaller --min-fraction");
  const SpanOwner owner(grid, trimming);
  EmbeddedSurface out;
  out.mesh = mesh;
  out.quadrature = make_points(grid, mesh, trimming, owner, rule);

  const std::vector<Point3> xi = to_span_units(grid, mesh);
  const std::vector<Point3> normals = vertex_normals(grid, mesh);
  out.vertex_cell.resize(xi.size());
  out.vertex_parameters.resize(3 * xi.size());
  tbb::parallel_for(std::size_t{0}, xi.size(), [&](std::size_t v) {
    out.vertex_cell[v] = owner.cell_of_vertex(xi[v], normals[v]);
    const Point3 u = owner.parameters_in(out.vertex_cell[v], xi[v]);
    std::copy(u.begin(), u.end(), out.vertex_parameters.begin() + static_cast<std::ptrdiff_t>(3 * v));
  });
  return out;
}

} // namespace iga::prep
