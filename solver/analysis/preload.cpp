#include "solver/analysis/preload.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/geometric_stiffness.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// Displacements of this share of the part's size are no longer small.
constexpr double small_displacement = 0.02;

void refuse_what_is_static(const StaticSettings& statics, std::span<const Load> loads) {
  if (!statics.cases.empty())
    throw InputError("[[case]]: load cases are those of static runs; for modes under load and buckling leave the cases "
                     "out of the run file: all its loads act together");
  if (statics.inertia_relief)
    throw InputError("inertia_relief: modes under load and buckling need a part that supports hold; leave it out and "
                     "add a [[support]]");
  for (const Load& load : loads)
    if (load.rigid)
      throw InputError(fmt::format("load '{}': spread = \"rigid\" holds its region in static runs alone, not in what "
                                   "vibrates or buckles; use spread = \"even\"",
                                   load.name));
}

/// Fields of one body of a solution, wherever it keeps them.
struct BodyFields {
  const std::vector<double>& positions;
  const FieldSamples& points;
};

BodyFields fields_of(const StaticSolution& solution, std::size_t b) {
  if (solution.bodies.empty()) return {solution.result.positions, solution.result.points};
  return {solution.bodies[b].positions, solution.bodies[b].points};
}

// Elastic strain: that of the stress.
double largest_strain(const BodySystem& system, const StaticSolution& solution) {
  double largest = 0;
  for (std::size_t b = 0; b < system.size(); ++b) {
    const auto [positions, points] = fields_of(solution, b);
    const VoigtMatrix compliance = system[b].material.C.inverse();
    for (std::size_t q = 0; 3 * q < positions.size(); ++q) {
      const Voigt e = compliance * Eigen::Map<const Voigt>(&points.stress[6 * q]);
      const double squares = e.head<3>().squaredNorm() + 0.5 * e.tail<3>().squaredNorm(); // engineering shear
      if (squares <= largest) continue;
      const Point3 x{positions[3 * q], positions[3 * q + 1], positions[3 * q + 2]};
      if (!singular_place_near(solution, system.name_among_several(b), x)) largest = squares;
    }
  }
  return std::sqrt(largest);
}

// -ω² M_⊥ of what turns about an axis. Where it speeds up, the force α × u that u adds is skew: no stiffness.
void add_spin_softening(const BodySystem& system, std::span<const Load> loads,
                        const std::shared_ptr<const Connectivity>& connectivity, StiffnessMatrix& L) {
  const auto spins = [](const Load& load) { return load.kind == LoadKind::Centrifugal; };
  if (std::none_of(loads.begin(), loads.end(), spins)) return;
  const MassMatrix M = assemble_mass(system, connectivity);
  for (const Load& load : loads) {
    if (!spins(load)) continue;
    const Eigen::Vector3d axis = spin_axis(load);
    const Eigen::Matrix3d across =
        -load.spin.speed * load.spin.speed * (Eigen::Matrix3d::Identity() - axis * axis.transpose());
    for (const SystemBody& body : system)
      if (load.body.empty() || load.body == body.name)
        add_blocks(M, across, L, body.first_node, body.first_node + body.space->num_nodes());
  }
}

// Of springs between two ends, and of the masses on bodies that a load acts on.
void add_attached(const BodySystem& system, const BoundSystem& bound, const Eigen::VectorXd& u,
                  std::span<const Load> loads, StiffnessMatrix& L) {
  add_spring_stress(system, bound.springs, u, L);
  for (const Load& load : loads)
    for (const PreparedMass& mass : bound.masses)
      if (acts_on_mass(load.kind) && (load.body.empty() || load.body == system[mass.body].name))
        add_inertia_stiffness(system, mass, load, L);
}

StiffnessMatrix load_stiffness(const BodySystem& system, const BoundSystem& bound, const StaticSolution& solution,
                               std::span<const Load> loads) {
  const std::shared_ptr<const Connectivity>& connectivity = bound.K.shared_connectivity();
  std::vector<std::span<const double>> stress;
  for (std::size_t b = 0; b < system.size(); ++b) stress.emplace_back(fields_of(solution, b).points.stress);
  StiffnessMatrix L(connectivity);
  add_blocks(assemble_geometric_stiffness(system, connectivity, stress), Eigen::Matrix3d::Identity(), L, 0,
             system.num_nodes());
  add_spin_softening(system, loads, connectivity, L);
  add_attached(system, bound, solution.unknowns, loads, L);
  return L;
}

double diagonal_of(const BodySystem& system) {
  const auto points = system.node_points();
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

// They are as many as ten copies of the displacement.
void drop_fields(StaticSolution& solution) {
  solution.result.points = {};
  solution.result.positions = {};
  solution.surface = {};
  solution.bodies.clear();
}

} // namespace

Preload make_preload(const RunSettings& run, const PreloadChoice& choice, const BodySystem& system,
                     const BoundSystem& bound) {
  refuse_what_is_static(run.statics, choice.loads);
  RunSettings under_load = run;
  StaticSettings statics = run.statics;
  statics.loads = choice.loads;
  statics.bolts = choice.bolts;
  if (!choice.others) statics.temperature.reset();
  if (!choice.others)
    for (Support& support : under_load.supports) {
      support.value = {};
      support.gradient = {};
    }
  Preload preload;
  for (const Load& load : choice.loads) preload.names.push_back(load.name);
  for (const Bolt& bolt : choice.bolts) preload.names.push_back(bolt.name);
  preload.loads = choice.loads;
  preload.solution = run_static(under_load, statics, system);
  preload.warnings = preload.solution.warnings;
  preload.largest_strain = largest_strain(system, preload.solution);
  preload.stiffness = load_stiffness(system, bound, preload.solution, choice.loads);
  drop_fields(preload.solution);
  const double share = preload.solution.largest_displacement.value / diagonal_of(system);
  if (share > small_displacement)
    preload.warnings.push_back(fmt::format("the preload moves the part by {:.2g} of its size: the linear preload holds "
                                           "for small displacements only",
                                           share));
  return preload;
}

PreloadChoice all_of(const StaticSettings& statics) {
  return {statics.loads, statics.bolts, true};
}

std::vector<std::string> preload_notes(const RunSettings& run, const Preload& preload) {
  std::vector<std::string> notes{
      "linear: displacements under the loads are small; forces keep their directions and act "
      "on the same material"};
  const auto has = [&](LoadKind kind) {
    return std::any_of(preload.loads.begin(), preload.loads.end(), [kind](const Load& l) { return l.kind == kind; });
  };
  if (has(LoadKind::Pressure)) notes.push_back("pressure keeps its direction too: it does not turn with the surface");
  if (has(LoadKind::Centrifugal))
    notes.push_back("in the turning frame: its force grows where the part moves away from the axis (spin softening); "
                    "Coriolis forces, which couple modes into forward and backward whirl, are left out");
  if (std::any_of(run.supports.begin(), run.supports.end(),
                  [](const Support& s) { return s.method != SupportMethod::Lagrange; }))
    notes.push_back("supports hold weakly: what they give way is as in a static run");
  if (std::any_of(run.springs.begin(), run.springs.end(), [](const Spring& s) { return !s.to || s.total; }))
    notes.push_back("springs keep the directions of their forces, but for axial ones between two ends, which turn with "
                    "the line between these");
  return notes;
}

} // namespace iga::solve
