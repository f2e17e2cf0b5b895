#include "solver/explicit/laws/neo_hookean.hpp"

#include "solver/explicit/laws/compaction.hpp"
#include "solver/explicit/simd/pack_math.hpp"

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
    const Pack squares_of_cofactor = squares(cof);
    const Pack area = largest_area_stretch_squared(squares(F), squares_of_cofactor, J);
    const PackMask crushed = is_crushed(J, squares_of_cofactor, inversion.smallest_J);
    Pack acoustic = mu + max(dp, 0.0) * area;
    if (any(crushed))
      acoustic += resist_crushing(J, cof, squares_of_cofactor, area, inversion.smallest_J, lambda + 2 * mu, stress);
    const PackOutput o{.wave_speed_squared = acoustic * (1 / density), .J = J, .inverted = crushed};
    store(inversion, at_rest, stress, o, k, P, out);
  }
}

NeoHookean neo_hookean(double E, double nu, double density, const InversionPolicy& inversion) {
  return hyperelastic<NeoHookean>(E, nu, density, inversion);
}

} // namespace iga::solve
