// The greedy boxes of Messmer et al. (2022), section 3.2.1, as something to compare with.
#pragma once

#include "preprocessor/interior/span_boxes.hpp"

namespace iga::test {

/// Each span is rated by L (1 - 0.9 |i - (L - 1) / 2| / ((L - 1) / 2)) over its runs in the three directions; a box
/// starts at the best span left and grows by the face layer with the largest summed rating.
std::vector<prep::SpanBox> greedy_boxes(const Index3& spans, const std::vector<std::uint8_t>& state);

} // namespace iga::test
