#include "format/model/spline_grid.hpp"

#include "format/model/errors.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga {

namespace {

// A rotation read from a file or a command line carries at least this many correct digits.
constexpr double rotation_tolerance = 1e-9;

void check_rotation(const Rotation& R) {
  double worst = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) {
      double dot = 0;
      for (std::size_t r = 0; r < 3; ++r) dot += R[r][a] * R[r][b];
      worst = std::max(worst, std::abs(dot - (a == b ? 1.0 : 0.0)));
    }
  const double det = R[0][0] * (R[1][1] * R[2][2] - R[1][2] * R[2][1]) -
                     R[0][1] * (R[1][0] * R[2][2] - R[1][2] * R[2][0]) +
                     R[0][2] * (R[1][0] * R[2][1] - R[1][1] * R[2][0]);
  if (!(worst <= rotation_tolerance) || det < 0)
    throw InputError(fmt::format("the grid's rotation is not a right-handed orthonormal matrix (error {:.3g}, "
                                 "determinant {:.6g})",
                                 worst, det));
}

} // namespace

SplineGrid::SplineGrid(const Point3& A, const Point3& B, const Index3& spans, const std::array<int, 3>& degree,
                       const Rotation& R)
    : A_(A), B_(B), R_(R) {
  for (std::size_t d = 0; d < 3; ++d) {
    if (!std::isfinite(A[d]) || !std::isfinite(B[d]) || !(A[d] < B[d]))
      throw InputError(
          fmt::format("the grid's box is empty along {}: from {} to {}; B must lie beyond A", "xyz"[d], A[d], B[d]));
    knots_[d] = KnotVector::uniform(degree[d], A[d], B[d], spans[d]);
    C_[d] = A[d] + 0.5 * (B[d] - A[d]);
    h_[d] = (B[d] - A[d]) / static_cast<double>(spans[d]);
  }
  check_rotation(R);
}

std::int64_t SplineGrid::num_spans() const {
  const auto n = spans();
  return n[0] * n[1] * n[2];
}

std::int64_t SplineGrid::num_functions() const {
  const auto n = functions();
  return n[0] * n[1] * n[2];
}

Box3 SplineGrid::span_box(const Index3& ijk) const {
  Box3 box;
  for (std::size_t d = 0; d < 3; ++d) {
    box.lower[d] = knots_[d].lower(ijk[d]);
    box.upper[d] = knots_[d].upper(ijk[d]);
  }
  return box;
}

Point3 SplineGrid::to_position(const Point3& u) const {
  if (R_ == identity_rotation) return u;
  Point3 x = C_;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t d = 0; d < 3; ++d) x[r] += R_[r][d] * (u[d] - C_[d]);
  return x;
}

Point3 SplineGrid::to_parameter(const Point3& x) const {
  if (R_ == identity_rotation) return x;
  Point3 u = C_;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t r = 0; r < 3; ++r) u[d] += R_[r][d] * (x[r] - C_[r]);
  return u;
}

double SplineGrid::integral(const Index3& ijk) const {
  double product = 1;
  for (std::size_t d = 0; d < 3; ++d) product *= knots(static_cast<int>(d)).integral(ijk[d]);
  return product;
}

Point3 SplineGrid::control_point(const Index3& ijk) const {
  return to_position({knots_[0].greville(ijk[0]), knots_[1].greville(ijk[1]), knots_[2].greville(ijk[2])});
}

} // namespace iga
