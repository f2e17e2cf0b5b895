// Stress of eight points from their displacement gradients, what the points remember, and what a step has to know of
// them.
#pragma once

#include "format/model/errors.hpp"
#include "format/model/spline_grid.hpp"
#include "solver/explicit/kernel/internal_forces.hpp"
#include "solver/explicit/laws/law_access.hpp"
#include "solver/explicit/simd/lane_transpose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

/// What the points keep between steps, in blocks of eight.
struct PointMemory {
  /// @param blocks  of points, all untouched
  PointMemory(const LawAccess& law, const KernelOptions& options, std::size_t blocks);
  PointHistory save() const;
  /// @throws InputError where the sizes differ
  void load(const PointHistory& saved);

  std::vector<Lanes> history; ///< (blocks × history of the law)
  std::vector<Lanes> F_old;   ///< (blocks × 9): for laws in rate form and for erosion; or empty
  std::vector<Lanes> extra;   ///< (blocks × extra_size)
  /// With erosion: 1 for points at work and 0 for those taken out, energy per reference volume, P of the last step (9).
  int extra_size = 0;
};

/// Extremes and sums over the points of a block of spans.
struct PointExtremes {
  double speed_squared = 0; ///< largest c² (√(1 + ξ²) + ξ)²
  double min_J = std::numeric_limits<double>::infinity();
  double viscous_power = 0, eroded_energy = 0;
  std::int64_t inverted = 0, eroded = 0;
  std::int32_t speed_span = -1, J_span = -1, inverted_span = -1;

  void add(const PointExtremes& other);
};

class PointStress {
 public:
  /// @param dt      since the last evaluation
  /// @param length  smallest side of a span
  PointStress(const LawAccess& law, const KernelOptions& options, const Rotation& R, double dt, double length,
              double kappa, PointMemory& memory)
      : law_(law), options_(options), R_(R), rotated_(R != identity_rotation), erodes_(options.erodes()), kappa_(kappa),
        memory_(memory), J_(Lanes{} + no_J) {
    in_.dt = dt;
    in_.length = length;
  }

  /// @param weight  of the points, volume; 0 in lanes that do not count
  /// @param H       gradient with respect to the grid's axes; taken over by weight P in the same axes
  [[gnu::always_inline]] void operator()(std::int64_t block, const Wide& weight, TensorWide& H) {
    to_deformation(H);
    TensorLanes P;
    for (int k = 0; k < 9; ++k) store(in_.F.c[k], H.c[k]);
    evaluate(block, weight, P, nullptr, nullptr);
    to_grid_axes(weight, P, H);
  }

  /// H with respect to the grid's axes becomes F with respect to the part's.
  [[gnu::always_inline]] void to_deformation(TensorWide& H) const {
    if (rotated_)
      for (int a = 0; a < 3; ++a) {
        const Wide h[3] = {H(a, 0), H(a, 1), H(a, 2)};
        for (std::size_t b = 0; b < 3; ++b)
          H(a, static_cast<int>(b)) = h[0] * R_[b][0] + h[1] * R_[b][1] + h[2] * R_[b][2];
      }
    for (int a = 0; a < 3; ++a) H(a, a) = H(a, a) + 1.0;
  }

  /// Stress at F̄ = scale F of a block of points whose own volume ratio is J.
  void evaluate_scaled(std::int64_t block, const Wide& weight, const TensorLanes& F, const Lanes& scale, const Lanes& J,
                       TensorLanes& P) {
    in_.F = F;
    evaluate(block, weight, P, &scale, &J);
  }

  /// P times weight in the grid's axes.
  [[gnu::always_inline]] void to_grid_axes(const Wide& weight, const TensorLanes& P, TensorWide& H) const {
    for (int a = 0; a < 3; ++a) {
      const Wide p[3] = {wide(P(a, 0)) * weight, wide(P(a, 1)) * weight, wide(P(a, 2)) * weight};
      for (std::size_t m = 0; m < 3; ++m)
        H(a, static_cast<int>(m)) = rotated_ ? p[0] * R_[0][m] + p[1] * R_[1][m] + p[2] * R_[2][m] : p[m];
    }
  }

  /// Ends a unit of work: spans[l] owns lane l.
  void finish(const std::int32_t* spans, PointExtremes& extremes) {
    if (largest(damping_) > 0)
      for (std::size_t l = 0; l < lanes; ++l) {
        const double xi = kappa_ * damping_[l], root = std::sqrt(1 + xi * xi) + xi;
        speed_[l] *= root * root;
      }
    if (largest(compression_) > 0) limit_compression();
    if (largest(speed_) > extremes.speed_squared)
      for (std::size_t l = 0; l < lanes; ++l)
        if (speed_[l] > extremes.speed_squared) {
          extremes.speed_squared = speed_[l];
          extremes.speed_span = spans[l];
        }
    if (smallest(J_) < extremes.min_J)
      for (std::size_t l = 0; l < lanes; ++l)
        if (J_[l] < extremes.min_J) {
          extremes.min_J = J_[l];
          extremes.J_span = spans[l];
        }
    if (has_inverted_)
      for (std::size_t l = 0; l < lanes; ++l) {
        if (inverted_[l] > 0 && extremes.inverted_span < 0) extremes.inverted_span = spans[l];
        extremes.inverted += inverted_[l];
      }
    extremes.viscous_power += sum(power_);
    if (erodes_) {
      extremes.eroded_energy += sum(eroded_energy_);
      extremes.eroded += eroded_;
      eroded_energy_ = Lanes{};
      eroded_ = 0;
    }
    speed_ = damping_ = power_ = compression_ = Lanes{};
    J_ = Lanes{} + no_J;
    inverted_ = LaneMask{};
    has_inverted_ = false;
  }

