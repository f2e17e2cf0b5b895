#include "solver/space/placement.hpp"

#include "format/model/vec3.hpp"

#include <Eigen/Geometry>

namespace iga::solve {

namespace {

Point3 product(const Rotation& R, const Point3& x) {
  return {dot(R[0], x), dot(R[1], x), dot(R[2], x)};
}

Rotation product(const Rotation& R, const Rotation& S) {
  Rotation RS{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c) RS[a][b] += R[a][c] * S[c][b];
  return RS;
}

// Rows of three numbers.
template <class Map> void each_row(std::vector<double>& rows, Map map) {
  for (std::size_t k = 0; k + 2 < rows.size(); k += 3) {
    const Point3 x = map({rows[k], rows[k + 1], rows[k + 2]});
    for (std::size_t d = 0; d < 3; ++d) rows[k + d] = x[d];
  }
}

} // namespace

Point3 Placement::turned(const Point3& direction) const {
  return product(R, direction);
}

Point3 Placement::moved(const Point3& x) const {
  return plus(plus(about, turned(minus(x, about))), shift);
}

Rotation rotation_about(const Point3& axis, double angle) {
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(angle, Eigen::Vector3d(axis[0], axis[1], axis[2])).toRotationMatrix();
  Rotation R{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) R[a][b] = Q(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  return R;
}

TrimmedModel placed(TrimmedModel model, const Placement& placement) {
  const SplineGrid grid = model.grid;
  // The grid turns about the centre of its own box, which is moved; parameters are places in that box.
  const Point3 centre = times(plus(grid.A(), grid.B()), 0.5);
  const Point3 way = minus(placement.moved(centre), centre);
  model.grid = SplineGrid(plus(grid.A(), way), plus(grid.B(), way), grid.spans(), grid.degree(),
                          product(placement.R, grid.rotation()));
  const auto shifted = [&](const Point3& u) { return plus(u, way); };
  each_row(model.points.parameters, shifted);
  each_row(model.unknowns.parameters, shifted);
  each_row(model.surface.vertex_parameters, shifted);
  each_row(model.surface.quadrature.parameters, shifted);
  each_row(model.surface.quadrature.normals, [&](const Point3& n) { return placement.turned(n); });
  for (std::vector<Point3>* points : {&model.surface.mesh.vertices, &model.curves.points, &model.markers.positions})
    for (Point3& x : *points) x = placement.moved(x);
  return model;
}

} // namespace iga::solve
