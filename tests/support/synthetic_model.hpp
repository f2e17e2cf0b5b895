// A complete, exact TrimmedModel made without the preprocessor: a box whose faces are parallel to the grid's axes.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::test {

struct BoxCase {
  Point3 A{0, 0, 0}, B{6, 5, 4}; ///< the grid
  Index3 spans{6, 5, 4};
  std::array<int, 3> degree{2, 2, 2};
  Rotation rotation = identity_rotation;
  Point3 lower{1.25, 1.5, 1}, upper{4.75, 3.5, 2.6}; ///< the solid, in parameters
};

/// Rotation by `angle` (radians) about the axis (1, 2, 2) / 3.
Rotation some_rotation(double angle);

/// Tensor Gauss rules with p + 1 points on box ∩ span, surface points with the same rule on every face rectangle, one
/// region per face of the box. Every number of the model is known in closed form.
TrimmedModel make_box_model(const BoxCase& box = {});

/// A solid box with many points for measuring: n³ interior spans of degree 2 inside a margin of two spans.
TrimmedModel make_large_model(std::int64_t n);

/// A small box in a grid too fine for a table of control points.
BoxCase very_fine_case();

/// Gives a model a curve of three points, a closed one and two markers.
void add_places(TrimmedModel& model);

/// Gauss–Legendre on [0, 1] with n = 1 … 5 points: (position, weight).
std::vector<std::pair<double, double>> gauss_rule(int n);

/// Fills cells.functions and links of a model with one cell a span from its cells.span and functions.number.
void make_cells(TrimmedModel& model);

} // namespace iga::test
