// Which span of a model a position belongs to, for point loads and probes.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <string>

namespace iga::solve {

/// How far outside the part's triangles a point may lie, in smallest span sizes: a point on a round face lies off the
/// flat triangles that stand for it.
constexpr double outside_allowance = 0.05;

struct LocatedPoint {
  std::int64_t span = 0; ///< cell
  Point3 parameter{};    ///< in the closed span: the point's own, or the nearest one an active span owns
  Point3 asked{};        ///< length
  Point3 position{};     ///< length; position of the parameter
};

/// Inside is decided by the winding number of the surface, not by the span: a trimmed span holds space without material
/// too. A point within the allowance outside, or in a piece that was snapped or dropped, moves to the nearest parameter
/// of an active span.
/// @param what  opens the message: "probe 'tip'"
/// @throws InputError for a point outside the part, with its distance
LocatedPoint locate(const TrimmedModel& model, const Point3& x, const std::string& what);

/// Generalised winding number of the mesh about x: 1 inside a closed surface, 0 outside (Van Oosterom & Strackee 1983).
double winding_number(const TriangleMesh& mesh, const Point3& x);

} // namespace iga::solve
