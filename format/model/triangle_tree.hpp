// A tree of boxes over the triangles of a surface: what lies on a way, and what lies near.
#pragma once

#include "format/model/box.hpp"
#include "format/model/triangle_mesh.hpp"

#include <optional>

namespace iga {

/// The triangle nearest to a place, and the shortest way there.
struct NearestTriangle {
  std::size_t triangle = 0;
  Point3 way{}; ///< length
};

/// Median split along the longest axis, four triangles to a leaf. Safe to share between threads.
class TriangleTree {
 public:
  /// @param mesh  must outlive the tree
  explicit TriangleTree(const TriangleMesh& mesh);

  /// visit(triangle) for all triangles whose boxes the straight way from `from` to `from + way` meets.
  template <class Visit> void each_on_way(const Point3& from, const Point3& way, Visit&& visit) const {
    std::size_t node = 0;
    while (node < nodes_.size()) {
      const Node& n = nodes_[node];
      if (!meets(n.box, from, way)) {
        node = n.skip;
        continue;
      }
      for (std::size_t i = n.first; i < n.last; ++i) visit(static_cast<std::size_t>(items_[i]));
      ++node;
    }
  }

  /// visit(triangle) for all triangles whose boxes meet the box, and some beside them.
  template <class Visit> void each_in_box(const Box3& box, Visit&& visit) const {
    std::size_t node = 0;
    while (node < nodes_.size()) {
      const Node& n = nodes_[node];
      if (!overlap(n.box, box)) {
        node = n.skip;
        continue;
      }
      for (std::size_t i = n.first; i < n.last; ++i) visit(static_cast<std::size_t>(items_[i]));
      ++node;
    }
  }

  /// Distance to the nearest triangle, length; infinite where there is none.
  double distance(const Point3& x) const;

  /// The nearest triangle less than `reach` away; none where all are further.
  std::optional<NearestTriangle> nearest(const Point3& x, double reach) const;

  /// Winding number of a closed surface about x: crossings of a straight way that leads out, along one direction after
  /// the other until no crossing is in doubt. None on the surface, within rounding.
  std::optional<int> winding_number(const Point3& x) const;

 private:
  struct Node {
    Box3 box{};
    std::size_t first = 0, last = 0; ///< items of a leaf; none for inner nodes
    std::size_t skip = 0;            ///< the node after this one's subtree
    std::size_t second = 0;          ///< second child of an inner node; the first one follows its parent
  };
  static bool meets(const Box3& box, const Point3& from, const Point3& way);
  void build(std::vector<Point3>& middles, std::size_t first, std::size_t last);
  void search(std::size_t node, const Point3& x, double& reach, std::optional<NearestTriangle>& nearest) const;
  Box3 box_of(std::size_t triangle) const;

  const TriangleMesh* mesh_;
  std::vector<Node> nodes_; ///< preorder
  std::vector<std::int32_t> items_;
  double size_ = 0; ///< of the whole surface, length
};

} // namespace iga
