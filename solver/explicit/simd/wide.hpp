// Eight lanes as the registers of the machine hold them: one pack with AVX-512, two with AVX2. g++ 12 keeps Lanes in
// memory where no register is that wide; of this struct it makes registers.
#pragma once

#include "solver/explicit/simd/pack.hpp"

namespace iga::solve {

struct Wide {
  Pack p[num_packs];
};

[[gnu::always_inline]] inline Wide wide(double x) {
  Wide y;
  for (int k = 0; k < num_packs; ++k) y.p[k] = pack(x);
  return y;
}
[[gnu::always_inline]] inline Wide wide(const Lanes& x) {
  Wide y;
  for (int k = 0; k < num_packs; ++k) y.p[k] = load(x, k);
  return y;
}
[[gnu::always_inline]] inline void store(Lanes& x, const Wide& y) {
  for (int k = 0; k < num_packs; ++k) store(x, k, y.p[k]);
}
[[gnu::always_inline]] inline Wide operator*(const Wide& x, const Wide& y) {
  Wide z;
  for (int k = 0; k < num_packs; ++k) z.p[k] = x.p[k] * y.p[k];
  return z;
}
[[gnu::always_inline]] inline Wide operator*(const Wide& x, double y) {
  Wide z;
  for (int k = 0; k < num_packs; ++k) z.p[k] = x.p[k] * y;
  return z;
}
[[gnu::always_inline]] inline Wide operator*(double x, const Wide& y) {
  return y * x;
}
[[gnu::always_inline]] inline Wide operator+(const Wide& x, const Wide& y) {
  Wide z;
  for (int k = 0; k < num_packs; ++k) z.p[k] = x.p[k] + y.p[k];
  return z;
}
[[gnu::always_inline]] inline Wide operator+(const Wide& x, double y) {
  Wide z;
  for (int k = 0; k < num_packs; ++k) z.p[k] = x.p[k] + y;
  return z;
}
[[gnu::always_inline]] inline Wide& operator+=(Wide& x, const Wide& y) {
  for (int k = 0; k < num_packs; ++k) x.p[k] += y.p[k];
  return x;
}
[[gnu::always_inline]] inline Wide min(const Wide& x, const Wide& y) {
  Wide z;
  for (int k = 0; k < num_packs; ++k) z.p[k] = x.p[k] < y.p[k] ? x.p[k] : y.p[k];
  return z;
}
[[gnu::always_inline]] inline Wide max(const Wide& x, const Wide& y) {
  Wide z;
  for (int k = 0; k < num_packs; ++k) z.p[k] = x.p[k] > y.p[k] ? x.p[k] : y.p[k];
  return z;
}
/// Is the mask true in any lane?
[[gnu::always_inline]] inline bool any_lane(const LaneMask& mask) {
  bool found = false;
  for (int k = 0; k < num_packs; ++k) {
    PackMask part;
    std::memcpy(&part, reinterpret_cast<const std::int64_t*>(&mask) + k * pack_size, sizeof(part));
    found = found || any(part);
  }
  return found;
}

/// Nine components side by side: a tensor between contraction and law.
struct TensorWide {
  Wide c[9];
  Wide& operator()(int a, int b) { return c[3 * a + b]; }
  const Wide& operator()(int a, int b) const { return c[3 * a + b]; }
};

} // namespace iga::solve
