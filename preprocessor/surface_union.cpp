#include "preprocessor/surface_union.hpp"

#include "preprocessor/surface_exact_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <algorithm>
#include <limits>
#include <numeric>

namespace iga::prep {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Index = std::size_t;

/// The body that each shell belongs to: itself, or for a cavity the smallest body around it.
std::vector<Index> owners(const TriangleMesh& mesh, const Shells& shells) {
  std::vector<Index> owner(shells.count());
  for (Index s = 0; s < shells.count(); ++s) {
    owner[s] = s;
    if (shells.volume[s] >= 0) continue;
    const Point3& x = corner(mesh, static_cast<Index>(shells.facets[s].front()), 0);
    double smallest = std::numeric_limits<double>::infinity();
    for (Index o = 0; o < shells.count(); ++o)
      if (shells.volume[o] > -shells.volume[s] && shells.volume[o] < smallest &&
          winding_number(mesh, shells.facets[o], x) > 0.5) {
        smallest = shells.volume[o];
        owner[s] = o;
      }
  }
  return owner;
}

} // namespace

Uniting unite_bodies(Surface& surface, const Shells& shells,
                     std::span<const std::pair<std::int32_t, std::int32_t>> crossing) {
  Uniting out;
  const Index n = shells.count();
  const std::vector<Index> owner = owners(surface.mesh, shells);
  std::vector<Index> group(n);
  std::iota(group.begin(), group.end(), Index{0});
  const auto relabel = [&](Index from, Index to) { std::replace(group.begin(), group.end(), from, to); };
  for (Index s = 0; s < n; ++s) relabel(group[s], group[owner[s]]);
  for (const auto& [a, b] : crossing) {
    const Index ga = group[static_cast<Index>(a)], gb = group[static_cast<Index>(b)];
    relabel(std::max(ga, gb), std::min(ga, gb));
  }
  std::vector<bool> keep(surface.mesh.triangles.size(), true);
  std::vector<ExactMesh> results;
  for (Index g = 0; g < n; ++g) {
    std::vector<Index> bodies;
    for (Index s = 0; s < n; ++s)
      if (group[s] == g && owner[s] == s) bodies.push_back(s);
    if (bodies.size() < 2) continue;
    ExactMesh whole;
    for (Index k = 0; k < bodies.size(); ++k) {
      std::vector<std::int32_t> facets;
      for (Index s = 0; s < n; ++s)
        if (owner[s] == bodies[k]) facets.insert(facets.end(), shells.facets[s].begin(), shells.facets[s].end());
      for (std::int32_t f : facets) keep[static_cast<Index>(f)] = false;
      ExactMesh body;
      if (!to_exact_mesh(surface.mesh, facets, body)) {
        out.failure = "a body is not a manifold solid";
        return out;
      }
      if (!pmp::does_bound_a_volume(body)) pmp::orient_to_bound_a_volume(body);
      if (k == 0) {
        whole = std::move(body);
        continue;
      }
      ExactMesh sum;
      regions_of(sum);
      try {
        if (!pmp::corefine_and_compute_union(
                whole, body, sum, CGAL::parameters::visitor(RegionKeeper{}).throw_on_self_intersection(true))) {
          out.failure = "the union would not be a manifold solid";
          return out;
        }
      } catch (const std::exception&) {
        out.failure = "a body intersects itself";
        return out;
      }
      whole = std::move(sum);
    }
    out.bodies += static_cast<std::int64_t>(bodies.size());
    ++out.unions;
    results.push_back(std::move(whole));
  }
  keep_triangles(surface, keep);
  for (ExactMesh& mesh : results) append_exact_mesh(mesh, surface);
  return out;
}

} // namespace iga::prep
