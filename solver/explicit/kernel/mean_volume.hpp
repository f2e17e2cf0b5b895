// F-bar for explicit steps: against volumetric locking the law sees one volume ratio per cell.
#pragma once

#include "solver/explicit/simd/pack_math.hpp"
#include "solver/explicit/simd/pack_tensor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace iga::solve {

/// Points of eight cells, one per lane, or of one cell, eight at a time. The law sees F̄ = (θ/J)^(1/3) F with J = det F
/// and θ = ⟨J⟩, its mean over the cell by volume; forces are those of the virtual work ∫ P̄ : δF̄ = ∫ P : δF with
///   P = (θ/J)^(1/3) P̄ + (⟨s⟩/θ - s/J) cof F,   s = P̄ : F̄ / 3,
/// so what the law stores is what the forces do. Homogeneous deformation and rotation are exact: they have θ = J.
/// Simo, Taylor and Pister (1985); Elguedj, Bazilevs, Calo and Hughes (2008) for splines.
///
/// A point with J below a quarter of θ keeps the factor 4^(1/3), and its s counts as 0: the law sees its own volume go
/// and resists, for the mean of its cell would not. With θ ≤ 0 the law sees F.
class MeanVolumeLanes {
 public:
  /// @param one_cell  all lanes belong to one cell
  void start(std::size_t blocks, bool one_cell) {
    points_.resize(blocks);
    one_cell_ = one_cell;
    volume_ = theta_ = share_ = Lanes{};
  }

  /// @param weight  of the points of a block: volumes, 0 in lanes that belong to none
  void add(std::size_t block, const Lanes& weight, const TensorLanes& F) {
    Points& p = points_[block];
    p.F = F;
    for (int k = 0; k < num_packs; ++k) {
      const PackTensor f = load(F, k), cof = cofactor(f);
      const Pack J = determinant(f, cof), w = load(weight, k);
      store(p.J, k, J);
      store(theta_, k, load(theta_, k) + w * J);
      store(volume_, k, load(volume_, k) + w);
    }
  }

  void find_means() {
    if (one_cell_) {
      spread(theta_);
      spread(volume_);
    }
    for (std::size_t l = 0; l < 8; ++l) theta_[l] = volume_[l] > 0 ? theta_[l] / volume_[l] : 1;
  }

  /// F̄ of a block, after find_means().
  TensorLanes scaled(std::size_t block) {
    Points& p = points_[block];
    TensorLanes F;
    for (int k = 0; k < num_packs; ++k) {
      const Pack theta = load(theta_, k), J = load(p.J, k);
      const PackMask positive = theta > 0.0;
      const Pack safe = positive ? theta : pack(1.0);
      const Pack ratio = min(safe / max(J, least_share * safe), pack(1 / least_share));
      const Pack scale = positive ? cbrt(ratio) : pack(1.0);
      store(p.scale, k, scale);
      PackTensor f = load(p.F, k);
      for (Pack& component : f.c) component *= scale;
      store(F, k, f);
    }
    return F;
  }
  /// What F is scaled by at one point.
  static double scale(double theta, double J) {
    return theta > 0 ? std::cbrt(theta / std::max(J, least_share * theta)) : 1;
  }
  const Lanes& J(std::size_t block) const { return points_[block].J; }
  const Lanes& scale(std::size_t block) const { return points_[block].scale; }

  /// P̄ of a block for its F̄.
  void take(std::size_t block, const Lanes& weight, const TensorLanes& P) {
    Points& p = points_[block];
    p.P = P;
    for (int k = 0; k < num_packs; ++k) {
      Pack s{};
      for (int i = 0; i < 9; ++i) s += load(P.c[i], k) * load(p.F.c[i], k);
      s *= load(p.scale, k) * (1.0 / 3.0);
      const Pack theta = load(theta_, k);
      s = load(p.J, k) > least_share * theta ? s : pack(0.0);
      s = theta > 0.0 ? s : pack(0.0);
      store(p.s, k, s);
      store(share_, k, load(share_, k) + load(weight, k) * s);
    }
  }

  void find_mean_stress() {
    if (one_cell_) spread(share_);
    for (std::size_t l = 0; l < 8; ++l)
      share_[l] = volume_[l] > 0 && theta_[l] > 0 ? share_[l] / (volume_[l] * theta_[l]) : 0;
  }

  /// P of a block, after find_mean_stress().
  TensorLanes stress(std::size_t block) const {
    const Points& p = points_[block];
    TensorLanes P;
    for (int k = 0; k < num_packs; ++k) {
      const Pack J = load(p.J, k), theta = load(theta_, k), s = load(p.s, k), scale = load(p.scale, k);
      const PackMask whole = (J > least_share * theta) & (theta > 0.0); // s is 0 where it is not
      const Pack pressure = load(share_, k) - s / (whole ? J : pack(1.0));
      const PackTensor cof = cofactor(load(p.F, k));
      for (int i = 0; i < 9; ++i) store(P.c[i], k, scale * load(p.P.c[i], k) + pressure * cof.c[i]);
    }
    return P;
  }

 private:
  static constexpr double least_share = 0.25;

  struct Points {
    TensorLanes F, P; ///< P: P̄
    Lanes J, scale, s;
  };
  static void spread(Lanes& x) {
    double sum = 0;
    for (std::size_t l = 0; l < 8; ++l) sum += x[l];
    x = Lanes{} + sum;
  }

  std::vector<Points> points_;
  bool one_cell_ = false;
  Lanes volume_{}, theta_{}, share_{}; ///< sums, then means: of w, of w J, of w s / θ
};

} // namespace iga::solve
