#include "preprocessor/surface_union.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace iga::prep {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Index = std::size_t;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Regions = Mesh::Property_map<Mesh::Face_index, std::int32_t>;
constexpr const char* region_key = "f:region";

Regions regions_of(const Mesh& mesh) { return mesh.property_map<Mesh::Face_index, std::int32_t>(region_key).first; }

/// Hands the region of a facet on to the facets that replace it.
struct RegionKeeper : pmp::Corefinement::Default_visitor<Mesh> {
  std::shared_ptr<std::int32_t> current = std::make_shared<std::int32_t>(0);

  void before_subface_creations(face_descriptor old_face, Mesh& mesh) { *current = regions_of(mesh)[old_face]; }
  void after_subface_created(face_descriptor new_face, Mesh& mesh) { regions_of(mesh)[new_face] = *current; }
  void after_face_copy(face_descriptor old_face, const Mesh& from, face_descriptor new_face, Mesh& to) {
    regions_of(to)[new_face] = regions_of(from)[old_face];
  }
};

/// One body as a mesh; false where it does not bound a volume.
bool to_mesh(const TriangleMesh& mesh, const std::vector<std::int32_t>& facets, Mesh& out) {
  std::vector<Kernel::Point_3> points;
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
  Regions regions = out.add_property_map<Mesh::Face_index, std::int32_t>(region_key, 0).first;
  for (Index i = 0; i < facets.size(); ++i)
    regions[Mesh::Face_index(static_cast<Mesh::size_type>(i))] = mesh.region[static_cast<Index>(facets[i])];
  if (!CGAL::is_closed(out)) return false;
  if (!pmp::does_bound_a_volume(out)) pmp::orient_to_bound_a_volume(out);
  return true;
}

void append(Mesh& mesh, Surface& surface) {
  mesh.collect_garbage();
  const auto offset = static_cast<std::int32_t>(surface.mesh.vertices.size());
  for (auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.mesh.vertices.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
  }
  const Regions regions = regions_of(mesh);
  for (auto f : mesh.faces()) {
    Triangle t{};
    Index i = 0;
    for (auto v : mesh.vertices_around_face(mesh.halfedge(f))) t[i++] = offset + static_cast<std::int32_t>(v.idx());
    surface.mesh.triangles.push_back(t);
    surface.mesh.region.push_back(regions[f]);
    surface.normals.push_back({});
  }
}

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
  std::vector<Mesh> results;
  for (Index g = 0; g < n; ++g) {
    std::vector<Index> bodies;
    for (Index s = 0; s < n; ++s)
      if (group[s] == g && owner[s] == s) bodies.push_back(s);
    if (bodies.size() < 2) continue;
    Mesh whole;
    for (Index k = 0; k < bodies.size(); ++k) {
      std::vector<std::int32_t> facets;
      for (Index s = 0; s < n; ++s)
        if (owner[s] == bodies[k]) facets.insert(facets.end(), shells.facets[s].begin(), shells.facets[s].end());
      for (std::int32_t f : facets) keep[static_cast<Index>(f)] = false;
      Mesh body;
      if (!to_mesh(surface.mesh, facets, body)) {
        out.failure = "a body is not a manifold solid";
        return out;
      }
      if (k == 0) {
        whole = std::move(body);
        continue;
      }
      Mesh sum;
      sum.add_property_map<Mesh::Face_index, std::int32_t>(region_key, 0);
      try {
        if (!pmp::corefine_and_compute_union(whole, body, sum,
                                             CGAL::parameters::visitor(RegionKeeper{}).throw_on_self_intersection(true))) {
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
  for (Mesh& mesh : results) append(mesh, surface);
  return out;
}

} // namespace iga::prep
