// Models of trimmed parts made by the preprocessor's library, without files in between.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::test {

struct PartOptions {
  int degree = 2;
  double span_size = 0.25; ///< length
  double shift = 0;        ///< of the grid, in spans
  int moment_degree = 0;   ///< 0: the spline's degree
  Rotation rotation = identity_rotation;
  const char* interior_rule = "gauss";
  bool split_gap_ends = true;
  const char* surface_rule = "exact";
};

/// A closed, outward-oriented surface in a grid with a margin of as many spans as its degree.
TrimmedModel make_part(const TriangleMesh& mesh, const PartOptions& options);
/// The same in a given grid.
TrimmedModel make_part(const TriangleMesh& mesh, const SplineGrid& grid, int moment_degree = 0,
                       const char* interior_rule = "gauss", bool split_gap_ends = true,
                       const char* surface_rule = "exact");

} // namespace iga::test
