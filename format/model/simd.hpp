// Eight doubles side by side: the compiler maps them to one AVX-512 or two AVX registers. Hot loops of both tools.
#pragma once

#include <cstddef>

namespace iga {

constexpr std::size_t lanes = 8;
using Lanes [[gnu::vector_size(8 * sizeof(double))]] = double;

inline double sum(const Lanes& x) {
  return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

} // namespace iga
