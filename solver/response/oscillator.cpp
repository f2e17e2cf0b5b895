#include "solver/response/oscillator.hpp"

#include <Eigen/Core>

#include <cmath>

namespace iga::solve {

namespace {

// Free motion after h from q = 1 and from q̇ = 1, damping δ = c / 2.
struct FreeMotion {
  double decay_cos, decay_sin; ///< e^(-δ h) cos(ω_d h), e^(-δ h) sin(ω_d h) / ω_d, or their hyperbolic forms
};

FreeMotion free_motion(double lambda, double delta, double h) {
  const double square = (lambda - delta * delta) * h * h; // (ω_d h)²
  if (std::abs(square) < 1e-4) { // about critical damping: the series of cos and sin / argument
    const double cosine = 1 - square / 2 * (1 - square / 12 * (1 - square / 30));
    const double sine = 1 - square / 6 * (1 - square / 20 * (1 - square / 42));
    return {std::exp(-delta * h) * cosine, std::exp(-delta * h) * sine * h};
  }
  if (square > 0) {
    const double s = std::sqrt(square);
    return {std::exp(-delta * h) * std::cos(s), std::exp(-delta * h) * std::sin(s) / s * h};
  }
  // Two decaying exponentials; the slow one's rate, δ - √(δ² - ω²), without cancellation.
  const double s = std::sqrt(-square), fast = std::exp(-(delta * h + s));
  const double slow = std::exp(-lambda * h * h / (delta * h + s));
  return {(slow + fast) / 2, (slow - fast) / (2 * s) * h};
}

} // namespace

OscillatorStep::OscillatorStep(double lambda, double c, double h) {
  // The particular solution divides by ω²: where a step is short against the period it loses digits.
  if (lambda * h * h > 1)
    by_closed_form(lambda, c, h);
  else
    by_exponential(lambda, c, h);
}

void OscillatorStep::by_closed_form(double lambda, double c, double h) {
  const auto [C, S] = free_motion(lambda, c / 2, h);
  A_ = {{{C + c / 2 * S, S}, {-lambda * S, C - c / 2 * S}}};
  // q_p = (p + p' t) / ω² - c p' / ω⁴ with p' = (p_end - p_start) / h; the rest is free motion.
  for (std::size_t k = 0; k < 2; ++k) {
    const double start = k == 0 ? 1 : 0, slope = (k == 0 ? -1 : 1) / h;
    const double q0 = start / lambda - c * slope / (lambda * lambda), v = slope / lambda;
    const double q1 = q0 + v * h;
    B_[0][k] = q1 - A_[0][0] * q0 - A_[0][1] * v;
    B_[1][k] = v - A_[1][0] * q0 - A_[1][1] * v;
  }
}

// exp of the system of (q, h q̇, h² p, h² (p_end - p_start)) over the unit step, by its series, scaled and squared.
void OscillatorStep::by_exponential(double lambda, double c, double h) {
  Eigen::Matrix4d G = Eigen::Matrix4d::Zero();
  G(0, 1) = 1;
  G(1, 0) = -lambda * h * h;
  G(1, 1) = -c * h;
  G(1, 2) = 1;
  G(2, 3) = 1;
  int halvings = 0;
  for (double size = std::max(1.0, c * h); size > 1; size /= 2) ++halvings;
  G *= std::ldexp(1.0, -halvings);
  Eigen::Matrix4d E = Eigen::Matrix4d::Identity(), term = Eigen::Matrix4d::Identity();
  for (int n = 1; n <= 22; ++n) { // norm at most 2: 2^22 / 22! is below rounding
    term = (term * G / n).eval();
    E += term;
  }
  for (int k = 0; k < halvings; ++k) E = (E * E).eval();
  A_ = {{{E(0, 0), E(0, 1) * h}, {E(1, 0) / h, E(1, 1)}}};
  for (std::size_t row = 0; row < 2; ++row) {
    const double unit = row == 0 ? h * h : h;
    const auto r = static_cast<Eigen::Index>(row);
    B_[row] = {(E(r, 2) - E(r, 3)) * unit, E(r, 3) * unit};
  }
}

} // namespace iga::solve
