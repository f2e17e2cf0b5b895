#include "preprocessor/connectivity/line_lattice.hpp"

#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

/// Where an edge meets the plane ξ_e = E.
struct EdgePoint {
  double f = 0, d = 0;
  int direction = 0; ///< +1 where the edge runs up along e
};

double between(double low, double high, double t) {
  const double x = low + t * (high - low);
  return low <= high ? std::clamp(x, low, high) : std::clamp(x, high, low);
}

// Always computed from the edge's lower end, whichever way the triangle runs along it. Returns false where the edge
// does not reach the plane; its lower end belongs to it, its upper end does not.
bool meet_edge(const Point3& p, const Point3& q, std::size_t d, std::size_t e, std::size_t f, double E,
               EdgePoint& out) {
  const bool up = p[e] < q[e];
  const Point3& low = up ? p : q;
  const Point3& high = up ? q : p;
  if (!(low[e] <= E && E < high[e])) return false;
  const double t = (E - low[e]) / (high[e] - low[e]);
  out = {between(low[f], high[f], t), between(low[d], high[d], t), up ? 1 : -1};
  return true;
}

} // namespace

LineShooter::LineShooter(const SplineGrid& grid, const TriangleMesh& mesh, const std::vector<Point3>& xi,
                         LineLattice lattice, std::size_t axis)
    : mesh_(mesh), xi_(xi), lattice_(lattice), d_(axis), e_((axis + 1) % 3), f_((axis + 2) % 3) {
  const std::int64_t slabs = grid.spans()[e_];
  const auto range = [&](const Triangle& t) {
    const auto coordinate = [&](std::size_t a) { return xi_[static_cast<std::size_t>(t[a])][e_]; };
    const auto [low, high] = std::minmax({coordinate(0), coordinate(1), coordinate(2)});
    return std::array{std::min(static_cast<std::int64_t>(low), slabs - 1),
                      std::min(static_cast<std::int64_t>(high), slabs - 1)};
  };
  first_.assign(static_cast<std::size_t>(slabs) + 1, 0);
  for (const Triangle& t : mesh.triangles) {
    const auto [low, high] = range(t);
    for (std::int64_t s = low; s <= high; ++s) ++first_[static_cast<std::size_t>(s) + 1];
  }
  for (std::size_t s = 0; s + 1 < first_.size(); ++s) first_[s + 1] += first_[s];
  triangles_.resize(static_cast<std::size_t>(first_.back()));
  std::vector<std::int64_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [low, high] = range(mesh.triangles[t]);
    for (std::int64_t s = low; s <= high; ++s)
      triangles_[static_cast<std::size_t>(next[static_cast<std::size_t>(s)]++)] = static_cast<std::int32_t>(t);
  }
}

void LineShooter::cross_triangle(const Triangle& triangle, std::int64_t slab,
                                 std::vector<LineCrossing>& crossings) const {
  const std::int64_t n = lattice_.per_span;
  const std::array<const Point3*, 3> v{&xi_[static_cast<std::size_t>(triangle[0])],
                                       &xi_[static_cast<std::size_t>(triangle[1])],
                                       &xi_[static_cast<std::size_t>(triangle[2])]};
  for (std::int64_t le = 0; le < n; ++le) {
    const double E = lattice_.coordinate(e_, slab * n + le);
    std::array<EdgePoint, 3> ends;
    std::size_t count = 0;
    for (std::size_t a = 0; a < 3; ++a) count += meet_edge(*v[a], *v[(a + 1) % 3], d_, e_, f_, E, ends[count]);
    if (count != 2) continue;
    const auto [low, high] = ends[0].f <= ends[1].f ? std::pair(ends[0], ends[1]) : std::pair(ends[1], ends[0]);
    // Lines with low.f <= F < high.f. One line to spare below: the guess may round either way, the comparison decides.
    for (auto lf = std::max<std::int64_t>(static_cast<std::int64_t>(low.f * static_cast<double>(n)) - 1, 0);; ++lf) {
      const double F = lattice_.coordinate(f_, lf);
      if (F < low.f) continue;
      if (F >= high.f) break;
      const double at = between(low.d, high.d, (F - low.f) / (high.f - low.f));
      // Seen against the axis an outward-facing triangle runs anticlockwise in (e, f): down along e on its upper side.
      crossings.push_back({lf * n + le, at, high.direction});
    }
  }
}

void LineShooter::shoot(std::int64_t slab, std::vector<LineCrossing>& crossings) const {
  crossings.clear();
  const auto s = static_cast<std::size_t>(slab);
  for (auto q = first_[s]; q < first_[s + 1]; ++q)
    cross_triangle(mesh_.triangles[static_cast<std::size_t>(triangles_[static_cast<std::size_t>(q)])], slab, crossings);
  std::sort(crossings.begin(), crossings.end(), [](const LineCrossing& a, const LineCrossing& b) {
    if (a.line != b.line) return a.line < b.line;
    return a.at != b.at ? a.at < b.at : a.change < b.change;
  });
}

} // namespace iga::prep
