// Interior spans are parted into boxes: the generalised rules save points on long runs, so few large boxes do best.
#pragma once

#include "format/model/types.hpp"
#include "preprocessor/interior/generalised_gauss.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace iga::prep {

/// Whole spans first … first + size - 1 in every direction.
struct SpanBox {
  Index3 first{};
  Index3 size{};
  bool operator==(const SpanBox&) const = default;
};

/// What rules on runs cost: points of a tensor rule on a box.
class BoxCost {
 public:
  /// @param longest  longest run in any direction, in spans
  BoxCost(const std::array<TargetSpace, 3>& spaces, std::int64_t longest);
  std::int64_t operator()(const Index3& size) const {
    return points_[0][static_cast<std::size_t>(size[0])] * points_[1][static_cast<std::size_t>(size[1])] *
           points_[2][static_cast<std::size_t>(size[2])];
  }
  /// True where no run is cheaper than its spans one by one.
  bool is_additive() const;

 private:
  std::array<std::vector<std::int64_t>, 3> points_; ///< (longest + 1)
};

/// Parts the INTERIOR spans into boxes with few points in all. Boxes grow from the middle of long runs, in several ways
/// of which the best stays; then every box with its neighbours is taken up and laid anew as long as that saves points.
/// Time and memory grow with the number of spans; the boxes do not depend on the number of threads.
/// @param state  (num_spans) SpanState, u fastest
std::vector<SpanBox> lay_boxes(const Index3& spans, const std::vector<std::uint8_t>& state, const BoxCost& cost);

} // namespace iga::prep
