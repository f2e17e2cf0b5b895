// Everything the interchange file holds, as plain data: what igaprep writes and igasolve reads.
#pragma once

#include "format/model/span_state.hpp"
#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace iga {

/// Quadrature points of all active spans, stored as parallel arrays.
/// Invariant: every point lies in its closed span and inside the solid; every weight is positive.
struct IntegrationPoints {
  std::vector<std::int64_t>
      offsets; ///< (num_active + 1); the a-th active span owns points [a] … [a + 1) - 1; entries may repeat
  std::vector<double> parameters; ///< (num_points × 3), row-major, knot space
  std::vector<double> weights;    ///< (num_points); physical volume, length³
  std::vector<double> residual;   ///< (num_active); relative moment residual of a trimmed span, 0 for an interior one
};

/// How the points were made and what was left out; attributes of /quadrature.
struct QuadratureInfo {
  std::string interior_rule = "gauss"; ///< gauss | ggq | ggq-reduced | ggq-reduced2
  std::string trimmed_rule = "nnls";   ///< nnls | minimal
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

/// Points on the embedded surface: triangles cut at span faces, grouped by active span.
/// Invariants: Σ weights per region = area of the region; Σ n w = 0; Σ x·n w = 3 volume.
struct SurfacePoints {
  std::vector<std::int64_t> offsets;  ///< (num_active + 1)
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
  std::vector<std::int64_t> vertex_span; ///< (n_v); linear number of the active span that owns the vertex
  SurfacePoints quadrature;
  double accepted_leak = 0; ///< worst leak the user accepted, in span volumes; 0 for a closed surface
  std::int64_t bodies = 0;  ///< separate bodies that the surface encloses (cavities not counted); 0 where not known
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

/// One part in its grid. Active spans are the INTERIOR and TRIMMED ones in ascending linear number.
struct TrimmedModel {
  std::string title;
  std::string length_unit = "unspecified";
  SplineGrid grid;
  std::vector<std::uint8_t> state;     ///< (n_w, n_v, n_u) of spans, u fastest; values of SpanState
  std::vector<std::int64_t> active;    ///< (num_active); linear span numbers, ascending
  std::vector<double> volume_fraction; ///< (num_active); exact, from the trimming
  IntegrationPoints points;
  QuadratureInfo quadrature;
  std::vector<std::int64_t>
      active_functions;              ///< (n_f); linear numbers of functions whose support holds material, ascending
  std::vector<double> mass_fraction; ///< (n_f); ∫_Ω N dV / ∫ N dV over the whole grid, in (0, 1]
  EmbeddedSurface surface;
  Provenance provenance;
};

/// Everything wrong with a model, one sentence each; empty for a sound one. At most `limit` entries per kind.
/// Checks what schema/README.md lists: shapes, states against points, weights > 0, points inside their closed spans
/// (1e-9 h), finite numbers, volumes, ownership of the surface. The surface's integrals are not judged where a leak was
/// accepted (surface.accepted_leak > 0).
std::vector<std::string> check(const TrimmedModel& model, int limit = 5);

/// How far a surface point may lie off its triangle: the sliver depth, by which a point is clamped to its span, and
/// rounding. Length.
double surface_depth(const TrimmedModel& model);

} // namespace iga
