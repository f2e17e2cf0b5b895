// A tree of boxes over numbered items, built once and fitted anew to items that moved.
#pragma once

#include "format/model/box.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace iga::solve {

inline Box3 grown(Box3 box, double by) {
  for (std::size_t d = 0; d < 3; ++d) box.lower[d] -= by, box.upper[d] += by;
  return box;
}

/// Median split along the longest axis, four items to a leaf. The order of visits depends on the boxes it was built
/// with alone.
class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(std::span<const Box3> boxes);
  bool empty() const { return nodes_.empty(); }
  /// New boxes of the same items, and boxes that hold the items' directions (or none). @param boxes as many as before
  void refit(std::span<const Box3> boxes, std::span<const Box3> directions = {});

  /// visit(item) for all items whose box overlaps the query.
  template <class Visit> void each_overlap(const Box3& query, Visit&& visit) const {
    each_overlap(
        query, [](const Box3&) { return false; }, visit);
  }
  /// Leaves out parts where pass_over(box) holds for a box that encloses the directions of all items of the part.
  template <class PassOver, class Visit>
  void each_overlap(const Box3& query, PassOver&& pass_over, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::size_t node = 0;
    while (node < nodes_.size()) {
      const Node& n = nodes_[node];
      if (!overlap(n.box, query) || pass_over(n.directions)) {
        node = n.skip;
        continue;
      }
      for (std::size_t i = n.first; i < n.last; ++i)
        if (overlap(boxes_[i], query)) visit(items_[i]);
      ++node;
    }
  }
  /// visit(item) for all items whose box the segment from `from` to `to` meets: far fewer than those of the box around
  /// an oblique segment.
  template <class Visit> void each_on_segment(const Point3& from, const Point3& to, Visit&& visit) const {
    std::size_t node = 0;
    while (node < nodes_.size()) {
      const Node& n = nodes_[node];
      if (!meets(n.box, from, to)) {
        node = n.skip;
        continue;
      }
      for (std::size_t i = n.first; i < n.last; ++i)
        if (meets(boxes_[i], from, to)) visit(items_[i]);
      ++node;
    }
  }
  /// Least of distance2(item), the squared distance of `x` to an item, over all items; infinite where there are none.
  template <class Distance2> double least_distance2(const Point3& x, Distance2&& distance2) const {
    double least = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty()) {
      const std::size_t node = open.back();
      const Node& n = nodes_[node];
      open.pop_back();
      if (distance2_to(n.box, x) > least) continue;
      for (std::size_t i = n.first; i < n.last; ++i)
        if (distance2_to(boxes_[i], x) <= least) least = std::min(least, distance2(items_[i]));
      if (n.second == 0) continue;
      // The nearer child is looked at first: it is on top.
      const bool first_is_nearer = distance2_to(nodes_[node + 1].box, x) <= distance2_to(nodes_[n.second].box, x);
      open.push_back(first_is_nearer ? n.second : node + 1);
      open.push_back(first_is_nearer ? node + 1 : n.second);
    }
    return least;
  }
  /// visit(a, b) for every item a of this tree and b of the other one whose boxes come within `reach` of each other,
  /// once. Leaves out parts where pass_over(directions of one part, of the other one) holds.
  template <class PassOver, class Visit>
  void each_close_pair(const Bvh& other, double reach, PassOver&& pass_over, Visit&& visit) const {
    for (const PartPair& parts : close_parts(other, reach, pass_over, 1))
      each_close_pair(parts, other, reach, pass_over, visit);
  }
  /// A part of this tree and one of another.
  using PartPair = std::pair<std::size_t, std::size_t>;
  /// Pairs of parts that hold all of these pairs of items, each in one of them: `wanted` or a few more where the trees
  /// are large enough. For work in parallel; the same whatever the number of threads.
  template <class PassOver>
  std::vector<PartPair> close_parts(const Bvh& other, double reach, PassOver&& pass_over, std::size_t wanted) const {
    std::vector<PartPair> parts, next;
    if (!nodes_.empty() && !other.nodes_.empty()) parts.emplace_back(0, 0);
    bool splits = true;
    while (splits && parts.size() < wanted) {
      next.clear();
      splits = false;
      for (const auto& [i, j] : parts) {
        const Node &a = nodes_[i], &b = other.nodes_[j];
        if (!within(a.box, b.box, reach) || pass_over(a.directions, b.directions)) continue;
        splits = split(i, j, other, next) || splits;
        if (a.second == 0 && b.second == 0) next.emplace_back(i, j);
      }
      parts.swap(next);
    }
    return parts;
  }
  /// The pairs of two parts: PartPair of close_parts with the same arguments.
  template <class PassOver, class Visit>
  void each_close_pair(const PartPair& parts, const Bvh& other, double reach, PassOver&& pass_over,
                       Visit&& visit) const {
    std::vector<PartPair> open{parts};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      const Node &a = nodes_[i], &b = other.nodes_[j];
      if (!within(a.box, b.box, reach) || pass_over(a.directions, b.directions)) continue;
      if (split(i, j, other, open)) continue;
      for (std::size_t k = a.first; k < a.last; ++k)
        for (std::size_t l = b.first; l < b.last; ++l)
          if (within(boxes_[k], other.boxes_[l], reach)) visit(items_[k], other.items_[l]);
    }
  }

 private:
  /// Adds the two pairs that a pair of parts falls into; false for two leaves.
  bool split(std::size_t i, std::size_t j, const Bvh& other, std::vector<PartPair>& to) const {
    const Node &a = nodes_[i], &b = other.nodes_[j];
    if (a.second == 0 && b.second == 0) return false;
    if (b.second == 0 || (a.second > 0 && size(a.box) >= size(b.box)))
      to.insert(to.end(), {{i + 1, j}, {a.second, j}});
    else
      to.insert(to.end(), {{i, j + 1}, {i, b.second}});
    return true;
  }
  void fit(std::size_t node, std::span<const Box3> directions);
  struct Node {
    Box3 box{}, directions{};
    std::size_t first = 0, last = 0; ///< items of a leaf; none for inner nodes
    std::size_t skip = 0;            ///< the node after this one's subtree
    std::size_t second = 0;          ///< second child of an inner node; the first one follows its parent
  };
  static bool within(const Box3& a, const Box3& b, double reach) {
    for (std::size_t d = 0; d < 3; ++d)
      if (a.lower[d] > b.upper[d] + reach || b.lower[d] > a.upper[d] + reach) return false;
    return true;
  }
  /// Slabs, with room for rounding: a box that is barely missed counts as met.
  static bool meets(const Box3& box, const Point3& from, const Point3& to) {
    constexpr double room = 1e-9; // of the segment
    double enter = 0, leave = 1;
    for (std::size_t d = 0; d < 3; ++d) {
      const double way = to[d] - from[d];
      if (way == 0) {
        if (from[d] < box.lower[d] || from[d] > box.upper[d]) return false;
        continue;
      }
      const double a = (box.lower[d] - from[d]) / way, b = (box.upper[d] - from[d]) / way;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave + room;
  }
  static double distance2_to(const Box3& box, const Point3& x) {
    double sum = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double gap = std::max({0.0, box.lower[d] - x[d], x[d] - box.upper[d]});
      sum += gap * gap;
    }
    return sum;
  }
  static double size(const Box3& box) {
    return box.upper[0] - box.lower[0] + box.upper[1] - box.lower[1] + box.upper[2] - box.lower[2];
  }
  void build(std::span<const Box3> boxes, std::size_t first, std::size_t last);

  std::vector<Node> nodes_;        ///< preorder
  std::vector<std::size_t> parts_; ///< roots of subtrees of some hundred items, which hold all leaves
  std::vector<std::int32_t> items_;
  std::vector<Box3> boxes_; ///< in the order of items_
};

} // namespace iga::solve
