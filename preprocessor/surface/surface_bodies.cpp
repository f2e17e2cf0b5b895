#include "preprocessor/surface/surface_bodies.hpp"

#include "preprocessor/surface/surface_shells.hpp"

#include <algorithm>
#include <limits>

namespace iga::prep {

namespace {

// The smallest outer shell around a cavity.
std::size_t body_around(const TriangleMesh& mesh, const Shells& shells, std::size_t cavity) {
  const Point3 x = mesh.vertices[static_cast<std::size_t>(
      mesh.triangles[static_cast<std::size_t>(shells.facets[cavity].front())][0])];
  std::size_t best = cavity;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < shells.count(); ++s)
    if (shells.volume[s] > 0 && shells.volume[s] < least && winding_number(mesh, shells.facets[s], x) > 0.5) {
      least = shells.volume[s];
      best = s;
    }
  return best;
}

TriangleMesh part_of(const TriangleMesh& mesh, const std::vector<std::int32_t>& facets) {
  TriangleMesh out;
  std::vector<std::int32_t> vertex(mesh.vertices.size(), -1), region(mesh.region_names.size(), -1);
  for (const std::int32_t t : facets) {
    Triangle facet = mesh.triangles[static_cast<std::size_t>(t)];
    for (std::int32_t& v : facet) {
      std::int32_t& n = vertex[static_cast<std::size_t>(v)];
      if (n < 0) {
        n = static_cast<std::int32_t>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
      }
      v = n;
    }
    out.triangles.push_back(facet);
    const auto old = static_cast<std::size_t>(mesh.region[static_cast<std::size_t>(t)]);
    if (region[old] < 0) {
      region[old] = static_cast<std::int32_t>(out.region_names.size());
      out.region_names.push_back(mesh.region_names[old]);
    }
    out.region.push_back(region[old]);
  }
  return out;
}

} // namespace

std::vector<TriangleMesh> split_into_bodies(const TriangleMesh& mesh) {
  const Shells shells = find_shells(mesh);
  std::vector<std::vector<std::int32_t>> facets(shells.count());
  for (std::size_t s = 0; s < shells.count(); ++s) {
    auto& body = facets[shells.volume[s] > 0 ? s : body_around(mesh, shells, s)];
    body.insert(body.end(), shells.facets[s].begin(), shells.facets[s].end());
  }
  std::vector<TriangleMesh> bodies;
  for (auto& body : facets) {
    if (body.empty()) continue;
    std::sort(body.begin(), body.end());
    bodies.push_back(part_of(mesh, body));
  }
  return bodies;
}

} // namespace iga::prep
