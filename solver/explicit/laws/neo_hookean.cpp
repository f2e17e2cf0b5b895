#include "solver/explicit/laws/neo_hookean.hpp"

#include "solver/explicit/laws/pack_math.hpp"

#include <cmath>

namespace iga::solve {

void NeoHookean::stress(const LawInput& in, Lanes*, TensorLanes& P, LawOutput& out) const {
  const double at_rest = (lambda + 2 * mu) / density;
  for (int k = 0; k < num_packs; ++k) {
    const PackTensor F = load(in.F, k), cof = cofactor(F);
    const Pack J = determinant(F, cof);
    const Pack clamped = max(J, inversion.smallest_J);
    const Pack one_over_J = 1.0 / clamped, log_J = log(clamped);
    const Pack p = (lambda * log_J - mu) * one_over_J;
    const Pack dp = (lambda + mu - lambda * log_J) * one_over_J * one_over_J;
    const Pack pressure = p + dp * (J - clamped);
    PackTensor stress;
    for (int i = 0; i < 9; ++i) stress.c[i] = mu * F.c[i] + pressure * cof.c[i];
    // dp < 0 where J > e^{1 + μ/λ}: then the shear wave is the fastest.
    const Pack area = largest_area_stretch_squared(squares(F), squares(cof), J);
    const PackOutput o{
        .wave_speed_squared = (mu + max(dp, 0.0) * area) * (1 / density), .J = J, .inverted = J < inversion.smallest_J};
    store(inversion, at_rest, stress, o, k, P, out);
  }
}

double NeoHookean::reference_wave_speed() const {
  return std::sqrt((lambda + 2 * mu) / density);
}

ElasticMaterial NeoHookean::small_strain() const {
  return isotropic(mu * (3 * lambda + 2 * mu) / (lambda + mu), lambda / (2 * (lambda + mu)), density);
}

NeoHookean neo_hookean(double E, double nu, double density, const InversionPolicy& inversion) {
  const ElasticMaterial m = isotropic(E, nu, density);
  return {.lambda = m.C(0, 1), .mu = m.C(3, 3), .density = density, .inversion = inversion};
}

} // namespace iga::solve
