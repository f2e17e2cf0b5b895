// Stress of eight points from their displacement gradients, what the points remember, and what a step has to know of
// them.
#pragma once

#include "format/model/errors.hpp"
#include "format/model/spline_grid.hpp"
#include "solver/explicit/internal_forces.hpp"
#include "solver/explicit/lane_transpose.hpp"
#include "solver/explicit/law.hpp"
#include "solver/explicit/laws/pack.hpp"

#include <cmath>
#include <limits>

namespace iga::solve {

/// What the points keep between steps, in blocks of eight.
struct PointMemory {
  /// @param blocks  of points, all untouched
  template <class Law> PointMemory(const Law& law, const KernelOptions& options, std::size_t blocks);
  PointHistory save() const;
  /// @throws InputError where the sizes differ
  void load(const PointHistory& saved);

  std::vector<Lanes> history; ///< (blocks × Law::history)
  std::vector<Lanes> F_old;   ///< (blocks × 9): for laws in rate form and for erosion; or empty
  std::vector<Lanes> extra;   ///< (blocks × extra_size)
  /// With bulk viscosity first J of the last step; with erosion 1 for points at work and 0 for those taken out, energy
  /// per reference volume, P of the last step (9).
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

template <class Law> class PointStress {
 public:
  /// @param dt      since the last evaluation
  /// @param length  smallest side of a span
  PointStress(const Law& law, const KernelOptions& options, const Rotation& R, double dt, double length, double kappa,
              PointMemory& memory)
      : law_(law), options_(options), R_(R), rotated_(R != identity_rotation), viscous_(options.viscous()),
        erodes_(options.erodes()), kappa_(kappa), memory_(memory), J_(Lanes{} + no_J) {
    in_.dt = dt;
    in_.length = length;
  }

  /// @param weight  of the points, volume; 0 in lanes that do not count
  /// @param H       gradient with respect to the grid's axes; taken over by weight P in the same axes
  [[gnu::always_inline]] void operator()(std::int64_t block, const Lanes& weight, TensorLanes& H) {
    TensorLanes& F = in_.F;
    if (rotated_) {
      for (int a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          F(a, static_cast<int>(b)) = H(a, 0) * R_[b][0] + H(a, 1) * R_[b][1] + H(a, 2) * R_[b][2];
    } else {
      F = H;
    }
    for (int a = 0; a < 3; ++a) F(a, a) += 1.0;
    if (Law::needs_old_F || erodes_) {
      Lanes* old = memory_.F_old.data() + 9 * block;
      for (int k = 0; k < 9; ++k) {
        in_.F_old.c[k] = old[k];
        old[k] = F.c[k];
      }
    }
    TensorLanes P;
    LawOutput out;
    law_.stress(in_, memory_.history.data() + Law::history * block, P, out);
    if (viscous_ || erodes_) {
      Lanes share = weight;
      extras(block, share, P, out);
      finish_point(share, P, out, H);
    } else {
      finish_point(weight, P, out, H);
    }
  }

  /// Ends a unit of work: spans[l] owns lane l.
  void finish(const std::int32_t* spans, PointExtremes& extremes) {
    if (largest(damping_) > 0)
      for (std::size_t l = 0; l < lanes; ++l) {
        const double xi = kappa_ * damping_[l], root = std::sqrt(1 + xi * xi) + xi;
        speed_[l] *= root * root;
      }
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
    speed_ = damping_ = power_ = Lanes{};
    J_ = Lanes{} + no_J;
    inverted_ = LaneMask{};
    has_inverted_ = false;
  }

 private:
  static constexpr double no_J = std::numeric_limits<double>::infinity();

  [[gnu::always_inline]] void finish_point(const Lanes& weight, const TensorLanes& P, const LawOutput& out,
                                           TensorLanes& H) {
    if (rotated_) {
      for (int a = 0; a < 3; ++a)
        for (std::size_t m = 0; m < 3; ++m)
          H(a, static_cast<int>(m)) = (P(a, 0) * R_[0][m] + P(a, 1) * R_[1][m] + P(a, 2) * R_[2][m]) * weight;
    } else {
      for (int k = 0; k < 9; ++k) H.c[k] = P.c[k] * weight;
    }
    bool inverted = false;
    for (int k = 0; k < num_packs; ++k) {
      store(speed_, k, max(pack_of(speed_, k), pack_of(out.wave_speed_squared, k)));
      store(damping_, k, max(pack_of(damping_, k), pack_of(out.damping_ratio, k)));
      store(J_, k, min(pack_of(J_, k), pack_of(out.J, k)));
      PackMask mask;
      std::memcpy(&mask, reinterpret_cast<const char*>(&out.inverted) + k * static_cast<int>(sizeof(mask)),
                  sizeof(mask));
      inverted = inverted || any(mask);
    }
    power_ += weight * out.viscous_power;
    if (inverted) count_inverted(weight, out.inverted);
  }

  static Pack pack_of(const Lanes& x, int k) { return iga::solve::load(x, k); }

  [[gnu::noinline]] void count_inverted(const Lanes& weight, const LaneMask& mask) {
    for (std::size_t l = 0; l < lanes; ++l)
      if (mask[l] != 0 && weight[l] > 0) {
        ++inverted_[l];
        has_inverted_ = true;
      }
  }

  // Bulk viscosity and erosion, lane by lane: rare, and dear only where they are asked for.
  [[gnu::noinline]] void extras(std::int64_t block, Lanes& weight, TensorLanes& P, LawOutput& out) {
    Lanes* extra = memory_.extra.data() + memory_.extra_size * block;
    for (std::size_t l = 0; l < lanes; ++l) {
      if (erodes_) erode(extra + (viscous_ ? 1 : 0), l, weight, P, out);
      if (viscous_) add_bulk_viscosity(extra[0], l, weight[l], P, out);
    }
  }

  void add_bulk_viscosity(Lanes& J_old, std::size_t l, double weight, TensorLanes& P, LawOutput& out) const {
    const double J = out.J[l], last = J_old[l];
    J_old[l] = J;
    if (!(in_.dt > 0 && J < last && J > 0 && weight > 0)) return;
    const double rate = 2 * (J - last) / ((J + last) * in_.dt); // tr D < 0
    const double l_now = in_.length * std::cbrt(J), c = law_.reference_wave_speed();
    const double q = law_.density / J * l_now *
                     (options_.quadratic_viscosity * l_now * rate * rate - options_.linear_viscosity * c * rate);
    const TensorLanes& F = in_.F;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        P(a, b)[l] -= q * (F(a1, b1)[l] * F(a2, b2)[l] - F(a1, b2)[l] * F(a2, b1)[l]);
      }
    out.viscous_power[l] -= q * J * rate;
    out.damping_ratio[l] += options_.linear_viscosity - options_.quadratic_viscosity * l_now * rate / c;
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
    out.wave_speed_squared[l] = out.viscous_power[l] = out.damping_ratio[l] = 0;
    out.J[l] = no_J;
    out.inverted[l] = 0;
  }

  const Law& law_;
  const KernelOptions& options_;
  const Rotation R_;
  const bool rotated_, viscous_, erodes_;
  const double kappa_;
  PointMemory& memory_;
  LawInput in_;
  Lanes speed_{}, damping_{}, power_{}, eroded_energy_{}, J_;
  LaneMask inverted_{};
  bool has_inverted_ = false;
  std::int64_t eroded_ = 0;
};

template <class Law> PointMemory::PointMemory(const Law& law, const KernelOptions& options, std::size_t blocks) {
  history.resize(static_cast<std::size_t>(Law::history) * blocks);
  if constexpr (Law::history > 0)
    for (std::size_t b = 0; b < blocks; ++b) law.start(history.data() + static_cast<std::size_t>(Law::history) * b);
  if (Law::needs_old_F || options.erodes()) {
    F_old.resize(9 * blocks);
    for (std::size_t k = 0; k < F_old.size(); ++k) F_old[k] = Lanes{} + (k % 9 % 4 == 0 ? 1.0 : 0.0);
  }
  extra_size = (options.viscous() ? 1 : 0) + (options.erodes() ? 11 : 0);
  extra.resize(static_cast<std::size_t>(extra_size) * blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    Lanes* of_block = extra.data() + static_cast<std::size_t>(extra_size) * b;
    if (options.viscous()) *of_block++ = Lanes{} + 1.0;
    if (options.erodes()) *of_block = Lanes{} + 1.0;
  }
}

} // namespace iga::solve
