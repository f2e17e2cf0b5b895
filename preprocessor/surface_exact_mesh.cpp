#include "preprocessor/surface_exact_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <unordered_map>

namespace iga::prep {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Index = std::size_t;
constexpr const char* region_key = "f:region";

} // namespace

ExactRegions regions_of(ExactMesh& mesh) {
  return mesh.add_property_map<ExactMesh::Face_index, std::int32_t>(region_key, 0).first;
}

ExactRegions regions_of(const ExactMesh& mesh) {
  return mesh.property_map<ExactMesh::Face_index, std::int32_t>(region_key).first;
}

bool to_exact_mesh(const TriangleMesh& mesh, std::span<const std::int32_t> facets, ExactMesh& out) {
  std::vector<ExactKernel::Point_3> points;
  std::vector<std::vector<Index>> polygons;
  std::unordered_map<std::int32_t, Index> number;
  for (std::int32_t f : facets) {
    std::vector<Index> polygon;
    for (std::int32_t v : mesh.triangles[static_cast<Index>(f)]) {
      const auto [place, is_new] = number.try_emplace(v, points.size());
      const Point3& x = mesh.vertices[static_cast<Index>(v)];
      if (is_new) points.emplace_back(x[0], x[1], x[2]);
      polygon.push_back(place->second);
    }
    polygons.push_back(std::move(polygon));
  }
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) pmp::orient_polygon_soup(points, polygons);
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) return false;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, out);
  ExactRegions regions = regions_of(out);
  for (Index i = 0; i < facets.size(); ++i)
    regions[ExactMesh::Face_index(static_cast<ExactMesh::size_type>(i))] = mesh.region[static_cast<Index>(facets[i])];
  return CGAL::is_closed(out);
}

void append_exact_mesh(ExactMesh& mesh, Surface& surface) {
  mesh.collect_garbage();
  const auto offset = static_cast<std::int32_t>(surface.mesh.vertices.size());
  for (auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.mesh.vertices.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
  }
  const ExactRegions regions = regions_of(mesh);
  for (auto f : mesh.faces()) {
    Triangle t{};
    Index i = 0;
    for (auto v : mesh.vertices_around_face(mesh.halfedge(f))) t[i++] = offset + static_cast<std::int32_t>(v.idx());
    surface.mesh.triangles.push_back(t);
    surface.mesh.region.push_back(regions[f]);
    surface.normals.push_back({});
  }
}

} // namespace iga::prep
