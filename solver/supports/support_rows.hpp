// Displacement and traction of the shape functions along the directions that a support fixes, as rows of a matrix.
#pragma once

#include "solver/supports/boundary.hpp"

namespace iga::solve {

/// Directions that a support fixes at a surface point, with the displacement prescribed along each.
struct FixedDirections {
  int count = 0;
  std::array<Point3, 3> direction{}; ///< unit, the part's frame
  Point3 prescribed{};               ///< length
};
FixedDirections fixed_directions(const PreparedSupport& prepared, const Point3& normal, const Point3& position);

/// For each fixed direction e of each point, in that order, one row over the unknowns of a span (3 r + a: component a
/// of nodes[r]).
struct SupportRows {
  Eigen::MatrixXd trace;           ///< (m × 3 n): e · u
  Eigen::MatrixXd traction;        ///< (m × 3 n): e · σ(u) n, force/length³
  Eigen::VectorXd initial;         ///< (m): e · (C ε₀) n, which the traction lacks; empty without an initial strain
  Eigen::VectorXd weight;          ///< (m): area, length²
  Eigen::VectorXd prescribed;      ///< (m): length
  std::vector<std::int32_t> point; ///< (m): number of the row's point in its batch
  std::vector<Point3> direction;   ///< (m)
};
enum class RowParts { Trace, Traction, Both };

SupportRows make_rows(const SolutionSpace& space, const ElasticMaterial& material, const PreparedSupport& prepared,
                      const PointBatch& batch, RowParts parts, SpanShapes& shapes);

/// Stress 6-vector → force on a unit area with normal n: t = T(n) σ.
Eigen::Matrix<double, 3, 6> traction_of_stress(const Point3& n);

/// Young's modulus where the material is isotropic; harmonic mean of the three axes' moduli elsewhere. force/length²
double effective_modulus(const ElasticMaterial& material);

/// E / h, on lines E, at points E h: what a penalty factor multiplies. force/length³, /length², /length
double penalty_stiffness(const SolutionSpace& space, const ElasticMaterial& material, Extent extent);

// The three methods; each fills what its support needs. `prepared` holds the supports of that method only.
void penalty_parameters(const SolutionSpace& space, const ElasticMaterial& material,
                        std::span<PreparedSupport* const> prepared);
/// Nitsche's parameter per span: twice the largest eigenvalue of ∫_Γ |t|² against the energy of the span, or of the
/// span and its neighbours where it holds too little material to bound its own traction (README.md, supports).
void nitsche_parameters(const SolutionSpace& space, const ElasticMaterial& material,
                        std::span<PreparedSupport* const> prepared);

/// Constraint rows of one support: C u = values.
struct ConstraintRows {
  std::vector<Eigen::Triplet<double>> entries; ///< row, unknown, value; rows from 0
  std::vector<double> values;
};
ConstraintRows lagrange_rows(const SolutionSpace& space, const ElasticMaterial& material,
                             const PreparedSupport& prepared);

} // namespace iga::solve
