#pragma once
#include "solver/explicit/law.hpp"
#include <cmath>
namespace iga::test {
struct NeoHooke {
  static constexpr int history = 0;
  static constexpr bool needs_old_F = false;
  double density = 1, lambda = 1, mu = 1;
  double reference_wave_speed() const { return std::sqrt((lambda + 2 * mu) / density); }
  void start(Lanes*) const {}
  [[gnu::always_inline]] void stress(const solve::LawInput& in, Lanes*, solve::TensorLanes& P,
                                     solve::LawOutput& out) const {
    const auto& F = in.F;
    solve::TensorLanes G; // cofactor
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        G(a, b) = F(a1, b1) * F(a2, b2) - F(a1, b2) * F(a2, b1);
      }
    const Lanes J = F(0, 0) * G(0, 0) + F(0, 1) * G(0, 1) + F(0, 2) * G(0, 2);
    const Lanes inv = 1 / J;
    // ln J by the artanh series, good near 1 for tests
    const Lanes z = (J - 1) / (J + 1), z2 = z * z;
    Lanes s = Lanes{} + 1.0 / 27;
    for (int k = 25; k >= 1; k -= 2) s = s * z2 + 1.0 / k;
    const Lanes ln = 2 * z * s;
    const Lanes c = (lambda * ln - mu) * inv;
    for (int k = 0; k < 9; ++k) P.c[k] = mu * F.c[k] + c * G.c[k];
    out.J = J;
    out.inverted = J < 0.05;
    out.viscous_power = Lanes{};
    out.damping_ratio = Lanes{};
    Lanes g = Lanes{};
    for (int k = 0; k < 9; ++k) g += G.c[k] * G.c[k];
    out.wave_speed_squared = (mu + (lambda + mu - lambda * ln) * g * inv * inv) / density;
  }
};
struct Linear {
  static constexpr int history = 0;
  static constexpr bool needs_old_F = false;
  double density = 1, lambda = 1, mu = 1;
  double reference_wave_speed() const { return std::sqrt((lambda + 2 * mu) / density); }
  void start(Lanes*) const {}
  [[gnu::always_inline]] void stress(const solve::LawInput& in, Lanes*, solve::TensorLanes& P,
                                     solve::LawOutput& out) const {
    const auto& F = in.F;
    const Lanes tr = lambda * (F.c[0] + F.c[4] + F.c[8] - 3.0);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) P(a, b) = mu * (F(a, b) + F(b, a));
    for (int a = 0; a < 3; ++a) P(a, a) += tr - 2 * mu;
    out.viscous_power = out.damping_ratio = Lanes{};
    out.inverted = solve::LaneMask{};
    out.J = 1 + (F.c[0] + F.c[4] + F.c[8] - 3.0);
    out.wave_speed_squared = Lanes{} + (lambda + 2 * mu) / density;
  }
};
} // namespace iga::test
