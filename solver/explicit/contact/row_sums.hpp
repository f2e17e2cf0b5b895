// Sums over the entries of the row of a vertex. Several at a time, since one sum after the other would wait for each
// addition, in an order that depends on the row alone. Not for sums over the active vertices of a node: which vertices
// are active is no part of the state, and only in the order of the entries do those without a force change no bit.
#pragma once

#include "format/model/types.hpp"
#include "solver/explicit/contact/contact_surface.hpp"

#include <cmath>
#include <utility>

namespace iga::solve {

/// Σ term(e) over the entries of row i; term(e) is a double.
template <class Term> [[gnu::always_inline]] inline double sum_over_row(const SparseRows& S, std::size_t i, Term term) {
  auto e = static_cast<std::size_t>(S.first[i]);
  const auto end = static_cast<std::size_t>(S.first[i + 1]);
  double a = 0, b = 0, c = 0, d = 0;
  for (; e + 4 <= end; e += 4) {
    a += term(e);
    b += term(e + 1);
    c += term(e + 2);
    d += term(e + 3);
  }
  for (; e < end; ++e) a += term(e);
  return (a + b) + (c + d);
}

/// Σ_e S_ie x_e of numbers at nodes, component fastest.
inline Point3 combine_row(const SparseRows& S, std::size_t i, const double* nodal) {
  const auto vector = [nodal](std::int32_t column) { return nodal + 3 * static_cast<std::ptrdiff_t>(column); };
  auto e = static_cast<std::size_t>(S.first[i]);
  const auto end = static_cast<std::size_t>(S.first[i + 1]);
  double a[3]{}, b[3]{};
  for (; e + 2 <= end; e += 2) {
    const double N = S.value[e], M = S.value[e + 1];
    const double *x = vector(S.column[e]), *y = vector(S.column[e + 1]);
    for (int d = 0; d < 3; ++d) {
      a[d] += N * x[d];
      b[d] += M * y[d];
    }
  }
  if (e < end) {
    const double* x = vector(S.column[e]);
    for (int d = 0; d < 3; ++d) a[d] += S.value[e] * x[d];
  }
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// The same of two fields at once: the row is read once.
inline std::pair<Point3, Point3> combine_row(const SparseRows& S, std::size_t i, const double* first,
                                             const double* second) {
  double a[3]{}, b[3]{};
  for (auto e = static_cast<std::size_t>(S.first[i]); e < static_cast<std::size_t>(S.first[i + 1]); ++e) {
    const double N = S.value[e];
    const std::ptrdiff_t place = 3 * static_cast<std::ptrdiff_t>(S.column[e]);
    for (int d = 0; d < 3; ++d) {
      a[d] += N * first[place + d];
      b[d] += N * second[place + d];
    }
  }
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

/// Σ_j |S_ij| z_j.
inline double sum_of_sizes(const SparseRows& S, std::size_t i, const double* z) {
  return sum_over_row(S, i, [&](std::size_t e) { return std::abs(S.value[e]) * z[S.column[e]]; });
}

} // namespace iga::solve
