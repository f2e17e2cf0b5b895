#include "solver/explicit/contact/coarsen_surface.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

namespace iga::solve {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
// Faces whose normals differ by more than 30 degrees meet in an edge that stays.
constexpr double sharp_cosine = 0.866;
// A face turns by no more than 30 degrees when one of its corners is merged into another vertex …
constexpr double turn_cosine = 0.866;
// … and no thinner than this, or than the thinnest of them was: twice the area by the square of the longest edge, 0.87
// for equilateral ones.
constexpr double least_shape = 0.2;

class Coarsening {
 public:
  Coarsening(const TriangleMesh& mesh, const CoarsenSettings& settings)
      : given_(mesh), settings_(settings), faces_(mesh.triangles), faces_of_(mesh.vertices.size()),
        merged_(mesh.triangles.size()), is_alive_(mesh.triangles.size(), 1), version_(mesh.vertices.size(), 0) {
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (const std::int32_t v : faces_[f]) faces_of_[at(v)].push_back(static_cast<std::int32_t>(f));
  }

  CoarseSurface run() {
    for (std::size_t v = 0; v < faces_of_.size(); ++v) offer(static_cast<std::int32_t>(v));
    while (!offers_.empty()) {
      const Offer offer = offers_.top();
      offers_.pop();
      if (offer.version == version_[at(offer.from)]) try_merge(offer.from);
    }
    return result();
  }

 private:
  /// A vertex that may be merged, by the shortest edge that it could go along.
  struct Offer {
    double length2 = 0;
    std::int32_t from = 0, version = 0;
    bool operator<(const Offer& other) const { // the shortest comes first
      return std::tie(other.length2, other.from, other.version) < std::tie(length2, from, version);
    }
  };

  const Point3& x(std::int32_t v) const { return given_.vertices[at(v)]; }
  Point3 normal(const Triangle& t) const { return twice_area(x(t[0]), x(t[1]), x(t[2])); }
  double length2(std::int32_t a, std::int32_t b) const {
    const Point3 way = minus(x(b), x(a));
    return dot(way, way);
  }

  double longest2(const Triangle& t) const {
    return std::max({length2(t[0], t[1]), length2(t[1], t[2]), length2(t[2], t[0])});
  }
  double shape(const Triangle& t) const {
    const double size = longest2(t);
    return size > 0 ? norm(normal(t)) / size : 0;
  }

