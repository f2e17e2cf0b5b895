#include "preprocessor/surface/surface_regions.hpp"

#include "format/model/disjoint_sets.hpp"
#include "preprocessor/surface/surface_topology.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace iga::prep {

namespace {

using Index = std::size_t;

} // namespace

void split_regions(TriangleMesh& mesh, double degrees) {
  const Index n = mesh.triangles.size();
  const double limit = degrees * std::numbers::pi / 180;
  std::vector<std::int32_t> parent(n);
  std::iota(parent.begin(), parent.end(), 0);
  const EdgeTable edges = make_edge_table(mesh.triangles);
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() != 2) continue;
    const auto a = static_cast<Index>(uses[0].triangle), b = static_cast<Index>(uses[1].triangle);
    if (mesh.region[a] != mesh.region[b]) continue;
    const Point3 na = area_vector(mesh, a), nb = area_vector(mesh, b);
    // A facet without area has no direction: it parts nothing.
    const double angle = std::atan2(norm(cross(na, nb)), dot(na, nb));
    if (angle > limit && norm(na) > 0 && norm(nb) > 0) continue;
    const std::int32_t ra = find_root(parent, uses[0].triangle), rb = find_root(parent, uses[1].triangle);
    parent[static_cast<Index>(std::max(ra, rb))] = std::min(ra, rb);
  }
  std::vector<std::int32_t> patches_of(mesh.region_names.size(), 0);
  for (Index t = 0; t < n; ++t)
    if (parent[t] == static_cast<std::int32_t>(t)) ++patches_of[static_cast<Index>(mesh.region[t])];
  std::vector<std::int32_t> number(n, -1); // new region of each patch, by root
  std::vector<std::string> all;
  std::vector<std::int32_t> region(n);
  // Names in the order of the old regions, patches by first facet (the root).
  std::vector<std::int32_t> first_of(mesh.region_names.size(), 0);
  for (Index r = 0; r < mesh.region_names.size(); ++r) {
    first_of[r] = static_cast<std::int32_t>(all.size());
    for (std::int32_t k = 1; k <= patches_of[r]; ++k)
      all.push_back(patches_of[r] == 1 ? mesh.region_names[r] : fmt::format("{}/{}", mesh.region_names[r], k));
  }
  for (Index t = 0; t < n; ++t)
    if (parent[t] == static_cast<std::int32_t>(t)) number[t] = first_of[static_cast<Index>(mesh.region[t])]++;
  for (Index t = 0; t < n; ++t) region[t] = number[static_cast<Index>(find_root(parent, static_cast<std::int32_t>(t)))];
  mesh.region = std::move(region);
  mesh.region_names = std::move(all);
}

} // namespace iga::prep
