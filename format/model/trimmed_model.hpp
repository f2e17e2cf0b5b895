// Everything the interchange file holds, as plain data: what igaprep writes and igasolve reads.
#pragma once

#include "format/model/span_state.hpp"
#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace iga {

/// What an analysis loops over. A cell is one *piece* of one span: a connected part of solid ∩ span. Most spans with
/// material hold one; pieces of a span that see the same functions are one cell.
struct Cells {
  std::vector<std::int64_t> span;  ///< (num_cells); linear span number, ascending, repeated where a span holds several
  std::vector<std::uint8_t> state; ///< (num_cells); SpanState: INTERIOR (the whole span) or TRIMMED
  std::vector<double> volume_fraction; ///< (num_cells); of the span; exact, from the trimming
  std::vector<std::int32_t> functions; ///< (num_cells × (p_u + 1)(p_v + 1)(p_w + 1)), u fastest: entries into Functions
};

/// The functions that carry the solution: one *copy* of a B-spline for each connected part of the solid in its support.
struct Functions {
  std::vector<std::int64_t> number;  ///< (n_f); the B-spline's linear number, ascending, repeated for its copies
  std::vector<double> mass_fraction; ///< (n_f); ∫ N over the copy's cells / ∫ N over the whole grid, in (0, 1]
};

/// Where a gap ends inside the support of a B-spline, the cells beside it have B-splines of their own, and what carries
/// the solution is a smaller set of *unknowns*: coefficients of functions = C · unknowns. Columns of C are continuous
/// on the solid: a B-spline copy elsewhere, inside these cells a Bernstein function of the grid's degree (continuous,
/// not smooth, across faces), one copy for each connected part of the solid in its own support of 2³ spans at most. All
/// empty where every function is an unknown of its own (no gap ends).
struct Unknowns {
  std::vector<std::int64_t> offsets; ///< (n_f + 1); function f has the terms offsets[f] … offsets[f + 1] - 1 of its row
  std::vector<std::int32_t> terms;   ///< unknown of each term, ascending within a row
  std::vector<double> weights;       ///< entry of C of each term; a row's sum is 1
  /// (n_u); the function that an unknown is the coefficient of, ascending; -1 for Bernstein functions, which follow.
  std::vector<std::int32_t> function;
  std::vector<double> parameters;    ///< (n_u × 3), knot space: Greville point; the coefficients of u(x) = x
  std::vector<double> mass_fraction; ///< (n_u); as Functions::mass_fraction, in (0, 1]
  bool empty() const { return offsets.empty(); }
};

/// Cells of face-neighbouring spans that share solid area on the common face.
struct CellLinks {
  std::vector<std::int32_t> cells; ///< (n_links × 2); lower cell number first, sorted
  std::size_t size() const { return cells.size() / 2; }
  std::pair<std::int32_t, std::int32_t> operator[](std::size_t link) const {
    return {cells[2 * link], cells[2 * link + 1]};
  }
  /// First link that does not come before the pair.
  std::size_t first_from(std::pair<std::int32_t, std::int32_t> pair) const;
};

/// Quadrature points of all cells, stored as parallel arrays.
/// Invariant: every point lies in its closed span and inside the solid; every weight is positive.
struct IntegrationPoints {
  std::vector<std::int64_t> offsets; ///< (num_cells + 1); cell c owns points [c] … [c + 1) - 1; entries may repeat
  std::vector<double> parameters;    ///< (num_points × 3), row-major, knot space
  std::vector<double> weights;       ///< (num_points); physical volume, length³
  std::vector<double> residual;      ///< (num_cells); relative moment residual of a trimmed cell, 0 for an interior one
};

/// How the points were made and what was left out; attributes of /quadrature.
struct QuadratureInfo {
  std::string interior_rule = "gauss"; ///< gauss | ggq | ggq-reduced | ggq-reduced2
  std::string trimmed_rule = "nnls";   ///< nnls | minimal
  std::string surface_rule = "exact";  ///< exact (for products of functions) | reduced (fewer points on small facets)
  std::array<int, 3> moment_degree{2, 2, 2};
  double tolerance = 1e-10; ///< bound on every residual
  double max_residual = 0;
  double sliver_tolerance = 2e-5; ///< depth in spans below which a cut is snapped to the span's face
  double min_fraction = 0;        ///< trimmed spans below this fraction were dropped
  double part_volume = 0;    ///< volume enclosed by the surface, length³ (Σ fractions · span volume where it leaks)
  double snapped_volume = 0; ///< added by snapping to INTERIOR less removed by snapping to EXTERIOR, length³
  double dropped_volume = 0; ///< removed by min_fraction, length³
  std::int64_t snapped_spans = 0;
  std::int64_t dropped_spans = 0;
};

