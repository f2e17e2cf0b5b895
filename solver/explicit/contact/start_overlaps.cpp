// How deep bodies lie in each other before the first step, however deep: what the narrow phase does not see counts too.
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/closest_point.hpp"
#include "solver/base/index.hpp"
#include "solver/explicit/contact/contact_model.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

// Direction of the rays that tell inside from outside: along no edge or face that a part would have.
const Point3 ray{0.5377, 0.6191, 0.5727};
// Faces that lie in each other no deeper than this, in spans, only touch.
constexpr double touching = 1e-6;

class Solid {
 public:
  explicit Solid(const MovingSurface& surface) : surface_(surface), boxes_(surface.mesh().triangles.size()) {
    for (std::size_t f = 0; f < boxes_.size(); ++f) {
      const Triangle& t = surface.mesh().triangles[f];
      boxes_[f] = {surface.x(t[0]), surface.x(t[0])};
      for (const std::int32_t v : t) boxes_[f] = join(boxes_[f], {surface.x(v), surface.x(v)});
      whole_ = f == 0 ? boxes_[f] : join(whole_, boxes_[f]);
    }
    tree_ = Bvh(boxes_);
  }

  /// Distance to the surface of a point inside; 0 outside.
  double depth(const Point3& x) const {
    if (!overlap({x, x}, whole_)) return 0;
    const double size = norm(minus(whole_.upper, whole_.lower));
    const Point3 end = plus(x, times(ray, 2 * size));
    int crossings = 0;
    tree_.each_on_segment(x, end, [&](std::int32_t f) { crossings += crosses(x, f) ? 1 : 0; });
    if (crossings % 2 == 0) return 0;
    return std::sqrt(tree_.least_distance2(x, [&](std::int32_t f) {
      const Triangle& t = surface_.mesh().triangles[at(f)];
      return closest_on_triangle(x, surface_.x(t[0]), surface_.x(t[1]), surface_.x(t[2])).distance2;
    }));
  }

 private:
  bool crosses(const Point3& x, std::int32_t f) const {
    const Triangle& t = surface_.mesh().triangles[at(f)];
    const Point3 a = minus(surface_.x(t[0]), x), b = minus(surface_.x(t[1]), x), c = minus(surface_.x(t[2]), x);
    const double u = dot(ray, cross(b, c)), v = dot(ray, cross(c, a)), w = dot(ray, cross(a, b));
    if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) return false;
    const Point3 n = cross(minus(b, a), minus(c, a));
    return dot(a, n) / dot(ray, n) > 0;
  }

  const MovingSurface& surface_;
  std::vector<Box3> boxes_;
  Box3 whole_{};
  Bvh tree_;
};

} // namespace

void ContactModel::refuse_deep_overlaps(std::span<const BodyState> bodies) {
  for (const StartOverlap& overlap : start_overlaps(bodies))
    if (overlap.is_deep())
      throw InputError(fmt::format("{}{}contact '{}': the bodies overlap by {:.4g} at the start near ({:.6g}, {:.6g}, "
                                   "{:.6g}), more than half a span ({:.4g}); move them apart",
                                   overlap.where, overlap.where.empty() ? "" : ": ", overlap.pair, overlap.depth,
                                   overlap.place[0], overlap.place[1], overlap.place[2], overlap.span_size));
  overlaps_are_checked_ = true;
}

std::vector<StartOverlap> ContactModel::start_overlaps(std::span<const BodyState> bodies) {
  for (MovingSurface& s : surfaces_) {
    if (s.is_rigid())
      s.move_all(rigid_[s.owner()]);
    else
      s.move_all(bodies[s.owner()]);
  }
  std::vector<StartOverlap> overlaps;
  for (const PairSearch& search : searches_) {
    if (search.is_self()) continue;
    const double h = surfaces_[search.first()].span_size();
    StartOverlap overlap{search.pair().name, search.pair().where, 0, {}, 0, h};
    const auto take = [&overlap](const Point3& x, double depth) {
      if (depth > overlap.depth) overlap.place = x;
      overlap.depth = std::max(overlap.depth, depth);
    };
    const auto add = [&](std::size_t surface, const auto& depth_of) {
      const MovingSurface& s = surfaces_[surface];
      const auto& chosen = search.mask(surface).vertex;
      std::vector<double> depth(chosen.size(), 0);
      tbb::parallel_for(std::size_t{0}, depth.size(), [&](std::size_t v) {
        if (chosen[v]) depth[v] = depth_of(s.positions()[v]);
      });
      for (std::size_t v = 0; v < depth.size(); ++v) {
        if (depth[v] <= touching * h) continue;
        ++overlap.vertices;
        take(s.positions()[v], depth[v]);
      }
    };
    if (search.second() == PairSearch::npos) {
      const RigidState& body = rigid_[search.pair().second.number];
      const RigidShape& shape = body.body().shape;
      add(search.first(), [&](const Point3& x) { return -distance_to_shape(shape, body.to_body(x)).gap; });
      // A small shape inside a large body holds none of its vertices.
      if (!std::holds_alternative<PlaneShape>(shape)) {
        const Point3 centre = body.to_space({});
        take(centre, Solid(surfaces_[search.first()]).depth(centre));
      }
    } else {
      const Solid first(surfaces_[search.first()]), second(surfaces_[search.second()]);
      add(search.first(), [&](const Point3& x) { return second.depth(x); });
      add(search.second(), [&](const Point3& x) { return first.depth(x); });
    }
    if (overlap.depth > touching * h) overlaps.push_back(overlap);
  }
  return overlaps;
}

} // namespace iga::solve
