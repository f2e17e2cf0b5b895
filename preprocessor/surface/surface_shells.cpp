#include "preprocessor/surface/surface_shells.hpp"

#include "format/model/disjoint_sets.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <numeric>
#include <tbb/parallel_for.h>

namespace iga::prep {

namespace {

using Index = std::size_t;

/// Facets joined across two-facet edges; the root is the smallest facet.
std::vector<std::int32_t> manifold_patches(Index num_triangles, const EdgeTable& edges) {
  std::vector<std::int32_t> parent(num_triangles);
  std::iota(parent.begin(), parent.end(), 0);
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() == 2) join_sets(parent, uses[0].triangle, uses[1].triangle);
  }
  for (Index t = 0; t < num_triangles; ++t) parent[t] = find_root(parent, static_cast<std::int32_t>(t));
  return parent;
}

double signed_volume(const TriangleMesh& mesh, std::span<const std::int32_t> facets, const Point3& origin) {
  double sum = 0;
  for (std::int32_t f : facets) {
    const auto t = static_cast<Index>(f);
    const Point3 a = minus(corner(mesh, t, 0), origin), b = minus(corner(mesh, t, 1), origin);
    sum += dot(a, cross(b, minus(corner(mesh, t, 2), origin)));
  }
  return sum / 6;
}

/// Breadth-first walk across two-facet edges: which facets must turn to agree with the first of their patch.
struct Walk {
  std::vector<bool> turn;
  std::int32_t conflict = -1;
};

Walk walk_patches(const TriangleMesh& mesh, const EdgeTable& edges) {
  const Index n = mesh.triangles.size();
  // Neighbours as (facet, agrees) lists in compressed rows.
  std::vector<std::int64_t> start(n + 1, 0);
  for (Index e = 0; e < edges.num_edges(); ++e)
    if (const auto u = edges.edge(e); u.size() == 2)
      for (const EdgeUse& use : u) ++start[static_cast<Index>(use.triangle) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::pair<std::int32_t, bool>> next(static_cast<Index>(start[n]));
  std::vector<std::int64_t> fill(start.begin(), start.end() - 1);
  for (Index e = 0; e < edges.num_edges(); ++e)
    if (const auto u = edges.edge(e); u.size() == 2) {
      const bool agree = u[0].forward != u[1].forward;
      next[static_cast<Index>(fill[static_cast<Index>(u[0].triangle)]++)] = {u[1].triangle, agree};
      next[static_cast<Index>(fill[static_cast<Index>(u[1].triangle)]++)] = {u[0].triangle, agree};
    }
  Walk walk{std::vector<bool>(n, false), -1};
  std::vector<bool> seen(n, false);
  std::vector<std::int32_t> queue;
  for (Index first = 0; first < n; ++first) {
    if (seen[first]) continue;
    queue.assign(1, static_cast<std::int32_t>(first));
    seen[first] = true;
    for (Index q = 0; q < queue.size(); ++q) {
      const auto t = static_cast<Index>(queue[q]);
      for (auto k = start[t]; k < start[t + 1]; ++k) {
        const auto [other, agree] = next[static_cast<Index>(k)];
        const auto o = static_cast<Index>(other);
        const bool wanted = agree ? walk.turn[t] : !walk.turn[t];
        if (!seen[o]) {
          seen[o] = true;
          walk.turn[o] = wanted;
          queue.push_back(other);
        } else if (walk.turn[o] != wanted && walk.conflict < 0) {
          walk.conflict = other;
        }
      }
    }
  }
  return walk;
}

/// Turns whole patches while that lowers the imbalance of the edges that more than two facets share.
void balance_patches(Surface& surface, const std::vector<std::int32_t>& patch, std::vector<bool>& turned) {
  const EdgeTable edges = make_edge_table(surface.mesh.triangles);
  const Index n = surface.mesh.triangles.size();
  struct Share {
    Index edge;
    int sum;
  };
  std::vector<std::vector<Share>> shares(n); // by patch root
  std::vector<int> balance;
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() < 3) continue;
    for (const EdgeUse& u : uses) {
      auto& list = shares[static_cast<Index>(patch[static_cast<Index>(u.triangle)])];
      if (list.empty() || list.back().edge != balance.size()) list.push_back({balance.size(), 0});
      list.back().sum += u.forward ? 1 : -1;
    }
    balance.push_back(edge_balance(uses));
  }
  constexpr int max_passes = 20;
  bool changed = true;
  std::vector<bool> turn_patch(n, false);
  for (int pass = 0; pass < max_passes && changed; ++pass) {
    changed = false;
    for (Index p = 0; p < n; ++p) {
      int gain = 0;
      for (const Share& s : shares[p]) gain += std::abs(balance[s.edge]) - std::abs(balance[s.edge] - 2 * s.sum);
      if (gain <= 0) continue;
      for (Share& s : shares[p]) {
        balance[s.edge] -= 2 * s.sum;
        s.sum = -s.sum;
      }
      turn_patch[p] = !turn_patch[p];
      changed = true;
    }
  }
  for (Index t = 0; t < n; ++t)
    if (turn_patch[static_cast<Index>(patch[t])]) {
      turn_triangle(surface, t);
      turned[t] = !turned[t];
    }
}

} // namespace

