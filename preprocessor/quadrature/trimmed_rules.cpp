#include "preprocessor/quadrature/trimmed_rules.hpp"

#include "format/model/errors.hpp"
#include "format/model/span_state.hpp"
#include "preprocessor/reduce/span_reduction.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <utility>

namespace iga::prep {

namespace {

std::size_t touched(const Trimming& trimming, std::size_t active) {
  return static_cast<std::size_t>(trimming.touched[active]);
}

void append(TrimmedRules::Block& block, const SpanRule& rule) {
  block.points.insert(block.points.end(), rule.points.begin(), rule.points.end());
  block.weights.insert(block.weights.end(), rule.weights.begin(), rule.weights.end());
  block.residual.push_back(rule.residual);
  block.count.push_back(static_cast<std::uint32_t>(rule.weights.size()));
  block.shape.push_back(rule.shape);
  block.axis.push_back(static_cast<std::int8_t>(rule.axis));
}

// Active spans of block b, one after the other.
template <class Visit> void for_trimmed(const Trimming& trimming, std::size_t b, const Visit& visit) {
  const std::size_t first = b * TrimmedRules::spans_per_block;
  const std::size_t last = std::min(trimming.active.size(), first + TrimmedRules::spans_per_block);
  for (std::size_t a = first; a < last; ++a)
    if (!is_interior(trimming, a)) visit(a);
}

} // namespace

bool is_interior(const Trimming& trimming, std::size_t active) {
  return trimming.state[static_cast<std::size_t>(trimming.active[active])] ==
         static_cast<std::uint8_t>(SpanState::Interior);
}

TrimmedRules::TrimmedRules(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options)
    : grid_(&grid), trimming_(&trimming), far_(grid, trimming, options.moment_degree),
      blocks_((trimming.active.size() + spans_per_block - 1) / spans_per_block) {
  tbb::enumerable_thread_specific<MomentFitter> fitters(
      [&] { return MomentFitter(grid, trimming, far_, options.moment_degree, options.tolerance); });
  // A cell with functions of its own is held by its neighbours less than others are: with moments of degree p it may
  // have mechanisms (seen at p = 3), with p + 1 it has more points than its stiffness has rank.
  std::array<int, 3> own_degree = options.moment_degree;
  for (std::size_t d = 0; d < 3; ++d) own_degree[d] = std::max(own_degree[d], grid.degree()[d] + 1);
  if (!trimming.gap_end.empty()) gap_end_far_ = std::make_unique<FarMoments>(grid, trimming, own_degree);
  tbb::enumerable_thread_specific<MomentFitter> own_fitters(
      [&] { return MomentFitter(grid, trimming, *gap_end_far_, own_degree, options.tolerance); });
  const auto total = static_cast<std::int64_t>(blocks_.size());
  std::atomic<std::int64_t> done{0};
  std::vector<std::vector<std::int64_t>> failed(blocks_.size());
  std::vector<QuadratureCounts> counts(blocks_.size());
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t b) {
    if (options.cancelled && options.cancelled()) throw Cancelled{};
    for_trimmed(trimming, b, [&](std::size_t a) {
      const bool own = trimming.is_at_gap_end(a);
      MomentFitter& fitter = own ? own_fitters.local() : fitters.local();
      const SpanRule& rule = fitter.fit(touched(trimming, a));
      append(blocks_[b], own ? resisting_rule(fitter.part(), rule, grid.degree()) : rule);
      counts[b].box_spans += rule.shape == SpanShape::Box;
      counts[b].prism_spans += rule.shape == SpanShape::Prism;
      counts[b].fitted_spans += rule.shape == SpanShape::Free;
      counts[b].refined_spans += rule.refined;
      if (!(rule.residual <= options.tolerance) || rule.weights.empty()) failed[b].push_back(trimming.active[a]);
    });
    const std::int64_t now = ++done;
    if (options.progress) options.progress(now, total);
  });
  std::vector<std::int64_t> all;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    all.insert(all.end(), failed[b].begin(), failed[b].end());
    counts_.box_spans += counts[b].box_spans;
    counts_.prism_spans += counts[b].prism_spans;
    counts_.fitted_spans += counts[b].fitted_spans;
    counts_.refined_spans += counts[b].refined_spans;
  }
  if (!all.empty()) report(all, options.tolerance);
}

