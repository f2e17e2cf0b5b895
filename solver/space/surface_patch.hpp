// Open pieces of surface from STL files, drawn in CAD where a support or a load shall act: which part of the model's
// surface lies on them.
#pragma once

#include "solver/base/bvh.hpp"
#include "solver/space/convex_clip.hpp"
#include "solver/space/surface_region.hpp"

namespace iga::solve {

/// What of a model's triangles a patch covers: its facets are projected along the normal of the triangle, those no
/// further from its plane than the tolerance and not steeper than 45° against it.
class SurfacePatch {
 public:
  /// Without a tolerance of the user: what the facets of patch and model may leave between two triangulations of the
  /// same round face, from the angles between neighbouring facets there, and the model's surface_depth.
  /// @param what  opens the message: "support 'heads'"
  /// @throws InputError for a file that is no STL, and a tolerance below 0
  SurfacePatch(const TrimmedModel& model, const RegionChoice::Patch& choice, const std::string& what);

  /// Convex polygons that do not overlap: the covered part of a convex polygon on the surface.
  std::vector<ConvexPolygon> part_of(const ConvexPolygon& polygon, const Point3& normal) const;
  /// For refusals: how near the patch's corners come to the model's surface.
  std::string how_near() const;
  /// For the report: how much of the patch found surface, with what tolerance; a warning where much of it found none.
  void describe(RegionReport& region) const;

 private:
  const TrimmedModel& model_;
  TriangleMesh mesh_;
  std::vector<Point3> normals_; ///< unit; zero where a facet has no area
  Bvh facets_;
  std::string name_;
  bool chosen_tolerance_ = true; ///< by this program
  double tolerance_ = 0, snap_ = 0, area_ = 0;
};

} // namespace iga::solve
