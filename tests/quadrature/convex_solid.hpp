// Convex solids cut by half-spaces in extended precision: moments found in another way than the product finds them.
#pragma once

#include "format/model/types.hpp"

#include <array>
#include <vector>

namespace iga::test {

using Long3 = std::array<long double, 3>;

/// n · x <= offset
struct HalfSpace {
  Long3 n{};
  long double offset = 0;
};

/// Convex polyhedron as outward-oriented convex faces; empty where nothing is left.
using Polyhedron = std::vector<std::vector<Long3>>;

Polyhedron cube_of(const Index3& span);
Polyhedron cut(const Polyhedron& solid, const HalfSpace& half_space);

/// Faces' planes of a convex mesh given by its vertices (any units) and outward triangles.
std::vector<HalfSpace> half_spaces(const std::vector<Point3>& vertices, const std::vector<Triangle>& triangles);

/// ∫ P_a(ξ) P_b(η) P_c(ζ) over the polyhedron in the units of a box (see span_moments), a fastest: tetrahedra about the
/// middle of the vertices, each with a collapsed Gauss rule.
std::vector<long double> legendre_moments(const Polyhedron& solid, const Box3& box, const std::array<int, 3>& degree);

} // namespace iga::test
