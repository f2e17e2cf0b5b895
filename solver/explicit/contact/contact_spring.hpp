// The spring of one touch: its potential over the depth, and the energy account that keeps it from giving back more
// than it took.
#pragma once

#include <algorithm>
#include <cmath>

namespace iga::solve {

/// W(e) = k φ(e) over the elastic depth e, with φ'' = 1 up to a third of the limit D: a linear spring. Beyond, with
/// L = 2/3 D, y = e - D/3 and q = L / (L - y),
///   φ = e²/2 + y² (q - 1),  φ' = e + y (q - 1) (q + 2),  φ'' = 1 + 2 (q³ - 1):
/// all three continuous, and φ → ∞ as e → D. From where φ'' reaches `largest_ratio` φ goes on as a parabola: what the
/// time step can bear at the moment.
struct DepthPotential {
  double limit = 0;          ///< D, length
  double largest_ratio = 16; ///< of φ'', at least 1

  static constexpr double linear_share = 1.0 / 3;
  static constexpr double hardest = 16000; ///< ratio that is never passed: 0.95 of the way to the limit

  struct Values {
    double energy = 0, force = 0, stiffness = 1; ///< φ, φ', φ''
  };
  Values at(double e) const {
    if (e <= 0) return {0, 0, 1};
    Values v{0.5 * e * e, e, 1};
    const double L = (1 - linear_share) * limit, y = e - linear_share * limit;
    if (y <= 0 || largest_ratio <= 1) return v;
    const double q_last = std::cbrt(1 + 0.5 * (std::min(largest_ratio, hardest) - 1));
    const double q = y < L * (1 - 1 / q_last) ? L / (L - y) : q_last;
    const double inside = std::min(y, L * (1 - 1 / q)), over = y - inside;
    const double force = inside * (q - 1) * (q + 2), stiffness = 2 * (q * q * q - 1);
    v.energy += inside * inside * (q - 1) + force * over + 0.5 * stiffness * over * over;
    v.force += force + stiffness * over;
    v.stiffness += stiffness;
    return v;
  }
  /// Where the spring begins to stiffen.
  double stiffens_from() const { return linear_share * limit; }
};

/// What a touch's spring holds. Stiffness and potential may change from step to step (area, time step, neighbours in
/// the same budget): energy that a softer spring no longer holds is kept in reserve and given back to a stiffer one,
/// and a spring that would hold more than was put into it is let go until it does not. In sum it gives back no more
/// than it took: in closing and opening it follows potentials, and where it changes from one to another it holds no
/// more.
struct SpringEnergy {
  double elastic = 0;                             ///< e of the last step, length
  double shift = 0;                               ///< depth by which the spring was let go so far, length
  double stored = 0;                              ///< W of the last step
  double reserve = 0;                             ///< energy put in beyond that
  double largest_ratio = DepthPotential::hardest; ///< of the last step's potential

  /// The spring of this step takes over at the elastic depth of the last one.
  void take_over(double k, const DepthPotential& potential) {
    const double held = stored + reserve, wanted = k * potential.at(elastic).energy;
    constexpr double rounding = 1e-12;
    if (wanted <= held * (1 + rounding)) {
      reserve = std::max(0.0, held - wanted);
      return;
    }
    constexpr int halvings = 40;
    double low = elastic * std::sqrt(held / wanted), high = elastic; // W(α e) <= α² W(e) for α < 1
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      (k * potential.at(middle).energy <= held ? low : high) = middle;
    }
    shift += elastic - low;
    elastic = low;
    reserve = std::max(0.0, held - k * potential.at(low).energy);
  }
  /// On to the elastic depth of this step.
  DepthPotential::Values move_to(double e, double k, const DepthPotential& potential) {
    const DepthPotential::Values v = potential.at(e);
    elastic = std::max(e, 0.0);
    stored = k * v.energy;
    largest_ratio = potential.largest_ratio;
    return v;
  }
};

} // namespace iga::solve
