// The pieces of all spans that hold material, and which of them hang together across faces.
#pragma once

#include "preprocessor/trim/trim.hpp"

namespace iga::prep {

/// Pieces in the order of their spans. A span without surface is one piece, and so is one that was snapped to INTERIOR.
/// Pieces that are slivers or below the smallest fraction are left out, as spans are.
struct PieceGraph {
  std::vector<std::int64_t> first; ///< (num_active + 1); active span a holds the pieces [a] … [a + 1) - 1, at least one
  std::vector<PieceLink> links;    ///< sorted by low, then high
  /// What a piece is made of where its span holds several.
  struct Part {
    std::int32_t piece;
    std::int64_t active;
    double fraction;                           ///< of the span's volume
    std::array<FaceState, 6> faces;            ///< areas, not touches
    std::vector<std::int64_t> polygons;        ///< of SurfacePieces, ascending
    std::vector<std::array<double, 4>> bounds; ///< of its region on the face u+: (v, w) from, to; solid on the left,
                                               ///< without stretches at v = 0 and along v; only where no face is whole
  };
  std::vector<Part> parts; ///< ascending
  /// A piece of a span with several others that counts for nothing: a sliver, or below the smallest fraction.
  struct LeftOut {
    std::int64_t active;
    double fraction;
    bool dropped; ///< by the smallest fraction
  };
  std::vector<LeftOut> left_out; ///< ascending
  /// Active span and polygon of SurfacePieces, ascending: of pieces left out of their span, alone beside another or
  /// not.
  std::vector<std::pair<std::int64_t, std::int64_t>> left_out_polygons;
  std::int64_t unclear = 0; ///< spans whose pieces cannot be told because the surface leaks or overlaps: one piece each
  std::int64_t first_unclear = -1; ///< one of them
};

/// @param trimming  of trim, not yet split
PieceGraph find_pieces(const SplineGrid& grid, const Trimming& trimming, const TrimOptions& options);

} // namespace iga::prep
