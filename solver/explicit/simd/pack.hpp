// As many doubles side by side as one register holds: what the laws compute with inside. Eight lanes are one pack with
// AVX-512 and two with AVX2, where g++ 12 would keep eight-lane values in memory and break comparisons into scalars.
#pragma once

#include "solver/explicit/simd/tensor_lanes.hpp"

#include <cmath>
#include <cstring>

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace iga::solve {

#if defined(__AVX512F__)
constexpr int pack_size = 8;
#else
constexpr int pack_size = 4;
#endif
/// Packs that make up eight lanes.
constexpr int num_packs = 8 / pack_size;

using Pack [[gnu::vector_size(pack_size * sizeof(double))]] = double;
/// -1 where true, 0 where false. Select with `mask ? a : b`.
using PackMask [[gnu::vector_size(pack_size * sizeof(std::int64_t))]] = std::int64_t;

inline Pack pack(double x) {
  return x - Pack{};
}

/// The k-th pack of eight lanes.
inline Pack load(const Lanes& x, int k) {
  Pack y;
  std::memcpy(&y, reinterpret_cast<const double*>(&x) + k * pack_size, sizeof(Pack));
  return y;
}

inline void store(Lanes& x, int k, const Pack& y) {
  std::memcpy(reinterpret_cast<double*>(&x) + k * pack_size, &y, sizeof(Pack));
}

inline void store(LaneMask& x, int k, const PackMask& y) {
  std::memcpy(reinterpret_cast<std::int64_t*>(&x) + k * pack_size, &y, sizeof(PackMask));
}

// The forms with a mask of ones give the same instructions; g++ 12 takes the plain ones for uninitialised.
#if defined(__AVX512F__)
inline Pack min(const Pack& a, const Pack& b) {
  return _mm512_maskz_min_pd(0xff, a, b);
}
inline Pack max(const Pack& a, const Pack& b) {
  return _mm512_maskz_max_pd(0xff, a, b);
}
inline Pack sqrt(const Pack& a) {
  return _mm512_maskz_sqrt_pd(0xff, a);
}
/// 1 / √a to 1 or 2 ulp for normal positive a; off the divider, which laws would wait for otherwise.
inline Pack reciprocal_sqrt(const Pack& a) {
  Pack y = _mm512_maskz_rsqrt14_pd(0xff, a);
  y = y * (1.5 - 0.5 * a * y * y);
  return y + 0.5 * y * (1.0 - a * y * y);
}
/// √a to 1e-8 for a from 1e-280 on: for estimates.
inline Pack rough_sqrt(const Pack& a) {
  const Pack y = _mm512_maskz_rsqrt14_pd(0xff, a);
  return a * y * (1.5 - 0.5 * a * y * y);
}
inline bool any(const PackMask& m) {
  return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(m), reinterpret_cast<__m512i>(m)) != 0;
}
#elif defined(__AVX__)
inline Pack min(const Pack& a, const Pack& b) {
  return _mm256_min_pd(a, b);
}
inline Pack max(const Pack& a, const Pack& b) {
  return _mm256_max_pd(a, b);
}
inline Pack sqrt(const Pack& a) {
  return _mm256_sqrt_pd(a);
}
inline bool any(const PackMask& m) {
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(m)) != 0;
}
#else
inline Pack min(const Pack& a, const Pack& b) {
  return a < b ? a : b;
}
inline Pack max(const Pack& a, const Pack& b) {
  return a > b ? a : b;
}
inline Pack sqrt(const Pack& a) {
  Pack r;
  for (int i = 0; i < pack_size; ++i) r[i] = std::sqrt(a[i]);
  return r;
}
inline bool any(const PackMask& m) {
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
#endif

#if !defined(__AVX512F__)
inline Pack reciprocal_sqrt(const Pack& a) {
  return 1.0 / sqrt(a);
}
inline Pack rough_sqrt(const Pack& a) {
  return sqrt(a);
}
#endif

inline Pack max(const Pack& a, double b) {
  return max(a, pack(b));
}
inline Pack min(const Pack& a, double b) {
  return min(a, pack(b));
}

/// Number of lanes in which a mask is true.
inline int count(const LaneMask& m) {
  std::int64_t n = 0;
  for (int i = 0; i < 8; ++i) n -= m[i];
  return static_cast<int>(n);
}

} // namespace iga::solve
