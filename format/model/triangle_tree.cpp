#include "format/model/triangle_tree.hpp"

#include "format/model/line_crossing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace iga {

namespace {

constexpr std::size_t leaf_size = 4;
// No two components alike, and none that symmetric parts have.
constexpr std::array<Point3, 6> directions{{{0.8163, 0.4379, 0.3769},
                                            {-0.3137, 0.8461, 0.4309},
                                            {0.2711, -0.3907, 0.8797},
                                            {-0.6733, -0.5519, 0.4919},
                                            {0.5813, -0.7109, -0.3959},
                                            {-0.1931, 0.5237, -0.8297}}};

Point3 corner(const TriangleMesh& mesh, std::size_t triangle, std::size_t a) {
  return mesh.vertices[static_cast<std::size_t>(mesh.triangles[triangle][a])];
}

} // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(&mesh), items_(mesh.triangles.size()) {
  if (items_.empty()) return;
  std::iota(items_.begin(), items_.end(), 0);
  std::vector<Point3> middles(items_.size());
  for (std::size_t t = 0; t < items_.size(); ++t) {
    const Box3 box = box_of(t);
    middles[t] = times(plus(box.lower, box.upper), 0.5);
  }
  build(middles, 0, items_.size());
  size_ = norm(minus(nodes_[0].box.upper, nodes_[0].box.lower));
}

Box3 TriangleTree::box_of(std::size_t triangle) const {
  return bounding_box(
      std::array{corner(*mesh_, triangle, 0), corner(*mesh_, triangle, 1), corner(*mesh_, triangle, 2)});
}

void TriangleTree::build(std::vector<Point3>& middles, std::size_t first, std::size_t last) {
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box3 box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}}, spread = box;
  for (std::size_t i = first; i < last; ++i) {
    const auto t = static_cast<std::size_t>(items_[i]);
    const Box3 own = box_of(t);
    for (std::size_t d = 0; d < 3; ++d) {
      box.lower[d] = std::min(box.lower[d], own.lower[d]);
      box.upper[d] = std::max(box.upper[d], own.upper[d]);
      spread.lower[d] = std::min(spread.lower[d], middles[t][d]);
      spread.upper[d] = std::max(spread.upper[d], middles[t][d]);
    }
  }
  nodes_[node].box = box;
  if (last - first <= leaf_size) {
    nodes_[node].first = first;
    nodes_[node].last = last;
  } else {
    std::size_t axis = 0;
    for (std::size_t d = 1; d < 3; ++d)
      if (spread.upper[d] - spread.lower[d] > spread.upper[axis] - spread.lower[axis]) axis = d;
    const std::size_t half = first + (last - first) / 2;
    const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(half), at(last), [&](std::int32_t a, std::int32_t b) {
      const double x = middles[static_cast<std::size_t>(a)][axis], y = middles[static_cast<std::size_t>(b)][axis];
      return x != y ? x < y : a < b;
    });
    build(middles, first, half);
    nodes_[node].second = nodes_.size();
    build(middles, half, last);
  }
  nodes_[node].skip = nodes_.size();
}

bool TriangleTree::meets(const Box3& box, const Point3& from, const Point3& way) {
  // A box that is missed by less than rounding counts as met.
  constexpr double unit = 8 * std::numeric_limits<double>::epsilon();
  double enter = 0, leave = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    const double slack = unit * (std::abs(box.lower[d]) + std::abs(box.upper[d]) + std::abs(from[d]));
    const double low = box.lower[d] - slack - from[d], high = box.upper[d] + slack - from[d];
    if (way[d] == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double one = low / way[d], other = high / way[d];
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter <= leave + unit;
}

double TriangleTree::distance(const Point3& x) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto found = nearest(x, infinity);
  return found ? norm(found->way) : infinity;
}

std::optional<NearestTriangle> TriangleTree::nearest(const Point3& x, double reach) const {
  std::optional<NearestTriangle> found;
  if (!nodes_.empty()) search(0, x, reach, found);
  return found;
}

void TriangleTree::search(std::size_t node, const Point3& x, double& reach,
                          std::optional<NearestTriangle>& nearest) const {
  const Node& n = nodes_[node];
  if (squared_distance(n.box, x) > reach * reach) return;
  for (std::size_t i = n.first; i < n.last; ++i) {
    const auto triangle = static_cast<std::size_t>(items_[i]);
    const Point3 way = way_to_triangle(*mesh_, triangle, x);
    if (const double distance = norm(way); distance < reach) {
      reach = distance;
      nearest = NearestTriangle{triangle, way};
    }
  }
  if (n.second == 0) return;
  std::size_t one = node + 1, other = n.second;
  if (squared_distance(nodes_[other].box, x) < squared_distance(nodes_[one].box, x)) std::swap(one, other);
  search(one, x, reach, nearest);
  search(other, x, reach, nearest);
}

std::optional<int> TriangleTree::winding_number(const Point3& x) const {
  if (nodes_.empty() || squared_distance(nodes_[0].box, x) > 0) return 0;
  for (const Point3& direction : directions) {
    const Point3 way = times(direction, 2 * size_);
    int change = 0;
    bool sure = true;
    each_on_way(x, way, [&](std::size_t t) {
      if (!sure) return;
      const Point3 a = corner(*mesh_, t, 0);
      const std::optional<int> own =
          winding_change(x, way, a, minus(corner(*mesh_, t, 1), a), minus(corner(*mesh_, t, 2), a));
      sure = own.has_value();
      if (sure) change += *own;
    });
    if (sure) return -change; // outside everything it is 0
  }
  return std::nullopt;
}

} // namespace iga
