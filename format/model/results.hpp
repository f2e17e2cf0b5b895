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
  std::string analysis; ///< eigen | static | buckling | explicit | nonlinear | heat | harmonic | random | transient
  std::string title;    ///< the model's
  std::string length_unit = "unspecified";
  std::string model_file;              ///< base name of the interchange file
  std::string model_sha256;            ///< of its bytes, lower-case hex
  std::string light_functions{"none"}; ///< none | remove | linear | degree-p
  double light_threshold = 0;          ///< mass fraction below which a function was light
  std::int64_t unknowns = 0;           ///< of the system that was solved, supports by multipliers not counted
  double density = 0;                  ///< mass/length³
  std::array<double, 36> stiffness{}; ///< C of σ = C ε, row-major; xx yy zz xy yz zx, engineering shear; force/length²
  Provenance provenance; ///< inputs: the model, then the run file; findings of the model, warnings of model and run
};

/// Where a part has next to no stress it could be multiplied for ever.
constexpr double largest_safety_factor = 1000;

/// What fields are at given points, for one or more steps (modes, load cases, times). Each array is
/// (num_steps × num_points × components), row-major; an array that was not asked for is empty.
struct FieldSamples {
  std::vector<double> displacement;         ///< 3: x y z; length
  std::vector<double> strain;               ///< 6: xx yy zz xy yz zx, shear strains are engineering strains
  std::vector<double> stress;               ///< 6: xx yy zz xy yz zx; force/length²
  std::vector<double> von_mises;            ///< 1; force/length²
  std::vector<double> temperature = {};     ///< 1
  std::vector<double> heat_flux = {};       ///< 3: x y z; power/length²
  std::vector<double> von_mises_error = {}; ///< 1; estimated, of stress that was recovered; force/length²
  std::vector<double> safety_factor = {};   ///< 1; yield strength / von_mises, at most largest_safety_factor
};

/// The embedded surface, made fine enough to show the fields.
struct OutputMesh {
  TriangleMesh mesh;              ///< undeformed, in the part's frame
  std::vector<double> parameters; ///< (n_v × 3), row-major, knot space, in the closed span that owns the vertex
  std::vector<std::int64_t> span; ///< (n_v); linear number of the span that owns the vertex
  std::vector<std::int64_t> cell; ///< (n_v); cell of the model that owns it; empty where an older file does not say it
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
  std::string mass = "consistent";       ///< consistent | lumped | two-pass | three-pass
  std::vector<std::string> preload = {}; ///< names of the loads under which the part vibrates; empty: none
  double complete_below = 0;             ///< 1/time: a Sturm count proves that no mode below is missing; 0: not counted
  std::vector<double> frequencies;       ///< (n_modes), cycles/time; 0 or rounding for rigid modes
  std::vector<double> omega_squared;     ///< (n_modes), 1/time²; as computed, may be slightly negative for rigid modes
  std::vector<double> residuals;  ///< (n_modes), ‖K φ - ω² M φ‖ relative as the solver's documentation says
  std::vector<std::uint8_t> kind; ///< (n_modes), values of Kind
  std::vector<double> modes;      ///< (n_modes × n_f × 3): coefficients of all active functions, φᵀ M φ = 1
  /// (n_modes × 3): participation φᵀ M r in translations along x, y, z and in rotations about the axes through the
  /// centre of mass; mass^(1/2), mass^(1/2) · length. Their squares are effective masses. Empty in files before 1.5.
  std::vector<double> participation, rotation_participation;
  Point3 centre_of_mass{}; ///< length
  double total_mass = 0;
  Point3 total_inertia{}; ///< about the axes x, y, z through the centre of mass; mass · length²
};

/// Linear buckling: factors on the loads at which the part has a second equilibrium beside the first.
struct BucklingResult {
  double complete_below = 0; ///< a Sturm count proves that no factor between 0 and this one is missing; 0: not counted
  std::vector<std::string> growing;  ///< names of the loads that the factor multiplies
  std::vector<std::string> constant; ///< of those that stay as they are
  std::vector<double> factors;       ///< (n_modes): positive ones, then negative ones, each ascending in size
  std::vector<double> residuals;     ///< (n_modes), ‖K φ + λ L φ‖ / ‖λ L φ‖
  std::vector<double> modes;         ///< (n_modes × n_f × 3): coefficients of all active functions
};

/// What holds the part on one region.
struct SupportResult {
  std::string name;
  std::string method; ///< nitsche | penalty | lagrange
  double area = 0;    ///< length²; 0 for lines and points
  Point3 centroid{};  ///< length
  Point3 force{};     ///< of the support on the part
  Point3 moment{};    ///< about the region's centroid, force · length
};

