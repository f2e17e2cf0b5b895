#include "preprocessor/surface/surface_fill.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/utility.h>
#include <algorithm>
#include <cstdlib>

namespace iga::prep {

namespace {

using Index = std::size_t;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Loop = std::vector<std::int32_t>;

/// Simple loops along the edges that lack a facet, in the direction the new facets need.
std::vector<Loop> hole_loops(const TriangleMesh& mesh) {
  std::vector<std::vector<std::int32_t>> next(mesh.vertices.size());
  const EdgeTable edges = make_edge_table(mesh.triangles);
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    const int balance = edge_balance(uses);
    const std::int32_t from = balance > 0 ? uses[0].hi : uses[0].lo, to = balance > 0 ? uses[0].lo : uses[0].hi;
    for (int k = 0; k < std::abs(balance); ++k) next[static_cast<Index>(from)].push_back(to);
  }
  // In every vertex as many edges arrive as leave, so a walk always goes on; where it meets its own path a loop is cut
  // off.
  std::vector<Loop> loops;
  std::vector<std::int64_t> place(mesh.vertices.size(), -1);
  for (Index start = 0; start < next.size(); ++start) {
    while (!next[start].empty()) {
      Loop path{static_cast<std::int32_t>(start)};
      place[start] = 0;
      while (!path.empty()) {
        auto& out = next[static_cast<Index>(path.back())];
        if (out.empty()) { // back at the start with nothing left
          place[static_cast<Index>(path.back())] = -1;
          path.pop_back();
          continue;
        }
        const std::int32_t v = out.back();
        out.pop_back();
        const std::int64_t met = place[static_cast<Index>(v)];
        if (met < 0) {
          place[static_cast<Index>(v)] = static_cast<std::int64_t>(path.size());
          path.push_back(v);
          continue;
        }
        loops.emplace_back(path.begin() + met, path.end());
        for (Index i = static_cast<Index>(met) + 1; i < path.size(); ++i) place[static_cast<Index>(path[i])] = -1;
        path.resize(static_cast<Index>(met) + 1);
      }
    }
  }
  return loops;
}

/// Facets that close a loop, in the loop's direction.
std::vector<Triangle> close_loop(const TriangleMesh& mesh, const Loop& loop, const Point3& centre) {
  std::vector<Kernel::Point_3> points;
  for (std::int32_t v : loop) {
    const Point3 x = minus(mesh.vertices[static_cast<Index>(v)], centre);
    points.emplace_back(x[0], x[1], x[2]);
  }
  std::vector<CGAL::Triple<int, int, int>> patch;
  if (loop.size() > 3) CGAL::Polygon_mesh_processing::triangulate_hole_polyline(points, std::back_inserter(patch));
  std::vector<Triangle> out;
  if (patch.size() + 2 != loop.size()) { // three corners, or no triangulation found: a fan closes any loop
    for (Index i = 1; i + 1 < loop.size(); ++i) out.push_back({loop[0], loop[i], loop[i + 1]});
    return out;
  }
  for (const auto& t : patch) {
    std::array<int, 3> corners{t.first, t.second, t.third};
    std::sort(corners.begin(), corners.end());
    out.push_back({loop[static_cast<Index>(corners[0])], loop[static_cast<Index>(corners[1])],
                   loop[static_cast<Index>(corners[2])]});
  }
  return out;
}

} // namespace

Filling fill_holes(Surface& surface) {
  Filling out;
  TriangleMesh& mesh = surface.mesh;
  const std::vector<Loop> loops = hole_loops(mesh);
  if (loops.empty()) return out;
  const Box3 box = bounding_box(mesh);
  const Point3 centre = plus(box.lower, times(minus(box.upper, box.lower), 0.5));
  const std::string name = "repaired";
  auto region = std::find(mesh.region_names.begin(), mesh.region_names.end(), name);
  const auto number = static_cast<std::int32_t>(region - mesh.region_names.begin());
  if (region == mesh.region_names.end()) mesh.region_names.push_back(name);
  out.where = mesh.vertices[static_cast<Index>(loops.front().front())];
  for (const Loop& loop : loops) {
    if (loop.size() < 3) continue;
    ++out.holes;
    for (const Triangle& t : close_loop(mesh, loop, centre)) {
      mesh.triangles.push_back(t);
      mesh.region.push_back(number);
      surface.normals.push_back({});
      ++out.facets;
      out.area += 0.5 * norm(area_vector(mesh, mesh.triangles.size() - 1));
    }
  }
  return out;
}

} // namespace iga::prep
