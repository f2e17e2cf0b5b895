// Straight ways between facing places of a surface: through a wall, or across a gap.
#pragma once

#include "format/model/triangle_tree.hpp"
#include "format/model/trimmed_model.hpp"

#include <functional>
#include <optional>

namespace iga::prep {

/// A place that stands for a part of the surface.
struct SurfaceSample {
  std::size_t active = 0;   ///< active span that owns it, position in model.cells.span
  std::size_t triangle = 0; ///< on which it lies
  Point3 x{};               ///< position, length
  Point3 normal{};          ///< outward unit normal
  double area = 0;          ///< that it stands for, length²
};

/// Up to eight of the model's surface points in every span that has some, chosen evenly by area; fewer in a span, and
/// then in fewer spans, where they would be more than `most`.
std::vector<SurfaceSample> sample_surface(const TrimmedModel& model, std::size_t most);

/// From a place of the surface to the one that faces it.
struct Chord {
  Point3 way{};             ///< length
  std::size_t triangle = 0; ///< where it ends
  double facing = 0;        ///< cosine of the angle between the way and the outward (or inward) normal at its end
};

/// First triangle along `way` that a way through material leaves by (`outwards`: a way through air enters by); none
/// within it. Triangles seen from their back, such as the one that the way starts on, do not count.
std::optional<Chord> first_chord(const TriangleMesh& mesh, const TriangleTree& tree, const Point3& from,
                                 const Point3& way, bool outwards);

/// A way in spans, along the grid's axes.
Point3 in_spans(const SplineGrid& grid, const Point3& way);

} // namespace iga::prep
