#include "preprocessor/surface/surface_junctions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace iga::prep {

namespace {

/// A vertex further from an edge than this share of its length makes a corner there, not a junction on it.
constexpr double max_bend = 0.01;

/// A facet takes three passes, one per edge; more only where junctions lie within the tolerance of each other.
constexpr int max_passes = 16;

/// Vertices of open edges, by their first coordinate.
std::vector<std::int32_t> open_vertices(const TriangleMesh& mesh, const EdgeTable& edges) {
  std::vector<std::int32_t> vertices;
  for (std::size_t e = 0; e < edges.num_edges(); ++e)
    if (edges.edge(e).size() % 2 != 0) {
      vertices.push_back(edges.edge(e)[0].lo);
      vertices.push_back(edges.edge(e)[0].hi);
    }
  const auto before = [&](std::int32_t a, std::int32_t b) {
    const double xa = mesh.vertices[static_cast<std::size_t>(a)][0], xb = mesh.vertices[static_cast<std::size_t>(b)][0];
    return xa < xb || (xa == xb && a < b);
  };
  std::sort(vertices.begin(), vertices.end(), before);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// Vertices inside the edge a → b, in its direction.
std::vector<std::int32_t> vertices_on(const TriangleMesh& mesh, const std::vector<std::int32_t>& vertices,
                                      const Triangle& facet, std::int32_t a, std::int32_t b, double tolerance) {
  const auto position = [&](std::int32_t v) -> const Point3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
  const Point3 &xa = position(a), &xb = position(b), ab = minus(xb, xa);
  const double length2 = dot(ab, ab), near = std::min(tolerance, max_bend * std::sqrt(length2));
  std::vector<std::pair<double, std::int32_t>> found;
  auto v = std::lower_bound(vertices.begin(), vertices.end(), std::min(xa[0], xb[0]) - tolerance,
                            [&](std::int32_t w, double x) { return position(w)[0] < x; });
  for (; v != vertices.end() && position(*v)[0] <= std::max(xa[0], xb[0]) + tolerance; ++v) {
    if (std::find(facet.begin(), facet.end(), *v) != facet.end()) continue;
    const Point3 ax = minus(position(*v), xa);
    const double t = dot(ax, ab) / length2;
    if (!(t > 0 && t < 1) || norm(minus(ax, times(ab, t))) > near) continue;
    found.emplace_back(t, *v);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::int32_t> out;
  for (const auto& [t, w] : found) out.push_back(w);
  return out;
}

} // namespace

std::int64_t split_at_junctions(Surface& surface, double tolerance) {
  TriangleMesh& mesh = surface.mesh;
  std::int64_t split = 0;
  // A pass splits every facet along one edge at most; the others follow in the passes after it.
  bool again = true;
  for (int pass = 0; again && pass < max_passes; ++pass) {
    again = false;
    const EdgeTable edges = make_edge_table(mesh.triangles);
    const std::vector<std::int32_t> vertices = open_vertices(mesh, edges);
    std::vector<bool> done(mesh.triangles.size(), false);
    for (std::size_t e = 0; e < edges.num_edges(); ++e) {
      const auto uses = edges.edge(e);
      if (uses.size() != 1) continue;
      const auto t = static_cast<std::size_t>(uses[0].triangle);
      if (done[t]) continue;
      const std::int32_t a = uses[0].forward ? uses[0].lo : uses[0].hi, b = uses[0].forward ? uses[0].hi : uses[0].lo;
      const Triangle facet = mesh.triangles[t];
      std::vector<std::int32_t> chain = vertices_on(mesh, vertices, facet, a, b, tolerance);
      if (chain.empty()) continue;
      const std::int32_t apex = *std::find_if(facet.begin(), facet.end(), [&](auto v) { return v != a && v != b; });
      chain.insert(chain.begin(), a);
      chain.push_back(b);
      mesh.triangles[t] = {chain[0], chain[1], apex};
      for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
        mesh.triangles.push_back({chain[i], chain[i + 1], apex});
        mesh.region.push_back(mesh.region[t]);
        surface.normals.push_back(surface.normals[t]);
      }
      done[t] = again = true;
      ++split;
    }
  }
  return split;
}

} // namespace iga::prep
