// Covered parts are taken out of what is left of a triangle facet by facet, so that patches whose facets overlap, or
// that were written twice, cover no surface twice.
#include "solver/space/surface_patch.hpp"

#include "format/io/file_bytes.hpp"
#include "format/io/stl_reader.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>

namespace iga::solve {

namespace {

// Facets steeper than 45° against a triangle do not cover it: the other side of an edge.
constexpr double least_cosine = 0.7071;
// Neighbouring facets at more than 45° meet at an edge; below they stand for a round face.
constexpr double round_cosine = 0.7071;
// Patches that find surface for less than this share of them are warned of.
constexpr double least_share = 0.9;
// STL files hold single precision.
constexpr double single_rounding = 1e-6;
// Pieces smaller than this share of their triangle are rounding of the cuts.
constexpr double negligible_share = 1e-13;

std::array<Point3, 3> corners(const TriangleMesh& mesh, std::size_t t) {
  std::array<Point3, 3> x;
  for (std::size_t a = 0; a < 3; ++a) x[a] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][a])];
  return x;
}

double largest_coordinate(const Box3& box) {
  double largest = 0;
  for (std::size_t d = 0; d < 3; ++d) largest = std::max({largest, std::abs(box.lower[d]), std::abs(box.upper[d])});
  return largest;
}

// Largest height of the arcs that two neighbouring facets of a round face stand for, of facets that reach into a box.
double facet_depth(const TriangleMesh& mesh, const Box3& box) {
  struct Side {
    Point3 normal{};
    double height = 0; ///< of the facet above the edge
  };
  std::map<std::pair<Point3, Point3>, Side> edges; // STL facets share no vertices, only their places
  double depth = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto x = corners(mesh, t);
    if (!overlap(bounding_box(x), box)) continue;
    const Point3 twice = twice_area(x[0], x[1], x[2]);
    const double size = norm(twice);
    if (!(size > 0)) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [first, second] = std::minmax(x[a], x[(a + 1) % 3]);
      const Side side{times(twice, 1 / size), size / norm(minus(second, first))};
      const auto [other, is_new] = edges.try_emplace({first, second}, side);
      if (is_new) continue;
      const double cosine = std::clamp(std::abs(dot(other->second.normal, side.normal)), 0.0, 1.0);
      if (cosine < round_cosine) continue;
      // A chord L whose arc turns by θ lies L/2 tan(θ/4) below its arc.
      depth = std::max(depth, 0.5 * std::max(side.height, other->second.height) * std::tan(std::acos(cosine) / 4));
    }
  }
  return depth;
}

} // namespace

SurfacePatch::SurfacePatch(const TrimmedModel& model, const RegionChoice::Patch& choice, const std::string& what)
    : model_(model), name_(choice.file.string()), chosen_tolerance_(!choice.tolerance), snap_(surface_depth(model)) {
  mesh_ = io::read_stl(io::read_bytes(choice.file, "an STL file"), name_, 1).mesh;
  std::vector<Box3> boxes;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto x = corners(mesh_, t);
    const Point3 twice = twice_area(x[0], x[1], x[2]);
    const double size = norm(twice);
    normals_.push_back(size > 0 ? times(twice, 1 / size) : Point3{});
    area_ += 0.5 * size;
    boxes.push_back(bounding_box(x));
  }
  if (!(area_ > 0)) throw InputError(fmt::format("{}: the patch {} has no area", what, name_));
  facets_ = Bvh(boxes);
  const Box3 box = bounding_box(mesh_);
  const double rounding = single_rounding * largest_coordinate(box);
  if (choice.tolerance) {
    tolerance_ = *choice.tolerance;
    if (!(tolerance_ >= 0))
      throw InputError(fmt::format("{}: the patch's tolerance is {}, expected 0 or more", what, tolerance_));
    return;
  }
  const double patch = facet_depth(mesh_, box);
  tolerance_ = 2 * (patch + facet_depth(model.surface.mesh, grown(box, patch))) + snap_ + rounding;
}

