// Polynomial displacements whose stresses are in equilibrium: what stress is recovered with.
#pragma once

#include "format/model/spline_grid.hpp"
#include "solver/mechanics/material.hpp"

#include <array>
#include <vector>

namespace iga::solve {

/// Strains of many fields at n points: one matrix (n × fields) for each of xx yy zz xy yz zx.
using FieldStrains = std::array<Eigen::MatrixXd, 6>;

/// b(s) = constant + slope s, force/length³ in the part's frame.
struct LinearForce {
  Eigen::Vector3d constant = Eigen::Vector3d::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  bool is_zero() const { return constant.isZero() && slope.isZero(); }
};

/// Six polynomials of s, one for each of xx yy zz xy yz zx: factors of EquilibratedPolynomials::monomials (n × 6).
using VoigtPolynomial = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// A basis of all polynomials u(s) of total degree 1 … k with div C ε(u) = 0 and without rigid motions: a local
/// solution of the equations of elasticity by itself. Coordinates s are those of the grid, in spans, about any centre;
/// components of u and ε are in the part's frame. Fields of lower degree come first; the strain of a field of degree k
/// is homogeneous, of degree k - 1.
class EquilibratedPolynomials {
 public:
  EquilibratedPolynomials(const SplineGrid& grid, const ElasticMaterial& material, int degree);

  int degree() const { return static_cast<int>(strains_.size()); }
  /// Fields of degree up to k.
  Eigen::Index size(int k) const { return first_[static_cast<std::size_t>(k)]; }
  Eigen::Index size() const { return size(degree()); }

  /// Monomials of total degree up to k: their number, and their values (n × number) at s (n × 3); of lower degree
  /// first.
  static Eigen::Index num_monomials(int k) { return k < 0 ? 0 : Eigen::Index{(k + 1) * (k + 2) * (k + 3) / 6}; }
  static Eigen::MatrixXd monomials(const Eigen::MatrixX3d& s, int k);

  /// Strains of the fields of degree k alone: factors of the monomials of degree k - 1 (monomials × fields), for each
  /// of xx yy zz xy yz zx.
  const FieldStrains& strains_of_degree(int k) const { return strains_[static_cast<std::size_t>(k - 1)]; }

  /// Strain of a sum of fields, from the first on.
  /// @param factors  (size(k)) for any k
  VoigtPolynomial strain(const Eigen::VectorXd& factors) const;
  /// Strain of one field of degree 2 and 3 with div C ε = -b; monomials of degree up to 2.
  VoigtPolynomial strain_of_force(const LinearForce& b) const;

  /// Strains of all fields of degree up to k at s (n × 3).
  FieldStrains strains(const Eigen::MatrixX3d& s, int k) const;

 private:
  using Exponents = std::array<int, 3>;
  static std::vector<Exponents> monomials_of(int degree);
  /// (3 monomials of degree - 2 × 3 monomials): div C ε of each monomial and component.
  Eigen::MatrixXd divergence(int degree) const;
  Eigen::MatrixXd linear_strains() const;
  /// Strains of fields of one degree, given by factors of monomials and components (3 monomials × fields), row 3 m + a.
  FieldStrains strains_of(int degree, const Eigen::MatrixXd& fields) const;
  void add_part(int degree, const Eigen::MatrixXd& fields);

  VoigtMatrix C_;
  Eigen::Matrix3d to_space_;          ///< ∂/∂x_b = Σ_d to_space(b, d) ∂/∂s_d
  std::vector<FieldStrains> strains_; ///< degree 1 …
  std::vector<Eigen::Index> first_;
};

} // namespace iga::solve
