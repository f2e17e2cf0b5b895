#include "preprocessor/connectivity/line_winding.hpp"

#include "preprocessor/connectivity/lattice_nodes.hpp"
#include "preprocessor/connectivity/line_lattice.hpp"
#include "preprocessor/connectivity/shared_functions.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <span>
#include <utility>

namespace iga::prep {

namespace {

// A crossing this close to a span's face (span units) counts on both sides of it: the triangle and the clipped piece
// may round to different sides.
constexpr double face_noise = 1e-9;

/// A stretch of one line where the winding number is wrong.
struct BadStretch {
  int winding = 0;
  double length = 0; ///< in spans
  std::int64_t line = -1;
  double middle = 0; ///< span units along the line

  // How far from 0 … 1; a stretch that is only wrong because it does not end counts least.
  int severity() const { return std::max(winding - 1, -winding); }
  bool worse_than(const BadStretch& other) const {
    if (other.line < 0) return line >= 0;
    if (severity() != other.severity()) return severity() > other.severity();
    return length > other.length;
  }
};

struct SlabReport {
  std::int64_t num_crossings = 0, bad_lines = 0;
  double bad_length = 0; ///< in spans
  BadStretch worst;
};

bool is_bad(int winding) {
  return winding < 0 || winding > 1;
}

// Follows one line's winding number. Consecutive wrong stretches are one: coincident faces split them at random.
void judge_line(std::span<const LineCrossing> crossings, double line_end, double sliver_tolerance, SlabReport& report) {
  bool bad = false;
  BadStretch run;
  double run_start = 0, longest = 0;
  const auto close_run = [&](double end) {
    run.length = end - run_start;
    run.middle = 0.5 * (run_start + end);
    if (run.length <= sliver_tolerance) return;
    bad = true;
    report.bad_length += run.length;
    if (run.worse_than(report.worst)) report.worst = run;
  };
  int winding = 0;
  bool in_run = false;
  for (std::size_t c = 0; c < crossings.size(); ++c) {
    winding += crossings[c].change;
    const double at = crossings[c].at, next = c + 1 < crossings.size() ? crossings[c + 1].at : line_end;
    if (is_bad(winding)) {
      if (!in_run) {
        run_start = at;
        longest = -1;
      }
      in_run = true;
      if (next - at > longest) {
        longest = next - at;
        run.winding = winding;
        run.line = crossings[c].line;
      }
    } else if (in_run) {
      close_run(at);
      in_run = false;
    }
  }
  if (in_run) close_run(line_end);
  if (winding != 0 && !is_bad(winding)) { // leaks out of the grid
    const BadStretch open{winding, line_end - crossings.back().at, crossings.back().line,
                          0.5 * (line_end + crossings.back().at)};
    if (open.worse_than(report.worst)) report.worst = open;
  }
  report.bad_lines += bad || winding != 0;
}

/// The touched spans in the order in which lines along one axis meet them: by slab, then row, then along the row.
struct TouchedOrder {
  std::vector<std::size_t> touched;     ///< numbers in SurfacePieces::spans
  std::vector<std::int64_t> slab_first; ///< (num_slabs + 1)
};

TouchedOrder order_touched(const SplineGrid& grid, const SurfacePieces& pieces, std::size_t d) {
  const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
  const Index3 n = grid.spans();
  std::vector<std::pair<std::int64_t, std::size_t>> keys(pieces.spans.size());
  TouchedOrder out;
  out.slab_first.assign(static_cast<std::size_t>(n[e]) + 1, 0);
  for (std::size_t t = 0; t < keys.size(); ++t) {
    const Index3 ijk = grid.span_index(pieces.spans[t]);
    keys[t] = {(ijk[e] * n[f] + ijk[f]) * n[d] + ijk[d], t};
    ++out.slab_first[static_cast<std::size_t>(ijk[e]) + 1];
  }
  tbb::parallel_sort(keys.begin(), keys.end());
  for (std::size_t s = 0; s + 1 < out.slab_first.size(); ++s) out.slab_first[s + 1] += out.slab_first[s];
  out.touched.reserve(keys.size());
  for (const auto& [key, t] : keys) out.touched.push_back(t);
  return out;
}

/// Follows the lines along one axis: judges them and records what they see at the lattice nodes of touched spans.
class AxisPass {
 public:
  AxisPass(const SplineGrid& grid, const TriangleMesh& mesh, const std::vector<Point3>& xi, const SurfacePieces& pieces,
           LineLattice lattice, double sliver_tolerance, std::size_t axis, LatticeNodes& nodes)
      : grid_(grid), pieces_(pieces), lattice_(lattice), sliver_tolerance_(sliver_tolerance), d_(axis),
        e_((axis + 1) % 3), f_((axis + 2) % 3), nodes_(nodes), shooter_(grid, mesh, xi, lattice, axis),
        order_(order_touched(grid, pieces, axis)) {}

  void run(WindingReport& report, BadStretch& worst) {
    std::vector<SlabReport> slabs(static_cast<std::size_t>(shooter_.num_slabs()));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slabs.size(), 1), [&](const auto& range) {
      std::vector<LineCrossing> crossings;
      for (std::size_t s = range.begin(); s != range.end(); ++s) {
        shooter_.shoot(static_cast<std::int64_t>(s), crossings);
        slabs[s] = judge_slab(crossings);
        record_nodes(s, crossings);
      }
    });
    report.num_lines += count_rows() * lattice_.per_span * lattice_.per_span;
    for (std::size_t s = 0; s < slabs.size(); ++s) {
      report.num_crossings += slabs[s].num_crossings;
      report.bad_lines += slabs[s].bad_lines;
      report.bad_length += slabs[s].bad_length * grid_.span_size()[d_];
      if (!slabs[s].worst.worse_than(worst)) continue;
      worst = slabs[s].worst;
      report.worst_winding = worst.winding;
      report.where = position(static_cast<std::int64_t>(s), worst);
    }
  }