/// Points on the embedded surface: triangles cut at span faces, grouped by cell.
/// Invariants: Σ weights per region = area of the region; Σ n w = 0; Σ x·n w = 3 volume.
struct SurfacePoints {
  std::vector<std::int64_t> offsets;  ///< (num_cells + 1)
  std::vector<double> parameters;     ///< (n × 3), row-major, knot space, inside the closed span
  std::vector<double> weights;        ///< (n); area, length²
  std::vector<double> normals;        ///< (n × 3); outward unit normals in space
  std::vector<std::int32_t> triangle; ///< (n); the surface triangle a point lies on
};

/// The embedded surface as given (repaired), tied to the grid.
struct EmbeddedSurface {
  TriangleMesh mesh; ///< in the STL's frame
  std::vector<double>
      vertex_parameters; ///< (n_v × 3), row-major, knot space, clamped into the closed span that owns the vertex
  std::vector<std::int64_t> vertex_cell; ///< (n_v); the cell that owns the vertex
  SurfacePoints quadrature;
  double accepted_leak = 0; ///< worst leak the user accepted, in span volumes; 0 for a closed surface
  std::int64_t bodies = 0;  ///< separate bodies that the surface encloses (cavities not counted); 0 where not known
};

/// Named lines in space, mostly edges of the CAD model: supports and loads act along them. They lie on the surface, as
/// near as its triangles follow the CAD model's faces. All empty where the model has none.
struct Curves {
  std::vector<std::string> names; ///< (n_curves); none empty, none twice
  std::vector<std::int64_t>
      offsets; ///< (n_curves + 1); curve c has the points offsets[c] … offsets[c + 1] - 1, two or more
  std::vector<Point3>
      points; ///< (n); in space, length; straight pieces between neighbours; a closed curve ends at its first
  std::size_t size() const { return names.size(); }
  bool empty() const { return names.empty(); }
  std::span<const Point3> points_of(std::size_t curve) const {
    const auto first = static_cast<std::size_t>(offsets[curve]);
    return std::span(points).subspan(first, static_cast<std::size_t>(offsets[curve + 1]) - first);
  }
};
/// Length of the straight pieces between neighbouring points.
double polyline_length(std::span<const Point3> points);

/// Named points in space, mostly vertices of the CAD model. All empty where the model has none.
struct Markers {
  std::vector<std::string> names; ///< (n_markers); none empty, none twice
  std::vector<Point3> positions;  ///< (n_markers); in space, length
  bool empty() const { return names.empty(); }
};

struct InputFile {
  std::string name;   ///< base name
  std::string sha256; ///< of its bytes, lower-case hex
};

/// Who made the file from what. Differs between runs; everything else in the file does not.
struct Provenance {
  std::string producer = "igaprep";
  std::string version;
  std::string command_line;
  std::vector<InputFile> inputs;
  std::string settings_sha256;                         ///< of the settings that affect data, in canonical form
  std::string created;                                 ///< UTC, ISO 8601
  std::vector<std::pair<std::string, double>> timings; ///< stage name, seconds
  std::vector<std::string> findings; ///< what was found and mended, or is worth knowing; one entry each
  std::vector<std::string> warnings; ///< what may make results wrong or inaccurate: every analysis repeats it
};

/// One part in its grid.
struct TrimmedModel {
  std::string title;
  std::string length_unit = "unspecified";
  SplineGrid grid;
  std::vector<std::uint8_t> state; ///< (n_w, n_v, n_u) of spans, u fastest; values of SpanState
  Cells cells;
  CellLinks links;
  IntegrationPoints points;
  QuadratureInfo quadrature;
  Functions functions;
  Unknowns unknowns;
  EmbeddedSurface surface;
  Curves curves;
  Markers markers;
  Provenance provenance;

