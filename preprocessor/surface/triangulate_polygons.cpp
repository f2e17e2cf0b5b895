#include "preprocessor/surface/triangulate_polygons.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/utility.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <vector>

namespace iga::prep {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = std::span<const std::int32_t>;
using Patch = std::vector<std::array<std::size_t, 3>>; ///< positions in the polygon's list of corners

/// CGAL's hole filling is cubic in the corners; up to here it costs nothing that counts.
constexpr std::size_t few_corners = 64;

const Point3& at(const io::PolygonSoup& soup, std::int32_t v) {
  return soup.points[static_cast<std::size_t>(v)];
}

/// Triangles of least dihedral angles and area; also for outlines that are not flat.
Patch fill(const io::PolygonSoup& soup, Corners polygon) {
  std::vector<Kernel::Point_3> outline;
  for (std::int32_t v : polygon) outline.emplace_back(at(soup, v)[0], at(soup, v)[1], at(soup, v)[2]);
  std::vector<CGAL::Triple<int, int, int>> triples;
  CGAL::Polygon_mesh_processing::triangulate_hole_polyline(outline, std::back_inserter(triples));
  Patch patch;
  for (const auto& t : triples)
    patch.push_back(
        {static_cast<std::size_t>(t.first), static_cast<std::size_t>(t.second), static_cast<std::size_t>(t.third)});
  return patch;
}

/// The axis along which a polygon is seen largest (Newell's normal), and whether it is seen turned round.
struct View {
  std::size_t axis = 2;
  bool turned = false;
};
View best_view(const io::PolygonSoup& soup, Corners polygon) {
  Point3 normal{};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point3& a = at(soup, polygon[i]);
    const Point3& b = at(soup, polygon[(i + 1) % polygon.size()]);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
      normal[d] += (a[e] - b[e]) * (a[f] + b[f]);
    }
  }
  View view;
  for (std::size_t d = 0; d < 3; ++d)
    if (std::abs(normal[d]) > std::abs(normal[view.axis])) view.axis = d;
  view.turned = normal[view.axis] < 0;
  return view;
}

/// Constrained Delaunay triangulation of the polygon seen along an axis, n log n. Empty where the outline crosses or
/// touches itself in that view: the number of triangles tells.
Patch triangulate_flat(const io::PolygonSoup& soup, Corners polygon) {
  using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::size_t, Kernel>;
  using Face = CGAL::Constrained_triangulation_face_base_2<Kernel>;
  using Data = CGAL::Triangulation_data_structure_2<Vertex, Face>;
  using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Data, CGAL::No_constraint_intersection_tag>;
  const View view = best_view(soup, polygon);
  const std::size_t e = (view.axis + 1) % 3, f = (view.axis + 2) % 3;
  Triangulation plane;
  std::vector<Triangulation::Vertex_handle> handles;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point3& x = at(soup, polygon[i]);
    const auto hint = handles.empty() ? Triangulation::Face_handle() : handles.back()->face();
    handles.push_back(plane.insert(Kernel::Point_2(x[e], x[f]), hint));
    handles.back()->info() = i;
  }
  if (plane.number_of_vertices() != polygon.size() || plane.dimension() != 2) return {};
  try {
    for (std::size_t i = 0; i < handles.size(); ++i)
      plane.insert_constraint(handles[i], handles[(i + 1) % handles.size()]);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return {};
  }
  // Inside is what an odd number of outline edges separates from the infinite face.
  std::map<Triangulation::Face_handle, bool> inside{{plane.infinite_face(), false}};
  std::vector<Triangulation::Face_handle> open{plane.infinite_face()};
  Patch patch;
  while (!open.empty()) {
    const auto face = open.back();
    open.pop_back();
    const bool in = inside.at(face);
    if (in) patch.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    for (int i = 0; i < 3; ++i) {
      const auto next = face->neighbor(i);
      if (inside.emplace(next, in != face->is_constrained(i)).second) open.push_back(next);
    }
  }
  if (view.turned)
    for (auto& t : patch) std::swap(t[1], t[2]);
  return patch;
}

/// Right in area and moments for any flat outline, even where it is not convex.
Patch fan(std::size_t corners) {
  Patch patch;
  for (std::size_t i = 1; i + 1 < corners; ++i) patch.push_back({0, i, i + 1});
  return patch;
}

Patch patch_of(const io::PolygonSoup& soup, Corners polygon) {
  if (polygon.size() == 3) return {{0, 1, 2}};
  Patch patch = polygon.size() <= few_corners ? fill(soup, polygon) : triangulate_flat(soup, polygon);
  return patch.size() + 2 == polygon.size() ? patch : fan(polygon.size());
}

} // namespace

TriangleMesh triangulate(const io::PolygonSoup& soup) {
  TriangleMesh mesh;
  mesh.region_names = {"surface"};
  mesh.vertices = soup.points;
  for (std::size_t p = 0; p < soup.num_polygons(); ++p) {
    const Corners polygon = Corners(soup.corners).subspan(soup.offsets[p], soup.offsets[p + 1] - soup.offsets[p]);
    for (const auto& t : patch_of(soup, polygon))
      mesh.triangles.push_back({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
  }
  mesh.region.assign(mesh.triangles.size(), 0);
  return mesh;
}

} // namespace iga::prep
