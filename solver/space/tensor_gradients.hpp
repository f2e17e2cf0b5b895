// Products of gradients in a span whose points form a tensor product, from univariate sums.
#pragma once

#include "solver/space/solution_space.hpp"

#include <array>

namespace iga::solve {

/// Points of a span as a tensor product of univariate rules, as all rules of interior spans are.
struct TensorPoints {
  std::array<std::vector<double>, 3> position, weight; ///< per direction; the weights' products are the points'
};

/// Fills `tensor` and returns true where the points, u fastest, are such a product: positions to the bit, weights to
/// rounding.
bool as_tensor(const SpanPoints& points, TensorPoints& tensor);

/// Univariate sums Σ w D^α N_a D^β N_b of a span's tensor points, α, β = 0 or 1: all products of gradients follow from
/// them with as many operations as they have entries, whatever the number of points.
class GradientProducts {
 public:
  GradientProducts(const SplineGrid& grid, std::int64_t span, const TensorPoints& tensor);

  /// (p_u + 1)(p_v + 1)(p_w + 1)
  Eigen::Index functions() const { return n_[0] * n_[1] * n_[2]; }
  /// use(i, j, Σ_q w ∇N_i ∇N_jᵀ) for the span's plain functions i >= j; gradients in the part's frame.
  template <class Use> void for_pairs(Use&& use) const {
    for (Eigen::Index b2 = 0; b2 < n_[2]; ++b2)
      for (Eigen::Index b1 = 0; b1 < n_[1]; ++b1)
        for (Eigen::Index a2 = b2; a2 < n_[2]; ++a2)
          for (Eigen::Index a1 = a2 == b2 ? b1 : 0; a1 < n_[1]; ++a1) {
            Eigen::Matrix3d vw;
            for (int k = 0; k < 3; ++k)
              for (int l = 0; l < 3; ++l) vw(k, l) = sum(1, k, l, a1, b1) * sum(2, k, l, a2, b2);
            const bool on_diagonal = a2 == b2 && a1 == b1;
            for (Eigen::Index b0 = 0; b0 < n_[0]; ++b0)
              for (Eigen::Index a0 = on_diagonal ? b0 : 0; a0 < n_[0]; ++a0) {
                Eigen::Matrix3d g;
                for (int k = 0; k < 3; ++k)
                  for (int l = 0; l < 3; ++l) g(k, l) = sum(0, k, l, a0, b0) * vw(k, l);
                if (is_rotated_) g = (R_ * g * R_.transpose()).eval();
                use(a0 + n_[0] * (a1 + n_[1] * a2), b0 + n_[0] * (b1 + n_[1] * b2), g);
              }
          }
  }

 private:
  double sum(int d, int k, int l, Eigen::Index a, Eigen::Index b) const { return sums_[d][k == d][l == d][a][b]; }

  double sums_[3][2][2][max_degree + 1][max_degree + 1] = {};
  Eigen::Index n_[3];
  Eigen::Matrix3d R_;
  bool is_rotated_;
};

} // namespace iga::solve
