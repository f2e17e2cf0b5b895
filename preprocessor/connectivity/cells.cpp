#include "preprocessor/connectivity/cells.hpp"

#include <algorithm>

namespace iga::prep {

namespace {

// First cell of each active span, and the cell of each piece.
struct Cellation {
  std::vector<std::int32_t> of_piece;
  std::vector<std::uint8_t> split; ///< (num_active)
  std::int32_t count = 0;
};

Cellation take_together(const PieceGraph& graph, const FunctionCopies& copies, std::size_t local) {
  Cellation out;
  out.split.resize(graph.first.size() - 1);
  out.of_piece.resize(static_cast<std::size_t>(graph.first.back()));
  for (std::size_t a = 0; a + 1 < graph.first.size(); ++a) {
    const auto first = static_cast<std::size_t>(graph.first[a]), last = static_cast<std::size_t>(graph.first[a + 1]);
    for (std::size_t q = first + 1; q < last && !out.split[a]; ++q)
      out.split[a] = !std::equal(copies.of_piece.begin() + static_cast<std::ptrdiff_t>(q * local),
                                 copies.of_piece.begin() + static_cast<std::ptrdiff_t>((q + 1) * local),
                                 copies.of_piece.begin() + static_cast<std::ptrdiff_t>(first * local));
    for (std::size_t q = first; q < last; ++q)
      out.of_piece[q] = out.split[a] ? out.count + static_cast<std::int32_t>(q - first) : out.count;
    out.count += out.split[a] ? static_cast<std::int32_t>(last - first) : 1;
  }
  return out;
}

// Puts the polygons of a touched span into another order.
void reorder(SurfacePieces& pieces, std::size_t touched, const std::vector<std::int64_t>& order) {
  const std::int64_t first = pieces.offsets[touched];
  std::vector<std::int32_t> triangle;
  std::vector<std::int64_t> size;
  std::vector<Point3> vertices;
  for (const std::int64_t q : order) {
    const auto polygon = pieces.polygon(q);
    triangle.push_back(pieces.triangle[static_cast<std::size_t>(q)]);
    size.push_back(static_cast<std::int64_t>(polygon.size()));
    vertices.insert(vertices.end(), polygon.begin(), polygon.end());
  }
  std::copy(triangle.begin(), triangle.end(), pieces.triangle.begin() + first);
  std::int64_t vertex = pieces.vertex_offsets[static_cast<std::size_t>(first)];
  std::copy(vertices.begin(), vertices.end(), pieces.vertices.begin() + vertex);
  for (std::size_t k = 0; k < size.size(); ++k)
    pieces.vertex_offsets[static_cast<std::size_t>(first) + k + 1] = vertex += size[k];
}

/// Rewrites a trimming so that its active spans are cells.
class Splitter {
 public:
  Splitter(const PieceGraph& graph, const Cellation& cells, Trimming& trimming)
      : graph_(graph), cells_(cells), trimming_(trimming) {}

  void run() {
    const std::size_t num_touched = trimming_.pieces.spans.size();
    std::size_t a = 0;
    for (std::size_t t = 0; t < num_touched; ++t) {
      while (a < trimming_.active.size() && trimming_.touched[a] < static_cast<std::int64_t>(t)) add_cell(a++, -1);
      const bool active = a < trimming_.active.size() && trimming_.touched[a] == static_cast<std::int64_t>(t);
      if (active && cells_.split[a]) {
        split(t, a++);
        continue;
      }
      if (active) add_cell(a++, static_cast<std::int64_t>(spans_.size()));
      add_touched(t, trimming_.pieces.offsets[t], trimming_.touched_fraction[t],
                  [&](std::size_t f) { return trimming_.face_state[6 * t + f]; });
    }
    while (a < trimming_.active.size()) add_cell(a++, -1);
    offsets_.push_back(trimming_.pieces.offsets.back());
    trimming_.pieces.spans = std::move(spans_);
    trimming_.pieces.offsets = std::move(offsets_);
    trimming_.touched_fraction = std::move(touched_fraction_);
    trimming_.face_state = std::move(face_state_);
    trimming_.active = std::move(active_);
    trimming_.touched = std::move(touched_);
    trimming_.fraction = std::move(fraction_);
  }

 private:
  // Interior runs without surface lie between touched spans: -1 keeps its place in the order.
  void add_cell(std::size_t a, std::int64_t touched) {
    active_.push_back(trimming_.active[a]);
    touched_.push_back(touched);
    fraction_.push_back(trimming_.fraction[a]);
  }

  template <class Face> void add_touched(std::size_t t, std::int64_t offset, double fraction, const Face& face) {
    spans_.push_back(trimming_.pieces.spans[t]);
    offsets_.push_back(offset);
    touched_fraction_.push_back(fraction);
    for (std::size_t f = 0; f < 6; ++f) face_state_.push_back(static_cast<std::uint8_t>(face(f)));
  }

