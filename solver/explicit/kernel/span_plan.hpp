// Which quadrature points are worked on side by side, with which shape functions, and in which order: the plan of one
// evaluation of internal forces, made once.
//
// Spans go eight at a time, one per lane, each with places of its own. Where their points are tensor products of as
// many points per direction (Gauss, generalised Gauss, boxes cut from a span) they are contracted direction by
// direction, else point by point. The few spans that are left over go one by one, eight of their points at a time.
// Shape functions are evaluated anew in every step: they cost less than reading them.
#pragma once

#include "format/model/simd.hpp"
#include "solver/explicit/kernel/span_polynomials.hpp"
#include "solver/space/solution_space.hpp"

#include <array>

namespace iga::solve {

/// Most points per direction of a tensor product.
constexpr std::size_t max_row_points = 8;

/// Points of eight spans that are tensor products, all with as many points per direction.
struct LaneTensor {
  std::array<std::int32_t, 3> polynomials{}; ///< of SpanPlan::polynomials
  std::array<int, 3> count{};                ///< points per direction
  std::array<std::vector<Lanes>, 3> t;       ///< (count[d]): places in the spans, 0 … 1
  std::vector<Lanes> weights;                ///< (count[2], count[1], count[0]), u fastest; length³
  int size() const { return count[0] * count[1] * count[2]; }
};

/// Up to eight spans. Block `first_block + q` of the points holds point q of each of them; spans with fewer points than
/// others repeat their last one with weight 0.
struct SpanGroup {
  std::int32_t count = 0;                  ///< spans; the last one is repeated in the lanes beyond
  std::array<std::int32_t, lanes> spans{}; ///< active spans
  std::int32_t tensor = -1;                ///< of SpanPlan::tensors; -1: own points
  std::int32_t blocks = 0;                 ///< of points
  std::array<std::int32_t, 3> polynomials{};
  std::int64_t first_block = 0;
  std::int64_t first_own = 0; ///< of SpanPlan::own_points; without a tensor
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

/// Eight points: of one span, or one of each of eight spans.
struct OwnPoints {
  Lanes t[3]; ///< places in their spans, 0 … 1
  Lanes weight;
};

/// Neighbouring spans that one thread works on, in this order.
struct WorkBlock {
  std::array<std::int64_t, 2> groups{};      ///< first and one beyond the last of SpanPlan::groups
  std::array<std::int64_t, 2> point_spans{}; ///< of SpanPlan::point_spans
};

struct SpanPlan {
  std::array<int, 3> degree{};
  std::vector<LaneTensor> tensors; ///< each once
  std::vector<SpanPolynomials> polynomials;
  std::vector<SpanGroup> groups;
  std::vector<PointSpan> point_spans;
  std::vector<OwnPoints> own_points;
  std::vector<WorkBlock> blocks; ///< by colour: the blocks of a colour share no function
  /// Blocks that share functions with a block and have a later colour: they come after it. So forces add up in the
  /// order of the colours, whichever blocks are worked on at the same time. (number of blocks)
  std::vector<std::vector<std::int32_t>> followers;
  std::vector<std::int32_t> num_before; ///< how many blocks a block follows; (number of blocks)
  /// First of the p_u + 1 functions (·, b, c) of each cell, b fastest, where they lie one after the other: nearly
  /// everywhere. A cell that sees copies has -1 - k in its first row: its functions are the k-th entry of `functions`.
  /// (num_cells × (p_v + 1)(p_w + 1))
  std::vector<std::int64_t> rows;
  std::vector<std::int32_t>
      functions;                   ///< of cells whose functions do not lie in rows; (k × (p_u + 1)(p_v + 1)(p_w + 1))
  std::vector<std::int64_t> point; ///< (8 num_blocks): number in model().points, -1 for padding and for
                                   ///< fictitious material
  std::int64_t num_points = 0;     ///< padding not counted
  std::int64_t num_tensor_points = 0; ///< of them in groups with a tensor
  std::int64_t num_lane_points = 0;   ///< of them in groups without
  std::int64_t num_point_blocks() const { return static_cast<std::int64_t>(point.size() / lanes); }
};

SpanPlan make_span_plan(const SolutionSpace& space);

/// Floating-point operations of one evaluation outside the material law, padding lanes not counted: gradients and
/// forces, shape functions of points without a tensor.
double contraction_flops(const SpanPlan& plan);

} // namespace iga::solve
