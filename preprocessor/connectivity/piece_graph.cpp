#include "preprocessor/connectivity/piece_graph.hpp"

#include "format/model/model_check.hpp"
#include "format/model/span_state.hpp"
#include "preprocessor/connectivity/span_splitter.hpp"
#include "preprocessor/trim/own_moments.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace iga::prep {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
// Pieces must add up to their span; more is a leak, and then they mean nothing.
constexpr double same_volume = 1e-9;

using Faces = std::array<FaceState, 6>;

/// A piece of a span that holds several.
struct SplitPiece {
  double fraction = 0;
  bool sliver = true;
  Faces faces{};
  std::int32_t number = -1; ///< among the pieces of the span that count, -1 where it is left out
  std::vector<std::int64_t> polygons;
  std::vector<std::array<double, 4>> bounds;
};

struct TouchedSpan {
  std::int32_t num_pieces = 1; ///< that count
  bool clear = true;
  std::array<bool, 3> lies_in_lower{}; ///< a polygon lies in this lower face
  Faces faces{};                       ///< where one piece counts
  std::vector<SplitPiece> pieces;      ///< all of them, where there are several
};

// ∫ x dy around the region of a piece on the face u+.
double area_on_upper_u(const SplitPiece& piece) {
  double area = 0;
  for (const auto& [x0, y0, x1, y1] : piece.bounds) area += 0.5 * (x0 + x1) * (y1 - y0);
  return area;
}

// Volume by the axis on which one of the span's faces is empty or whole, where rounding is least.
double piece_volume(const OwnMoments& m, const SplitPiece& piece) {
  double best = 0, error = std::numeric_limits<double>::infinity();
  const auto offer = [&](double value, double rounding) {
    if (rounding >= error) return;
    best = value;
    error = rounding;
  };
  for (std::size_t d = 0; d < 3; ++d) {
    const FaceState low = piece.faces[2 * d], up = piece.faces[2 * d + 1];
    const double whole = up == FaceState::Full ? 1 : 0, below = low == FaceState::Full ? 1 : 0;
    if (up != FaceState::Crossed)
      offer(m.volume[d] + whole, m.magnitude[d] + whole);
    else if (low != FaceState::Crossed)
      offer(m.volume[d] + below - m.area[d], m.magnitude[d] + below + std::abs(m.area[d]));
  }
  if (std::isinf(error)) offer(m.volume[0] + area_on_upper_u(piece), m.magnitude[0] + 1);
  return std::abs(best) <= 16 * epsilon * error ? 0 : best;
}

class Finder {
 public:
  Finder(const SplineGrid& grid, const Trimming& trimming, const TrimOptions& options)
      : grid_(grid), trimming_(trimming), options_(options), depth_(sliver_depth(grid, options)),
        rounding_(detail::volume_rounding(grid)), touched_(trimming.pieces.spans.size()),
        splitters_([&] { return SpanSplitter(grid, trimming); }) {}

  PieceGraph run() {
    tbb::parallel_for(std::size_t{0}, touched_.size(), [&](std::size_t t) {
      if (state(trimming_.pieces.spans[t]) != SpanState::Exterior) look_at(t, splitters_.local());
    });
    number_pieces();
    link_all();
    return std::move(graph_);
  }

 private:
  SpanState state(std::int64_t span) const {
    return static_cast<SpanState>(trimming_.state[static_cast<std::size_t>(span)]);
  }
  Point3 corner(std::int64_t span) const {
    const Index3 ijk = grid_.span_index(span);
    return {static_cast<double>(ijk[0]), static_cast<double>(ijk[1]), static_cast<double>(ijk[2])};
  }

  void look_at(std::size_t t, SpanSplitter& splitter) {
    TouchedSpan& out = touched_[t];
    splitter.split(t);
    for (std::size_t d = 0; d < 3; ++d) out.lies_in_lower[d] = splitter.covers(2 * d);
    out.clear = splitter.reliable() && splitter.num_pieces() > 0;
    if (out.clear && splitter.num_pieces() > 1) out.clear = take_pieces(t, splitter, out);
    if (!out.clear) {
      out.pieces.clear();
      out.num_pieces = 1;
      for (std::size_t f = 0; f < 6; ++f) out.faces[f] = static_cast<FaceState>(trimming_.face_state[6 * t + f]);
    } else if (out.pieces.empty()) {
      for (std::size_t f = 0; f < 6; ++f) out.faces[f] = splitter.face(0, f);
    }
  }

