// Hughes–Winget increments: what laws in rate form share.
#pragma once

#include "solver/explicit/laws/compaction.hpp"
#include "solver/explicit/laws/inversion.hpp"

namespace iga::solve {

/// What rate laws need of F at the end of a step.
struct RateGeometry {
  Pack J;
  Pack clamped;      ///< max(J, smallest_J)
  Pack area_squared; ///< max |cof F N|²
  PackTensor cofactor;
  Pack cofactor_squares; ///< |cof F|²

  RateGeometry(const PackTensor& F, const PackTensor& cof, double smallest_J)
      : J(determinant(F, cof)), clamped(max(J, smallest_J)), cofactor(cof), cofactor_squares(squares(cof)) {
    area_squared = largest_area_stretch_squared(squares(F), cofactor_squares, J);
  }
  PackMask is_crushed(double smallest) const { return solve::is_crushed(J, cofactor_squares, smallest); }
};

/// Strain and rotation of one step about its midpoint: G = ΔF F_{n+1/2}^-1, strain = sym G, and θ half the axial vector
/// of skew G (Hughes and Winget 1980, doi 10.1002/nme.1620151210). A rigid rotation has no strain and turns exactly.
struct RateIncrement {
  PackSymmetric strain;
  Pack rotation[3];      ///< θ
  Pack one_over_clamped; ///< 1 / RateGeometry::clamped
  PackMask inverted;
  Pack compression{}; ///< LawOutput::compression
};

/// Points with J < smallest_J, or whose midpoint is that flat, get the increment zero: their stress stays.
inline RateIncrement rate_increment(const PackTensor& F, const PackTensor& F_old, const RateGeometry& geometry,
                                    double smallest_J) {
  PackTensor sum, G; // sum = 2 F_{n+1/2}
  for (int i = 0; i < 9; ++i) sum.c[i] = F.c[i] + F_old.c[i];
  const PackTensor cof = cofactor(sum);
  const Pack det = determinant(sum, cof); // 8 J of the midpoint
  RateIncrement r;
  r.inverted = (geometry.J < smallest_J) | (det < 4 * smallest_J);
  const Pack safe = r.inverted ? pack(8) : det;
  const Pack both = 1.0 / (safe * geometry.clamped); // one division for two
  r.one_over_clamped = both * safe;
  const Pack scale = r.inverted ? Pack{} : 2.0 * both * geometry.clamped;
  for (int a = 0; a < 3; ++a) {
    const Pack d0 = scale * (F(a, 0) - F_old(a, 0)), d1 = scale * (F(a, 1) - F_old(a, 1)),
               d2 = scale * (F(a, 2) - F_old(a, 2));
    for (int b = 0; b < 3; ++b) G(a, b) = d0 * cof(b, 0) + d1 * cof(b, 1) + d2 * cof(b, 2);
  }
  r.strain = {
      {G(0, 0), G(1, 1), G(2, 2), 0.5 * (G(0, 1) + G(1, 0)), 0.5 * (G(1, 2) + G(2, 1)), 0.5 * (G(2, 0) + G(0, 2))}};
  r.rotation[0] = 0.25 * (G(2, 1) - G(1, 2));
  r.rotation[1] = 0.25 * (G(0, 2) - G(2, 0));
  r.rotation[2] = 0.25 * (G(1, 0) - G(0, 1));
  const PackMask crushed = (geometry.J < crushed_J) | geometry.is_crushed(flat);
  if (any(crushed)) {
    constexpr double tiny = 1e-200;
    const double last = CrushingEnergy::last_ratio * smallest_J;
    const PackTensor cof_old = cofactor(F_old);
    const Pack J_old = determinant(F_old, cof_old), s_old = J_old / sqrt(squares(cof_old) + tiny);
    const Pack s = geometry.J / sqrt(geometry.cofactor_squares + tiny);
    const Pack lost = max((J_old - geometry.J) / max(geometry.J, last), (s_old - s) / max(s, last));
    r.compression = crushed ? max(lost, 0.0) : Pack{};
  }
  return r;
}

/// Q s Qᵀ with Q = (I - Θ)^-1 (I + Θ), Θ v = θ × v.
inline PackSymmetric rotated(const PackSymmetric& s, const Pack (&theta)[3]) {
  const Pack square = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2];
  const Pack c = 2.0 / (1.0 + square), diagonal = 1.0 - c * square;
  const Pack t0 = c * theta[0], t1 = c * theta[1], t2 = c * theta[2];
  const Pack xy = t0 * theta[1], yz = t1 * theta[2], zx = t2 * theta[0];
  const PackTensor Q{{diagonal + t0 * theta[0], xy - t2, zx + t1, xy + t2, diagonal + t1 * theta[1], yz - t0, zx - t1,
                      yz + t0, diagonal + t2 * theta[2]}};
  PackTensor T; // Q s
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) T(a, b) = Q(a, 0) * s(0, b) + Q(a, 1) * s(1, b) + Q(a, 2) * s(2, b);
  const auto entry = [&](int a, int b) -> Pack { return T(a, 0) * Q(b, 0) + T(a, 1) * Q(b, 1) + T(a, 2) * Q(b, 2); };
  return {{entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)}};
}

