// Cells: what every later stage and every analysis loops over. A cell is one piece of one span.
#pragma once

#include "preprocessor/connectivity/gap_ends.hpp"

namespace iga::prep {

/// How cells and functions belong together; cells are numbered as Trimming::active is after the split; the links
/// between them are Trimming::links.
struct CellTable {
  std::vector<std::int64_t> function; ///< (n_f); see FunctionCopies::number
  /// (num_cells × (p_u + 1)(p_v + 1)(p_w + 1)), u fastest: entries into `function`.
  std::vector<std::int32_t> functions;
  GapEndUnknowns unknowns;
  std::int64_t pieces = 0; ///< before those that see the same functions were taken together; what else there is to
                           ///< count, count_cells tells of the model
  std::int64_t unclear_spans = 0; ///< see PieceGraph
  std::int64_t first_unclear = -1;
};

/// Splits spans into cells. Pieces of a span that see the same copies of all functions stay one cell: for an analysis
/// they differ in nothing, and one rule needs fewer points than two. In `trimming` the spans of several cells appear
/// several times in active, touched, fraction and, with their polygons, in pieces, touched_fraction, face_state;
/// polygons of no cell (in a face of the span, of pieces left out) follow as one more touched entry that no cell refers
/// to.
CellTable split_into_cells(const SplineGrid& grid, const TrimOptions& options, Trimming& trimming);

} // namespace iga::prep