Orienting orient_facets(Surface& surface) {
  Orienting out;
  const EdgeTable edges = make_edge_table(surface.mesh.triangles);
  if (is_closed_chain(edges)) return out;
  const Index n = surface.mesh.triangles.size();
  const std::vector<std::int32_t> patch = manifold_patches(n, edges);
  Walk walk = walk_patches(surface.mesh, edges);
  if (walk.conflict >= 0) {
    out.orientable = false;
    out.where = corner(surface.mesh, static_cast<Index>(walk.conflict), 0);
  }
  std::vector<std::int64_t> votes(n, 0);
  for (Index t = 0; t < n; ++t) votes[static_cast<Index>(patch[t])] += walk.turn[t] ? -1 : 1;
  std::vector<bool> turned(n);
  for (Index t = 0; t < n; ++t) {
    turned[t] = votes[static_cast<Index>(patch[t])] < 0 ? !walk.turn[t] : walk.turn[t];
    if (turned[t]) turn_triangle(surface, t);
  }
  balance_patches(surface, patch, turned);
  out.turned = std::count(turned.begin(), turned.end(), true);
  return out;
}

Shells find_shells(const TriangleMesh& mesh) {
  const Index n = mesh.triangles.size();
  const EdgeTable edges = make_edge_table(mesh.triangles);
  std::vector<std::int32_t> parent = manifold_patches(n, edges);
  // A patch that does not balance an edge on its own belongs together with the others at that edge.
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() < 3) continue;
    std::vector<std::int32_t> loose;
    for (const EdgeUse& u : uses) {
      int sum = 0;
      for (const EdgeUse& w : uses)
        if (find_root(parent, w.triangle) == find_root(parent, u.triangle)) sum += w.forward ? 1 : -1;
      if (sum != 0) loose.push_back(u.triangle);
    }
    for (std::int32_t t : loose) join_sets(parent, loose.front(), t);
  }
  Shells out;
  out.shell.assign(n, -1);
  for (Index t = 0; t < n; ++t) {
    const auto root = static_cast<Index>(find_root(parent, static_cast<std::int32_t>(t)));
    if (out.shell[root] < 0) {
      out.shell[root] = static_cast<std::int32_t>(out.facets.size());
      out.facets.emplace_back();
    }
    out.shell[t] = out.shell[root];
    out.facets[static_cast<Index>(out.shell[t])].push_back(static_cast<std::int32_t>(t));
  }
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const auto& facets : out.facets) {
    Box3 box{{inf, inf, inf}, {-inf, -inf, -inf}};
    double area = 0;
    for (std::int32_t f : facets) {
      const auto t = static_cast<Index>(f);
      area += 0.5 * norm(area_vector(mesh, t));
      for (Index i = 0; i < 3; ++i)
        for (Index d = 0; d < 3; ++d) {
          box.lower[d] = std::min(box.lower[d], corner(mesh, t, i)[d]);
          box.upper[d] = std::max(box.upper[d], corner(mesh, t, i)[d]);
        }
    }
    const Point3 centre = plus(box.lower, times(minus(box.upper, box.lower), 0.5));
    out.box.push_back(box);
    out.area.push_back(area);
    out.volume.push_back(signed_volume(mesh, facets, centre));
  }
  return out;
}