void TrimmedRules::report(const std::vector<std::int64_t>& failed, double tolerance) const {
  std::string list;
  for (std::size_t f = 0; f < std::min<std::size_t>(failed.size(), 5); ++f) {
    const Index3 ijk = grid_->span_index(failed[f]);
    list += fmt::format("{}({}, {}, {})", f ? ", " : "", ijk[0], ijk[1], ijk[2]);
  }
  throw NumericalError(
      fmt::format("{} trimmed span{} did not reach the moment residual {:.3g}: {}{}; choose another span "
                  "size or shift the grid, or raise --tolerance",
                  failed.size(), failed.size() == 1 ? "" : "s", tolerance, list, failed.size() > 5 ? ", …" : ""));
}

namespace {

// The rule that starts at point `first` of a block.
SpanRule extract(const TrimmedRules::Block& block, std::size_t span, std::size_t first) {
  const auto part = [&](const std::vector<double>& values, std::size_t width) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(width * first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(width * block.count[span]));
  };
  SpanRule rule;
  rule.points = part(block.points, 3);
  rule.weights = part(block.weights, 1);
  rule.residual = block.residual[span];
  rule.shape = block.shape[span];
  rule.axis = block.axis[span];
  return rule;
}

} // namespace

void TrimmedRules::reduce(const QuadratureOptions& options) {
  tbb::enumerable_thread_specific<SpanReducer> reducers([&] {
    return SpanReducer(*grid_, *trimming_, far_, options.moment_degree, options.tolerance, options.rank_bound);
  });
  // The work lies in the trimmed spans alone: they are what the time left is told by.
  std::int64_t total = 0;
  for (const Block& block : blocks_) total += static_cast<std::int64_t>(block.count.size());
  std::atomic<std::int64_t> done{0}, kept{0};
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t b) {
    const Block fitted = std::exchange(blocks_[b], {});
    SpanReducer& reducer = reducers.local();
    std::size_t span = 0, first = 0;
    for_trimmed(*trimming_, b, [&](std::size_t a) {
      SpanRule rule = extract(fitted, span, first);
      first += rule.weights.size();
      ++span;
      if (!trimming_->is_at_gap_end(a)) {
        if (options.cancelled && options.cancelled())
          ++kept;
        else
          reducer.reduce(touched(*trimming_, a), rule);
      }
      append(blocks_[b], rule);
    });
    const std::int64_t now = done += static_cast<std::int64_t>(span);
    if (options.progress) options.progress(now, total);
  });
  reduced_ = true;
  counts_.kept_spans = kept;
  for (const SpanReducer& reducer : reducers) counts_.reduction += reducer.counts();
}

SpanRule TrimmedRules::rule(std::size_t a) const {
  const std::size_t b = a / spans_per_block;
  std::size_t span = 0, first = 0;
  SpanRule found;
  for_trimmed(*trimming_, b, [&](std::size_t other) {
    if (other < a) first += blocks_[b].count[span++];
    if (other == a) found = extract(blocks_[b], span, first);
  });
  return found;
}

// Puts rules of other lengths into the blocks. @param rules  ascending by active span
void TrimmedRules::replace(const std::vector<std::pair<std::size_t, SpanRule>>& rules) {
  for (std::size_t i = 0; i < rules.size();) {
    const std::size_t b = rules[i].first / spans_per_block;
    const Block old = std::exchange(blocks_[b], {});
    std::size_t span = 0, first = 0;
    for_trimmed(*trimming_, b, [&](std::size_t a) {
      if (i < rules.size() && rules[i].first == a)
        append(blocks_[b], rules[i++].second);
      else
        append(blocks_[b], extract(old, span, first));
      first += old.count[span++];
    });
  }
}

} // namespace iga::prep
