// Eight rows of eight doubles turned into eight columns: from "one span after the other" to "eight spans side by side".
#pragma once

#include "format/model/simd.hpp"

#include <cstring>

namespace iga::solve {

/// Eight doubles from anywhere in memory.
inline Lanes load_lanes(const double* x) {
  Lanes y;
  std::memcpy(&y, x, sizeof(y));
  return y;
}

inline void store_lanes(const Lanes& x, double* y) {
  std::memcpy(y, &x, sizeof(x));
}

/// column[c][r] = row[r][c], in three rounds of exchanges between neighbours at distance 1, 2 and 4.
inline void transpose(Lanes (&a)[8]) {
  Lanes b[8];
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
    b[j] = __builtin_shufflevector(a[j], a[j + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    b[j + 4] = __builtin_shufflevector(a[j], a[j + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
  for (int i = 0; i < 8; ++i) a[i] = b[i];
}

/// Sums of eight Lanes side by side: result[i] = Σ_l a[i][l], each in the same order.
inline Lanes lane_sums(Lanes (&a)[8]) {
  transpose(a);
  return ((a[0] + a[4]) + (a[1] + a[5])) + ((a[2] + a[6]) + (a[3] + a[7]));
}

/// Largest of the eight.
inline double largest(const Lanes& x) {
  double y = x[0];
  for (std::size_t l = 1; l < lanes; ++l) y = x[l] > y ? x[l] : y;
  return y;
}

inline double smallest(const Lanes& x) {
  return -largest(-x);
}

} // namespace iga::solve
