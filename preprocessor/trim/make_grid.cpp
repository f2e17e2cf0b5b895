#include "preprocessor/trim/make_grid.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <unistd.h>

namespace iga::prep {

namespace {

constexpr double default_spans = 20; // along the part's longest side

double longest(const Point3& sides) {
  return *std::max_element(sides.begin(), sides.end());
}

Point3 sides_of(const Box3& box) {
  return {box.upper[0] - box.lower[0], box.upper[1] - box.lower[1], box.upper[2] - box.lower[2]};
}

// Fewest whole spans that hold a length given in spans.
double whole_spans(double length) {
  return std::max(1.0, std::ceil(length - whole_span_tolerance));
}

// Box of the points R^T (x - origin).
Box3 local_box(const TriangleMesh& mesh, const Rotation& R, const Point3& origin) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box3 box{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) {
      const Point3& x = mesh.vertices[static_cast<std::size_t>(v)];
      for (std::size_t d = 0; d < 3; ++d) {
        double y = 0;
        for (std::size_t r = 0; r < 3; ++r) y += R[r][d] * (x[r] - origin[r]);
        box.lower[d] = std::min(box.lower[d], y);
        box.upper[d] = std::max(box.upper[d], y);
      }
    }
  return box;
}

// Refuses a grid whose states (one byte per span) and knots cannot be held, before anything is allocated.
void check_memory(const Point3& counts) {
  const double total = counts[0] * counts[1] * counts[2];
  const double bytes = total + 8 * (counts[0] + counts[1] + counts[2]);
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  // Half of the memory is left to the active spans, their points and the surface.
  if (bytes <= 0.5 * memory) return;
  constexpr double gib = 1024.0 * 1024 * 1024;
  throw InputError(
      fmt::format("the grid would have {:.4g} spans ({:.10g} × {:.10g} × {:.10g}); their states alone need {:.3g} GiB "
                  "and this machine has {:.3g} GiB: choose a larger span_size or fewer spans",
                  total, counts[0], counts[1], counts[2], bytes / gib, memory / gib));
}

Index3 as_index(const Point3& counts) {
  return {static_cast<std::int64_t>(counts[0]), static_cast<std::int64_t>(counts[1]),
          static_cast<std::int64_t>(counts[2])};
}

std::string text(const Point3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]);
}

void check_part_inside(const TriangleMesh& mesh, const SplineGrid& grid) {
  Point3 centre;
  for (std::size_t d = 0; d < 3; ++d) centre[d] = grid.A()[d] + 0.5 * (grid.B()[d] - grid.A()[d]);
  const bool rotated = grid.rotation() != identity_rotation;
  Box3 part = local_box(mesh, grid.rotation(), rotated ? centre : Point3{});
  double out = 0;
  std::size_t worst = 0;
  bool missed = false;
  for (std::size_t d = 0; d < 3; ++d) {
    if (rotated) part.lower[d] += centre[d], part.upper[d] += centre[d];
    missed = missed || part.upper[d] <= grid.A()[d] || part.lower[d] >= grid.B()[d];
    // Rounding of the coordinates themselves; typed digits of a box are far coarser.
    const double slack = 1e-14 * (std::abs(grid.A()[d]) + std::abs(grid.B()[d]));
    const double beyond = std::max(grid.A()[d] - part.lower[d], part.upper[d] - grid.B()[d]);
    if (beyond > std::max(slack, out)) {
      out = beyond;
      worst = d;
    }
  }
  const std::string where = fmt::format("the box from A {} to B {}", text(grid.A()), text(grid.B()));
  const std::string frame = rotated ? "in the grid's axes, " : "";
  if (missed)
    throw InputError(
        fmt::format("{} misses the part, which reaches from {} to {}; {}check the box and the part's units "
                    "(scale)",
                    where, text(part.lower), text(part.upper), frame));
  if (out > 0)
    throw InputError(
        fmt::format("the part sticks out of {} by {:.6g} along {}: {}it reaches from {} to {}; enlarge the box "
                    "or leave it out",
                    where, out, "xyz"[worst], frame, text(part.lower), text(part.upper)));
}

GridChoice grid_in_box(const TriangleMesh& mesh, const GridOptions& options) {
  const auto& [A, B] = *options.box;
  const Point3 sides = sides_of({A, B});
  const Point3 h = wanted_size(options, sides);
  GridChoice choice;
  Point3 counts;
  for (std::size_t d = 0; d < 3; ++d) {
    counts[d] = std::max(1.0, std::round(sides[d] / h[d]));
    const double adjusted = sides[d] / counts[d];
    // A remainder that only rounding left is no adjustment.
    if (options.spans.size() != 3 && std::abs(adjusted - h[d]) > 1e-9 * h[d])
      choice.notes.push_back(fmt::format("the span size {:.6g} does not divide the box along {} ({:.6g}): adjusted to "
                                         "{:.6g}, {:.0f} spans",
                                         h[d], "xyz"[d], sides[d], adjusted, counts[d]));
  }
  check_memory(counts);
  choice.grid = SplineGrid(A, B, as_index(counts), options.degree, options.rotation);
  check_part_inside(mesh, choice.grid);
  return choice;
}

} // namespace

