// A stand-in for the vehicle foam part of the paper: an energy absorber of about 310 × 150 × 260 mm.
#pragma once

#include "format/model/triangle_mesh.hpp"

namespace iga::samples {

/// Bowed, bevelled front (high y), six deep pockets open at the back (y = 0), bores along x, y and z through ribs and
/// front, a notch in the edge at high z; every edge is rounded. Millimetres, one corner of its box at the origin.
TriangleMesh foam_part();

} // namespace iga::samples
