// The grid around a part: its box in the grid's axes, the span size, whole spans of margin.
// With C the box's centre and R the rotation, x = C + R (u - C); everything is measured relative to the part, so a part
// that is moved or scaled gets the same grid, moved or scaled.
#pragma once

#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <optional>
#include <string>
#include <vector>

namespace iga::prep {

struct GridOptions {
  std::array<int, 3> degree{2, 2, 2};
  std::optional<std::array<Point3, 2>> box; ///< corners A and B before the rotation about their centre, length
  std::vector<std::int64_t> spans;          ///< none, 3 (per direction) or 1 (along the longest side, cubic spans)
  std::vector<double> span_size;            ///< none, 3 (per direction) or 1 (cubic spans), length
  std::optional<std::int64_t> margin;       ///< empty spans on every side; default: the degree of each direction
  Rotation rotation = identity_rotation;
};

/// A part measured in the axes of its grid: everything but the grid's position relative to the part.
struct GridFrame {
  Point3 origin{};    ///< position that local coordinates y = R^T (x - origin) start from
  Box3 part;          ///< the part's box in local coordinates
  Point3 span_size{}; ///< length, kept exactly
  Index3 margin{};    ///< empty spans on every side
  std::array<int, 3> degree{2, 2, 2};
  Rotation rotation = identity_rotation;
};

struct GridChoice {
  SplineGrid grid;
  std::optional<GridFrame> frame; ///< where the grid may move within one span: absent for an explicit box
  std::vector<std::string> notes; ///< what was adjusted, one sentence each
};

/// @throws InputError for values that no part can make valid: counts, sizes, degrees out of range, or settings that
/// contradict each other
void check_options(const GridOptions& options);

/// Span size per direction that the options ask for, around a part or in a box of the given sides, length.
Point3 wanted_size(const GridOptions& options, const Point3& sides);

/// Grid after the options. Without a box: `span_size` is kept exactly and the part's box, centred, is rounded up to
/// whole spans; `spans` counts spans across the part; neither: a twentieth of the longest side. With a box: no margin,
/// a size that does not divide it is adjusted. A part that is a whole number of spans up to `whole_span_tolerance` gets
/// that number.
/// @throws InputError for an empty or missed box, a part that sticks out of it, sizes or counts that are not positive,
/// and more spans than this machine's memory holds
GridChoice make_grid(const TriangleMesh& mesh, const GridOptions& options);

/// Offset (in spans, 0 … 1) of the part's lower corner from the first grid planes that lie outside the margin.
Point3 centred_offset(const GridFrame& frame);
/// The grid with that offset and as many spans as the part and the margin then need.
SplineGrid place_grid(const GridFrame& frame, const Point3& offset);

/// Overhang (in spans) of the part into the margin that does not call for another span: coordinates in single precision
/// are off by about 1e-7 of the part's size, and cuts this shallow are snapped (the default sliver depth is as large).
constexpr double whole_span_tolerance = 2e-5;

} // namespace iga::prep
