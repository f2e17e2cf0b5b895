// Generalised Gaussian rules on runs of equal spans: about half as many points as the spline space has functions.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace iga::prep {

/// The univariate space that a rule integrates exactly: piecewise polynomials of this degree with `continuity`
/// continuous derivatives at the inner knots of a run, nothing asked at its ends. Continuity -1: spans are independent.
struct TargetSpace {
  int degree = 5;
  int continuity = -1;
  bool operator==(const TargetSpace&) const = default;
};

/// Target of an interior rule for splines of degree p (1 … 4):
///   gauss         S^{2p+1}_{-1}: p + 1 Gauss points in every span
///   ggq           S^{2p}_{p-2}: every product of two functions, or of their derivatives
///   ggq-reduced   S^{2p-1}_{p-2}
///   ggq-reduced2  S^{2p-2}_{p-2}, from p = 3 on
/// At p = 1 derivatives jump at the knots, so that no run is longer than a span: ggq is Gauss with two points, and so
/// is ggq-reduced, whose single point a span would leave hourglass modes.
/// @throws InputError for another name, and for ggq-reduced2 at p <= 2
TargetSpace target_space(const std::string& interior_rule, int p);

/// Points of the rule on a run of `spans` spans: half the dimension (d - r) e + r + 1 of the space, rounded up.
std::int64_t run_points(const TargetSpace& space, std::int64_t spans);

/// Rule on a run of e spans of length one. Every node belongs to a span: a node on a knot must not be looked up again.
struct RunRule {
  std::vector<std::int32_t> first; ///< (e + 1); span i of the run owns nodes [i] … [i + 1) - 1, possibly none
  std::vector<double> position;    ///< (m); within the own span, 0 … 1; ascending along the run
  std::vector<double> weights;     ///< (m); positive, in spans: they sum to e

  std::int64_t spans() const { return static_cast<std::int64_t>(first.size()) - 1; }
  std::int32_t count(std::int64_t i) const {
    return first[static_cast<std::size_t>(i) + 1] - first[static_cast<std::size_t>(i)];
  }
};

/// The symmetric rule on a run, computed once and kept; may be called from several threads.
/// Hughes, Reali and Sangalli (2010); Bartoň and Calo (2016, 2017); Johannessen (2017).
/// @throws NumericalError where Newton's method does not reach rounding
std::shared_ptr<const RunRule> run_rule(const TargetSpace& space, std::int64_t spans);

} // namespace iga::prep
