// Does a rule with few points still resist every deformation that the neighbouring spans leave free?
#pragma once

#include "format/model/spline_grid.hpp"
#include "preprocessor/fit/moment_equations.hpp"

#include <Eigen/Cholesky>

namespace iga::prep {

/// Faces of a span beyond which the spline is known to move rigidly: per direction -1 the lower one, +1 the upper one,
/// 0 none.
using HeldFaces = std::array<int, 3>;

/// A spline of degree p and continuity p - 1 that is rigid beyond a face ξ = 0 differs from that rigid motion by
/// ξ^p times polynomials of the other directions: three unknowns times (p + 1) for every direction that is not held.
/// The rule keeps the span's stiffness when it gives all of these fields at least a share of the strain energy that
/// the fitted rule gives them. One object per thread, buffers are kept.
class KeptStiffness {
 public:
  explicit KeptStiffness(const SplineGrid& grid) : degree_(grid.degree()), size_(grid.span_size()) {}

  /// @param box  around the solid's part, in spans relative to the span's lower corner: polynomials are scaled to it
  /// @param rule, fitted  points (n × 3) in spans relative to the span's lower corner, weights in span volumes
  bool keeps(const Box3& box, const HeldFaces& held, const PointSet& rule, const PointSet& fitted);

  static constexpr double share = 0.01; ///< of the energy

 private:
  void add_energy(const Box3& box, const HeldFaces& held, const PointSet& points);

  std::array<int, 3> degree_;
  Point3 size_;
  Eigen::MatrixXd energy_, strains_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

} // namespace iga::prep