/// s += λ tr(e) I + 2 μ e
inline void add_elastic(PackSymmetric& s, const PackSymmetric& e, double lambda, double mu) {
  const Pack volumetric = lambda * trace(e);
  for (int i = 0; i < 6; ++i) s.c[i] += 2 * mu * e.c[i];
  for (int i = 0; i < 3; ++i) s.c[i] += volumetric;
}

/// Second invariant of the deviator, ½ s:s.
inline Pack deviator_invariant(const PackSymmetric& s) {
  const Pack a = s.c[0] - s.c[1], b = s.c[1] - s.c[2], c = s.c[2] - s.c[0];
  return (1.0 / 6.0) * (a * a + b * b + c * c) + s.c[3] * s.c[3] + s.c[4] * s.c[4] + s.c[5] * s.c[5];
}

inline PackSymmetric load_symmetric(const Lanes* h, int k) {
  PackSymmetric s;
  for (int i = 0; i < 6; ++i) s.c[i] = load(h[i], k);
  return s;
}

inline void store_symmetric(Lanes* h, int k, const PackSymmetric& s) {
  for (int i = 0; i < 6; ++i) store(h[i], k, s.c[i]);
}

/// The beginning of every rate law: the stress of the last step turned, with the elastic increment of this one.
struct RateTrial {
  RateGeometry geometry;
  RateIncrement step;
  PackSymmetric sigma;

  [[gnu::always_inline]] RateTrial(const PackTensor& F, const PackTensor& F_old, const PackSymmetric& last,
                                   double lambda, double mu, double smallest_J)
      : geometry(F, cofactor(F), smallest_J), step(rate_increment(F, F_old, geometry, smallest_J)),
        sigma(rotated(last, step.rotation)) {
    add_elastic(sigma, step.strain, lambda, mu);
  }
};

/// The end of every rate law: P = (σ + viscous) cof F, and below smallest_J the policy Clamp: a spring, a pressure
/// M (1 - J / smallest_J) (M the modulus of a plane wave: as stiff as the elastic material at smallest_J), and
/// resist_crushing.
///
/// Wave speed: with g = F^-T N, the acoustic tensor is J (∂σ/∂l) g⊗g; the terms of σ tr l and σ lᵀ cancel, the spin
/// adds at most half the difference of the principal stresses, which √J2 bounds. So ρ c² ≤ |cof F N|²/J · (M_t + √J2).
/// @param tangent M_t, force/length²: the stiffest response to a plane wave now
inline PackTensor finish_rate_law(const RateGeometry& geometry, const RateIncrement& step, const PackSymmetric& sigma,
                                  const Pack& tangent, double modulus, double density, double smallest_J,
                                  PackOutput& o) {
  constexpr double tiny = 1e-200;
  const Pack spring = modulus / smallest_J * min(geometry.J - smallest_J, 0.0);
  PackSymmetric total = sigma;
  for (int i = 0; i < 3; ++i) total.c[i] += spring;
  const PackMask below = geometry.J < smallest_J, crushed = geometry.is_crushed(smallest_J);
  const Pack extra = below ? pack(modulus / smallest_J) : Pack{};
  o.J = geometry.J;
  o.inverted = step.inverted | crushed;
  o.compression = step.compression;
  o.wave_speed_squared = geometry.area_squared *
                         ((tangent + rough_sqrt(deviator_invariant(sigma) + tiny)) * step.one_over_clamped + extra) *
                         (1 / density);
  PackTensor P = first_piola(total, geometry.cofactor);
  if (any(crushed))
    o.wave_speed_squared += (1 / density) * resist_crushing(geometry.J, geometry.cofactor, geometry.cofactor_squares,
                                                            geometry.area_squared, smallest_J, modulus, P);
  return P;
}

} // namespace iga::solve
