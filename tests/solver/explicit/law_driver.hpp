// Leads eight points through deformations, as the kernel does.
#pragma once

#include "solver/explicit/laws/law.hpp"

#include <Eigen/Dense>

#include <array>
#include <functional>
#include <random>

namespace iga::solve {

template <class Law> class LawDriver {
 public:
  explicit LawDriver(Law law_in, double length = 1) : law(std::move(law_in)) {
    in.length = length;
    for (int l = 0; l < 8; ++l) put(in.F, l, Eigen::Matrix3d::Identity());
    law.start(h);
  }

  /// One step of all points to their own F.
  void step(const std::array<Eigen::Matrix3d, 8>& F, double dt = 0) {
    in.F_old = in.F;
    in.dt = dt;
    for (int l = 0; l < 8; ++l) put(in.F, l, F[static_cast<std::size_t>(l)]);
    law.stress(in, h, P_, out);
  }
  /// One step of all points to the same F.
  void step(const Eigen::Matrix3d& F, double dt = 0) {
    std::array<Eigen::Matrix3d, 8> all;
    all.fill(F);
    step(all, dt);
  }
  /// `steps` steps along F(s), s = 0 … 1.
  void path(const std::function<Eigen::Matrix3d(double)>& F, int steps, double dt = 0) {
    for (int i = 1; i <= steps; ++i) step(F(static_cast<double>(i) / steps), dt);
  }
  /// P after a step to F from the state now, which stays.
  Eigen::Matrix3d trial(const Eigen::Matrix3d& F) const {
    LawDriver copy = *this;
    copy.step(F);
    return copy.P();
  }

  Eigen::Matrix3d F(int l = 0) const { return get(in.F, l); }
  Eigen::Matrix3d P(int l = 0) const { return get(P_, l); }
  Eigen::Matrix3d cauchy(int l = 0) const { return P(l) * F(l).transpose() / F(l).determinant(); }

  /// max over directions N of the largest singular value of A_ac = N_b ∂P_ab/∂F_cd N_d, by central differences.
  double acoustic_maximum(double step_size = 1e-6) const {
    double most = 0;
    const Eigen::Matrix3d at = F();
    for (int x = -3; x <= 3; ++x)
      for (int y = -3; y <= 3; ++y)
        for (int z = 0; z <= 3; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const Eigen::Vector3d N = Eigen::Vector3d(x, y, z).normalized();
          Eigen::Matrix3d A;
          for (int c = 0; c < 3; ++c) {
            const Eigen::Matrix3d dF = step_size * Eigen::Vector3d::Unit(c) * N.transpose();
            A.col(c) = (trial(at + dF) - trial(at - dF)) * N / (2 * step_size);
          }
          most = std::max(most, A.eigenvalues().real().maxCoeff());
        }
    return most;
  }

  Law law;
  LawInput in{};
  LawOutput out{};

 private:
  static void put(TensorLanes& t, int lane, const Eigen::Matrix3d& m) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) t(a, b)[lane] = m(a, b);
  }
  static Eigen::Matrix3d get(const TensorLanes& t, int lane) {
    Eigen::Matrix3d m;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) m(a, b) = t(a, b)[lane];
    return m;
  }

  Lanes h[Law::history > 0 ? Law::history : 1]{};
  TensorLanes P_{};
};

inline Eigen::Matrix3d diagonal(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).asDiagonal();
}

inline Eigen::Matrix3d rotation(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Deformations of moderate size: I + numbers in ±size.
class RandomTensors {
 public:
  Eigen::Matrix3d tensor(double size) {
    std::uniform_real_distribution<double> uniform(-size, size);
    return Eigen::Matrix3d::NullaryExpr([&](Eigen::Index) { return uniform(generator_); });
  }
  Eigen::Matrix3d deformation(double size) { return Eigen::Matrix3d::Identity() + tensor(size); }
  Eigen::Matrix3d turn() { return rotation(tensor(1).col(0) + Eigen::Vector3d(1e-3, 0, 0), tensor(3)(0, 0)); }

 private:
  std::mt19937 generator_{7};
};

} // namespace iga::solve