/// One spring and what it does to the part.
struct SpringResult {
  std::string name;
  double area = 0;   ///< length²; 0 for lines and points
  Point3 centroid{}; ///< length
  Point3 force{};    ///< of the spring on the part
  Point3 moment{};   ///< about the region's centroid, force · length
  double energy = 0; ///< force · length
};

/// One load and its resultant.
struct LoadResult {
  std::string name;
  std::string kind;  ///< "pressure", "bearing", …: schema/README.md lists them
  double area = 0;   ///< length²; 0 for body forces and loads on lines and at points
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

/// One of several load cases of a static analysis.
struct CaseResult {
  std::string name;
  std::vector<double> factors;       ///< (n_loads): how much of each load
  std::vector<double> displacement;  ///< (n_f × 3): coefficients of all active functions, length
  std::vector<Point3> support_force; ///< (n_supports), force
  double strain_energy = 0;          ///< force · length
  double largest_displacement = 0;   ///< length
  double largest_von_mises = 0;      ///< force/length²
};

struct StaticResult {
  double strain_energy = 0; ///< ½ uᵀ K u, without the supports' terms; force · length
  double external_work = 0; ///< ½ fᵀ u of the loads; force · length
  /// The rest of the energy balance: strain_energy + spring_energy + penalty_energy = external_work + support_work +
  /// gap_work + initial_strain_work.
  double spring_energy = 0;  ///< of all springs; force · length
  double support_work = 0;   ///< ½ ∫ t · u_D dA: of the reactions on prescribed displacements; force · length
  double gap_work = 0;       ///< Nitsche: ∫ (σ n) · (u - u_D) dA over the supports; force · length
  double penalty_energy = 0; ///< Nitsche and penalty: ½ ∫ β |u - u_D|² dA, and of rigid regions; force · length
  double initial_strain_work = 0; ///< -½ ∫ σ : ε₀ dV of strains without stress (heat, bolts); on the side of the works
  std::vector<double> displacement; ///< (n_f × 3): coefficients of all active functions, length
  std::vector<double> positions;    ///< (num_points × 3) of the model's quadrature points, length
  FieldSamples points;              ///< one step, at the model's quadrature points in their order
  ProbeResult probes;
  std::vector<SupportResult> supports;
  std::vector<SpringResult> springs; ///< since version 1.5 of the results file
  std::vector<LoadResult> loads;
  std::vector<CaseResult> cases = {}; ///< empty where there is one; the rest of the struct is then that of the first
};

/// Where heat enters or leaves a body.
struct HeatBoundaryResult {
  std::string name;
  std::string kind;       ///< "temperature", "flux", "convection", "source"
  double area = 0;        ///< length²; of sources the volume, length³
  Point3 centroid{};      ///< length
  double temperature = 0; ///< mean over it
  double power = 0;       ///< into the body
};

/// Steady conduction of heat.
struct HeatResult {
  std::vector<double> temperature; ///< (n_f): coefficients of all active functions
  std::vector<HeatBoundaryResult> boundaries;
  ProbeResult probes; ///< with temperature and heat flux
};

/// What changes with time in an explicit analysis, with the load in a nonlinear one: one row per output. Every series
/// has num_times · components entries, time slowest; one that is empty was not kept. format/model/time_series.hpp goes
/// through them one by one.
struct TimeSeries {
  static constexpr std::array energy_names{"internal", "kinetic",  "contact", "friction",
                                           "damping",  "external", "eroded"};
  struct Contact {
    std::string name;
    std::vector<double> force;               ///< 3; on the first-named body
    std::vector<double> impulse = {};        ///< 3; ∫ force dt since the start, step by step
    std::vector<double> normal_force = {};   ///< 1; Σ of the sizes
    std::vector<double> friction_force = {}; ///< 1
    std::vector<double> depth = {};          ///< 1; deepest penetration, length
    std::vector<double> area = {};           ///< 1; in contact, undeformed, length²
  };
  struct Body {
    std::string name;
    std::vector<double> momentum, angular_momentum; ///< 3; half a step later; angular about the origin
    std::vector<double> impulse, angular_impulse;   ///< 3; of all that acts from outside, since the start
    std::vector<double> min_volume_ratio;           ///< 1; smallest det F
    std::vector<double> inverted, eroded;           ///< 1; points so far (evaluation by evaluation; taken out)
  };
  struct Rigid {
    std::string name;
    std::vector<double> position; ///< 3; of the centre
    std::vector<double> rotation; ///< 4; unit quaternion w x y z from the start's axes to now
    std::vector<double> velocity; ///< 3; half a step later
    std::vector<double> force;    ///< 3; of all contacts
    std::vector<double> moment;   ///< 3; about the centre
  };
  struct Support {
    std::string name;
    std::vector<double> force; ///< 3; of the support on the body
  };
  struct Probe {
    std::string name;
    std::vector<double> displacement; ///< 3
  };
  std::vector<double> time;              ///< of nonlinear statics the load factor, 0 … 1
  std::vector<double> dt = {};           ///< of the step to come
  std::vector<double> energy_error = {}; ///< |change of the sum| / largest energy so far
  std::array<std::vector<double>, energy_names.size()> energy;
  std::vector<Contact> contacts;
  std::vector<Body> bodies = {};
  std::vector<Rigid> rigid = {};
  std::vector<Support> supports = {};
  std::vector<Probe> probes = {};
  std::vector<double> iterations = {}; ///< of Newton's method in the step
  std::vector<double> residual = {};   ///< that is left, relative to the forces
};

/// A body of an explicit or nonlinear analysis, or of one with several bodies, as the head of its results says.
struct BodyResult {
  std::string name;
  std::string model_file, model_sha256;
  std::string law;                     ///< as in the run file
  std::string mass;                    ///< consistent | lumped | two-pass | three-pass
  std::string light_functions{"none"}; ///< as in ResultsHeader
  double light_threshold = 0;
  std::int64_t unknowns = 0;
  double density = 0; ///< mass/length³
};

/// Which files beside the results file hold the fields; names relative to its folder.
struct FieldIndex {
  std::string bodies_file;        ///< meshes and functions of the bodies
  std::vector<double> times;      ///< (num_steps), ascending
  std::vector<std::string> files; ///< (num_steps)
};

/// What fields of one body refer to: written once.
struct BodyMesh {
  std::string name;
  std::vector<std::int64_t> active_functions; ///< (n_f), the model's
  OutputMesh surface;
};

/// Fields of one body at one time.
struct BodyFields {
  std::string name;
  std::vector<double> coefficients;   ///< (n_f × 3) of the displacement, length
  std::vector<double> displacement;   ///< (n_v × 3) of the surface's vertices, length
  std::vector<double> von_mises;      ///< (n_v); of the Cauchy stress, smoothed; force/length²
  std::vector<double> strain;         ///< (n_v); largest principal logarithmic strain by size, smoothed
  std::vector<double> plastic_strain; ///< (n_v); equivalent plastic strain, smoothed, or empty
  std::vector<double> point_stress;   ///< (n_points × 6) Cauchy at the model's quadrature points, or empty; xx … zx
  std::vector<double> point_plastic_strain; ///< (n_points), or empty
};

/// Fields of one of several bodies of an eigen or static analysis. They are written into field files, step by step, not
/// into the results file.
struct BodyPart {
  std::string name;
  std::vector<std::int64_t> active_functions; ///< (n_f), the model's
  std::vector<double> coefficients;           ///< (num_steps × n_f × 3)
  SurfaceResult surface;                      ///< with displacement, strain and von Mises stress
  std::vector<double> point_stress;           ///< (n_points × 6) of the only step, or empty
};

/// Named columns of numbers: frequency responses, spectra, histories.
struct ResultTable {
  std::string name;        ///< a name of a group: no slash
  std::string description; ///< one line
  std::vector<std::string> columns;
  std::vector<std::string> units; ///< by column, in the words of the schema: length, 1/time, force/length^2, …
  std::vector<double> values;     ///< (rows × columns), row-major
};

/// All that one results file holds; parts that an analysis has not are absent.
struct Results {
  ResultsHeader header;
  std::vector<std::int64_t> active_functions; ///< (n_f), the model's: coefficients are in their order
  std::optional<EigenResult> eigen;
  std::optional<StaticResult> statics;
  std::optional<HeatResult> heat = {};
  std::optional<BucklingResult> buckling = {};
  std::optional<TimeSeries> time_series;
  std::optional<SurfaceResult> surface;
  std::vector<BodyResult> bodies = {};   ///< explicit, and where there are several
  std::optional<FieldIndex> fields = {}; ///< likewise
  std::vector<ResultTable> tables = {};  ///< harmonic, random and transient analyses
  std::vector<BodyPart> parts = {};      ///< of several bodies, to be written; empty after reading
};

} // namespace iga
