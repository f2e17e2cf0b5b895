// The trivariate B-spline grid: three knot vectors, its place in space, span and function numbers.
#pragma once

#include "format/model/knot_vector.hpp"
#include "format/model/types.hpp"

#include <array>

namespace iga {

using Rotation = std::array<std::array<double, 3>, 3>; ///< R[row][column]; columns are the grid axes in space
constexpr Rotation identity_rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// A box A … B cut into equal spans, rotated about its centre C = (A + B) / 2: x = C + R (u - C).
/// Numbers of spans and functions run u fastest, then v, then w: number = i + n_u (j + n_v k).
class SplineGrid {
 public:
  SplineGrid() = default;
  /// @throws InputError for an empty box, counts < 1, degrees outside 1 … max_degree, or an R that is no rotation
  SplineGrid(const Point3& A, const Point3& B, const Index3& spans, const std::array<int, 3>& degree,
             const Rotation& R = identity_rotation);

  const Point3& A() const { return A_; }
  const Point3& B() const { return B_; }
  const Rotation& rotation() const { return R_; }
  const KnotVector& knots(int d) const { return knots_[static_cast<std::size_t>(d)]; }
  std::array<int, 3> degree() const { return {knots_[0].degree(), knots_[1].degree(), knots_[2].degree()}; }
  Index3 spans() const { return {knots_[0].num_spans(), knots_[1].num_spans(), knots_[2].num_spans()}; }
  Index3 functions() const { return {knots_[0].num_functions(), knots_[1].num_functions(), knots_[2].num_functions()}; }
  std::int64_t num_spans() const;
  std::int64_t num_functions() const;
  Point3 span_size() const { return h_; } ///< length per direction
  double span_volume() const { return h_[0] * h_[1] * h_[2]; }

  std::int64_t span_number(const Index3& ijk) const { return number(ijk, spans()); }
  Index3 span_index(std::int64_t number) const { return index(number, spans()); }
  std::int64_t function_number(const Index3& ijk) const { return number(ijk, functions()); }
  Index3 function_index(std::int64_t number) const { return index(number, functions()); }
  /// Corners of a span in parameter space.
  Box3 span_box(const Index3& ijk) const;

  /// Position (length) of a parameter, and back.
  Point3 to_position(const Point3& u) const;
  Point3 to_parameter(const Point3& x) const;
  /// A direction in space along the grid's axes: Rᵀ way.
  Point3 along_axes(const Point3& way) const {
    Point3 g{};
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t r = 0; r < 3; ++r) g[d] += R_[r][d] * way[r];
    return g;
  }
  /// Control point of function (i, j, k): the position of its Greville parameters.
  Point3 control_point(const Index3& ijk) const;
  /// ∫ of function (i, j, k) over the whole grid, length³.
  double integral(const Index3& ijk) const;

 private:
  static std::int64_t number(const Index3& i, const Index3& n) { return i[0] + n[0] * (i[1] + n[1] * i[2]); }
  static Index3 index(std::int64_t m, const Index3& n) { return {m % n[0], (m / n[0]) % n[1], m / (n[0] * n[1])}; }

  Point3 A_{}, B_{}, C_{}, h_{};
  Rotation R_ = identity_rotation;
  std::array<KnotVector, 3> knots_;
};

} // namespace iga
