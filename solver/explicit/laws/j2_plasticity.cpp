#include "solver/explicit/laws/j2_plasticity.hpp"

#include "format/model/errors.hpp"
#include "solver/explicit/laws/stress_rate.hpp"
#include "solver/explicit/simd/pack_math.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// Newton's method runs until no lane moves by more than this share of its value; it converges monotonically and
// quadratically, so that the step after is below round-off.
constexpr double newton_tolerance = 1e-10;
constexpr int newton_limit = 40;

} // namespace

double RateFactor::value(double plastic_rate) const {
  if (kind == Kind::CowperSymonds) return 1 + std::pow(plastic_rate / rate, 1 / exponent);
  if (kind == Kind::JohnsonCook) return 1 + exponent * std::log(std::max(1.0, plastic_rate / rate));
  return 1;
}

void check_hardening(const Curve& yield, const std::string& name) {
  if (yield.x()[0] != 0)
    throw InputError(fmt::format("{}: the yield stress starts at a plastic strain of {:.6g}; its first point has to be "
                                 "that of plastic strain 0",
                                 name, yield.x()[0]));
  for (std::size_t k = 0; k < yield.size(); ++k) {
    if (!(yield.y()[k] > 0))
      throw InputError(
          fmt::format("{}: found the yield stress {:.6g} at plastic strain {:.6g}, expected a positive one", name,
                      yield.y()[k], yield.x()[k]));
    if (yield.slope(yield.x()[k]) < 0)
      throw InputError(fmt::format("{}: the yield stress falls beyond plastic strain {:.6g}; softening makes results "
                                   "depend on the span size: give a curve that never falls",
                                   name, yield.x()[k]));
  }
}

J2Plasticity::J2Plasticity(const J2Settings& s)
    : density(s.density), elastic_(isotropic(s.E, s.nu, s.density)), lambda_(elastic_.C(0, 1)), mu_(elastic_.C(3, 3)),
      yield_(s.yield), rate_(s.rate), inversion_(s.inversion) {
  check_hardening(yield_, "material: hardening");
  if (rate_.kind != RateFactor::Kind::None &&
      (!(rate_.rate > 0) || !(rate_.exponent > 0) || !std::isfinite(rate_.rate) || !std::isfinite(rate_.exponent)))
    throw InputError(
        fmt::format("material: rate factor with the reference rate {} and the exponent {}; both have to be "
                    "positive",
                    rate_.rate, rate_.exponent));
}

void J2Plasticity::start(Lanes* h) const {
  for (int i = 0; i < history; ++i) h[i] = Lanes{};
}

double J2Plasticity::reference_wave_speed() const {
  return std::sqrt(elastic_.C(0, 0) / density);
}

// Solves q - 3 μ Δ = R(Δ / dt) Y(ε + Δ) where q > Y(ε); the left side falls, the right side never does.
Pack J2Plasticity::plastic_increment(const Pack& q, const Pack& strain, double dt) const {
  const double three_mu = 3 * mu_;
  const Curve::Piece piece = yield_.last_piece(
      [&](double x, double y) -> PackMask { return q - three_mu * (x - strain) >= y; }); // Δ ends in this piece
  const Pack without_rate = max((q - piece.value(strain)) / (three_mu + piece.slope), 0.0);
  if (!(dt > 0)) return without_rate;
  if (rate_.kind == RateFactor::Kind::CowperSymonds) return cowper_symonds(q, strain, dt);
  if (rate_.kind == RateFactor::Kind::JohnsonCook) return johnson_cook(q, strain, without_rate, dt);
  return without_rate;
}

// In y = (Δ / (dt D))^{1/n} the residual is concave and falls: Newton from the right comes down to the root.
Pack J2Plasticity::cowper_symonds(const Pack& q, const Pack& strain, double dt) const {
  const double n = rate_.exponent, unit = dt * rate_.rate, three_mu = 3 * mu_;
  constexpr double least = 1e-30; // keeps logarithms of zero out where a lane does not yield
  const Pack now = yield_.piece_at(strain).value(strain);
  const Pack excess = max(q - now, 0.0);
  const Pack limit = min(excess / now, pow(excess / (three_mu * unit) + least, 1 / n));
  Pack y = limit;
  for (int i = 0; i < newton_limit; ++i) {
    const Pack power = pow(y + least, n - 1), delta = unit * power * y, rise = n * unit * power;
    const Curve::Piece piece = yield_.piece_at(strain + delta);
    const Pack stress = piece.value(strain + delta);
    const Pack residual = q - three_mu * delta - (1.0 + y) * stress;
    const Pack slope = three_mu * rise + stress + (1.0 + y) * piece.slope * rise;
    const Pack next = min(max(y + residual / slope, 0.0), limit);
    const Pack step = next - y;
    y = next;
    if (!any(max(step, -step) > newton_tolerance * y)) break;
  }
  return unit * pow(y + least, n);
}

// Above the reference rate the residual is convex and falls: Newton from the left climbs up to the root.
Pack J2Plasticity::johnson_cook(const Pack& q, const Pack& strain, const Pack& without_rate, double dt) const {
  const double unit = dt * rate_.rate, three_mu = 3 * mu_;
  const PackMask fast = without_rate > unit;
  if (!any(fast)) return without_rate;
  Pack delta = pack(unit);
  for (int i = 0; i < newton_limit; ++i) {
    const Curve::Piece piece = yield_.piece_at(strain + delta);
    const Pack stress = piece.value(strain + delta), factor = 1.0 + rate_.exponent * log(delta * (1 / unit));
    const Pack residual = q - three_mu * delta - factor * stress;
    const Pack slope = three_mu + factor * piece.slope + rate_.exponent * stress / delta;
    const Pack next = min(max(delta + residual / slope, unit), max(without_rate, unit));
    const Pack step = fast ? next - delta : Pack{};
    delta = next;
    if (!any(max(step, -step) > newton_tolerance * delta)) break;
  }
  return fast ? delta : without_rate;
}

void J2Plasticity::stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const {
  const double modulus = elastic_.C(0, 0), J_min = inversion_.smallest_J;
  for (int k = 0; k < num_packs; ++k) {
    auto [geometry, step, sigma] =
        RateTrial(load(in.F, k), load(in.F_old, k), load_symmetric(h, k), lambda_, mu_, J_min);

    const Pack strain = load(h[6], k), q = sqrt(3.0 * deviator_invariant(sigma));
    const PackMask yields = (q > yield_.piece_at(strain).value(strain)) & ~step.inverted;
    if (any(yields)) {
      const Pack increment = yields ? plastic_increment(q, strain, in.dt) : Pack{};
      const Pack factor = yields ? 1.0 - 3 * mu_ * increment / q : pack(1), mean = (1.0 / 3.0) * trace(sigma);
      for (int i = 0; i < 6; ++i) sigma.c[i] *= factor;
      for (int i = 0; i < 3; ++i) sigma.c[i] += (1.0 - factor) * mean;
      store(h[6], k, strain + increment);
    }
    store_symmetric(h, k, sigma);
    PackOutput o;
    PackTensor stress = finish_rate_law(geometry, step, sigma, pack(modulus), modulus, density, J_min, o);
    store(inversion_, modulus / density, stress, o, k, P, out);
  }
}

} // namespace iga::solve
