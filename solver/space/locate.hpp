// Which cell of a model a position belongs to, for point loads and probes.
#pragma once

#include "solver/space/surface_cells.hpp"

#include <string>

namespace iga::solve {

/// How far outside the part's triangles a point may lie, in smallest span sizes: a point on a round face lies off the
/// flat triangles that stand for it.
constexpr double outside_allowance = 0.05;
/// In a gap it must be nearer to one of the two walls than this share of the gap's width: what lies between is
/// neither's.
constexpr double gap_allowance = 0.1;

struct LocatedPoint {
  std::int64_t cell = 0;
  Point3 parameter{}; ///< in the closed span of the cell: the point's own, or the nearest one
  Point3 asked{};     ///< length
  Point3 position{};  ///< length; position of the parameter
};

/// Holds a reference: the model must outlive it. Safe to share between threads.
class Locator {
 public:
  explicit Locator(const TrimmedModel& model) : model_(model), surface_(model) {}

  /// Inside is decided by the winding number of the surface, not by the span: a trimmed span holds space without
  /// material too. The nearest surface within the point's span tells the cell, since nothing but the solid lies between
  /// (a span is convex). A point outside, within the allowances, belongs to the wall that is nearest to it.
  /// @param what  opens the message: "probe 'tip'"
  /// @throws InputError for a point outside the part, with its distance, or in a gap, with its width
  LocatedPoint locate(const Point3& x, const std::string& what) const;

  /// Cell that a place in the solid, or on its surface, belongs to.
  /// @param u  parameter
  std::int64_t cell_in_solid(const Point3& u) const;

 private:
  std::int64_t cell_outside(const Point3& x, const std::string& what) const;

  const TrimmedModel& model_;
  SurfaceCells surface_;
};

/// For one point; a Locator serves many.
LocatedPoint locate(const TrimmedModel& model, const Point3& x, const std::string& what);

/// Generalised winding number of the mesh about x: 1 inside a closed surface, 0 outside (Van Oosterom & Strackee 1983).
double winding_number(const TriangleMesh& mesh, const Point3& x);

} // namespace iga::solve
