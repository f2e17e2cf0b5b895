#include "preprocessor/trim/span_owner.hpp"

#include "format/model/box.hpp"
#include "format/model/span_state.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace iga::prep {

namespace {

// Distances (span units) closer than this count as equal: far above the rounding of coordinates, far below a sliver.
constexpr double same_distance = 1e-9;

// How far (span units) a place moved out of a sliver may come to lie before a surface that looks the same way: the
// sliver's own, continued, whose slope adds to the depth that slivers have by default.
constexpr double beside_sliver = 1e-4;

// Shells of spans searched around a point before all active spans are: a dropped span's neighbour is nearly always
// near.
constexpr std::int64_t max_shell = 6;

// Does a polygon lie in a grid plane? Then it bounds the solid of the span on the side of the material.
bool lies_in_grid_plane(std::span<const Point3> polygon) {
  for (std::size_t d = 0; d < 3; ++d)
    if (polygon[0][d] == std::floor(polygon[0][d]) &&
        std::all_of(polygon.begin(), polygon.end(), [&](const Point3& v) { return v[d] == polygon[0][d]; }))
      return true;
  return false;
}

// Does the box around a polygon lie farther away than `limit`?
bool is_farther(std::span<const Point3> polygon, const Point3& xi, double limit) {
  return squared_distance(bounding_box(polygon), xi) > limit * limit;
}

Point3 unit_normal(std::span<const Point3> polygon) {
  Point3 n{};
  for (std::size_t a = 1; a + 1 < polygon.size(); ++a) n = plus(n, twice_area(polygon[0], polygon[a], polygon[a + 1]));
  const double length = norm(n);
  return length > 0 ? times(n, 1 / length) : n;
}

} // namespace

struct SpanOwner::Choice {
  std::int64_t span = -1;
  std::int64_t cell = -1;
  double distance = std::numeric_limits<double>::infinity();
  double height = 0; ///< of the span's centre above the surface's tangent plane, length
};

SpanOwner::SpanOwner(const SplineGrid& grid, const Trimming& trimming) : grid_(grid), trimming_(trimming) {
  assert(!trimming.active.empty());
}

std::int64_t SpanOwner::cell_of_polygon(std::int64_t touched, std::int64_t polygon, const Point3& middle,
                                        const Point3& normal) const {
  const std::int64_t own = cell_of_entry(touched);
  if (own < 0 || is_left_out(polygon) || lies_in_grid_plane(trimming_.pieces.polygon(polygon)))
    return cell_of_vertex(middle, normal);
  const std::int64_t span = nearest(middle, normal, Accept::AnySpan).span;
  return span == trimming_.active[static_cast<std::size_t>(own)] ? own : cell_in(span, middle, normal);
}

std::int64_t SpanOwner::cell_of_vertex(const Point3& xi, const Point3& normal) const {
  const Choice best = nearest(xi, normal, Accept::SolidAtPlace);
  if (best.cell >= 0) return best.cell;
  return cell_in(nearest(xi, normal, Accept::AnySpan).span, xi, normal);
}

void SpanOwner::consider(const Index3& ijk, const Point3& xi, const Point3& normal, Accept accept, Choice& best) const {
  const std::int64_t span = grid_.span_number(ijk);
  if (trimming_.state[static_cast<std::size_t>(span)] == static_cast<std::uint8_t>(SpanState::Exterior)) return;
  Choice c{span, -1, 0, 0};
  const Point3 h = grid_.span_size();
  Point3 moved{};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto low = static_cast<double>(ijk[d]);
    moved[d] = std::clamp(xi[d], low, low + 1);
    c.distance = std::hypot(c.distance, xi[d] - moved[d]);
    c.height += normal[d] * h[d] * (low + 0.5 - xi[d]);
  }
  const bool nearer = c.distance < best.distance - same_distance;
  const bool as_near = c.distance <= best.distance + same_distance;
  const bool better =
      best.span < 0 || nearer || (as_near && (c.height < best.height || (c.height == best.height && span < best.span)));
  if (!better) return;
  if (accept == Accept::SolidAtPlace && (c.cell = cell_at(span, moved, normal)) < 0) return;
  best = c;
}

