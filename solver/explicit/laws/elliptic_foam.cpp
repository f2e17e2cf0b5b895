#include "solver/explicit/laws/elliptic_foam.hpp"

#include "format/model/errors.hpp"
#include "solver/explicit/laws/j2_plasticity.hpp"
#include "solver/explicit/laws/stress_rate.hpp"
#include "solver/explicit/simd/pack_math.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double newton_tolerance = 1e-14; // of the equivalent stress
constexpr int newton_limit = 60;           // bisection alone would end by then

void evaluate(const Curve& curve, const Pack& strain, Pack& stress, Pack& slope) {
  const Curve::Piece piece = curve.piece_at(strain);
  stress = piece.value(strain);
  slope = piece.slope;
}

void evaluate(const DensificationHardening& hardening, const Pack& strain, Pack& stress, Pack& slope) {
  hardening.evaluate(strain, stress, slope);
}

void check(const Curve& curve) {
  check_hardening(curve, "material: hardening");
}

void check(const DensificationHardening& h) {
  if (!(h.plateau > 0) || !(h.power > 0) || !(h.densification_strain > 0) || !(h.linear >= 0) || !(h.log >= 0))
    throw InputError(fmt::format("material: hardening with plateau {}, linear {}, log {}, power {} and densification "
                                 "strain {}; linear and log have to be ≥ 0, the others positive",
                                 h.plateau, h.linear, h.log, h.power, h.densification_strain));
}

} // namespace

void DensificationHardening::evaluate(const Pack& strain, Pack& stress, Pack& slope) const {
  constexpr double last = 0.999, least = 1e-30;
  const Pack z = strain * (1 / densification_strain), inside = min(max(z, least), last);
  const Pack below = pow(inside, power - 1), rest = 1.0 - below * inside;
  slope = (linear + log * power * below / rest) * (1 / densification_strain);
  stress = plateau + linear * inside - log * iga::solve::log(rest) + slope * densification_strain * (z - inside);
}

EllipticFoam::EllipticFoam(const EllipticFoamSettings& s)
    : density(s.density), elastic_(isotropic(s.E, s.nu, s.density)), lambda_(elastic_.C(0, 1)), mu_(elastic_.C(3, 3)),
      alpha_squared_(4.5 * (1 - 2 * s.plastic_nu) / (1 + s.plastic_nu)), yield_(s.yield), inversion_(s.inversion) {
  if (!(s.plastic_nu > -1 && s.plastic_nu < 0.5))
    throw InputError(
        fmt::format("material: plastic_nu = {} does not lie between -1 and 0.5; foams have about 0", s.plastic_nu));
  std::visit([](const auto& yield) { check(yield); }, yield_);
}

void EllipticFoam::start(Lanes* h) const {
  for (int i = 0; i < history; ++i) h[i] = Lanes{};
}

double EllipticFoam::reference_wave_speed() const {
  return std::sqrt(elastic_.C(0, 0) / density);
}

void EllipticFoam::stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const {
  std::visit([&](const auto& yield) { stress_with(yield, in, h, P, out); }, yield_);
}

template <class Yield>
void EllipticFoam::stress_with(const Yield& yield, const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const {
  const double modulus = elastic_.C(0, 0), J_min = inversion_.smallest_J;
  const double a = 3 * mu_, b = (lambda_ + 2 * mu_ / 3) * alpha_squared_, kappa = 1 + alpha_squared_ / 9;
  for (int k = 0; k < num_packs; ++k) {
    auto [geometry, step, sigma] =
        RateTrial(load(in.F, k), load(in.F_old, k), load_symmetric(h, k), lambda_, mu_, J_min);

    const Pack strain = load(h[6], k), mean = (1.0 / 3.0) * trace(sigma);
    const Pack shear = (3 / kappa) * deviator_invariant(sigma), volume = (alpha_squared_ / kappa) * mean * mean;
    const Pack trial = sqrt(shear + volume);
    Pack strength, slope;
    evaluate(yield, strain, strength, slope);
    const PackMask yields = (trial > strength) & ~step.inverted;
    if (any(yields)) {
      // With x = Δε^ / (κ σ^): q = q* / (1 + 3μ x), p = p* / (1 + K α² x), Δε^ = κ x σ^(x); the residual
      // σ^(x) - σ_y(ε^ + Δε^) falls. Newton inside a bracket.
      Pack x{}, low{}, high = max(trial / strength - 1.0, 0.0) * (1 / std::min(a, b)), increment{};
      for (int i = 0; i < newton_limit; ++i) {
        const Pack from_shear = 1.0 / (1.0 + a * x), from_volume = 1.0 / (1.0 + b * x);
        const Pack shear_now = shear * from_shear * from_shear, volume_now = volume * from_volume * from_volume;
        const Pack now = sqrt(shear_now + volume_now);
        const Pack now_slope = -(a * shear_now * from_shear + b * volume_now * from_volume) / now;
        increment = kappa * x * now;
        evaluate(yield, strain + increment, strength, slope);
        const Pack residual = yields ? now - strength : Pack{};
        if (!any(max(residual, -residual) > newton_tolerance * strength)) break;
        low = residual > 0.0 ? x : low;
        high = residual < 0.0 ? x : high;
        const Pack next = x - residual / (now_slope - slope * kappa * (now + x * now_slope));
        const PackMask outside = ~((next >= low) & (next <= high));
        x = outside ? 0.5 * (low + high) : next;
      }
      const Pack keep = yields ? 1.0 / (1.0 + a * x) : pack(1), keep_mean = yields ? 1.0 / (1.0 + b * x) : pack(1);
      for (int i = 0; i < 6; ++i) sigma.c[i] *= keep;
      for (int i = 0; i < 3; ++i) sigma.c[i] += (keep_mean - keep) * mean;
      store(h[6], k, strain + (yields ? increment : Pack{}));
    }
    store_symmetric(h, k, sigma);
    PackOutput o;
    PackTensor stress = finish_rate_law(geometry, step, sigma, pack(modulus), modulus, density, J_min, o);
    store(inversion_, modulus / density, stress, o, k, P, out);
  }
}

} // namespace iga::solve