 private:
  SlabReport judge_slab(const std::vector<LineCrossing>& crossings) const {
    SlabReport report;
    report.num_crossings = static_cast<std::int64_t>(crossings.size());
    const auto line_end = static_cast<double>(grid_.spans()[d_]);
    for (std::size_t first = 0, last = 0; first < crossings.size(); first = last) {
      while (last < crossings.size() && crossings[last].line == crossings[first].line) ++last;
      judge_line(std::span(crossings).subspan(first, last - first), line_end, sliver_tolerance_, report);
    }
    return report;
  }

  Point3 position(std::int64_t slab, const BadStretch& stretch) const {
    const std::int64_t n = lattice_.per_span;
    Point3 xi, u;
    xi[d_] = stretch.middle;
    xi[e_] = lattice_.coordinate(e_, slab * n + stretch.line % n);
    xi[f_] = lattice_.coordinate(f_, stretch.line / n);
    for (std::size_t c = 0; c < 3; ++c) u[c] = grid_.A()[c] + grid_.span_size()[c] * xi[c];
    return grid_.to_position(u);
  }

  Index3 index(std::size_t touched) const { return grid_.span_index(pieces_.spans[touched]); }

  std::int64_t count_rows() const {
    std::int64_t rows = 0;
    for (std::size_t q = 0; q < order_.touched.size(); ++q) {
      const Index3 a = index(order_.touched[q]), b = index(order_.touched[q == 0 ? 0 : q - 1]);
      rows += q == 0 || a[e_] != b[e_] || a[f_] != b[f_];
    }
    return rows;
  }

  void record_nodes(std::size_t slab, const std::vector<LineCrossing>& crossings) {
    const std::int64_t n = lattice_.per_span;
    auto q = static_cast<std::size_t>(order_.slab_first[slab]);
    const auto end = static_cast<std::size_t>(order_.slab_first[slab + 1]);
    auto c = crossings.begin();
    while (q < end) {
      const std::size_t row_first = q;
      const std::int64_t row = index(order_.touched[q])[f_];
      while (q < end && index(order_.touched[q])[f_] == row) ++q;
      const std::span<const std::size_t> spans(order_.touched.data() + row_first, q - row_first);
      while (c != crossings.end() && c->line < row * n * n) ++c;
      while (c != crossings.end() && c->line < (row + 1) * n * n) {
        const auto first = c;
        while (c != crossings.end() && c->line == first->line) ++c;
        record_line(spans, {&*first, static_cast<std::size_t>(c - first)}, row);
      }
    }
  }

  void record_line(std::span<const std::size_t> spans, std::span<const LineCrossing> crossings, std::int64_t row) {
    const std::int64_t n = lattice_.per_span;
    Index3 m{};
    m[e_] = crossings.front().line % n;
    m[f_] = crossings.front().line / n - row * n;
    std::size_t c = 0;
    int winding = 0;
    const auto pass = [&](double limit) { // crossings below the limit; true where there are any
      const std::size_t before = c;
      for (; c < crossings.size() && crossings[c].at < limit; ++c) winding += crossings[c].change;
      return c > before;
    };
    for (const std::size_t t : spans) {
      const std::int64_t span = index(t)[d_];
      const auto face = static_cast<double>(span);
      pass(face);
      bool blocked = c > 0 && crossings[c - 1].at >= face - face_noise;
      for (m[d_] = 0; m[d_] < n; ++m[d_]) {
        blocked |= pass(lattice_.coordinate(d_, span * n + m[d_]));
        if (blocked) nodes_.set_blocked(t, d_, m);
        if (d_ == 0 && winding > 0) nodes_.set_inside(t, nodes_.node(m));
        blocked = false;
      }
      if (c < crossings.size() && crossings[c].at < face + 1 + face_noise) nodes_.set_blocked(t, d_, m);
    }
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  LineLattice lattice_;
  double sliver_tolerance_;
  std::size_t d_, e_, f_;
  LatticeNodes& nodes_;
  LineShooter shooter_;
  TouchedOrder order_;
};

} // namespace

WindingReport check_winding(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                            double sliver_tolerance) {
  const auto degree = grid.degree();
  const LineLattice lattice{*std::max_element(degree.begin(), degree.end()) + 2};
  const std::vector<Point3> xi = to_span_units(grid, mesh);
  LatticeNodes nodes(static_cast<std::int64_t>(trimming.pieces.spans.size()), lattice);
  WindingReport report;
  BadStretch worst;
  for (std::size_t axis = 0; axis < 3; ++axis)
    AxisPass(grid, mesh, xi, trimming.pieces, lattice, sliver_tolerance, axis, nodes).run(report, worst);
  const SharedFunctions shared = find_shared_functions(grid, trimming.pieces, trimming.state, nodes);
  report.shared_functions = shared.count;
  if (shared.count > 0) report.shared_where = grid.control_point(grid.function_index(shared.first));
  return report;
}

} // namespace iga::prep
