#include "samples/mesh_implicit.hpp"

#include "samples/surface_mesh.hpp"

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/IO/facets_in_complex_2_to_triangle_mesh.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Surface_mesh_default_criteria_3.h>
#include <CGAL/Surface_mesh_default_triangulation_3.h>
#include <CGAL/make_surface_mesh.h>

#include <cmath>

namespace iga::samples {
namespace {

using Triangulation = CGAL::Surface_mesh_default_triangulation_3;
using Traits = Triangulation::Geom_traits;
using Function = std::function<Traits::FT(const Traits::Point_3&)>;

/// Newton along the gradient: x -= f g / |g|². Three steps reach rounding from the mesher's accuracy.
Point3 project(const ImplicitSolid& solid, Point3 x, double step) {
  for (int iteration = 0; iteration < 3; ++iteration) {
    const double value = solid(x);
    Point3 gradient{};
    double square = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      Point3 low = x, high = x;
      low[d] -= step;
      high[d] += step;
      gradient[d] = (solid(high) - solid(low)) / (2 * step);
      square += gradient[d] * gradient[d];
    }
    for (std::size_t d = 0; d < 3; ++d) x[d] -= value * gradient[d] / square;
  }
  return x;
}

} // namespace

TriangleMesh mesh_implicit(const ImplicitSolid& solid, const ImplicitMeshOptions& options) {
  constexpr double bisection_error = 1e-5; // relative to the ball; Newton does the rest
  constexpr double difference_step = 1e-6; // relative to the ball: rounding and truncation balance near eps^(1/3)

  const Function function = [&](const Traits::Point_3& p) { return solid({p.x(), p.y(), p.z()}); };
  const Traits::Point_3 centre(options.inside[0], options.inside[1], options.inside[2]);
  const CGAL::Implicit_surface_3<Traits, Function> surface(
      function, Traits::Sphere_3(centre, options.radius * options.radius), bisection_error);
  const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(options.min_angle, options.max_size,
                                                                      options.max_distance);
  Triangulation triangulation;
  CGAL::Complex_2_in_triangulation_3<Triangulation> complex(triangulation);
  CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag());
  SurfaceMesh mesh;
  CGAL::facets_in_complex_2_to_triangle_mesh(complex, mesh);

  TriangleMesh result = to_triangles(mesh);
  for (Point3& x : result.vertices) x = project(solid, x, difference_step * options.radius);
  orient_outwards(result);
  return result;
}

} // namespace iga::samples