std::vector<ConvexPolygon> SurfacePatch::part_of(const ConvexPolygon& polygon, const Point3& n) const {
  const Point3 origin = polygon.front();
  const double negligible = negligible_share * polygon_area(polygon);
  std::vector<ConvexPolygon> covered, left{polygon};
  facets_.each_overlap(grown(bounding_box(polygon), tolerance_), [&](std::int32_t item) {
    const auto t = static_cast<std::size_t>(item);
    const double cosine = dot(normals_[t], n);
    if (std::abs(cosine) < least_cosine) return;
    const auto x = corners(mesh_, t);
    ConvexPolygon facet(x.begin(), x.end());
    for (const double side : {1.0, -1.0})
      facet = clip_convex(facet, [&](const Point3& y) { return side * dot(minus(y, origin), n) - tolerance_; });
    if (facet.size() < 3) return;
    if (cosine < 0) std::reverse(facet.begin(), facet.end());
    for (Point3& y : facet) y = minus(y, times(n, dot(minus(y, origin), n)));
    const Box3 box = grown(bounding_box(facet), snap_);
    std::vector<ConvexPolygon> next;
    for (ConvexPolygon& piece : left) {
      if (!overlap(box, bounding_box(piece))) {
        next.push_back(std::move(piece));
        continue;
      }
      ConvexPolygon inside = piece;
      std::vector<ConvexPolygon> outside;
      for (std::size_t a = 0; a < facet.size() && inside.size() >= 3; ++a) {
        const Point3 &from = facet[a], &to = facet[a + 1 == facet.size() ? 0 : a + 1];
        const Point3 edge = cross(minus(to, from), n); // points out of the facet
        const double length = norm(edge);
        if (!(length > 0)) continue;
        const auto height = [&](const Point3& y) {
          const double h = dot(minus(y, from), edge) / length;
          return std::abs(h) <= snap_ ? 0 : h;
        };
        ConvexPolygon cut = clip_convex(inside, [&](const Point3& y) { return -height(y); });
        if (cut.size() >= 3 && polygon_area(cut) > negligible) outside.push_back(std::move(cut));
        inside = clip_convex(inside, height);
      }
      if (inside.size() < 3 || !(polygon_area(inside) > negligible)) {
        next.push_back(std::move(piece));
        continue;
      }
      covered.push_back(std::move(inside));
      next.insert(next.end(), std::make_move_iterator(outside.begin()), std::make_move_iterator(outside.end()));
    }
    left = std::move(next);
  });
  return covered;
}

std::string SurfacePatch::how_near() const {
  double least = std::numeric_limits<double>::infinity();
  const TriangleMesh& mesh = model_.surface.mesh;
  std::vector<Box3> boxes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) boxes.push_back(bounding_box(corners(mesh, t)));
  const Bvh tree(boxes);
  for (const Point3& x : mesh_.vertices)
    least = std::min(least, tree.least_distance2(x, [&](std::int32_t t) {
      const Point3 way = way_to_triangle(mesh, static_cast<std::size_t>(t), x);
      return dot(way, way);
    }));
  return fmt::format(
      "the patch's corners come as near as {:.4g} to the surface, its tolerance is {:.3g}: check that it lies in "
      "the model's frame and length unit, or give patch = {{ file = \"…\", tolerance = … }}",
      std::sqrt(least), tolerance_);
}

void SurfacePatch::describe(RegionReport& region) const {
  const double share = region.area / area_;
  region.note = fmt::format("patch {}: area {:.6g}, {:.1f} % of it found on the surface within {:.3g}{}", name_, area_,
                            100 * share, tolerance_, chosen_tolerance_ ? " (chosen from the facets)" : "");
  if (share < least_share)
    region.warning =
        fmt::format("only {:.0f} % of the patch {} lies on the surface, within its tolerance of {:.3g}: check its "
                    "place, or give patch = {{ file = \"…\", tolerance = … }}",
                    100 * share, name_, tolerance_);
}

} // namespace iga::solve