double winding_number(const TriangleMesh& mesh, std::span<const std::int32_t> facets, const Point3& x) {
  double sum = 0;
  for (std::int32_t f : facets) {
    const auto t = static_cast<Index>(f);
    const Point3 a = minus(corner(mesh, t, 0), x), b = minus(corner(mesh, t, 1), x), c = minus(corner(mesh, t, 2), x);
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double up = dot(a, cross(b, c));
    const double down = la * lb * lc + dot(a, b) * lc + dot(c, a) * lb + dot(b, c) * la;
    if (up != 0 || down != 0) sum += std::atan2(up, down);
  }
  return sum / (2 * std::numbers::pi);
}

bool box_contains(const Box3& outer, const Box3& inner, double slack) {
  for (Index d = 0; d < 3; ++d)
    if (inner.lower[d] < outer.lower[d] - slack || inner.upper[d] > outer.upper[d] + slack) return false;
  return true;
}

namespace {

/// The middle of a shell's facet, moved by `depth` into what the shell encloses: where two bodies touch, rounding puts
/// the facets of one a little into the other.
Point3 point_below(const TriangleMesh& mesh, const Shells& shells, Index shell, Index t, double depth) {
  const Point3& x = corner(mesh, t, 0);
  const Point3 middle = plus(x, times(plus(minus(corner(mesh, t, 1), x), minus(corner(mesh, t, 2), x)), 1.0 / 3));
  const Point3 normal = area_vector(mesh, t);
  const double length = norm(normal);
  if (length == 0) return middle;
  return plus(middle, times(normal, (shells.volume[shell] > 0 ? -depth : depth) / length));
}

enum class Side { Out, On, In };

/// Distance of a winding number from an integer up to which it decides; on the surface it is 1/2 away.
constexpr double clear_winding = 0.05;

Side side_of(const TriangleMesh& mesh, const Shells& shells, Index shell, const Point3& x) {
  const Box3& box = shells.box[shell];
  for (Index d = 0; d < 3; ++d)
    if (x[d] < box.lower[d] || x[d] > box.upper[d]) return Side::Out;
  const double w = winding_number(mesh, shells.facets[shell], x);
  if (std::abs(w - std::round(w)) > clear_winding) return Side::On;
  return std::abs(w) > 0.5 ? Side::In : Side::Out;
}

/// Whether shell `inner` lies inside shell `outer`, by the first of its facets whose middle is clearly in or out.
bool lies_inside(const TriangleMesh& mesh, const Shells& shells, Index inner, Index outer, double depth) {
  constexpr Index max_samples = 40;
  const auto& facets = shells.facets[inner];
  const Index samples = std::min(max_samples, facets.size());
  for (Index s = 0; s < samples; ++s) {
    const Point3 x = point_below(mesh, shells, inner, static_cast<Index>(facets[s * facets.size() / samples]), depth);
    const Side side = side_of(mesh, shells, outer, x);
    if (side != Side::On) return side == Side::In;
  }
  return false;
}

/// Area-weighted agreement of a shell's stored normals with its facets' order, −1 … 1; 0 where none are stored.
double normal_agreement(const Surface& surface, const std::vector<std::int32_t>& facets) {
  double agree = 0, total = 0;
  for (std::int32_t f : facets) {
    const auto t = static_cast<Index>(f);
    const Point3 a = area_vector(surface.mesh, t);
    const double along = dot(a, surface.normals[t]);
    if (along == 0) continue;
    agree += along > 0 ? norm(a) : -norm(a);
    total += norm(a);
  }
  return total > 0 ? agree / total : 0;
}

struct Roles {
  std::vector<int> sign; ///< wanted sign of each shell's volume
  std::vector<std::int32_t> doubled;
};

/// Outer shells first; `stored` holds the sign each shell is read with, `around` the shells that contain it.
Roles assign_roles(const std::vector<Index>& order, const std::vector<std::vector<Index>>& around,
                   const std::vector<int>& stored, const std::vector<bool>& normals_disagree) {
  Roles roles{std::vector<int>(stored.size(), 1), {}};
  for (Index s : order) {
    int winding = 0;
    for (Index outer : around[s]) winding += roles.sign[outer];
    if (winding <= 0) continue; // empty around it: a body
    if (stored[s] < 0 || normals_disagree[s])
      roles.sign[s] = -1; // in material, facing inwards: a cavity
    else
      roles.doubled.push_back(static_cast<std::int32_t>(s));
  }
  return roles;
}

} // namespace

