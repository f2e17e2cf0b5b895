// Which quadrature points are worked on side by side, with which shape functions, and in which order: the plan of one
// evaluation of internal forces, made once.
//
// Interior spans whose points lie alike (Gauss, generalised Gauss at the same place of its pattern) share tables of
// univariate values and go eight spans at a time. All other spans go one by one, eight of their points at a time; their
// shape functions are evaluated anew from the points' parameters.
#pragma once

#include "format/model/simd.hpp"
#include "solver/explicit/span_polynomials.hpp"
#include "solver/solution_space.hpp"

#include <array>

namespace iga::solve {

/// Most points along u that a table may have.
constexpr std::size_t max_row_points = 16;

/// Points that are the tensor product of one list per direction, in a span.
struct TensorTable {
  std::array<int, 3> count{};                ///< points per direction
  std::array<std::vector<double>, 3> values; ///< (count[d] × p[d] + 1), row-major
  std::array<std::vector<double>, 3> slopes; ///< d/du of them, 1/length
  std::vector<double> weights;               ///< (count[2], count[1], count[0]), u fastest; length³
  int size() const { return count[0] * count[1] * count[2]; }
};

/// Up to eight interior spans of one table. Block `first_block + q` of the points holds point q of each of them.
struct SpanGroup {
  std::int32_t table = 0;
  std::int32_t count = 0;                  ///< spans; the last one is repeated in the lanes beyond
  std::array<std::int32_t, lanes> spans{}; ///< active spans
  std::int64_t first_block = 0;
};

/// A span with points of its own, in `blocks` blocks of eight; the last point is repeated, with weight 0, in the lanes
/// beyond.
struct PointSpan {
  std::int32_t span = 0; ///< active span
  std::int32_t blocks = 0;
  std::array<std::int32_t, 3> polynomials{}; ///< of SpanPlan::polynomials
  std::int64_t first_block = 0;
  std::int64_t first_own = 0; ///< of SpanPlan::own_points
};

/// Eight points of a PointSpan.
struct OwnPoints {
  Lanes t[3]; ///< place in the span, 0 … 1
  Lanes weight;
};

/// Neighbouring spans that one thread works on, in this order.
struct WorkBlock {
  std::array<std::int64_t, 2> groups{};      ///< first and one beyond the last of SpanPlan::groups
  std::array<std::int64_t, 2> point_spans{}; ///< of SpanPlan::point_spans
};

struct SpanPlan {
  std::array<int, 3> degree{};
  std::vector<TensorTable> tables;
  std::vector<SpanPolynomials> polynomials;
  std::vector<SpanGroup> groups;
  std::vector<PointSpan> point_spans;
  std::vector<OwnPoints> own_points;
  std::vector<WorkBlock> blocks;            ///< by colour: the blocks of a colour share no function
  std::vector<std::int64_t> colour_offsets; ///< (number of colours + 1): into blocks
  std::vector<std::int64_t> rows;           ///< function_rows of the model
  std::vector<std::int64_t> point;          ///< (8 num_blocks): number in model().points, -1 for padding and for
                                            ///< fictitious material
  std::int64_t num_points = 0;              ///< padding not counted
  std::int64_t num_group_points = 0;        ///< of them in groups
  std::int64_t num_point_blocks() const { return static_cast<std::int64_t>(point.size() / lanes); }
};

SpanPlan make_span_plan(const SolutionSpace& space);

/// Floating-point operations of one evaluation outside the material law, padding lanes not counted: shape functions of
/// points in trimmed spans, gradients, forces.
double contraction_flops(const SpanPlan& plan);

} // namespace iga::solve
