// Which points the interior spans get: tensor products of univariate rules, on single spans or on boxes of them.
#pragma once

#include "preprocessor/interior/generalised_gauss.hpp"
#include "preprocessor/interior/span_boxes.hpp"
#include "preprocessor/trim/trim.hpp"

namespace iga::prep {

/// The rule of every interior span. A generalised rule stands for a box of spans; a span owns the points that lie in
/// it, possibly none, and only the sum over the box integrates anything.
class InteriorRules {
 public:
  /// @param rule  gauss | ggq | ggq-reduced | ggq-reduced2; see target_space
  InteriorRules(const SplineGrid& grid, const Trimming& trimming, const std::string& rule);

  /// Boxes of spans that share a rule; 0 where every span stands for itself.
  std::int64_t num_boxes() const { return static_cast<std::int64_t>(boxes_.size()); }
  /// Points that an active interior span owns.
  std::int64_t count(std::size_t active) const;
  /// use(position in the span (0 … 1 each way), weight in spans) for each of them, u fastest.
  template <class Use> void for_points(std::size_t active, Use&& use) const {
    const Place place = place_of(active);
    const auto nodes = [&](std::size_t d, auto&& each) {
      const RunRule& rule = *place.rules[d];
      for (auto q = static_cast<std::size_t>(rule.first[place.span[d]]);
           q < static_cast<std::size_t>(rule.first[place.span[d] + 1]); ++q)
        each(rule.position[q], rule.weights[q]);
    };
    nodes(2, [&](double z, double c) {
      nodes(1, [&](double y, double b) { nodes(0, [&](double x, double a) { use(Point3{x, y, z}, a * b * c); }); });
    });
  }

 private:
  using Rules = std::array<std::shared_ptr<const RunRule>, 3>;
  struct Place {
    const Rules& rules;
    std::array<std::size_t, 3> span; // within the runs
  };
  Place place_of(std::size_t active) const;

  Index3 spans_;
  const Trimming& trimming_;
  std::vector<SpanBox> boxes_;
  Rules gauss_;                             // of spans with functions of their own
  std::vector<Rules> rules_;                // one a box, or a single one for all spans
  std::vector<std::int32_t> box_of_active_; // (num_active); empty without boxes, -1 for trimmed spans and at gap ends
};

} // namespace iga::prep
