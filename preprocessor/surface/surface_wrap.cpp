#include "preprocessor/surface/surface_wrap.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

using Index = std::size_t;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Wrap = CGAL::Surface_mesh<Kernel::Point_3>;
using Facets = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Facets::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

} // namespace

bool has_area(const TriangleMesh& mesh) {
  const auto point = [&](std::int32_t v) {
    const Point3& x = mesh.vertices[static_cast<Index>(v)];
    return Kernel::Point_3(x[0], x[1], x[2]);
  };
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                     [&](const Triangle& t) { return !CGAL::collinear(point(t[0]), point(t[1]), point(t[2])); });
}

TriangleMesh wrap_surface(const TriangleMesh& mesh, double alpha, double offset) {
  const Box3 box = bounding_box(mesh);
  const Point3 centre = plus(box.lower, times(minus(box.upper, box.lower), 0.5));
  // A diagonal between 1 and 2 by a power of two, which rounds nothing: squares and products of very small or large
  // lengths would leave the range of doubles.
  const double scale = std::ldexp(1.0, -std::ilogb(diagonal(box)));
  std::vector<Kernel::Point_3> points;
  for (const Point3& v : mesh.vertices) {
    const Point3 x = times(minus(v, centre), scale);
    points.emplace_back(x[0], x[1], x[2]);
  }
  std::vector<std::array<std::size_t, 3>> faces;
  Facets facets;
  std::vector<Index> number; // mesh facet of each entry; CGAL's tree takes none without area
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    std::array<std::size_t, 3> v{};
    for (Index i = 0; i < 3; ++i) v[i] = static_cast<std::size_t>(mesh.triangles[t][i]);
    const Kernel::Triangle_3 facet(points[v[0]], points[v[1]], points[v[2]]);
    if (facet.is_degenerate()) continue;
    faces.push_back(v);
    facets.push_back(facet);
    number.push_back(t);
  }
  TriangleMesh out;
  out.region_names = mesh.region_names;
  Wrap wrap;
  CGAL::alpha_wrap_3(points, faces, alpha * scale, offset * scale, wrap);

  for (auto v : wrap.vertices()) {
    const auto& p = wrap.point(v);
    out.vertices.push_back(plus(times({p.x(), p.y(), p.z()}, 1 / scale), centre));
  }
  const Tree tree(facets.begin(), facets.end());
  for (auto f : wrap.faces()) {
    Triangle t{};
    Index i = 0;
    for (auto v : wrap.vertices_around_face(wrap.halfedge(f))) t[i++] = static_cast<std::int32_t>(v.idx());
    const auto middle = CGAL::centroid(wrap.point(Wrap::Vertex_index(static_cast<Wrap::size_type>(t[0]))),
                                       wrap.point(Wrap::Vertex_index(static_cast<Wrap::size_type>(t[1]))),
                                       wrap.point(Wrap::Vertex_index(static_cast<Wrap::size_type>(t[2]))));
    const auto nearest = tree.closest_point_and_primitive(middle).second;
    out.triangles.push_back(t);
    out.region.push_back(mesh.region[number[static_cast<Index>(nearest - facets.begin())]]);
  }
  return out;
}

} // namespace iga::prep
