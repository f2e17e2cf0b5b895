// Suffix sums. For fixed (v, w) each crossing s of the surface contributes sign(n_u) to every point left of it, so a
// span's volume is Σ over its own pieces of ∫ (ξ - i) n_u dA plus the projected area of all pieces further right in its
// row; no face of a span needs closing. Everything is relative to the span's corner, where differences are exact.
#include "preprocessor/trim/trim.hpp"

#include "format/model/model_check.hpp"
#include "format/model/span_state.hpp"
#include "preprocessor/trim/own_moments.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::prep {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Spans of one row (fixed j, k): touched spans [first, last), and the interior runs between them.
struct Row {
  std::size_t first, last;
};

std::vector<Row> find_rows(const SurfacePieces& pieces, std::int64_t num_u) {
  std::vector<Row> rows;
  std::int64_t row_end = 0; // first span behind the row
  for (std::size_t t = 0; t < pieces.spans.size(); ++t) {
    if (pieces.spans[t] >= row_end) {
      rows.push_back({t, t});
      row_end = (pieces.spans[t] / num_u + 1) * num_u;
    }
    rows.back().last = t + 1;
  }
  return rows;
}

FaceState uniform(double value) {
  return value > 0.5 ? FaceState::Full : FaceState::Empty;
}

struct JudgedVolume {
  double volume = 0;
  double leak = 0; ///< how far a uniform face is from being empty or full
};

// A face that no piece reaches is empty or full; the volume tells which. Returns the volume computed from such faces,
// which is exact relative to the span's own pieces where the span is nearly empty.
JudgedVolume judge_faces(const OwnMoments& m, double volume, std::uint8_t* faces) {
  double refined = volume, leak = 0;
  double smallest = m.magnitude[0] + 1; // what the row's sum is relative to
  for (std::size_t d = 0; d < 3; ++d) {
    const double upper = volume - m.volume[d];
    const double lower = upper + m.far_area[d];
    const FaceState up = m.touches[2 * d + 1] ? FaceState::Crossed : uniform(upper);
    const FaceState low = m.touches[2 * d] ? FaceState::Crossed : uniform(lower);
    if (up != FaceState::Crossed) leak = std::max(leak, std::min(std::abs(upper), std::abs(upper - 1)));
    if (low != FaceState::Crossed) leak = std::max(leak, std::min(std::abs(lower), std::abs(lower - 1)));
    faces[2 * d] = static_cast<std::uint8_t>(low);
    faces[2 * d + 1] = static_cast<std::uint8_t>(up);
    double value = 0, error = std::numeric_limits<double>::infinity();
    if (up != FaceState::Crossed) {
      value = m.volume[d] + (up == FaceState::Full ? 1.0 : 0.0);
      error = m.magnitude[d] + (up == FaceState::Full ? 1.0 : 0.0);
    } else if (low == FaceState::Empty) {
      value = m.volume[d] - m.far_area[d];
      error = m.magnitude[d] + std::abs(m.far_area[d]);
    }
    if (error < smallest) {
      smallest = error;
      refined = value;
    }
  }
  if (std::abs(refined) <= 16 * epsilon * smallest) refined = 0; // sheets that cancel, not a solid
  return {refined, leak};
}

} // namespace

double sliver_depth(const SplineGrid& grid, const TrimOptions& options) {
  const Point3 rounding = detail::parameter_rounding(grid);
  return std::max({options.sliver_tolerance, rounding[0], rounding[1], rounding[2]});
}