  std::size_t num_cells() const { return cells.span.size(); }
  /// Is a cell a whole span?
  bool is_interior(std::size_t cell) const {
    return cells.state[cell] == static_cast<std::uint8_t>(SpanState::Interior);
  }
  /// First and last + 1 of the cells of a span; equal where it holds none.
  std::pair<std::size_t, std::size_t> cells_of(std::int64_t span) const;
  /// Function that an unknown is the coefficient of, -1 for Bernstein functions.
  std::int64_t function_of(std::size_t unknown) const {
    return unknowns.empty() ? static_cast<std::int64_t>(unknown) : std::int64_t{unknowns.function[unknown]};
  }
  /// visit(unknown, factor) for the terms of a function's coefficient.
  template <class Visit> void for_terms(std::int32_t function, Visit&& visit) const {
    if (unknowns.empty()) return visit(function, 1.0);
    const auto f = static_cast<std::size_t>(function);
    for (auto t = static_cast<std::size_t>(unknowns.offsets[f]); t < static_cast<std::size_t>(unknowns.offsets[f + 1]);
         ++t)
      visit(unknowns.terms[t], unknowns.weights[t]);
  }
  std::size_t num_unknowns() const { return unknowns.empty() ? functions.number.size() : unknowns.function.size(); }
  /// Share of its support that each unknown finds filled with material: (n_u).
  const std::vector<double>& unknown_mass_fraction() const {
    return unknowns.empty() ? functions.mass_fraction : unknowns.mass_fraction;
  }
  /// Has a cell B-splines of its own, because a gap ends nearby?
  bool is_at_gap_end(std::size_t cell) const;
  /// Functions that a cell sees: entries into `functions`, u fastest.
  std::span<const std::int32_t> functions_of(std::size_t cell) const {
    const std::size_t local = cells.functions.size() / cells.span.size();
    return {cells.functions.data() + cell * local, local};
  }
};

/// The cells that see each function, or each unknown.
struct FunctionCells {
  std::vector<std::size_t> first;  ///< (n_f + 1)
  std::vector<std::int32_t> cells; ///< those of function f: [first[f], first[f + 1]), ascending
  std::span<const std::int32_t> of(std::int64_t function) const {
    const auto f = static_cast<std::size_t>(function);
    return std::span(cells).subspan(first[f], first[f + 1] - first[f]);
  }
};
/// @pre cells.functions holds entries into functions only
FunctionCells cells_by_function(const TrimmedModel& model);

/// The unknowns that cells see: their functions where no gap ends, else what the coefficients of these follow from,
/// ascending.
class CellUnknowns {
 public:
  explicit CellUnknowns(const TrimmedModel& model);
  std::span<const std::int32_t> of(std::size_t cell) const {
    if (first_.empty()) return model_->functions_of(cell);
    return std::span(unknowns_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }
  FunctionCells by_unknown() const;

 private:
  const TrimmedModel* model_;
  std::vector<std::size_t> first_; // (num_cells + 1); empty where no gap ends
  std::vector<std::int32_t> unknowns_;
};

/// Connected part of each cell under the links: the lowest cell of the part; (num_cells).
std::vector<std::int32_t> connected_parts(const TrimmedModel& model);

struct CellCounts {
  std::int64_t split_spans = 0;      ///< spans with several cells
  std::int64_t copied_functions = 0; ///< B-splines with several copies, those at gap ends not counted
  std::int64_t gap_end_cells = 0;    ///< cells with B-splines of their own
  std::int64_t components = 0;       ///< of the cells under their links: bodies that move apart
};
CellCounts count_cells(const TrimmedModel& model);

/// Everything wrong with a model, one sentence each; empty for a sound one. At most `limit` entries per kind.
/// Checks what schema/README.md lists: shapes, states against points, weights > 0, points inside their closed spans
/// (1e-9 h), finite numbers, volumes, ownership of the surface. The surface's integrals are not judged where a leak was
/// accepted (surface.accepted_leak > 0).
std::vector<std::string> check(const TrimmedModel& model, int limit = 5);

/// How far a surface point may lie off its triangle: the sliver depth, by which a point is clamped to its span, and
/// rounding. Length.
double surface_depth(const TrimmedModel& model);

} // namespace iga
