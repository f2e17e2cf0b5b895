// Rules of all trimmed spans of a solid, and what every such rule must fulfil.
#pragma once

#include "preprocessor/fit/moment_fitting.hpp"

#include <functional>

namespace iga::test {

/// n³ spans of size 1 from the origin.
SplineGrid grid_of(std::int64_t n, int degree = 2);

struct Fitted {
  Index3 span;
  std::size_t touched;
  prep::SpanRule rule;
};

/// Calls `reduce(fitted, trimming, far)` on every rule where that is given.
using Reduce = std::function<void(Fitted&, const prep::Trimming&, const prep::FarMoments&)>;
std::vector<Fitted> fit_all(const SplineGrid& grid, const TriangleMesh& mesh, const std::array<int, 3>& degree,
                            const Reduce& reduce = {});

/// Of a convex solid: positive weights, points strictly inside, no more points than moments, and a residual recomputed
/// from half-space cuts in extended precision.
void expect_valid(const SplineGrid& grid, const TriangleMesh& mesh, const Fitted& f, const std::array<int, 3>& degree);

} // namespace iga::test
