// One oscillator under a load that is linear between two times: its exact state at the second one.
#pragma once

#include <array>

namespace iga::solve {

/// q̈ + c q̇ + ω² q = p(t), p linear over a step h: (q, q̇) after it is A (q, q̇) + B (p at its start, p at its end).
/// Exact for any c ≥ 0, ω ≥ 0, h: below, at and above critical damping, and for free motions.
class OscillatorStep {
 public:
  /// @param lambda ω², 1/time²
  OscillatorStep(double lambda, double c, double h);
  std::array<double, 2> advance(const std::array<double, 2>& state, double p_start, double p_end) const {
    return {A_[0][0] * state[0] + A_[0][1] * state[1] + B_[0][0] * p_start + B_[0][1] * p_end,
            A_[1][0] * state[0] + A_[1][1] * state[1] + B_[1][0] * p_start + B_[1][1] * p_end};
  }

 private:
  void by_closed_form(double lambda, double c, double h);
  void by_exponential(double lambda, double c, double h);

  std::array<std::array<double, 2>, 2> A_{}, B_{};
};

} // namespace iga::solve
