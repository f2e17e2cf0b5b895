#include "preprocessor/trim/span_owner.hpp"

#include "format/model/span_state.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace iga::prep {

namespace {

// Distances (span units) closer than this count as equal: far above the rounding of coordinates, far below a sliver.
constexpr double same_distance = 1e-9;

// Shells of spans searched around a point before all active spans are: a dropped span's neighbour is nearly always
// near.
constexpr std::int64_t max_shell = 6;

} // namespace

struct SpanOwner::Choice {
  std::int64_t span = -1;
  double distance = std::numeric_limits<double>::infinity();
  double height = 0; ///< of the span's centre above the surface's tangent plane, length
};

SpanOwner::SpanOwner(const SplineGrid& grid, const Trimming& trimming) : grid_(grid), trimming_(trimming) {
  assert(!trimming.active.empty());
}

void SpanOwner::consider(const Index3& ijk, const Point3& xi, const Point3& normal, Choice& best) const {
  const std::int64_t span = grid_.span_number(ijk);
  if (trimming_.state[static_cast<std::size_t>(span)] == static_cast<std::uint8_t>(SpanState::Exterior)) return;
  Choice c{span, 0, 0};
  const Point3 h = grid_.span_size();
  for (std::size_t d = 0; d < 3; ++d) {
    const auto low = static_cast<double>(ijk[d]);
    c.distance = std::hypot(c.distance, xi[d] - std::clamp(xi[d], low, low + 1));
    c.height += normal[d] * h[d] * (low + 0.5 - xi[d]);
  }
  const bool nearer = c.distance < best.distance - same_distance;
  const bool as_near = c.distance <= best.distance + same_distance;
  if (best.span < 0 || nearer || (as_near && (c.height < best.height || (c.height == best.height && span < best.span))))
    best = c;
}

std::int64_t SpanOwner::find(const Point3& xi, const Point3& normal) const {
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
    if (best.span >= 0 && best.distance <= static_cast<double>(shell - 1) + same_distance) return best.span;
    if (shell == 1 && best.span >= 0) return best.span;
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
          if (shell == 0 || on_shell) consider({i, j, k}, xi, normal, best);
        }
  }
  if (best.span >= 0) return best.span;
  for (const std::int64_t span : trimming_.active) consider(grid_.span_index(span), xi, normal, best);
  return best.span;
}

std::int64_t SpanOwner::cell(std::int64_t span, const Point3& xi, std::int64_t touched) const {
  const auto& active = trimming_.active;
  const auto [first, last] = std::equal_range(active.begin(), active.end(), span);
  const std::int64_t begin = first - active.begin(), end = last - active.begin();
  if (end - begin == 1) return begin;
  std::int64_t best = begin;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::int64_t c = begin; c < end; ++c) {
    const std::int64_t own = trimming_.touched[static_cast<std::size_t>(c)];
    if (own == touched) return c;
    const auto t = static_cast<std::size_t>(own);
    for (std::int64_t q = trimming_.pieces.offsets[t]; q < trimming_.pieces.offsets[t + 1]; ++q) {
      const double distance = distance_to_polygon(trimming_.pieces.polygon(q), xi);
      if (distance >= nearest) continue;
      nearest = distance;
      best = c;
    }
  }
  return best;
}

Point3 SpanOwner::parameters_in(std::int64_t span, const Point3& xi) const {
  const Box3 box = grid_.span_box(grid_.span_index(span));
  const Point3 A = grid_.A(), h = grid_.span_size();
  Point3 u;
  for (std::size_t d = 0; d < 3; ++d) u[d] = std::clamp(A[d] + h[d] * xi[d], box.lower[d], box.upper[d]);
  return u;
}

} // namespace iga::prep