  // False where the pieces do not add up to the span.
  bool take_pieces(std::size_t t, const SpanSplitter& splitter, TouchedSpan& out) const {
    const SurfacePieces& pieces = trimming_.pieces;
    const Point3 low = corner(pieces.spans[t]);
    out.pieces.resize(static_cast<std::size_t>(splitter.num_pieces()));
    const auto owner = splitter.polygon_pieces();
    for (std::size_t q = 0; q < owner.size(); ++q)
      if (owner[q] >= 0)
        out.pieces[static_cast<std::size_t>(owner[q])].polygons.push_back(pieces.offsets[t] +
                                                                          static_cast<std::int64_t>(q));
    double total = 0;
    std::size_t largest = 0;
    for (std::size_t k = 0; k < out.pieces.size(); ++k) {
      SplitPiece& piece = out.pieces[k];
      for (std::size_t f = 0; f < 6; ++f) piece.faces[f] = splitter.face(static_cast<std::int32_t>(k), f);
      if (std::all_of(piece.faces.begin(), piece.faces.end(), [](FaceState f) { return f == FaceState::Crossed; }))
        for (const auto* list : {&splitter.traces(1), &splitter.edge_stretches(1)})
          for (const FaceTrace& b : *list)
            if (b.piece == static_cast<std::int32_t>(k)) piece.bounds.push_back({b.x0, b.y0, b.x1, b.y1});
      OwnMoments m;
      for (const std::int64_t q : piece.polygons) m.add(pieces.polygon(q), low);
      piece.sliver = m.depth <= depth_;
      piece.fraction = piece_volume(m, piece);
      total += piece.fraction;
      if (piece.fraction > out.pieces[largest].fraction) largest = k;
    }
    if (!(std::abs(total - trimming_.touched_fraction[t]) <= same_volume)) return false;
    const bool whole = state(pieces.spans[t]) == SpanState::Interior;
    std::int32_t count = 0;
    for (std::size_t k = 0; k < out.pieces.size(); ++k) {
      SplitPiece& piece = out.pieces[k];
      const bool counts = !piece.sliver && piece.fraction > rounding_ && piece.fraction >= options_.min_fraction;
      if (whole ? k == largest : counts) piece.number = count++;
    }
    if (count == 0) out.pieces[largest].number = count++;
    out.num_pieces = count;
    for (const SplitPiece& piece : out.pieces)
      if (count == 1 && piece.number == 0) out.faces = piece.faces;
    return true;
  }

  void number_pieces() {
    const std::size_t n = trimming_.active.size();
    graph_.first.assign(n + 1, 0);
    for (std::size_t a = 0; a < n; ++a) {
      const std::int64_t t = trimming_.touched[a];
      const auto first = graph_.first[a];
      graph_.first[a + 1] = first + 1;
      if (t < 0) continue;
      const TouchedSpan& span = touched_[static_cast<std::size_t>(t)];
      graph_.first[a + 1] = first + span.num_pieces;
      if (!span.clear) {
        ++graph_.unclear;
        if (graph_.first_unclear < 0) graph_.first_unclear = trimming_.active[a];
      }
      for (const SplitPiece& piece : span.pieces)
        if (piece.number < 0)
          for (const std::int64_t q : piece.polygons)
            graph_.left_out_polygons.emplace_back(static_cast<std::int64_t>(a), q);
      if (span.num_pieces < 2) continue;
      for (const SplitPiece& piece : span.pieces) {
        if (piece.number >= 0) {
          graph_.parts.push_back({static_cast<std::int32_t>(first + piece.number), static_cast<std::int64_t>(a),
                                  piece.fraction, piece.faces, piece.polygons, piece.bounds});
        } else {
          graph_.left_out.push_back(
              {static_cast<std::int64_t>(a), piece.fraction, !piece.sliver && piece.fraction > rounding_});
        }
      }
    }
    std::sort(graph_.left_out_polygons.begin(), graph_.left_out_polygons.end());
  }

