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

/// A basis of all polynomials u(s) of total degree 1 … k with div C ε(u) = 0 and without rigid motions: a local
/// solution of the equations of elasticity by itself. Coordinates s are those of the grid, in spans, about any centre;
/// components of u and ε are in the part's frame. Fields of lower degree come first.
class EquilibratedPolynomials {
 public:
  EquilibratedPolynomials(const SplineGrid& grid, const ElasticMaterial& material, int degree);

  int degree() const { return static_cast<int>(parts_.size()); }
  /// Fields of degree up to k.
  Eigen::Index size(int k) const { return first_[static_cast<std::size_t>(k)]; }
  Eigen::Index size() const { return size(degree()); }

  /// @param s  (n × 3)
  /// @param k  degree up to which fields are wanted
  FieldStrains strains(const Eigen::MatrixX3d& s, int k) const;
  /// Strains (n × 6) of one field of degree 2 and 3 with div C ε = -b.
  Eigen::Matrix<double, Eigen::Dynamic, 6> strains_of_force(const Eigen::MatrixX3d& s, const LinearForce& b) const;

 private:
  using Exponents = std::array<int, 3>;
  /// Of one degree: its monomials, and of each component of the fields their coefficients (monomials × fields).
  struct Part {
    std::vector<Exponents> monomials;
    std::array<Eigen::MatrixXd, 3> fields;
  };
  static std::vector<Exponents> monomials_of(int degree);
  /// (3 monomials of degree - 2 × 3 monomials): div C ε of each monomial and component.
  Eigen::MatrixXd divergence(int degree) const;
  Eigen::MatrixXd linear_strains() const;
  /// Derivatives by x, y, z of monomials: (n × monomials) each.
  std::array<Eigen::MatrixXd, 3> gradients(const Eigen::MatrixX3d& s, const std::vector<Exponents>& monomials) const;
  void add_part(int degree, const Eigen::MatrixXd& fields);

  VoigtMatrix C_;
  Eigen::Matrix3d to_space_; ///< ∂/∂x_b = Σ_d to_space(b, d) ∂/∂s_d
  std::vector<Part> parts_;  ///< degree 1 …
  std::vector<Eigen::Index> first_;
};

} // namespace iga::solve
