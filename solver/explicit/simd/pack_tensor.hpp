// 3×3 tensors of packs and the kinematics that the laws share.
#pragma once

#include "solver/explicit/simd/pack.hpp"

namespace iga::solve {

/// A_ab, row-major.
struct PackTensor {
  Pack c[9];

  Pack& operator()(int a, int b) { return c[3 * a + b]; }
  const Pack& operator()(int a, int b) const { return c[3 * a + b]; }
};

/// Symmetric, in the order xx yy zz xy yz zx (tensor components).
struct PackSymmetric {
  Pack c[6];

  Pack& operator()(int a, int b) { return c[place(a, b)]; }
  const Pack& operator()(int a, int b) const { return c[place(a, b)]; }

  static constexpr int place(int a, int b) { return a == b ? a : (a + b == 1 ? 3 : a + b == 3 ? 4 : 5); }
};

inline PackTensor load(const TensorLanes& x, int k) {
  PackTensor y;
  for (int i = 0; i < 9; ++i) y.c[i] = load(x.c[i], k);
  return y;
}

inline void store(TensorLanes& x, int k, const PackTensor& y) {
  for (int i = 0; i < 9; ++i) store(x.c[i], k, y.c[i]);
}

/// cof F = ∂(det F)/∂F = det F · F^-T.
inline PackTensor cofactor(const PackTensor& F) {
  PackTensor C;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
      C(a, b) = F(a1, b1) * F(a2, b2) - F(a1, b2) * F(a2, b1);
    }
  return C;
}

inline Pack determinant(const PackTensor& F, const PackTensor& cofactor) {
  return F(0, 0) * cofactor(0, 0) + F(0, 1) * cofactor(0, 1) + F(0, 2) * cofactor(0, 2);
}

/// Sum of the squares of all components.
inline Pack squares(const PackTensor& F) {
  Pack s = F.c[0] * F.c[0];
  for (int i = 1; i < 9; ++i) s += F.c[i] * F.c[i];
  return s;
}

inline Pack trace(const PackSymmetric& s) {
  return s.c[0] + s.c[1] + s.c[2];
}

/// a : b
inline Pack contract(const PackSymmetric& a, const PackSymmetric& b) {
  return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2] +
         2.0 * (a.c[3] * b.c[3] + a.c[4] * b.c[4] + a.c[5] * b.c[5]);
}

/// Upper bound of the largest eigenvalue of a symmetric positive tensor from its first two invariants: I1/3 plus √2
/// standard deviations of the eigenvalues (Wolkowicz and Styan 1980). Exact (to 1e-8) where the two smaller ones agree.
inline Pack largest_eigenvalue_bound(const Pack& I1, const Pack& I2) {
  constexpr double tiny = 1e-200;
  return (1.0 / 3.0) * I1 + (2.0 / 3.0) * rough_sqrt(max(I1 * I1 - 3.0 * I2, tiny));
}

/// Upper bound of the largest squared stretch of an area, max |cof F N|² over unit normals N = (J / σ_min(F))².
inline Pack largest_area_stretch_squared(const Pack& squares_of_F, const Pack& squares_of_cofactor, const Pack& J) {
  return largest_eigenvalue_bound(squares_of_cofactor, J * J * squares_of_F);
}

/// P = τ-like stress times area: P = σ cof F, with σ the Cauchy stress.
inline PackTensor first_piola(const PackSymmetric& sigma, const PackTensor& cofactor) {
  PackTensor P;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      P(a, b) = sigma(a, 0) * cofactor(0, b) + sigma(a, 1) * cofactor(1, b) + sigma(a, 2) * cofactor(2, b);
  return P;
}

} // namespace iga::solve
