#include "solver/space/span_advice.hpp"

#include "format/model/rounded_down.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/solution_space.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

constexpr double spans_across = 2; // of a wall, for bending and for well-filled functions
constexpr double flat = 1.5;       // a part no thicker than this many times its walls lies along a grid axis
constexpr double many_spans = 1e6; // beyond this the advice names the number

std::vector<std::int64_t> all_spans(const TrimmedModel& model) {
  std::vector<std::int64_t> spans(model.cells.span.size());
  for (std::size_t a = 0; a < spans.size(); ++a) spans[a] = static_cast<std::int64_t>(a);
  return spans;
}

double volume_of(const TrimmedModel& model, const std::vector<std::int64_t>& spans) {
  double volume = 0;
  for (const std::int64_t a : spans) volume += model.cells.volume_fraction[static_cast<std::size_t>(a)];
  return volume * model.grid.span_volume();
}

// Extents of the surface's points along the grid's axes, length.
Point3 extents(const TrimmedModel& model, const std::vector<std::int64_t>& spans) {
  Point3 low, high;
  low.fill(INFINITY);
  high.fill(-INFINITY);
  for (const std::int64_t a : spans) {
    const auto u = surface_parameters(model, a);
    for (std::size_t k = 0; k < u.size(); ++k) {
      low[k % 3] = std::min(low[k % 3], u[k]);
      high[k % 3] = std::max(high[k % 3], u[k]);
    }
  }
  return {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
}

// Twice the volume over the area of surface of some active spans: the thickness of a wall, half that of a square bar.
// Length; infinite where they hold no surface.
double wall_thickness(const TrimmedModel& model, const std::vector<std::int64_t>& spans) {
  double area = 0;
  const auto& q = model.surface.quadrature;
  for (const std::int64_t a : spans)
    for (auto s = q.offsets[static_cast<std::size_t>(a)]; s < q.offsets[static_cast<std::size_t>(a) + 1]; ++s)
      area += q.weights[static_cast<std::size_t>(s)];
  return area > 0 ? 2 * volume_of(model, spans) / area : std::numeric_limits<double>::infinity();
}

} // namespace

std::string span_advice(const TrimmedModel& model, const std::vector<std::int64_t>& chosen) {
  const std::vector<std::int64_t> spans = chosen.empty() ? all_spans(model) : chosen;
  const double thickness = wall_thickness(model, spans);
  const Point3 h = model.grid.span_size(), size = extents(model, spans);
  const double wanted = rounded_down(thickness / spans_across, 2);
  Point3 finer = h;
  bool flat_part = false;
  for (std::size_t d = 0; d < 3; ++d)
    if (size[d] <= flat * thickness) {
      flat_part = true;
      finer[d] = std::min(h[d], wanted);
    }
  if (!flat_part)
    for (double& f : finer) f = std::min(f, wanted);
  if (!(wanted > 0) || finer == h) return "";
  const std::string start =
      fmt::format("its walls are about {:.2g} thick, its spans measure {:.3g}; ", thickness, fmt::join(h, " × "));
  const double count = volume_of(model, spans) / (finer[0] * finer[1] * finer[2]);
  if (count <= many_spans)
    return start +
           fmt::format("igaprep --span-size {:.3g} puts {} spans across a wall", fmt::join(finer, " "), spans_across);
  return start +
         fmt::format("two across a wall would be about {:.1g} spans: try igaprep --span-size {:.3g}, or turn the "
                     "grid with --rotate-axis-angle so that the wall is parallel to two of its axes and give "
                     "small spans along the third one only",
                     count, fmt::join(times(h, 0.25), " "));
}

} // namespace iga::solve
