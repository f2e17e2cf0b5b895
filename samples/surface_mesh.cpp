#include "samples/surface_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>

#include <stdexcept>
#include <utility>

namespace iga::samples {

TriangleMesh to_triangles(const SurfaceMesh& mesh) {
  TriangleMesh result;
  std::vector<std::int32_t> number(mesh.num_vertices() + mesh.number_of_removed_vertices());
  for (const auto v : mesh.vertices()) {
    number[v] = static_cast<std::int32_t>(result.vertices.size());
    const auto& p = mesh.point(v);
    result.vertices.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : mesh.faces()) {
    Triangle triangle{};
    std::size_t corner = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) triangle.at(corner++) = number[v];
    result.triangles.push_back(triangle);
  }
  result.region.assign(result.triangles.size(), 0);
  result.region_names = {"surface"};
  return result;
}

SurfaceMesh to_surface_mesh(const TriangleMesh& mesh) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  std::vector<Kernel::Point_3> points;
  for (const Point3& x : mesh.vertices) points.emplace_back(x[0], x[1], x[2]);
  std::vector<std::vector<std::size_t>> polygons;
  for (const Triangle& t : mesh.triangles)
    polygons.push_back(
        {static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2])});
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons))
    throw std::runtime_error("the triangles are no oriented manifold surface");
  SurfaceMesh result;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, result);
  return result;
}

void orient_outwards(TriangleMesh& mesh) {
  if (volume_moments(mesh).volume >= 0) return;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

} // namespace iga::samples
