#include "solver/explicit/laws/crushable_foam.hpp"

#include "format/model/errors.hpp"
#include "solver/explicit/laws/principal.hpp"
#include "solver/explicit/laws/stress_rate.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

double modulus_of(const FoamSettings& s) {
  if (s.modulus == FoamModulus::E) return s.E;
  if (!(s.yield.final_slope() > 0))
    throw InputError(
        fmt::format("material: modulus = \"lcid_final_slope\", but the yield curve ends with slope {:.6g}; "
                    "give a curve that rises at its end or modulus = \"E\"",
                    s.yield.final_slope()));
  return s.yield.final_slope();
}

} // namespace

CrushableFoam::CrushableFoam(const FoamSettings& s)
    : density(s.density), elastic_(isotropic(modulus_of(s), s.nu, s.density)), lambda_(elastic_.C(0, 1)),
      mu_(elastic_.C(3, 3)), yield_(s.yield), tension_limit_(s.tension_limit), damping_(s.damping),
      inversion_(s.inversion) {
  const std::size_t last = yield_.size() - 1;
  for (std::size_t k = 0; k <= last; ++k)
    if (!(yield_.y()[k] > 0))
      throw InputError(fmt::format("material: the yield curve has Y({:.6g}) = {:.6g}; every yield stress has to be "
                                   "positive, that at γ = 0 too (the elastic line governs below it)",
                                   yield_.x()[k], yield_.y()[k]));
  if (yield_.final_slope() < 0)
    throw InputError(fmt::format("material: the yield curve falls at its end (slope {:.6g}) and would go on below "
                                 "zero; add a point that makes it flat or rising",
                                 yield_.final_slope()));
  if (!(tension_limit_ >= 0) || !std::isfinite(tension_limit_))
    throw InputError(
        fmt::format("material: tension_limit = {}, expected a stress ≥ 0 (0: the yield stress)", tension_limit_));
  if (!(damping_ >= 0 && damping_ <= 1))
    throw InputError(fmt::format("material: damping = {}, expected 0 … 1; usual are 0.05 … 0.5", damping_));
}

std::optional<std::string> CrushableFoam::warning() const {
  const double modulus = elastic_.C(0, 0);
  double worst = 0, where = 0;
  for (std::size_t k = 0; k < yield_.size(); ++k) {
    const double slope = (1 - std::max(yield_.x()[k], 0.0)) * yield_.slope(yield_.x()[k]);
    if (slope > worst) {
      worst = slope;
      where = yield_.x()[k];
    }
  }
  if (worst <= modulus) return std::nullopt;
  return fmt::format(
      "material: from volumetric strain {:.4g} the yield curve is steeper ((1 - γ) dY/dγ up to {:.4g}) "
      "than the elastic modulus {:.4g}: the stress lags behind the curve there and the time step follows "
      "the curve; modulus = \"lcid_final_slope\" would raise the modulus",
      where, worst, modulus);
}

void CrushableFoam::start(Lanes* h) const {
  for (int i = 0; i < history; ++i) h[i] = Lanes{};
}

double CrushableFoam::reference_wave_speed() const {
  return std::sqrt(elastic_.C(0, 0) / density);
}

void CrushableFoam::stress(const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) const {
  const double modulus = elastic_.C(0, 0), wave_speed = std::sqrt(modulus / density), J_min = inversion_.smallest_J;
  for (int k = 0; k < num_packs; ++k) {
    auto [geometry, step, sigma] =
        RateTrial(load(in.F, k), load(in.F_old, k), load_symmetric(h, k), lambda_, mu_, J_min);

    const Pack gamma = 1.0 - geometry.clamped;
    const Curve::Piece piece = yield_.piece_at(max(gamma, 0.0));
    const Pack compression = -piece.value(max(gamma, 0.0));
    const Pack tension = tension_limit_ > 0 ? pack(tension_limit_) : -compression;
    if (any(~principal_values_inside(sigma, compression, tension)))
      sigma = isotropic_function(sigma, [&](const Pack& s) -> Pack { return min(max(s, compression), tension); });
    store_symmetric(h, k, sigma);

    // Crushing, the stress follows the curve: ∂σ/∂J = dY/dγ, times J for a unit of strain.
    const Pack curve_slope = gamma >= 0.0 ? piece.slope : Pack{};
    const Pack tangent = max(geometry.clamped * curve_slope, modulus);
    PackOutput o;
    PackTensor stress = finish_rate_law(geometry, step, sigma, tangent, modulus, density, J_min, o);
    if (damping_ > 0) {
      const Pack area = sqrt(geometry.area_squared);
      o.damping_ratio = damping_ * wave_speed * area / sqrt(o.wave_speed_squared);
      if (in.dt > 0) {
        const Pack viscosity =
            (damping_ * density * wave_speed * in.length / in.dt) * (geometry.clamped / area); // of Δε
        PackSymmetric viscous;
        for (int i = 0; i < 6; ++i) viscous.c[i] = viscosity * step.strain.c[i];
        const PackTensor added = first_piola(viscous, geometry.cofactor);
        for (int i = 0; i < 9; ++i) stress.c[i] += added.c[i];
        o.viscous_power = geometry.J * contract(viscous, step.strain) * (1 / in.dt);
      }
    }
    store(inversion_, modulus / density, stress, o, k, P, out);
  }
}

} // namespace iga::solve
