#include "preprocessor/interior/interior_rules.hpp"

#include "format/model/span_state.hpp"

#include <algorithm>

namespace iga::prep {

InteriorRules::InteriorRules(const SplineGrid& grid, const Trimming& trimming, const std::string& rule)
    : spans_(grid.spans()), trimming_(trimming) {
  std::array<TargetSpace, 3> spaces;
  // Spans with functions of their own are exact by themselves.
  for (std::size_t d = 0; d < 3; ++d) gauss_[d] = run_rule(target_space("gauss", grid.degree()[d]), 1);
  for (std::size_t d = 0; d < 3; ++d) spaces[d] = target_space(rule, grid.degree()[d]);
  const std::vector<std::int64_t>& active = trimming.active;
  const BoxCost cost(spaces, *std::max_element(spans_.begin(), spans_.end()));
  if (cost.is_additive()) {
    rules_.push_back({run_rule(spaces[0], 1), run_rule(spaces[1], 1), run_rule(spaces[2], 1)});
    return;
  }
  std::vector<std::uint8_t> state; // boxes leave out cells at gap ends
  if (!trimming.gap_end.empty()) {
    state = trimming.state;
    for (std::size_t a = 0; a < active.size(); ++a)
      if (trimming.is_at_gap_end(a))
        state[static_cast<std::size_t>(active[a])] = static_cast<std::uint8_t>(SpanState::Trimmed);
  }
  boxes_ = lay_boxes(spans_, state.empty() ? trimming.state : state, cost);
  box_of_active_.assign(active.size(), -1);
  rules_.reserve(boxes_.size());
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const SpanBox& box = boxes_[b];
    rules_.push_back(
        {run_rule(spaces[0], box.size[0]), run_rule(spaces[1], box.size[1]), run_rule(spaces[2], box.size[2])});
    for (std::int64_t k = 0; k < box.size[2]; ++k)
      for (std::int64_t j = 0; j < box.size[1]; ++j) {
        // All spans of a row are active, so they follow each other in the list.
        const std::int64_t first = grid.span_number({box.first[0], box.first[1] + j, box.first[2] + k});
        const auto row = std::lower_bound(active.begin(), active.end(), first) - active.begin();
        std::fill_n(box_of_active_.begin() + row, box.size[0], static_cast<std::int32_t>(b));
      }
  }
}

InteriorRules::Place InteriorRules::place_of(std::size_t active) const {
  if (trimming_.is_at_gap_end(active)) return {gauss_, {0, 0, 0}};
  if (box_of_active_.empty()) return {rules_.front(), {0, 0, 0}};
  const auto b = static_cast<std::size_t>(box_of_active_[active]);
  const Index3& first = boxes_[b].first;
  const std::int64_t s = trimming_.active[active];
  const Index3 ijk{s % spans_[0], s / spans_[0] % spans_[1], s / (spans_[0] * spans_[1])};
  Place place{rules_[b], {}};
  for (std::size_t d = 0; d < 3; ++d) place.span[d] = static_cast<std::size_t>(ijk[d] - first[d]);
  return place;
}

std::int64_t InteriorRules::count(std::size_t active) const {
  const Place place = place_of(active);
  std::int64_t count = 1;
  for (std::size_t d = 0; d < 3; ++d) count *= place.rules[d]->count(static_cast<std::int64_t>(place.span[d]));
  return count;
}

} // namespace iga::prep