Point3 wanted_size(const GridOptions& options, const Point3& sides) {
  const auto cubic = [](double h) { return Point3{h, h, h}; };
  if (options.span_size.size() == 3) return {options.span_size[0], options.span_size[1], options.span_size[2]};
  if (options.span_size.size() == 1) return cubic(options.span_size[0]);
  if (options.spans.size() == 1) return cubic(longest(sides) / static_cast<double>(options.spans[0]));
  if (options.spans.empty()) return cubic(longest(sides) / default_spans);
  Point3 h;
  for (std::size_t d = 0; d < 3; ++d) h[d] = sides[d] / static_cast<double>(options.spans[d]);
  return h;
}

void check_options(const GridOptions& options) {
  if (!options.spans.empty() && !options.span_size.empty())
    throw InputError("both spans and span_size are given; one of them fixes the grid: leave the other out");
  for (const std::int64_t n : options.spans)
    if (n < 1) throw InputError(fmt::format("spans = {}: a direction needs at least one span", n));
  for (const double h : options.span_size)
    if (!(h > 0) || !std::isfinite(h))
      throw InputError(fmt::format("span_size = {}: a span's size must be a positive number", h));
  for (const int p : options.degree)
    if (p < 1 || p > max_degree)
      throw InputError(fmt::format("degree = {}: supported degrees are 1 … {}", p, max_degree));
  if (options.margin && *options.margin < 0)
    throw InputError(fmt::format("margin = {}: the margin is a number of whole spans, 0 or more", *options.margin));
  if (!options.box) return;
  if (options.margin)
    throw InputError("margin and box are both given; an explicit box is the whole grid: leave the margin out");
  const auto& [A, B] = *options.box;
  for (std::size_t d = 0; d < 3; ++d)
    if (!std::isfinite(B[d] - A[d]) || !(B[d] > A[d]))
      throw InputError(fmt::format("the box is empty along {}: from {} to {}; B must lie beyond A in every direction",
                                   "xyz"[d], A[d], B[d]));
}

GridChoice make_grid(const TriangleMesh& mesh, const GridOptions& options) {
  check_options(options);
  if (mesh.triangles.empty()) throw InputError("the surface has no triangles: there is nothing to put a grid around");
  if (options.box) return grid_in_box(mesh, options);

  GridFrame frame;
  frame.degree = options.degree;
  frame.rotation = options.rotation;
  if (options.rotation != identity_rotation) {
    const Box3 box = bounding_box(mesh);
    for (std::size_t d = 0; d < 3; ++d) frame.origin[d] = box.lower[d] + 0.5 * (box.upper[d] - box.lower[d]);
  }
  frame.part = local_box(mesh, frame.rotation, frame.origin);
  const Point3 sides = sides_of(frame.part);
  for (std::size_t d = 0; d < 3; ++d) {
    if (!(sides[d] > 0))
      throw InputError(fmt::format("the part has no extent along {} ({:.6g} to {:.6g}): it encloses no volume",
                                   "xyz"[d], frame.part.lower[d], frame.part.upper[d]));
    frame.margin[d] = options.margin.value_or(options.degree[d]);
  }
  frame.span_size = wanted_size(options, sides);

  // One span more per direction than the centred grid: shifted grids may need it.
  Point3 counts;
  for (std::size_t d = 0; d < 3; ++d)
    counts[d] = whole_spans(sides[d] / frame.span_size[d]) + 2 * static_cast<double>(frame.margin[d]) + 1;
  check_memory(counts);
  GridChoice choice;
  choice.grid = place_grid(frame, centred_offset(frame));
  choice.frame = frame;
  return choice;
}

Point3 centred_offset(const GridFrame& frame) {
  const Point3 sides = sides_of(frame.part);
  Point3 offset;
  for (std::size_t d = 0; d < 3; ++d) {
    const double length = sides[d] / frame.span_size[d];
    offset[d] = 0.5 * (whole_spans(length) - length);
  }
  return offset;
}

SplineGrid place_grid(const GridFrame& frame, const Point3& offset) {
  const Point3 sides = sides_of(frame.part);
  const bool rotated = frame.rotation != identity_rotation;
  Point3 counts, A, B;
  for (std::size_t d = 0; d < 3; ++d) {
    const double h = frame.span_size[d];
    const auto margin = static_cast<double>(frame.margin[d]);
    counts[d] = whole_spans(offset[d] + sides[d] / h) + 2 * margin;
    A[d] = frame.part.lower[d] - (offset[d] + margin) * h;
    B[d] = A[d] + counts[d] * h;
    if (frame.margin[d] == 0) {
      // Nothing but the part's own box may then hold what rounding leaves over.
      const double slack = rotated ? 1e-14 * (std::abs(frame.origin[d]) + sides[d]) : 0;
      A[d] = std::min(A[d], frame.part.lower[d] - slack);
      B[d] = std::max(B[d], frame.part.upper[d] + slack);
    }
  }
  if (rotated) {
    Point3 centre = frame.origin;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t d = 0; d < 3; ++d) centre[r] += frame.rotation[r][d] * 0.5 * (A[d] + B[d]);
    for (std::size_t d = 0; d < 3; ++d) {
      const double half = 0.5 * (B[d] - A[d]);
      A[d] = centre[d] - half;
      B[d] = centre[d] + half;
    }
  }
  return SplineGrid(A, B, as_index(counts), frame.degree, frame.rotation);
}

} // namespace iga::prep
