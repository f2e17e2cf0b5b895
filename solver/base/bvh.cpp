#include "solver/base/bvh.hpp"

#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace iga::solve {

namespace {

constexpr std::size_t leaf_size = 4;
constexpr std::size_t part_size = 512; // items whose boxes one thread fits

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr Box3 empty_box{{inf, inf, inf}, {-inf, -inf, -inf}};

} // namespace

Bvh::Bvh(std::span<const Box3> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  if (!boxes.empty()) build(boxes, 0, boxes.size());
  refit(boxes);
}

void Bvh::build(std::span<const Box3> boxes, std::size_t first, std::size_t last) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  const bool is_part = last - first <= part_size && (parts_.empty() || nodes_[parts_.back()].skip > 0);
  if (is_part) parts_.push_back(self);
  if (last - first <= leaf_size) {
    nodes_[self].first = first;
    nodes_[self].last = last;
  } else {
    const auto middle = [&](std::int32_t i, std::size_t d) { return boxes[at(i)].lower[d] + boxes[at(i)].upper[d]; };
    std::size_t axis = 0;
    double longest = -1;
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [low, high] = std::minmax_element(
          items_.begin() + static_cast<std::ptrdiff_t>(first), items_.begin() + static_cast<std::ptrdiff_t>(last),
          [&](std::int32_t a, std::int32_t b) { return middle(a, d) < middle(b, d); });
      if (const double length = middle(*high, d) - middle(*low, d); length > longest) {
        longest = length;
        axis = d;
      }
    }
    const std::size_t half = first + (last - first) / 2;
    std::nth_element(items_.begin() + static_cast<std::ptrdiff_t>(first),
                     items_.begin() + static_cast<std::ptrdiff_t>(half),
                     items_.begin() + static_cast<std::ptrdiff_t>(last), [&](std::int32_t a, std::int32_t b) {
                       const double x = middle(a, axis), y = middle(b, axis);
                       return x != y ? x < y : a < b;
                     });
    build(boxes, first, half);
    nodes_[self].second = nodes_.size();
    build(boxes, half, last);
  }
  nodes_[self].skip = nodes_.size();
}

void Bvh::refit(std::span<const Box3> boxes, std::span<const Box3> directions) {
  boxes_.resize(boxes.size());
  for_indices(boxes_.size(), 1024, [&](std::size_t i) { boxes_[i] = boxes[at(items_[i])]; });
  // Children come after their parents: parts by themselves, then what lies above them.
  for_indices(parts_.size(), 1, [&](std::size_t p) {
    for (std::size_t n = nodes_[parts_[p]].skip; n-- > parts_[p];) fit(n, directions);
  });
  std::size_t p = parts_.size();
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    if (p > 0 && n < nodes_[parts_[p - 1]].skip && n >= parts_[p - 1]) {
      n = parts_[--p]; // this one is fitted
      continue;
    }
    fit(n, directions);
  }
}

void Bvh::fit(std::size_t n, std::span<const Box3> directions) {
  Node& node = nodes_[n];
  node.box = node.directions = empty_box;
  if (node.second > 0) {
    node.box = join(nodes_[n + 1].box, nodes_[node.second].box);
    node.directions = join(nodes_[n + 1].directions, nodes_[node.second].directions);
  }
  for (std::size_t i = node.first; i < node.last; ++i) {
    node.box = join(node.box, boxes_[i]);
    if (!directions.empty()) node.directions = join(node.directions, directions[at(items_[i])]);
  }
}

} // namespace iga::solve
