// F-bar: against volumetric locking the law sees one volume ratio per cell.
#pragma once

#include <Eigen/Core>
#include <span>

namespace iga::solve {

/// The points of a cell whose law sees F̄ = (θ/J)^(1/3) F, J = det F, θ = ⟨J⟩ the mean of J by volume. The internal
/// forces are those of the virtual work ∫ P̄ : δF̄, so that a law with an energy keeps one, ∫ ψ(F̄), and a symmetric
/// tangent: ∫ P̄ : δF̄ = ∫ P : δF with
///   P = (θ/J)^(1/3) P̄ + (⟨s/θ⟩ - s/J) cof F,   s = P̄ : F̄ / 3.
/// Homogeneous deformation and rotation are exact, for they have θ = J. The idea is that of Simo, Taylor and Pister
/// (1985), for splines of Elguedj, Bazilevs, Calo and Hughes (2008); the mean of a cell is their projection of lowest
/// degree: smooth splines have three unknowns for each of these constraints, as a continuum has.
/// Tensors have component (a, A) at 3 a + A.
class MeanVolume {
 public:
  /// @param H  (points × 9) displacement gradients; weights (points) as positive as volumes are
  void set(std::span<const double> weights, const Eigen::MatrixXd& H);

  /// Is J not positive at a point? Then there is no F̄, and scale() is 1.
  bool crushed() const { return crushed_; }
  double J(Eigen::Index q) const { return J_[q]; }
  double scale(Eigen::Index q) const { return scale_[q]; } ///< F̄ = scale F

  /// P̄ → P.
  void to_stress(Eigen::MatrixXd& P) const;

  /// dP = A : dF + V dθ + cof F ⟨R : dF + c dθ⟩,   dθ = ⟨cof F : dF⟩.
  struct Linear {
    Eigen::MatrixXd V, R; ///< (points × 9)
    double c = 0;         ///< its mean
  };
  /// @param P  (points × 9) P̄
  /// @param A  (points × 81) ∂P̄/∂F̄, component 9 (3 a + A) + 3 b + B, becomes A
  void to_tangent(const Eigen::MatrixXd& P, Eigen::MatrixXd& A, Linear& linear) const;

  const Eigen::MatrixXd& cofactors() const { return cof_; } ///< (points × 9)
  double volume() const { return volume_; }                 ///< undeformed

 private:
  double mean(const Eigen::VectorXd& v) const { return weights_.dot(v) / volume_; }
  Eigen::VectorXd mean_stress(const Eigen::MatrixXd& P) const; ///< s

  Eigen::MatrixXd F_, cof_;
  Eigen::VectorXd weights_, J_, scale_;
  double volume_ = 0, theta_ = 1;
  bool crushed_ = false;
};

} // namespace iga::solve
