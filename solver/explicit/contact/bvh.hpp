// A tree of boxes over numbered items, built once and fitted anew to items that moved.
#pragma once

#include "format/model/types.hpp"

#include <span>
#include <vector>

namespace iga::solve {

inline bool overlap(const Box3& a, const Box3& b) {
  return a.lower[0] <= b.upper[0] && b.lower[0] <= a.upper[0] && a.lower[1] <= b.upper[1] && b.lower[1] <= a.upper[1] &&
         a.lower[2] <= b.upper[2] && b.lower[2] <= a.upper[2];
}

/// Median split along the longest axis, four items to a leaf. The order of visits depends on the boxes it was built
/// with alone.
class Bvh {
 public:
  Bvh() = default;
  explicit Bvh(std::span<const Box3> boxes);
  /// New boxes of the same items, and the items' directions (or none). @param boxes as many as before
  void refit(std::span<const Box3> boxes, std::span<const Point3> directions = {});

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

 private:
  struct Node {
    Box3 box{}, directions{};
    std::size_t first = 0, last = 0; ///< items of a leaf; none for inner nodes
    std::size_t skip = 0;            ///< the node after this one's subtree
    std::size_t second = 0;          ///< second child of an inner node; the first one follows its parent
  };
  void build(std::span<const Box3> boxes, std::size_t first, std::size_t last);

  std::vector<Node> nodes_; ///< preorder
  std::vector<std::int32_t> items_;
  std::vector<Box3> boxes_; ///< in the order of items_
};

} // namespace iga::solve
