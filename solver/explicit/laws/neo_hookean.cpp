#include "solver/explicit/laws/neo_hookean.hpp"

#include "solver/explicit/laws/pack_math.hpp"

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

NeoHookean neo_hookean(double E, double nu, double density, const InversionPolicy& inversion) {
  return hyperelastic<NeoHookean>(E, nu, density, inversion);
}

} // namespace iga::solve