  void split(std::size_t t, std::size_t a) {
    std::vector<std::int64_t> order;
    std::vector<std::uint8_t> used(
        static_cast<std::size_t>(trimming_.pieces.offsets[t + 1] - trimming_.pieces.offsets[t]), 0);
    const std::int64_t first = trimming_.pieces.offsets[t];
    for (; part_ < graph_.parts.size() && graph_.parts[part_].active < static_cast<std::int64_t>(a); ++part_) {
    }
    for (; part_ < graph_.parts.size() && graph_.parts[part_].active == static_cast<std::int64_t>(a); ++part_) {
      const PieceGraph::Part& part = graph_.parts[part_];
      active_.push_back(trimming_.active[a]);
      touched_.push_back(static_cast<std::int64_t>(spans_.size()));
      fraction_.push_back(part.fraction);
      if (!part.bounds.empty()) trimming_.far_bounds.push_back({spans_.size(), part.bounds});
      add_touched(t, first + static_cast<std::int64_t>(order.size()), part.fraction,
                  [&](std::size_t f) { return part.faces[f]; });
      for (const std::int64_t q : part.polygons) {
        order.push_back(q);
        used[static_cast<std::size_t>(q - first)] = 1;
      }
    }
    if (order.size() < used.size())
      add_touched(t, first + static_cast<std::int64_t>(order.size()), 0, [](std::size_t) { return FaceState::Empty; });
    for (std::size_t k = 0; k < used.size(); ++k)
      if (!used[k]) order.push_back(first + static_cast<std::int64_t>(k));
    reorder(trimming_.pieces, t, order);
  }

  const PieceGraph& graph_;
  const Cellation& cells_;
  Trimming& trimming_;
  std::size_t part_ = 0;
  std::vector<std::int64_t> spans_, offsets_, active_, touched_;
  std::vector<double> touched_fraction_, fraction_;
  std::vector<std::uint8_t> face_state_;
};

} // namespace

CellTable split_into_cells(const SplineGrid& grid, const TrimOptions& options, Trimming& trimming) {
  const PieceGraph graph = find_pieces(grid, trimming, options);
  FunctionCopies copies = copy_functions(grid, trimming.active, graph);
  CellTable out;
  std::vector<std::uint8_t> own;
  if (options.split_gap_ends) {
    own = find_gap_ends(grid, trimming.active, graph, copies);
    out.unknowns = separate_gap_ends(grid, trimming.active, graph, own, copies);
  }
  const auto p = grid.degree();
  const auto local = static_cast<std::size_t>((p[0] + 1) * (p[1] + 1) * (p[2] + 1));
  const Cellation cells = take_together(graph, copies, local);

  out.pieces = graph.first.back();
  out.unclear_spans = graph.unclear;
  out.first_unclear = graph.first_unclear;
  out.function = std::move(copies.number);
  if (static_cast<std::size_t>(cells.count) == cells.of_piece.size()) {
    out.functions = std::move(copies.of_piece);
    trimming.links = graph.links;
  } else {
    out.functions.resize(static_cast<std::size_t>(cells.count) * local);
    for (std::size_t q = 0; q < cells.of_piece.size(); ++q)
      std::copy_n(copies.of_piece.begin() + static_cast<std::ptrdiff_t>(q * local), local,
                  out.functions.begin() +
                      static_cast<std::ptrdiff_t>(static_cast<std::size_t>(cells.of_piece[q]) * local));
    for (const PieceLink& link : graph.links)
      trimming.links.push_back({cells.of_piece[static_cast<std::size_t>(link.low)],
                                cells.of_piece[static_cast<std::size_t>(link.high)], link.axis});
    std::sort(trimming.links.begin(), trimming.links.end(),
              [](const PieceLink& x, const PieceLink& y) { return x.low != y.low ? x.low < y.low : x.high < y.high; });
    trimming.links.erase(
        std::unique(trimming.links.begin(), trimming.links.end(),
                    [](const PieceLink& x, const PieceLink& y) { return x.low == y.low && x.high == y.high; }),
        trimming.links.end());
  }
  for (const auto& [active, polygon] : graph.left_out_polygons) // those of split spans get an entry without a cell
    if (!cells.split[static_cast<std::size_t>(active)]) trimming.left_out_polygons.push_back(polygon);
  if (std::find(cells.split.begin(), cells.split.end(), 1) != cells.split.end()) {
    const double span_volume = grid.span_volume();
    for (const PieceGraph::LeftOut& piece : graph.left_out) {
      if (!cells.split[static_cast<std::size_t>(piece.active)]) continue;
      if (piece.dropped) {
        trimming.dropped_volume += piece.fraction * span_volume;
        ++trimming.dropped_spans;
      } else {
        trimming.snapped_volume -= piece.fraction * span_volume;
        trimming.snapped_spans += piece.fraction > 1e-12;
      }
    }
    Splitter(graph, cells, trimming).run();
  }
  if (!out.unknowns.rows.empty()) {
    trimming.gap_end.assign(trimming.active.size(), 0);
    for (std::size_t q = 0; q < own.size(); ++q)
      if (own[q]) trimming.gap_end[static_cast<std::size_t>(cells.of_piece[q])] = 1;
  }
  return out;
}

} // namespace iga::prep
