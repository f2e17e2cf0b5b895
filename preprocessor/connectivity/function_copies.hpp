// One copy of a B-spline function for each connected part of the solid in its support.
#pragma once

#include "preprocessor/connectivity/piece_graph.hpp"

namespace iga::prep {

/// Copies of a function add up to it on the solid: every copy is the function on the pieces of one connected component
/// of its support and zero elsewhere (generalised Heaviside enrichment; Hansbo & Hansbo 2004, Noël et al. 2022).
struct FunctionCopies {
  std::vector<std::int64_t> number; ///< (n_f); the B-spline's linear number, ascending, repeated for its copies
  /// (num_pieces × (p_u + 1)(p_v + 1)(p_w + 1)), u fastest: entries into `number`.
  std::vector<std::int32_t> of_piece;
};

/// Pieces hang together where links inside the support join them; copies of a function are numbered by their first
/// piece.
FunctionCopies copy_functions(const SplineGrid& grid, const std::vector<std::int64_t>& active, const PieceGraph& graph);

} // namespace iga::prep
