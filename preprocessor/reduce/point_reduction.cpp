#include "preprocessor/reduce/point_reduction.hpp"

#include <algorithm>
#include <numeric>

namespace iga::prep {

namespace {

// Residuals between removals; the last rule is polished. Parts on which that fails are worked through once more with
// exact rules all the way.
constexpr double loose_residual = 1e-6;
constexpr double tight_residual = 1e-12;
constexpr double polished_residual = 1e-13;
// Removals that cost more (PointRelocator::rank) hardly ever succeed: of 700 none did.
constexpr double hopeless = 20;
// Points are removed together while the sum of their costs stays below this.
constexpr double cheap = 0.02;
constexpr std::size_t most_together = 6;
constexpr std::size_t most_attempts = 25;
// The bounded descent is tried where a rule stalls at more than this many times the least number of points, on the
// cheapest points: elsewhere it wins one time in five and doubles the whole cost.
constexpr double stalled = 1.5;
constexpr std::size_t bounded_attempts = 3;

} // namespace

void PointReducer::reduce(const std::array<int, 3>& degree, std::span<const double> moments, int fixed_axis,
                          std::size_t least, double tolerance, PointSet& points) {
  relocator_.start(degree, moments, fixed_axis);
  const auto unknowns = static_cast<std::size_t>(relocator_.equations().unknowns());
  least = std::max(least, (moments.size() + unknowns - 1) / unknowns);
  if (points.size() <= least) return;
  if (eliminate(least, loose_residual, tolerance, points) || eliminate(least, tight_residual, tolerance, points)) {
    counts_ += run_;
    if (state_.size() < points.size()) {
      points = state_;
      return;
    }
  }
  ++counts_.unchanged;
}

// From `points` to state_, run_; false where state_ does not fulfil its moments in the end or
// a point is not proven to lie in the solid.
bool PointReducer::eliminate(std::size_t least, double loose, double tolerance, const PointSet& points) {
  run_ = {};
  state_ = relocator_.measured(points);
  Metric metric = Metric::Even;
  bool several = true, stalled_once = false;
  while (state_.size() > least) {
    if (remove_some(least, loose, metric, several)) continue;
    if (metric == Metric::Even) {
      metric = Metric::Near;
      state_ = relocator_.measured(state_);
      continue;
    }
    if (static_cast<double>(state_.size()) <= stalled * static_cast<double>(least)) break;
    if (!stalled_once) ++run_.stalls;
    stalled_once = true;
    if (!remove_bounded(loose)) break;
    metric = Metric::Even;
  }
  if (!relocator_.relocate(state_, Metric::Even, polished_residual) && !(relocator_.reached() <= 0.1 * tolerance))
    return false;
  return relocator_.holds(state_);
}

void PointReducer::sort_by_cost() {
  order_.resize(cost_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return cost_[a] < cost_[b]; });
}

bool PointReducer::remove_some(std::size_t least, double loose, Metric metric, bool& several) {
  if (!relocator_.rank(state_, metric, cost_)) return false;
  sort_by_cost();
  std::size_t together = 1;
  if (several) {
    const std::size_t most = std::min(most_together, state_.size() - least);
    double sum = cost_[order_[0]];
    while (together < most && sum + cost_[order_[together]] < cheap) sum += cost_[order_[together++]];
    several = together > 1;
  }
  std::vector<std::size_t> removed;
  const auto without = [&](std::size_t first, std::size_t count) {
    removed.assign(order_.begin() + static_cast<std::ptrdiff_t>(first),
                   order_.begin() + static_cast<std::ptrdiff_t>(first + count));
    std::sort(removed.begin(), removed.end());
    if (!relocator_.relocate_without(state_, removed, loose, next_)) return false;
    std::swap(state_, next_);
    run_.newton += static_cast<std::int64_t>(count);
    return true;
  };
  if (together > 1) {
    if (without(0, together)) return true;
    several = false;
  }
  for (std::size_t t = 0; t < std::min(state_.size(), most_attempts) && cost_[order_[t]] <= hopeless; ++t)
    if (without(t, 1)) return true;
  return false;
}

bool PointReducer::remove_bounded(double loose) {
  if (!relocator_.rank(state_, Metric::Even, cost_)) return false;
  sort_by_cost();
  for (std::size_t t = 0; t < bounded_attempts; ++t) {
    next_ = state_;
    next_.drop(order_[t]);
    if (!relocator_.relocate_bounded(next_, loose)) continue;
    std::swap(state_, next_);
    ++run_.bounded;
    return true;
  }
  return false;
}

} // namespace iga::prep
