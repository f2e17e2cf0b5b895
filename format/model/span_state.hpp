// Where a knot span lies with respect to the solid.
#pragma once

#include <cstdint>

namespace iga {

enum class SpanState : std::uint8_t { Exterior = 0, Interior = 1, Trimmed = 2 };

} // namespace iga