Trimming trim(const SplineGrid& grid, const TriangleMesh& mesh, const TrimOptions& options) {
  Trimming out;
  out.pieces = clip_to_spans(grid, mesh);
  const SurfacePieces& pieces = out.pieces;
  const Index3 n = grid.spans();
  const double span_volume = grid.span_volume();
  const double depth = sliver_depth(grid, options);
  const std::vector<Row> rows = find_rows(pieces, n[0]);
  out.state.assign(static_cast<std::size_t>(grid.num_spans()), static_cast<std::uint8_t>(SpanState::Exterior));
  out.touched_fraction.resize(pieces.spans.size());
  out.face_state.resize(6 * pieces.spans.size());

  struct RowResult {
    std::int64_t num_active = 0;
    double volume = 0, snapped = 0, dropped = 0; // in span volumes
    std::int64_t num_snapped = 0, num_dropped = 0;
    Leak leak;
  };
  std::vector<RowResult> results(rows.size());

  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t r) {
    RowResult& row = results[r];
    const std::int64_t row_start = pieces.spans[rows[r].first] / n[0] * n[0];
    double right = 0; // projected area of all pieces further right = the solid's area on the face looked at
    std::int64_t next = row_start + n[0];
    const auto note_leak = [&](std::int64_t span, double error) {
      if (error > row.leak.error) row.leak = {grid.span_index(span), error};
    };
    const auto fill = [&](std::int64_t from, std::int64_t to) { // untouched spans [from, to)
      if (from >= to) return;
      const bool inside = right > 0.5;
      note_leak(to - 1, std::abs(right - (inside ? 1.0 : 0.0)));
      if (!inside) return;
      std::fill(out.state.begin() + from, out.state.begin() + to, static_cast<std::uint8_t>(SpanState::Interior));
      row.num_active += to - from;
      row.volume += static_cast<double>(to - from);
    };
    for (std::size_t t = rows[r].last; t-- > rows[r].first;) {
      const std::int64_t span = pieces.spans[t];
      fill(span + 1, next);
      next = span;
      const Index3 ijk = grid.span_index(span);
      const Point3 corner{static_cast<double>(ijk[0]), static_cast<double>(ijk[1]), static_cast<double>(ijk[2])};
      OwnMoments m;
      for (std::int64_t q = pieces.offsets[t]; q < pieces.offsets[t + 1]; ++q) m.add(pieces.polygon(q), corner);
      const double raw = m.volume[0] + right;
      right += m.area[0];
      note_leak(span, std::max(-raw, raw - 1));
      const auto [fraction, face_leak] = judge_faces(m, raw, &out.face_state[6 * t]);
      note_leak(span, face_leak);
      out.touched_fraction[t] = fraction;
      row.volume += fraction;
      SpanState state = SpanState::Trimmed;
      if (m.depth <= depth) {
        state = fraction > 0.5 ? SpanState::Interior : SpanState::Exterior;
        const double change = (state == SpanState::Interior ? 1.0 : 0.0) - fraction;
        row.snapped += change;
        if (std::abs(change) > 1e-12) ++row.num_snapped; // more than rounding
      } else if (fraction <= 0) {
        state = SpanState::Exterior;
      } else if (fraction < options.min_fraction) {
        state = SpanState::Exterior;
        row.dropped += fraction;
        ++row.num_dropped;
      }
      out.state[static_cast<std::size_t>(span)] = static_cast<std::uint8_t>(state);
      row.num_active += state != SpanState::Exterior;
    }
    fill(row_start, next);
  });

  std::vector<std::size_t> first(rows.size() + 1, 0);
  long double volume = 0, snapped = 0, dropped = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    first[r + 1] = first[r] + static_cast<std::size_t>(results[r].num_active);
    volume += results[r].volume;
    snapped += results[r].snapped;
    dropped += results[r].dropped;
    out.snapped_spans += results[r].num_snapped;
    out.dropped_spans += results[r].num_dropped;
    out.worst_leak = std::max(out.worst_leak, results[r].leak.error);
  }
  out.exact_volume = static_cast<double>(volume) * span_volume;
  out.snapped_volume = static_cast<double>(snapped) * span_volume;
  out.dropped_volume = static_cast<double>(dropped) * span_volume;

  constexpr double leak_noise = 1e-9; // rounding of a row stays far below this; a missing facet lies far above
  for (const RowResult& row : results)
    if (row.leak.error > leak_noise) out.leaks.push_back(row.leak);
  out.num_leaks = static_cast<std::int64_t>(out.leaks.size());
  std::stable_sort(out.leaks.begin(), out.leaks.end(), [](const Leak& a, const Leak& b) { return a.error > b.error; });
  if (out.leaks.size() > 20) out.leaks.resize(20);

  out.active.resize(first.back());
  out.fraction.resize(first.back());
  out.touched.resize(first.back());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t r) {
    const std::int64_t row_start = pieces.spans[rows[r].first] / n[0] * n[0];
    std::size_t a = first[r], t = rows[r].first;
    for (std::int64_t span = row_start; span < row_start + n[0]; ++span) {
      while (t < rows[r].last && pieces.spans[t] < span) ++t;
      if (out.state[static_cast<std::size_t>(span)] == static_cast<std::uint8_t>(SpanState::Exterior)) continue;
      const bool touched = t < rows[r].last && pieces.spans[t] == span;
      out.active[a] = span;
      out.touched[a] = touched ? static_cast<std::int64_t>(t) : -1;
      out.fraction[a++] = touched ? out.touched_fraction[t] : 1.0;
    }
  });
  return out;
}

} // namespace iga::prep
