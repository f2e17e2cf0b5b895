// Eight rows of eight doubles turned into eight columns: from "one span after the other" to "eight spans side by side".
#pragma once

#include "solver/explicit/simd/wide.hpp"

namespace iga::solve {

using UnalignedPack [[gnu::vector_size(pack_size * sizeof(double)), gnu::aligned(8), gnu::may_alias]] = double;

/// Eight doubles from anywhere in memory.
// Whole registers: of a copy by memcpy g++ 12 makes halves, and later loads wait until both have arrived in the cache.
[[gnu::always_inline]] inline Wide load_wide(const double* x) {
  Wide y;
  for (int k = 0; k < num_packs; ++k) y.p[k] = *reinterpret_cast<const UnalignedPack*>(x + k * pack_size);
  return y;
}
[[gnu::always_inline]] inline void store_wide(const Wide& x, double* y) {
  for (int k = 0; k < num_packs; ++k) *reinterpret_cast<UnalignedPack*>(y + k * pack_size) = x.p[k];
}

#if defined(__AVX512F__)
/// a[c][r] = a[r][c], in three rounds of exchanges between neighbours at distance 1, 2 and 4.
[[gnu::always_inline]] inline void transpose(Wide (&rows)[8]) {
  Pack a[8], b[8];
  for (int i = 0; i < 8; ++i) a[i] = rows[i].p[0];
  for (int i = 0; i < 8; i += 2) {
    b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 8; i += 4)
    for (int j = i; j < i + 2; ++j) {
      a[j] = __builtin_shufflevector(b[j], b[j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      a[j + 2] = __builtin_shufflevector(b[j], b[j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int j = 0; j < 4; ++j) {
    rows[j].p[0] = __builtin_shufflevector(a[j], a[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    rows[j + 4].p[0] = __builtin_shufflevector(a[j], a[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}
#else
/// a[c][r] = a[r][c]: the four 4 × 4 blocks, those off the diagonal exchanged.
[[gnu::always_inline]] inline void transpose(Wide (&rows)[8]) {
  const auto block = [](const Pack(&x)[4], Pack(&y)[4]) {
    const Pack a = __builtin_shufflevector(x[0], x[1], 0, 4, 2, 6), b = __builtin_shufflevector(x[0], x[1], 1, 5, 3, 7),
               c = __builtin_shufflevector(x[2], x[3], 0, 4, 2, 6), d = __builtin_shufflevector(x[2], x[3], 1, 5, 3, 7);
    y[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
    y[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
    y[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    y[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
  };
  Pack from[2][2][4], to[2][2][4];
  for (int r = 0; r < 8; ++r)
    for (int h = 0; h < 2; ++h) from[r / 4][h][r % 4] = rows[r].p[h];
  for (int g = 0; g < 2; ++g)
    for (int h = 0; h < 2; ++h) block(from[g][h], to[h][g]);
  for (int r = 0; r < 8; ++r)
    for (int h = 0; h < 2; ++h) rows[r].p[h] = to[r / 4][h][r % 4];
}
#endif

/// Sums of eight rows of lanes side by side: lane i of the result is Σ_l rows[i][l], each in the same order.
[[gnu::always_inline]] inline Wide lane_sums(Wide (&rows)[8]) {
  transpose(rows);
  return ((rows[0] + rows[4]) + (rows[1] + rows[5])) + ((rows[2] + rows[6]) + (rows[3] + rows[7]));
}

/// Largest of the eight.
inline double largest(const Lanes& x) {
  double y = x[0];
  for (std::size_t l = 1; l < lanes; ++l) y = x[l] > y ? x[l] : y;
  return y;
}
inline double smallest(const Lanes& x) {
  double y = x[0];
  for (std::size_t l = 1; l < lanes; ++l) y = x[l] < y ? x[l] : y;
  return y;
}

} // namespace iga::solve
