#include "preprocessor/connectivity/line_winding.hpp"

#include "preprocessor/connectivity/line_lattice.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>

namespace iga::prep {

namespace {

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

/// Follows the lines along one axis and judges them.
class AxisPass {
 public:
  AxisPass(const SplineGrid& grid, const TriangleMesh& mesh, const std::vector<Point3>& xi, const SurfacePieces& pieces,
           LineLattice lattice, double sliver_tolerance, std::size_t axis)
      : grid_(grid), pieces_(pieces), lattice_(lattice), sliver_tolerance_(sliver_tolerance), d_(axis),
        e_((axis + 1) % 3), f_((axis + 2) % 3), shooter_(grid, mesh, xi, lattice, axis) {}

  void run(WindingReport& report, BadStretch& worst) {
    std::vector<SlabReport> slabs(static_cast<std::size_t>(shooter_.num_slabs()));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, slabs.size(), 1), [&](const auto& range) {
      std::vector<LineCrossing> crossings;
      for (std::size_t s = range.begin(); s != range.end(); ++s) {
        shooter_.shoot(static_cast<std::int64_t>(s), crossings);
        slabs[s] = judge_slab(crossings);
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

  // Rows of spans along the axis that hold a touched span.
  std::int64_t count_rows() const {
    const Index3 n = grid_.spans();
    std::vector<std::uint8_t> held(static_cast<std::size_t>(n[e_] * n[f_]), 0);
    for (const std::int64_t span : pieces_.spans) {
      const Index3 ijk = grid_.span_index(span);
      held[static_cast<std::size_t>(ijk[e_] + n[e_] * ijk[f_])] = 1;
    }
    return std::count(held.begin(), held.end(), 1);
  }

  const SplineGrid& grid_;
  const SurfacePieces& pieces_;
  LineLattice lattice_;
  double sliver_tolerance_;
  std::size_t d_, e_, f_;
  LineShooter shooter_;
};

} // namespace

WindingReport check_winding(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming,
                            double sliver_tolerance) {
  const auto degree = grid.degree();
  const LineLattice lattice{*std::max_element(degree.begin(), degree.end()) + 2};
  const std::vector<Point3> xi = to_span_units(grid, mesh);
  WindingReport report;
  BadStretch worst;
  for (std::size_t axis = 0; axis < 3; ++axis)
    AxisPass(grid, mesh, xi, trimming.pieces, lattice, sliver_tolerance, axis).run(report, worst);
  return report;
}

} // namespace iga::prep
