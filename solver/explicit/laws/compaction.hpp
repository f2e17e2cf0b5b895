// What keeps a point from being crushed to nothing: an energy that grows without bound as it is squeezed flat.
#pragma once

#include "solver/explicit/simd/pack_tensor.hpp"

#include <cmath>

namespace iga::solve {

/// u(x) = (1 - x)³ / x² for x < 1, 0 above: u, u' and u'' begin at zero, and u → ∞ for x → 0. A step may leap over that
/// end nevertheless: below x = 0.02 u goes on as its parabola of second order there, also through x < 0. Its curvature,
/// 3.7e7, makes the time step fall below the floor of a run.
struct CrushingEnergy {
  Pack slope;     ///< u' <= 0
  Pack curvature; ///< u'' >= 0

  static constexpr double last_ratio = 0.02;

  explicit CrushingEnergy(const Pack& ratio) {
    const Pack x = min(ratio, 1.0), inside = max(x, last_ratio);
    const Pack inverse = 1.0 / inside, left = 1.0 - inside, inverse2 = inverse * inverse;
    curvature = 6.0 * left * inverse2 * inverse2;
    slope = curvature * (x - inside) - left * left * (2.0 + inside) * inverse2 * inverse;
  }
};

/// s = 1 / |F^-1| = J / |cof F| (Frobenius norms) of a column that is compressed to the volume ratio J: 0.577 at rest,
/// J where that is small.
inline double column_stretch(double J) {
  return J / std::sqrt(1 + 2 * J * J);
}

/// Crushed: J < smallest, or flatter than a column of that volume ratio. s is between a √3-th and the whole of the
/// smallest principal stretch, equal to it where that is small; negative where J is.
inline PackMask is_crushed(const Pack& J, const Pack& squares_of_cofactor, double smallest) {
  const double s = column_stretch(smallest);
  return (J < smallest) | (J * J < s * s * squares_of_cofactor);
}

/// Added to every law with geometry where a point is crushed, beside what the law itself does below smallest_J:
///   U(F) = M (r u(J / r) + r_s u(s / r_s)), r = smallest_J, r_s = column_stretch(r), M the modulus of a plane wave.
/// The volume ratio alone would not do: material that gives way to the sides is squeezed to a sheet of no thickness at
/// any volume. P = M (u'(J/r) cof F + u'(s/r_s) cof F (cof F)ᵀ cof F / |cof F|³); the second gradient's norm is at
/// most 1.
/// @return what it adds to a bound of ρ c²: M (u''(J/r) |cof F N|² / r + 2 u''(s/r_s) / r_s)
inline Pack resist_crushing(const Pack& J, const PackTensor& cof, const Pack& squares_of_cofactor,
                            const Pack& area_squared, double smallest_J, double modulus, PackTensor& P) {
  constexpr double tiny = 1e-200;
  const Pack one_over_norm = 1.0 / sqrt(squares_of_cofactor + tiny);
  const double smallest_s = column_stretch(smallest_J);
  const CrushingEnergy volume(J * (1 / smallest_J)), stretch(J * one_over_norm * (1 / smallest_s));
  const Pack along = modulus * volume.slope;
  const Pack across = modulus * stretch.slope * one_over_norm * one_over_norm * one_over_norm;
  PackSymmetric A; // (cof F)ᵀ cof F
  for (int i = 0; i < 6; ++i) {
    const int a = i < 3 ? i : i - 3, b = i < 3 ? i : (i - 2) % 3;
    A.c[i] = cof(0, a) * cof(0, b) + cof(1, a) * cof(1, b) + cof(2, a) * cof(2, b);
  }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      P(a, b) += along * cof(a, b) + across * (cof(a, 0) * A(0, b) + cof(a, 1) * A(1, b) + cof(a, 2) * A(2, b));
  return modulus * ((1 / smallest_J) * volume.curvature * area_squared + (2 / smallest_s) * stretch.curvature);
}

/// A point that is crushed below this volume ratio, or flatter than `flat`, may lose no more of either in a step than
/// LawOutput::compression allows.
inline constexpr double crushed_J = 0.25, flat = 0.1;

} // namespace iga::solve
