// Isotropic functions of symmetric tensors without eigenvectors.
#pragma once

#include "solver/explicit/simd/pack_tensor.hpp"

namespace iga::solve {

/// Σ_k f(s_k) n_k n_kᵀ for the principal values s_k and directions n_k of a; f: Pack → Pack.
/// The best separated root of the characteristic equation comes from a polynomial and one step of Newton's method
/// (error 1e-15 of the deviator), its projection n nᵀ from the adjugate; what is left acts in a plane, where the two
/// other roots follow from a square root (the deflation of Scherzinger and Dohrmann 2008,
/// doi 10.1016/j.cma.2008.03.031). Accurate to round-off for a Lipschitz-continuous f, also where principal values
/// agree.
template <class Function> PackSymmetric isotropic_function(const PackSymmetric& a, Function f) {
  const Pack mean = (1.0 / 3.0) * trace(a);
  PackSymmetric s = a; // deviator
  for (int i = 0; i < 3; ++i) s.c[i] -= mean;
  // Far below any stress, its third power still a normal number: keeps 1/p finite for a spherical tensor.
  constexpr double tiny = 1e-180;
  const Pack p2 = (1.0 / 6.0) * contract(s, s) + tiny; // roots p (2 cos φ_k)
  const Pack one_over_p = reciprocal_sqrt(p2), p = p2 * one_over_p;
  const Pack xx = s.c[0], yy = s.c[1], zz = s.c[2], xy = s.c[3], yz = s.c[4], zx = s.c[5];
  const Pack det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
  const Pack cos3 = 0.5 * det * one_over_p * one_over_p * one_over_p;
  const Pack sign = cos3 < 0.0 ? pack(-1) : pack(1);
  const Pack r = min(sign * cos3, 1.0);
  // g = 2 cos(arccos(r)/3) is the root of g³ - 3 g - 2 r in √3 … 2, smooth in r; the polynomial is right to 2.2e-8.
  Pack g = 1.7320508296149835 +
           r * (0.3333303826834962 +
                r * (-0.09615929561778862 +
                     r * (0.04881168115693242 +
                          r * (-0.028654594140164705 +
                               r * (0.015437627112263949 + r * (-0.00592397390041565 + r * 0.0011073596107101403))))));
  const Pack w = 1.0 / (3.0 * g * g - 3.0);
  g -= (g * (g * g - 3.0) - 2.0 * r) * w;
  const Pack s1 = sign * p * g;
  // adj(s - s1) = (s2 - s1)(s3 - s1) n nᵀ and (s2 - s1)(s3 - s1) = p² (3 g² - 3), its inverse w polished once
  const Pack scale = w * (2.0 - w * (3.0 * g * g - 3.0)) * one_over_p * one_over_p;
  const Pack x = xx - s1, y = yy - s1, z = zz - s1;
  PackSymmetric n{{scale * (y * z - yz * yz), scale * (x * z - zx * zx), scale * (x * y - xy * xy),
                   scale * (yz * zx - xy * z), scale * (xy * zx - yz * x), scale * (xy * yz - zx * y)}};
  // s = s1 n nᵀ - s1/2 (I - n nᵀ) + b with b traceless in the plane normal to n, principal values ±d
  const Pack half = 0.5 * s1;
  PackSymmetric b;
  for (int i = 0; i < 6; ++i) b.c[i] = s.c[i] - 3.0 * half * n.c[i];
  for (int i = 0; i < 3; ++i) b.c[i] += half;
  const Pack d2 = 0.5 * contract(b, b) + tiny, one_over_d = reciprocal_sqrt(d2), d = d2 * one_over_d;
  const Pack f1 = f(mean + s1), f2 = f(mean - half + d), f3 = f(mean - half - d);
  const Pack average = 0.5 * (f2 + f3), in_plane = 0.5 * (f2 - f3) * one_over_d, along = f1 - average;
  PackSymmetric result;
  for (int i = 0; i < 6; ++i) result.c[i] = along * n.c[i] + in_plane * b.c[i];
  for (int i = 0; i < 3; ++i) result.c[i] += average;
  return result;
}

/// True where all principal values of a lie inside low … high (Sylvester's criterion on both sides).
inline PackMask principal_values_inside(const PackSymmetric& a, const Pack& low, const Pack& high) {
  const Pack xy = a.c[3], yz = a.c[4], zx = a.c[5];
  const Pack xy2 = xy * xy, yz2 = yz * yz, zx2 = zx * zx, product = 2.0 * xy * yz * zx;
  const auto positive = [&](const Pack& x, const Pack& y, const Pack& z, const Pack& offdiagonal) -> PackMask {
    const Pack minor = x * y - xy2;
    const Pack det = minor * z + offdiagonal - x * yz2 - y * zx2;
    return (x > 0.0) & (minor > 0.0) & (det > 0.0);
  };
  return positive(a.c[0] - low, a.c[1] - low, a.c[2] - low, product) &
         positive(high - a.c[0], high - a.c[1], high - a.c[2], -product);
}

} // namespace iga::solve
