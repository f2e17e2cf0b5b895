// States and exact volume fractions of all spans, from one pass over the surface pieces (suffix sums along rows).
#pragma once

#include "preprocessor/trim/clip.hpp"

#include <array>
#include <compare>
#include <cstdint>
#include <utility>
#include <vector>

namespace iga::prep {

struct TrimOptions {
  /// Depth, in spans: a cut that stays this close to the span's faces is snapped. Never below the rounding of
  /// positions.
  double sliver_tolerance = 2e-5;
  double min_fraction = 0;    ///< trimmed spans with a smaller fraction are dropped (counted, volume recorded)
  bool split_gap_ends = true; ///< functions of lower continuity where gaps end inside the support of B-splines
};

/// A row of spans along one axis in which the crossings do not cancel: the surface leaks there.
struct Leak {
  Index3 span{};    ///< first span (from the high end) where it shows
  double error = 0; ///< how far the fraction lies outside what is possible, in span volumes
};

/// Two parts of the solid in face-neighbouring spans that share area on the common face: pieces, or cells.
struct PieceLink {
  std::int32_t low, high; ///< low < high
  std::uint8_t axis;      ///< along which the spans follow each other
  friend auto operator<=>(const PieceLink&, const PieceLink&) = default;
};

struct Trimming {
  std::vector<std::uint8_t> state;      ///< (num_spans); SpanState, u fastest
  std::vector<std::int64_t> active;     ///< (num_active); INTERIOR and TRIMMED spans, ascending
  std::vector<std::int64_t> touched;    ///< (num_active); their numbers in pieces.spans, -1 for untouched ones
  std::vector<double> fraction;         ///< (num_active); exact fraction, also of spans snapped to INTERIOR
  SurfacePieces pieces;                 ///< of all touched spans, snapped and dropped ones included
  std::vector<double> touched_fraction; ///< (num_touched); exact fraction of pieces.spans
  std::vector<std::uint8_t> face_state; ///< (num_touched × 6): see FaceState; faces u-, u+, v-, v+, w-, w+
  std::vector<PieceLink> links; ///< between cells, sorted by low, then high; empty before spans are split into cells
  /// Regions on the face u+ of cells that cross all faces of their span: touched entry, and boundary without stretches
  /// at v = 0 and along v as (v, w) from, to in span units relative to the span's corner, the solid on the left. Empty
  /// before spans are split into cells.
  std::vector<std::pair<std::size_t, std::vector<std::array<double, 4>>>> far_bounds;
  /// (num_active), or empty where there are none: cells with functions of their own, which their neighbours hold less.
  std::vector<std::uint8_t> gap_end;
  /// Ascending: polygons of pieces that count for nothing (slivers, or below the smallest fraction) in spans of one
  /// cell: they lie beside its own, and need not be joined with it. Empty before spans are split into cells.
  std::vector<std::int64_t> left_out_polygons;
  /// Has a cell functions of its own?
  bool is_at_gap_end(std::size_t cell) const { return !gap_end.empty() && gap_end[cell] != 0; }
  double exact_volume = 0;        ///< Σ fractions · span volume before snapping and dropping, length³
  double snapped_volume = 0;      ///< added by snapping to INTERIOR less removed by snapping to EXTERIOR, length³
  double dropped_volume = 0;      ///< length³
  std::int64_t snapped_spans = 0; ///< spans whose volume snapping changed
  std::int64_t dropped_spans = 0;
  std::vector<Leak> leaks; ///< the worst rows, at most 20, largest error first
  double worst_leak = 0;   ///< in span volumes; rounding only for a closed surface
  std::int64_t num_leaks = 0;
};

/// What a span's face shows of the solid just inside the span.
enum class FaceState : std::uint8_t { Empty = 0, Full = 1, Crossed = 2 };

/// Depth below which a cut is snapped: the tolerance, but never below the rounding of positions.
double sliver_depth(const SplineGrid& grid, const TrimOptions& options);

Trimming trim(const SplineGrid& grid, const TriangleMesh& mesh, const TrimOptions& options);

} // namespace iga::prep
