// Container positions from the signed numbers that meshes store.
#pragma once

#include <concepts>
#include <cstddef>

namespace iga::solve {

constexpr std::size_t at(std::integral auto i) {
  return static_cast<std::size_t>(i);
}

} // namespace iga::solve
