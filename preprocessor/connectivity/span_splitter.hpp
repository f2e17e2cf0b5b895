// The connected pieces of the solid in one span, exactly from the clipped surface.
#pragma once

#include "preprocessor/trim/trim.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace iga::prep {

/// Where the surface crosses a face of a span: a straight stretch with the solid on its left. Coordinates are those of
/// the face's two axes, ascending, in span units relative to the span's lower corner: the two spans at a face see the
/// same bits.
struct FaceTrace {
  double x0, y0, x1, y1;
  std::int32_t piece;
};

/// A *piece* is a connected component of solid ∩ span. Its boundary consists of *sheets* (clipped polygons joined
/// across edges inside the span) and of regions of the span's faces. An edge of a sheet that has no partner is a
/// *trace* on a face; traces bound the regions. Sheets and regions of one boundary are joined where a trace bounds a
/// region from the solid side and where regions of neighbouring faces share a stretch of the span's edge. Closed sheets
/// are bodies of their own or cavities of the piece that surrounds them. Polygons that lie in a face of the span close
/// it and bound no sheet. Sheets that touch along an edge are one. One object per thread, buffers are kept.
class SpanSplitter {
 public:
  /// Both must outlive the object.
  SpanSplitter(const SplineGrid& grid, const Trimming& trimming) : grid_(&grid), trimming_(&trimming) {}

  /// Splits the t-th touched span.
  void split(std::size_t touched);

  /// False where the surface leaks or overlaps in the span: then the pieces mean nothing.
  bool reliable() const { return reliable_; }
  std::int32_t num_pieces() const { return num_pieces_; }
  /// Does a polygon lie in a face of the span?
  bool covers(std::size_t face) const { return covered_[face]; }
  /// Piece of each polygon of the span; -1 for one in a face of the span.
  std::span<const std::int32_t> polygon_pieces() const { return polygon_piece_; }
  /// What a piece shows on a face (u-, u+, v-, v+, w-, w+); an area, not a touch.
  FaceState face(std::int32_t piece, std::size_t face) const {
    return faces_[6 * static_cast<std::size_t>(piece) + face];
  }
  const std::vector<FaceTrace>& traces(std::size_t face) const { return traces_[face]; }
  /// Stretches of the upper end of a face's first axis (x = 1) that bound the solid, with their piece: what the traces
  /// lack of the boundary of a region, but for the stretches at x = 0 and those along x.
  const std::vector<FaceTrace>& edge_stretches(std::size_t face) const { return edge_stretches_[face]; }
  /// Piece whose region on a face holds a place, -1 where there is none.
  std::int32_t piece_at(std::size_t face, double x, double y) const;

 private:
  struct Edge {
    std::int32_t low, high; // vertices
    std::int32_t polygon;
    int sign; // +1 from low to high
  };
  struct Trapezoid { // of a face: between two abscissae, below and above bounded by a trace or the face's edge
    double x0, x1, low0, low1, high0, high1;
    std::int32_t node;
  };
  void load(std::size_t touched);
  void join_polygons();
  void add_trace(std::int32_t from, std::int32_t to, std::int32_t polygon);
  void add_edge_nodes();
  void block_edge(std::size_t edge, double from, double to, bool low_axis_side, std::int32_t polygon);
  void sweep(std::size_t face);
  void join_sides(const std::vector<Trapezoid>& left, const std::vector<Trapezoid>& right,
                  const std::vector<FaceTrace>& upright);
  void join_edge(std::size_t face, std::size_t edge, const std::vector<Trapezoid>& column, bool at_start);
  void collect();
  void place_cavities();
  std::int32_t piece_around(std::size_t cavity, const std::vector<std::int32_t>& known);

  std::int32_t add_node();
  std::int32_t root(std::int32_t node);
  void join(std::int32_t a, std::int32_t b);
  std::size_t edge_at(std::size_t face, std::size_t along, bool upper) const;
  std::int32_t edge_node(std::size_t edge, std::size_t interval, std::size_t face) const;

  const SplineGrid* grid_;
  const Trimming* trimming_;
  std::size_t touched_ = 0;
  bool reliable_ = true;
  std::int32_t num_pieces_ = 0;
  std::vector<Point3> vertices_;          // relative to the span's corner, all polygons in turn
  std::vector<std::size_t> first_vertex_; // (polygons + 1)
  std::vector<std::int32_t> vertex_;      // number of each vertex; equal bits, equal numbers
  std::vector<std::uint8_t> in_face_;     // polygons that lie in a face
  std::array<bool, 6> covered_{};         // faces of the span that they lie in
  std::vector<std::int32_t> order_;
  std::vector<Edge> edges_;
  std::array<std::vector<FaceTrace>, 6> traces_, edge_stretches_;
  std::array<std::vector<Trapezoid>, 6> trapezoids_;
  struct AlongEdge {        // a trace along an edge of the span
    std::size_t edge, face; // the face whose region it bounds
    double from, to;
    std::int32_t polygon;
  };
  std::vector<AlongEdge> along_edge_;
  std::array<std::vector<double>, 12> ends_;       // of the intervals of the span's edges, 0 and 1 included
  std::array<std::int32_t, 12> first_edge_node_{}; // two nodes an interval, one for each face at the edge
  std::vector<std::int32_t> parent_;               // disjoint sets: polygons, edge intervals, trapezoids
  std::vector<std::uint8_t> void_;                 // nodes known to lie outside the solid
  std::vector<std::int32_t> polygon_piece_;
  std::vector<FaceState> faces_;
  std::vector<std::int32_t> piece_of_root_;
};

} // namespace iga::prep
