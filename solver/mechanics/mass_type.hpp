// Which mass matrix an analysis works with; theory in README.md.
#pragma once

namespace iga::solve {

enum class MassType { Consistent, Lumped, TwoPass, ThreePass };

} // namespace iga::solve