bool reaches_in_and_out(const TriangleMesh& mesh, const Shells& shells, std::int32_t a, std::int32_t b, double depth) {
  constexpr Index max_samples = 100;
  const auto& facets = shells.facets[static_cast<Index>(a)];
  const Index samples = std::min(max_samples, facets.size());
  bool in = false, out = false;
  for (Index s = 0; s < samples && !(in && out); ++s) {
    const auto t = static_cast<Index>(facets[s * facets.size() / samples]);
    const Point3 x = point_below(mesh, shells, static_cast<Index>(a), t, depth);
    const Side side = side_of(mesh, shells, static_cast<Index>(b), x);
    in = in || side == Side::In;
    out = out || side == Side::Out;
  }
  return in && out;
}

Nesting orient_shells(Surface& surface, Shells& shells, double depth) {
  const Index n = shells.count();
  const TriangleMesh& mesh = surface.mesh;
  std::vector<std::vector<Index>> around(n);
  tbb::parallel_for(Index{0}, n, [&](Index s) {
    for (Index o = 0; o < n; ++o) {
      const double slack = 1e-9 * diagonal(shells.box[o]);
      if (o == s || std::abs(shells.volume[o]) <= std::abs(shells.volume[s])) continue;
      if (box_contains(shells.box[o], shells.box[s], slack) && lies_inside(mesh, shells, s, o, depth))
        around[s].push_back(o);
    }
  });
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return around[a].size() < around[b].size(); });

  std::vector<int> absolute(n), relative(n);
  std::vector<bool> contrary(n);
  for (Index s : order) {
    absolute[s] = shells.volume[s] < 0 ? -1 : 1;
    relative[s] = absolute[s];
    for (Index o : around[s])
      if (around[o].empty()) relative[s] = absolute[s] * absolute[o];
    contrary[s] = normal_agreement(surface, shells.facets[s]) < -0.9;
  }
  // A tree read relative to its outermost shell first (inside out as a whole); where that finds bodies inside bodies,
  // the shells' own signs may explain it without.
  Roles roles = assign_roles(order, around, relative, contrary);
  if (!roles.doubled.empty()) {
    Roles other = assign_roles(order, around, absolute, contrary);
    if (other.doubled.size() < roles.doubled.size()) roles = std::move(other);
  }
  Nesting out;
  out.doubled = roles.doubled;
  for (Index s = 0; s < n; ++s) {
    (roles.sign[s] > 0 ? out.bodies : out.cavities) += 1;
    if (roles.sign[s] == absolute[s]) continue;
    out.turned.push_back(static_cast<std::int32_t>(s));
    for (std::int32_t f : shells.facets[s]) turn_triangle(surface, static_cast<Index>(f));
    shells.volume[s] = -shells.volume[s];
  }
  out.whole_turned = out.turned.size() == n;
  return out;
}

} // namespace iga::prep
