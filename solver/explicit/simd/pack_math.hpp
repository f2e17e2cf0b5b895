// Logarithm, exponential, power and cube root of packs, without branches or tables. The reductions and coefficients
// are those of fdlibm (Sun Microsystems 1993, e_log.c and e_exp.c): errors below 1 ulp for log and exp.
#pragma once

#include "solver/explicit/simd/pack.hpp"

namespace iga::solve {

namespace detail {

inline constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
// 1.5 · 2^52: added to a number below 2^51 its last bits hold that number, rounded to an integer.
inline constexpr double round_shift = 6755399441055744.0;
inline constexpr std::int64_t round_shift_bits = 0x4338000000000000;
inline constexpr std::int64_t one_bits = 0x3ff0000000000000, sqrt_half_bits = 0x3fe6a09e00000000,
                              mantissa_bits = 0x000fffffffffffff;
using PackBits [[gnu::vector_size(pack_size * sizeof(std::int64_t))]] = std::uint64_t;

} // namespace detail

/// ln x for normal positive x; what comes back for any other x is finite or NaN and means nothing.
inline Pack log(const Pack& x) {
  using namespace detail;
  // x = 2^k m with m in √½ … √2
  const PackMask bits = reinterpret_cast<PackMask>(x) + (one_bits - sqrt_half_bits);
  const PackMask exponent = reinterpret_cast<PackMask>(reinterpret_cast<PackBits>(bits) >> 52) - 1023;
  const Pack k = reinterpret_cast<Pack>(exponent + round_shift_bits) - round_shift;
  const Pack f = reinterpret_cast<Pack>((bits & mantissa_bits) + sqrt_half_bits) - 1.0;
  const Pack s = f / (2.0 + f), z = s * s, w = z * z;
  const Pack even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const Pack odd = z * (6.666666666666735130e-01 +
                        w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const Pack half_square = 0.5 * f * f;
  return k * ln2_high - ((half_square - (s * (half_square + even + odd) + k * ln2_low)) - f);
}

/// e^x; x is clamped to -708 … 709, so that nothing overflows.
inline Pack exp(const Pack& x) {
  using namespace detail;
  const Pack c = min(max(x, -708.0), 709.0);
  const Pack shifted = c * 1.44269504088896338700 + round_shift;
  const Pack k = shifted - round_shift;
  const Pack high = c - k * ln2_high, low = k * ln2_low, r = high - low, rr = r * r;
  const Pack t = r - rr * (1.66666666666666019037e-01 +
                           rr * (-2.77777777770155933842e-03 +
                                 rr * (6.61375632143793436117e-05 +
                                       rr * (-1.65339022054652515390e-06 + rr * 4.13813679705723846039e-08))));
  const Pack y = 1.0 + (r * t / (2.0 - t) - low + high);
  const PackMask power = (reinterpret_cast<PackMask>(shifted) - round_shift_bits + 1023) << 52;
  return y * reinterpret_cast<Pack>(power);
}

/// x^y for normal positive x; relative error about |y ln x| ulp.
inline Pack pow(const Pack& x, double y) {
  return exp(y * log(x));
}

/// Cube root of normal positive x.
inline Pack cbrt(const Pack& x) {
  const Pack y = exp(log(x) * (1.0 / 3.0));
  return y - (y * y * y - x) / (3.0 * y * y);
}

} // namespace iga::solve