SpanOwner::Choice SpanOwner::nearest(const Point3& xi, const Point3& normal, Accept accept) const {
  const Index3 n = grid_.spans();
  Index3 low{}, high{}; // spans whose closed box holds the point
  for (std::size_t d = 0; d < 3; ++d) {
    const double below = std::floor(xi[d]);
    high[d] = std::clamp<std::int64_t>(static_cast<std::int64_t>(below), 0, n[d] - 1);
    low[d] = xi[d] == below ? std::clamp<std::int64_t>(static_cast<std::int64_t>(below) - 1, 0, n[d] - 1) : high[d];
  }
  Choice best;
  for (std::int64_t shell = 0; shell <= max_shell; ++shell) {
    // Every span of this shell is at least shell - 1 away.
    if (best.span >= 0 && best.distance <= static_cast<double>(shell - 1) + same_distance) return best;
    if (shell == 1 && best.span >= 0) return best;
    Index3 first{}, last{};
    for (std::size_t d = 0; d < 3; ++d) {
      first[d] = std::max<std::int64_t>(low[d] - shell, 0);
      last[d] = std::min(high[d] + shell, n[d] - 1);
    }
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
      for (std::int64_t j = first[1]; j <= last[1]; ++j)
        for (std::int64_t i = first[0]; i <= last[0]; ++i) {
          const bool on_shell = i == low[0] - shell || i == high[0] + shell || j == low[1] - shell ||
                                j == high[1] + shell || k == low[2] - shell || k == high[2] + shell;
          if (shell == 0 || on_shell) consider({i, j, k}, xi, normal, accept, best);
        }
  }
  if (best.span >= 0) return best;
  for (const std::int64_t span : trimming_.active) consider(grid_.span_index(span), xi, normal, accept, best);
  return best;
}

// First and last + 1.
std::pair<std::int64_t, std::int64_t> SpanOwner::cells_of(std::int64_t span) const {
  const auto& active = trimming_.active;
  const auto [first, last] = std::equal_range(active.begin(), active.end(), span);
  return {first - active.begin(), last - active.begin()};
}

// -1 where the polygons of an entry belong to no cell.
std::int64_t SpanOwner::cell_of_entry(std::int64_t touched) const {
  const auto [first, last] = cells_of(trimming_.pieces.spans[static_cast<std::size_t>(touched)]);
  for (std::int64_t c = first; c < last; ++c)
    if (trimming_.touched[static_cast<std::size_t>(c)] == touched) return c;
  return -1;
}

bool SpanOwner::is_left_out(std::int64_t polygon) const {
  return std::binary_search(trimming_.left_out_polygons.begin(), trimming_.left_out_polygons.end(), polygon);
}

// A vertex of the surface within a span, not on its faces, lies on polygons of that span.
bool SpanOwner::lies_within(std::int64_t span, const Point3& xi) const {
  const Index3 ijk = grid_.span_index(span);
  for (std::size_t d = 0; d < 3; ++d) {
    const double t = xi[d] - static_cast<double>(ijk[d]);
    if (!(t > same_distance && t < 1 - same_distance)) return false;
  }
  return true;
}

// The cell that all polygons of an entry belong to; -1 where some were left out.
std::int64_t SpanOwner::whole_entry(std::int64_t touched) const {
  const auto& out = trimming_.left_out_polygons;
  const auto next =
      std::lower_bound(out.begin(), out.end(), trimming_.pieces.offsets[static_cast<std::size_t>(touched)]);
  if (next != out.end() && *next < trimming_.pieces.offsets[static_cast<std::size_t>(touched) + 1]) return -1;
  return cell_of_entry(touched);
}