  std::vector<std::int32_t> neighbours(std::int32_t v) const {
    std::vector<std::int32_t> all;
    for (const std::int32_t f : faces_of_[at(v)])
      for (const std::int32_t w : faces_[at(f)])
        if (w != v) all.push_back(w);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  std::vector<std::int32_t> faces_beside(std::int32_t v, std::int32_t w) const {
    std::vector<std::int32_t> both;
    for (const std::int32_t f : faces_of_[at(v)])
      if (std::count(faces_[at(f)].begin(), faces_[at(f)].end(), w) > 0) both.push_back(f);
    return both;
  }

  /// Is the edge one that stays: sharp, a border, between regions?
  bool is_kept(std::int32_t v, std::int32_t w) const {
    const auto both = faces_beside(v, w);
    if (both.size() != 2 || given_.region[at(both[0])] != given_.region[at(both[1])]) return true;
    const Point3 a = normal(faces_[at(both[0])]), b = normal(faces_[at(both[1])]);
    return dot(a, b) < sharp_cosine * norm(a) * norm(b);
  }

  void offer(std::int32_t v) {
    double shortest = inf;
    for (const std::int32_t w : neighbours(v)) shortest = std::min(shortest, length2(v, w));
    if (shortest < settings_.shortest * settings_.shortest) offers_.push({shortest, v, version_[at(v)]});
  }

  // Where the vertex may go without leaving a line that stays: all of them inside a patch, two on a straight line.
  std::vector<std::int32_t> targets(std::int32_t v) const {
    std::vector<std::int32_t> all = neighbours(v), kept;
    for (const std::int32_t w : all)
      if (is_kept(v, w)) kept.push_back(w);
    if (kept.empty()) return all;
    if (kept.size() != 2) return {};
    const Point3 a = minus(x(kept[0]), x(v)), b = minus(x(kept[1]), x(v));
    const Point3 off = cross(a, b);
    // Distance from the line through both ends.
    const double ends = std::sqrt(length2(kept[0], kept[1]));
    return dot(a, b) < 0 && norm(off) <= settings_.deviation * ends ? kept : std::vector<std::int32_t>{};
  }

  void try_merge(std::int32_t v) {
    auto to = targets(v);
    std::sort(to.begin(), to.end(), [&](std::int32_t a, std::int32_t b) {
      return std::pair(length2(v, a), a) < std::pair(length2(v, b), b);
    });
    for (const std::int32_t w : to) {
      if (length2(v, w) >= settings_.shortest * settings_.shortest) return;
      if (!keeps_connections(v, w)) continue;
      if (std::vector<Triangle> ring; fits(v, w, ring)) {
        merge(v, w);
        return;
      }
    }
  }

  // The only common neighbours are the corners across from the edge, and no face comes to lie on another one.
  bool keeps_connections(std::int32_t v, std::int32_t w) const {
    const auto a = neighbours(v), b = neighbours(w);
    std::vector<std::int32_t> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    const auto both = faces_beside(v, w);
    return both.size() == 2 && common.size() == 2 && faces_of_[at(v)].size() > 3;
  }

  // New faces are no thinner or longer than allowed, turn little, and all that was merged so far lies near to them.
  bool fits(std::int32_t v, std::int32_t w, std::vector<Triangle>& ring) {
    std::vector<std::int32_t> points{v};
    double allowed = least_shape;
    for (const std::int32_t f : faces_of_[at(v)]) allowed = std::min(allowed, shape(faces_[at(f)]));
    for (const std::int32_t f : faces_of_[at(v)]) {
      points.insert(points.end(), merged_[at(f)].begin(), merged_[at(f)].end());
      Triangle t = faces_[at(f)];
      if (std::count(t.begin(), t.end(), w) > 0) continue;
      const Point3 before = normal(t);
      std::replace(t.begin(), t.end(), v, w);
      const Point3 after = normal(t);
      if (longest2(t) > settings_.longest * settings_.longest) return false;
      if (!(shape(t) >= allowed)) return false;
      if (!(dot(before, after) >= turn_cosine * norm(before) * norm(after))) return false;
      ring.push_back(t);
    }
    largest_ = 0;
    for (const std::int32_t p : points) {
      double least = inf;
      for (const Triangle& t : ring) {
        const Point3 way = way_to_triangle({x(t[0]), x(t[1]), x(t[2])}, x(p));
        least = std::min(least, dot(way, way));
      }
      largest_ = std::max(largest_, std::sqrt(least));
    }
    return largest_ <= settings_.deviation;
  }

  void merge(std::int32_t v, std::int32_t w) {
    std::vector<std::int32_t> points{v}, touched = neighbours(v);
    for (const std::int32_t f : faces_of_[at(v)]) {
      points.insert(points.end(), merged_[at(f)].begin(), merged_[at(f)].end());
      merged_[at(f)].clear();
    }
    std::vector<std::int32_t> ring;
    for (const std::int32_t f : faces_of_[at(v)]) {
      Triangle& t = faces_[at(f)];
      if (std::count(t.begin(), t.end(), w) > 0) {
        is_alive_[at(f)] = 0;
        for (const std::int32_t u : t)
          if (u != v) std::erase(faces_of_[at(u)], f);
        continue;
      }
      std::replace(t.begin(), t.end(), v, w);
      faces_of_[at(w)].push_back(f);
      ring.push_back(f);
    }
    faces_of_[at(v)].clear();
    for (const std::int32_t p : points) { // each belongs to the face nearest to it
      double least = inf;
      std::int32_t nearest = ring.front();
      for (const std::int32_t f : ring) {
        const Triangle& t = faces_[at(f)];
        const Point3 way = way_to_triangle({x(t[0]), x(t[1]), x(t[2])}, x(p));
        if (const double d2 = dot(way, way); d2 < least) {
          least = d2;
          nearest = f;
        }
      }
      merged_[at(nearest)].push_back(p);
    }
    ++version_[at(v)];
    for (const std::int32_t u : touched) {
      ++version_[at(u)];
      offer(u);
    }
  }

  CoarseSurface result() const {
    CoarseSurface coarse;
    coarse.mesh.region_names = given_.region_names;
    std::vector<std::int32_t> number(faces_of_.size(), -1);
    for (std::size_t v = 0; v < faces_of_.size(); ++v) {
      if (faces_of_[v].empty()) continue;
      number[v] = static_cast<std::int32_t>(coarse.vertex.size());
      coarse.vertex.push_back(static_cast<std::int32_t>(v));
      coarse.mesh.vertices.push_back(given_.vertices[v]);
    }
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!is_alive_[f]) continue;
      const Triangle& t = faces_[f];
      coarse.mesh.triangles.push_back({number[at(t[0])], number[at(t[1])], number[at(t[2])]});
      coarse.mesh.region.push_back(given_.region[f]);
      for (const std::int32_t p : merged_[f]) {
        const Point3 way = way_to_triangle({x(t[0]), x(t[1]), x(t[2])}, x(p));
        coarse.deviation = std::max(coarse.deviation, norm(way));
      }
    }
    return coarse;
  }

  const TriangleMesh& given_;
  CoarsenSettings settings_;
  std::vector<Triangle> faces_;
  std::vector<std::vector<std::int32_t>> faces_of_; ///< of each vertex; empty once it is merged
  std::vector<std::vector<std::int32_t>> merged_;   ///< vertices that each face stands for
  std::vector<std::uint8_t> is_alive_;              ///< per face
  std::vector<std::int32_t> version_;               ///< per vertex: counts changes around it
  std::priority_queue<Offer> offers_;
  double largest_ = 0; ///< distance found by the last fits()
};

} // namespace

CoarseSurface coarsen(const TriangleMesh& mesh, const CoarsenSettings& settings) {
  return Coarsening(mesh, settings).run();
}

} // namespace iga::solve