  void link_all() {
    const std::size_t n = trimming_.active.size(), block_size = 1024;
    std::vector<std::vector<PieceLink>> blocks((n + block_size - 1) / block_size);
    tbb::enumerable_thread_specific<SpanSplitter> others([&] { return SpanSplitter(grid_, trimming_); });
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
      for (std::size_t a = b * block_size; a < std::min(n, (b + 1) * block_size); ++a) {
        const Index3 ijk = grid_.span_index(trimming_.active[a]);
        for (std::size_t d = 0; d < 3; ++d) {
          Index3 next = ijk;
          if (++next[d] >= grid_.spans()[d]) continue;
          const std::int64_t number = grid_.span_number(next);
          if (state(number) == SpanState::Exterior) continue;
          const auto found = std::lower_bound(trimming_.active.begin() + static_cast<std::ptrdiff_t>(a),
                                              trimming_.active.end(), number);
          link(a, static_cast<std::size_t>(found - trimming_.active.begin()), d, splitters_.local(), others.local(),
               blocks[b]);
        }
      }
      std::sort(blocks[b].begin(), blocks[b].end());
      blocks[b].erase(
          std::unique(blocks[b].begin(), blocks[b].end(),
                      [](const PieceLink& x, const PieceLink& y) { return x.low == y.low && x.high == y.high; }),
          blocks[b].end());
    });
    for (const auto& block : blocks) graph_.links.insert(graph_.links.end(), block.begin(), block.end());
  }

  const TouchedSpan* touched(std::size_t a) const {
    const std::int64_t t = trimming_.touched[a];
    return t < 0 ? nullptr : &touched_[static_cast<std::size_t>(t)];
  }

  // What the n-th piece of a span that counts shows on a face.
  static FaceState face(const TouchedSpan* span, std::int32_t n, std::size_t f) {
    if (!span) return FaceState::Full;
    if (span->num_pieces == 1) return span->faces[f];
    for (const SplitPiece& piece : span->pieces)
      if (piece.number == n) return piece.faces[f];
    return FaceState::Empty;
  }

  void link(std::size_t a, std::size_t b, std::size_t axis, SpanSplitter& below, SpanSplitter& above,
            std::vector<PieceLink>& out) const {
    const TouchedSpan *low = touched(a), *high = touched(b);
    const std::size_t up = 2 * axis + 1, down = 2 * axis;
    const std::int32_t num_low = low ? low->num_pieces : 1, num_high = high ? high->num_pieces : 1;
    const auto add = [&](std::int32_t m, std::int32_t n) {
      if (m >= 0 && n >= 0)
        out.push_back({static_cast<std::int32_t>(graph_.first[a]) + m, static_cast<std::int32_t>(graph_.first[b]) + n,
                       static_cast<std::uint8_t>(axis)});
    };
    const bool simple = num_low == 1 && num_high == 1 && !(high && high->lies_in_lower[axis]);
    const bool unclear = (low && !low->clear) || (high && !high->clear);
    bool whole = false; // one side fills the face: whatever the other shows is shared
    for (std::int32_t m = 0; m < num_low; ++m) whole = whole || face(low, m, up) == FaceState::Full;
    for (std::int32_t n = 0; n < num_high; ++n) whole = whole || face(high, n, down) == FaceState::Full;
    if (simple || unclear || whole) {
      for (std::int32_t m = 0; m < num_low; ++m)
        for (std::int32_t n = 0; n < num_high; ++n)
          if (face(low, m, up) != FaceState::Empty && face(high, n, down) != FaceState::Empty) add(m, n);
      return;
    }
    below.split(static_cast<std::size_t>(trimming_.touched[a]));
    above.split(static_cast<std::size_t>(trimming_.touched[b]));
    const auto number = [](const TouchedSpan& span, std::int32_t piece) {
      if (piece < 0) return std::int32_t{-1};
      return span.pieces.empty() ? 0 : span.pieces[static_cast<std::size_t>(piece)].number;
    };
    const auto key = [](const FaceTrace& t) { return std::array<double, 4>{t.x0, t.y0, t.x1, t.y1}; };
    std::vector<FaceTrace> other = above.traces(down);
    std::sort(other.begin(), other.end(), [&](const FaceTrace& x, const FaceTrace& y) { return key(x) < key(y); });
    std::vector<std::uint8_t> met(other.size());
    const auto beside = [](const FaceTrace& t) { // a place just inside the solid
      constexpr double nudge = 1e-7;
      return std::array<double, 2>{0.5 * (t.x0 + t.x1) - nudge * (t.y1 - t.y0),
                                   0.5 * (t.y0 + t.y1) + nudge * (t.x1 - t.x0)};
    };
    for (const FaceTrace& t : below.traces(up)) {
      const auto found = std::lower_bound(other.begin(), other.end(), key(t),
                                          [&](const FaceTrace& x, const auto& k) { return key(x) < k; });
      if (found != other.end() && key(*found) == key(t)) {
        met[static_cast<std::size_t>(found - other.begin())] = 1;
        add(number(*low, t.piece), number(*high, found->piece));
      } else {
        const auto [x, y] = beside(t);
        add(number(*low, t.piece), number(*high, above.piece_at(down, x, y)));
      }
    }
    for (std::size_t k = 0; k < other.size(); ++k) {
      if (met[k]) continue;
      const auto [x, y] = beside(other[k]);
      add(number(*low, below.piece_at(up, x, y)), number(*high, other[k].piece));
    }
  }

  const SplineGrid& grid_;
  const Trimming& trimming_;
  const TrimOptions& options_;
  double depth_;
  double rounding_; // of a volume, in span volumes: a piece of no more is none
  std::vector<TouchedSpan> touched_;
  tbb::enumerable_thread_specific<SpanSplitter> splitters_;
  PieceGraph graph_;
};

} // namespace

PieceGraph find_pieces(const SplineGrid& grid, const Trimming& trimming, const TrimOptions& options) {
  return Finder(grid, trimming, options).run();
}

} // namespace iga::prep