// The cell on whose surface or in whose solid a place of a closed active span lies; -1 where it lies in a gap or in a
// piece left out. The nearest surface in the span tells: a span is convex, so nothing lies between.
std::int64_t SpanOwner::cell_at(std::int64_t span, const Point3& xi, const Point3& normal) const {
  const SurfacePieces& pieces = trimming_.pieces;
  const auto [first, last] = std::equal_range(pieces.spans.begin(), pieces.spans.end(), span);
  if (last - first == 1 && lies_within(span, xi))
    if (const std::int64_t only = whole_entry(first - pieces.spans.begin()); only >= 0) return only;
  struct Side {
    double distance = std::numeric_limits<double>::infinity();
    double height = 0; ///< of the place above the polygon's plane
    std::int64_t cell = -1;
    bool looks_alike = false;
    bool found = false;
  } best;
  const Point3 h = grid_.span_size();
  for (std::int64_t t = first - pieces.spans.begin(); t < last - pieces.spans.begin(); ++t) {
    const std::int64_t own = cell_of_entry(t);
    for (std::int64_t q = pieces.offsets[static_cast<std::size_t>(t)];
         q < pieces.offsets[static_cast<std::size_t>(t) + 1]; ++q) {
      const auto polygon = pieces.polygon(q);
      if (polygon.size() < 3 || is_farther(polygon, xi, best.distance + same_distance) || lies_in_grid_plane(polygon))
        continue;
      const double distance = distance_to_polygon(polygon, xi);
      if (distance > best.distance + same_distance) continue;
      const Point3 n = unit_normal(polygon);
      if (n == Point3{}) continue;
      Side side{distance, 0, is_left_out(q) ? -1 : own, false, true};
      side.height = dot(minus(xi, polygon[0]), n);
      side.looks_alike = n[0] * normal[0] * h[0] + n[1] * normal[1] * h[1] + n[2] * normal[2] * h[2] > 0;
      // Of polygons that meet at the nearest place, the one whose plane is farthest away tells the side; where the
      // place lies on them, one of a cell rather than of a piece left out.
      const bool nearer = distance < best.distance - same_distance;
      const bool on_it = distance <= same_distance;
      const bool tells = on_it ? best.cell < 0 && side.cell >= 0 : std::abs(side.height) > std::abs(best.height);
      if (!best.found || nearer || tells) best = side;
    }
  }
  if (!best.found) return cells_of(span).first;
  if (best.height <= same_distance || best.distance <= same_distance) return best.cell;
  return best.height <= beside_sliver && best.looks_alike ? best.cell : -1;
}

// Cell of an active span for a place that is known to bound its solid.
std::int64_t SpanOwner::cell_in(std::int64_t span, const Point3& xi, const Point3& normal) const {
  const auto [first, last] = cells_of(span);
  if (last - first == 1) return first;
  const std::int64_t cell = cell_at(span, xi, normal);
  if (cell >= 0) return cell;
  std::int64_t best = first;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::int64_t c = first; c < last; ++c) {
    const auto t = static_cast<std::size_t>(trimming_.touched[static_cast<std::size_t>(c)]);
    for (std::int64_t q = trimming_.pieces.offsets[t]; q < trimming_.pieces.offsets[t + 1]; ++q) {
      const double distance = distance_to_polygon(trimming_.pieces.polygon(q), xi);
      if (distance >= nearest) continue;
      nearest = distance;
      best = c;
    }
  }
  return best;
}

Point3 SpanOwner::parameters_in(std::int64_t cell, const Point3& xi) const {
  const Box3 box = grid_.span_box(grid_.span_index(trimming_.active[static_cast<std::size_t>(cell)]));
  const Point3 A = grid_.A(), h = grid_.span_size();
  Point3 u;
  for (std::size_t d = 0; d < 3; ++d) u[d] = std::clamp(A[d] + h[d] * xi[d], box.lower[d], box.upper[d]);
  return u;
}

} // namespace iga::prep
