// Linear elastic materials, small strain.
#pragma once

#include "format/model/spline_grid.hpp"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace iga::solve {

/// Strains and stresses as 6-vectors in the order xx yy zz xy yz zx (the frame of the part); shear strains are
/// engineering strains γ = 2 ε.
using Voigt = Eigen::Matrix<double, 6, 1>;
using VoigtMatrix = Eigen::Matrix<double, 6, 6>;

/// Place of the tensor component (a, b) in such a vector.
constexpr int voigt_place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// Strains at some points, row by row in the order of Voigt.
using Strains = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// A strain that a body has without stress: thermal expansion, the tightening of a bolt.
class StrainField {
 public:
  virtual ~StrainField() = default;
  /// At points of a cell of the body's model. Safe to call from several threads.
  /// @param parameters  (n × 3), row-major, knot space
  /// @returns (n × 6)
  virtual Strains at(std::int64_t cell, std::span<const double> parameters) const = 0;
  /// Polynomials of the splines' degree follow it inside a span: no jumps, no kinks.
  virtual bool is_smooth() const { return true; }
};

/// σ = C (ε - ε₀) with a positive definite C.
struct ElasticMaterial {
  VoigtMatrix C = VoigtMatrix::Zero(); ///< force/length², symmetric
  double density = 1;                  ///< mass/length³
  std::optional<double> expansion;     ///< thermal, the same in all directions; 1/temperature
  std::optional<double> conductivity;  ///< of heat; power/(length · temperature)
  /// ε₀ of one static solution (StaticSolution::system); null: none. Whatever makes stresses from strains takes it off;
  /// stiffness, modes and waves do not know it.
  std::shared_ptr<const StrainField> initial_strain;

  /// Largest and smallest speed of a plane wave over a fixed set of directions (length/time): c_L and c_S where the
  /// material is isotropic. Eigenvalues of the acoustic tensor A(n) / ρ.
  double fastest_wave() const;
  double slowest_wave() const;
};

/// @throws InputError unless E > 0, -1 < nu < 0.5 and density > 0, naming what to do
ElasticMaterial isotropic(double E, double nu, double density);
/// @throws InputError unless C is symmetric (1e-9 of its largest entry) and positive definite and density > 0
ElasticMaterial anisotropic(const VoigtMatrix& C, double density);

/// The matrix of 21 entries (upper triangle by rows) or 36 (by rows) of a run file.
VoigtMatrix voigt_matrix(const std::vector<double>& entries);

/// The material of a body that was turned: x → R x.
ElasticMaterial turned(const ElasticMaterial& material, const Rotation& R);

double von_mises(const Voigt& stress);

} // namespace iga::solve
