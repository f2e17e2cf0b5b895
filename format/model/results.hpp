// What an analysis found, as plain data: what igasolve writes beside the model and what pictures are drawn from.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace iga {

/// What every results file says about its origin.
struct ResultsHeader {
  std::string analysis; ///< eigen | static | explicit
  std::string title;    ///< the model's
  std::string length_unit = "unspecified";
  std::string model_file;              ///< base name of the interchange file
  std::string model_sha256;            ///< of its bytes, lower-case hex
  std::string light_functions{"none"}; ///< none | remove | linear | degree-p
  double light_threshold = 0;          ///< mass fraction below which a function was light
  std::int64_t unknowns = 0;           ///< of the system that was solved, supports by multipliers not counted
  double density = 0;                  ///< mass/length³
  std::array<double, 36> stiffness{}; ///< C of σ = C ε, row-major; xx yy zz xy yz zx, engineering shear; force/length²
  Provenance provenance;              ///< inputs: the model, then the run file; findings: warnings
};

/// What fields are at given points, for one or more steps (modes, load cases, times). Each array is
/// (num_steps × num_points × components), row-major; an array that was not asked for is empty.
struct FieldSamples {
  std::vector<double> displacement; ///< 3: x y z; length
  std::vector<double> strain;       ///< 6: xx yy zz xy yz zx, shear strains are engineering strains
  std::vector<double> stress;       ///< 6: xx yy zz xy yz zx; force/length²
  std::vector<double> von_mises;    ///< 1; force/length²
};

/// The embedded surface, made fine enough to show the fields.
struct OutputMesh {
  TriangleMesh mesh;              ///< undeformed, in the part's frame
  std::vector<double> parameters; ///< (n_v × 3), row-major, knot space, in the closed span that owns the vertex
  std::vector<std::int64_t> span; ///< (n_v); linear number of the active span that owns the vertex
};

/// Fields on the embedded surface, step by step.
struct SurfaceResult {
  OutputMesh output;
  std::vector<double> steps; ///< (num_steps), ascending: mode number from 1, load step from 1, or time
  FieldSamples fields;       ///< at the vertices of the mesh
  std::int64_t num_steps() const { return static_cast<std::int64_t>(steps.size()); }
};

/// Natural modes: rigid ones, mechanisms, elastic ones, each ascending in frequency.
struct EigenResult {
  enum Kind : std::uint8_t {
    Rigid = 0,     ///< a rigid motion: no strain energy
    Elastic = 1,   ///< an ordinary mode
    Mechanism = 2, ///< no strain energy and yet no rigid motion: badly supported functions
  };
  std::string mass = "consistent";   ///< consistent | lumped | two-pass | three-pass
  double complete_below = 0;         ///< 1/time: a Sturm count proves that no mode below is missing; 0: not counted
  std::vector<double> frequencies;   ///< (n_modes), cycles/time; 0 or rounding for rigid modes
  std::vector<double> omega_squared; ///< (n_modes), 1/time²; as computed, may be slightly negative for rigid modes
  std::vector<double> residuals;     ///< (n_modes), ‖K φ - ω² M φ‖ relative as the solver's documentation says
  std::vector<std::uint8_t> kind;    ///< (n_modes), values of Kind
  std::vector<double> modes;         ///< (n_modes × n_f × 3): coefficients of all active functions, φᵀ M φ = 1
};

/// What holds the part on one region.
struct SupportResult {
  std::string name;
  std::string method; ///< nitsche | penalty | lagrange
  double area = 0;    ///< length²
  Point3 centroid{};  ///< length
  Point3 force{};     ///< of the support on the part
  Point3 moment{};    ///< about the region's centroid, force · length
};

/// One load and its resultant.
struct LoadResult {
  std::string name;
  std::string kind;  ///< body force | traction | pressure | point
  double area = 0;   ///< length²; 0 for body forces and point loads
  Point3 centroid{}; ///< of what it acts on, length
  Point3 force{};    ///< on the part
  Point3 moment{};   ///< about that centroid, force · length
};

/// Points that the user asked for.
struct ProbeResult {
  std::vector<std::string> names;
  std::vector<double> positions; ///< (n × 3), length
  FieldSamples fields;           ///< one step
};

struct StaticResult {
  double strain_energy = 0;         ///< ½ uᵀ K u, without the supports' terms; force · length
  double external_work = 0;         ///< ½ fᵀ u of the loads; force · length
  std::vector<double> displacement; ///< (n_f × 3): coefficients of all active functions, length
  std::vector<double> positions;    ///< (num_points × 3) of the model's quadrature points, length
  FieldSamples points;              ///< one step, at the model's quadrature points in their order
  ProbeResult probes;
  std::vector<SupportResult> supports;
  std::vector<LoadResult> loads;
};

/// What changes with time in an explicit analysis. Energies in force · length; each (num_times) or empty.
struct TimeSeries {
  static constexpr std::array energy_names{"internal", "kinetic",  "contact", "friction",
                                           "damping",  "external", "eroded"};
  struct Contact {
    std::string name;
    std::vector<double> force; ///< (num_times × 3); on the first-named body
  };
  std::vector<double> time;
  std::array<std::vector<double>, energy_names.size()> energy;
  std::vector<Contact> contacts;
};

/// All that one results file holds; parts that an analysis has not are absent.
struct Results {
  ResultsHeader header;
  std::vector<std::int64_t> active_functions; ///< (n_f), the model's: coefficients are in their order
  std::optional<EigenResult> eigen;
  std::optional<StaticResult> statics;
  std::optional<TimeSeries> time_series;
  std::optional<SurfaceResult> surface;
};

} // namespace iga