 private:
  static constexpr double no_J = std::numeric_limits<double>::infinity();

  // Stress at in_.F, zero where points are taken out, and what the step has to know of it.
  [[gnu::always_inline]] void evaluate(std::int64_t block, const Wide& weight, TensorLanes& P, const Lanes* scale,
                                       const Lanes* J) {
    if (law_.needs_old_F || erodes_) {
      Lanes* old = memory_.F_old.data() + 9 * block;
      for (int k = 0; k < 9; ++k) {
        const Wide now = wide(in_.F.c[k]);
        store(in_.F_old.c[k], wide(old[k]));
        store(old[k], now);
      }
    }
    LawOutput out;
    law_.stress(law_.law.get(), in_, memory_.history.data() + law_.history * block, P, out);
    if (scale != nullptr) {
      out.J = *J;
      for (std::size_t l = 0; l < lanes; ++l) out.wave_speed_squared[l] *= std::max(1.0, (*scale)[l] * (*scale)[l]);
    }
    if (erodes_) {
      Lanes share;
      store(share, weight);
      erode(block, share, P, out);
      count(wide(share), out);
    } else {
      count(weight, out);
    }
  }

  [[gnu::always_inline]] void count(const Wide& weight, const LawOutput& out) {
    store(speed_, max(wide(speed_), wide(out.wave_speed_squared)));
    store(damping_, max(wide(damping_), wide(out.damping_ratio)));
    store(compression_, max(wide(compression_), wide(out.compression)));
    store(J_, min(wide(J_), wide(out.J)));
    store(power_, wide(power_) + weight * wide(out.viscous_power));
    if (any_lane(out.inverted)) {
      Lanes counted;
      store(counted, weight);
      count_inverted(counted, out.inverted);
    }
  }

  // The step in which a crushed point would lose `largest_loss` of the volume it has left, as the speed of a wave that
  // asks for this step: dt = length / (κ c).
  [[gnu::noinline]] void limit_compression() {
    constexpr double largest_loss = 0.25;
    if (in_.dt <= 0) return;
    const double per_share = in_.length / (kappa_ * largest_loss * in_.dt);
    for (std::size_t l = 0; l < lanes; ++l) {
      const double c = compression_[l] * per_share;
      speed_[l] = std::max(speed_[l], c * c);
    }
  }

  [[gnu::noinline]] void count_inverted(const Lanes& weight, const LaneMask& mask) {
    for (std::size_t l = 0; l < lanes; ++l)
      if (mask[l] != 0 && weight[l] > 0) {
        ++inverted_[l];
        has_inverted_ = true;
      }
  }

  // Takes points out, lane by lane: dear only where it is asked for.
  [[gnu::noinline]] void erode(std::int64_t block, Lanes& weight, TensorLanes& P, LawOutput& out) {
    for (std::size_t l = 0; l < lanes; ++l) erode(memory_.extra.data() + memory_.extra_size * block, l, weight, P, out);
  }

  void erode(Lanes* extra, std::size_t l, Lanes& weight, TensorLanes& P, LawOutput& out) {
    Lanes &alive = extra[0], &energy = extra[1];
    if (alive[l] > 0) {
      for (int k = 0; k < 9; ++k)
        energy[l] += 0.5 * (P.c[k][l] + extra[2 + k][l]) * (in_.F.c[k][l] - in_.F_old.c[k][l]);
      energy[l] -= out.viscous_power[l] * in_.dt;
      for (int k = 0; k < 9; ++k) extra[2 + k][l] = P.c[k][l];
      const bool dies = (options_.erode_inverted && out.inverted[l] != 0) || out.J[l] < options_.erosion_J;
      if (!dies) return;
      alive[l] = 0;
      if (weight[l] > 0) {
        ++eroded_;
        eroded_energy_[l] += weight[l] * energy[l];
      }
    }
    weight[l] = 0;
    for (int k = 0; k < 9; ++k) P.c[k][l] = 0;
    out.wave_speed_squared[l] = out.viscous_power[l] = out.damping_ratio[l] = out.compression[l] = 0;
    out.J[l] = no_J;
    out.inverted[l] = 0;
  }

  const LawAccess& law_;
  const KernelOptions& options_;
  const Rotation R_;
  const bool rotated_, erodes_;
  const double kappa_;
  PointMemory& memory_;
  LawInput in_;
  Lanes speed_{}, damping_{}, power_{}, compression_{}, eroded_energy_{}, J_;
  LaneMask inverted_{};
  bool has_inverted_ = false;
  std::int64_t eroded_ = 0;
};

} // namespace iga::solve
