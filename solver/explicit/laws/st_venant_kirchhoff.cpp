#include "solver/explicit/laws/st_venant_kirchhoff.hpp"

#include "solver/explicit/laws/compaction.hpp"

namespace iga::solve {

void StVenantKirchhoff::stress(const LawInput& in, Lanes*, TensorLanes& P, LawOutput& out) const {
  const double modulus = lambda + 2 * mu, spring = modulus / inversion.smallest_J;
  for (int k = 0; k < num_packs; ++k) {
    const PackTensor F = load(in.F, k), cof = cofactor(F);
    const Pack J = determinant(F, cof);
    const Pack squares_of_F = squares(F), squares_of_cofactor = squares(cof);
    const Pack volumetric = (0.5 * lambda) * (squares_of_F - 3.0); // λ tr E
    PackSymmetric S;
    for (int i = 0; i < 6; ++i) {
      const int a = i < 3 ? i : i - 3, b = i < 3 ? i : (i - 2) % 3;
      S.c[i] = mu * (F(0, a) * F(0, b) + F(1, a) * F(1, b) + F(2, a) * F(2, b));
    }
    for (int i = 0; i < 3; ++i) S.c[i] += volumetric - mu;
    PackOutput o;
    o.J = J;
    o.inverted = is_crushed(J, squares_of_cofactor, inversion.smallest_J);
    const Pack pressure = spring * min(J - inversion.smallest_J, 0.0);
    PackTensor stress;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        stress(a, b) = F(a, 0) * S(0, b) + F(a, 1) * S(1, b) + F(a, 2) * S(2, b) + pressure * cof(a, b);
    // Acoustic tensor (N·S N) I + F ((λ + μ) N⊗N + μ I) Fᵀ, plus that of the pressure.
    const Pack stretch = largest_eigenvalue_bound(squares_of_F, squares_of_cofactor);
    const Pack area = largest_area_stretch_squared(squares_of_F, squares_of_cofactor, J);
    const Pack from_stress = max(volumetric + mu * (stretch - 1.0), 0.0);
    const Pack from_pressure = J < inversion.smallest_J ? spring * area : Pack{};
    Pack acoustic = from_stress + modulus * stretch + from_pressure;
    if (any(o.inverted))
      acoustic += resist_crushing(J, cof, squares_of_cofactor, area, inversion.smallest_J, modulus, stress);
    o.wave_speed_squared = acoustic * (1 / density);
    store(inversion, modulus / density, stress, o, k, P, out);
  }
}

StVenantKirchhoff st_venant_kirchhoff(double E, double nu, double density, const InversionPolicy& inversion) {
  return hyperelastic<StVenantKirchhoff>(E, nu, density, inversion);
}

} // namespace iga::solve
