#include "solver/response/response_system.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/analysis/participation.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/base/stopwatch.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/output/sample_fields.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void refuse_what_is_not_known(const RunSettings& run) {
  for (const Support& support : run.supports) {
    if (support.method == SupportMethod::Lagrange)
      throw InputError(fmt::format("support '{}': modal superposition knows no Lagrange multipliers; use method = "
                                   "\"nitsche\" or \"penalty\"",
                                   support.name));
    bool moves = norm(support.value) > 0;
    for (const Point3& row : support.gradient) moves = moves || norm(row) > 0;
    if (moves)
      throw InputError(fmt::format("support '{}': prescribes a displacement; in a response analysis supports rest, or "
                                   "all move together by [base]",
                                   support.name));
  }
  for (const Load& load : run.statics.loads)
    if (load.rigid)
      throw InputError(fmt::format("load '{}': a region that stays rigid is known to static analyses alone; use spread "
                                   "= \"even\"",
                                   load.name));
  const StaticSettings& statics = run.statics;
  const char* const unknown = statics.temperature      ? "[temperature]"
                              : !statics.bolts.empty() ? "[[bolt]]"
                              : !statics.cases.empty() ? "[[case]]"
                              : statics.inertia_relief ? "inertia_relief"
                              : run.eigen.prestress    ? "prestress in [eigen]"
                              : !run.lines.empty()     ? "[[line]]"
                                                       : nullptr;
  if (unknown)
    throw InputError(
        fmt::format("{}: a response analysis does not know it; leave it out, or run igasolve static", unknown));
  const bool on_springs = std::any_of(run.springs.begin(), run.springs.end(), [](const Spring& s) { return !s.to; });
  if (run.response.base && run.supports.empty() && !on_springs)
    throw InputError(fmt::format("{}: the base moves the part through its supports and the springs that stand on the "
                                 "ground, but the run has no [[support]] and no such [[spring]]",
                                 run.response.base->acceleration.where));
  if (!run.response.base && run.statics.loads.empty())
    throw InputError("nothing excites the part; give a [[load]] or [base]");
  if (!run.response.damping.given)
    throw InputError(
        fmt::format("{}: missing; give [damping] with ratio = 0.02 (of critical), modes, table, rayleigh or "
                    "structural; ratio = 0 is none",
                    run.response.damping.where));
}

// The same translation everywhere. (num_unknowns)
VectorXd translation(const BodySystem& system, const Point3& direction) {
  VectorXd all(system.num_unknowns());
  for (Index node = 0; node < system.num_nodes(); ++node) all.segment<3>(3 * node) = as_vector(direction);
  return all;
}

EigenSettings eigen_settings(const RunSettings& run, double highest) {
  EigenSettings settings = run.eigen;
  if (!run.response.choose_modes) return settings;
  if (highest > 0)
    settings.modes_below = 2 * highest;
  else
    settings.modes = transient_modes;
  return settings;
}

Observed observe(const RunSettings& run, const BodySystem& system, const BoundSystem& bound,
                 const std::vector<RegionReport>& regions, std::span<const LocatedProbe> located, const MatrixXd& V) {
  Observed seen;
  const auto& probes = run.statics.probes;
  const auto count = static_cast<Index>(probes.size());
  seen.displacement.resize(3 * count, V.cols());
  seen.stress.resize(6 * count, V.cols());
  for (Index k = 0; k < count; ++k) {
    const LocatedProbe& probe = located[static_cast<std::size_t>(k)];
    const SystemBody& body = system[probe.body];
    seen.probes.push_back(probes[static_cast<std::size_t>(k)].name);
    seen.positions.push_back(probe.place.position);
    seen.probe_bodies.push_back(system.name_among_several(probe.body));
    const SamplePoints point{{probe.place.cell}, {probe.place.parameter.begin(), probe.place.parameter.end()}};
    const MatrixXd own = V.middleRows(body.first_unknown(), body.space->num_unknowns());
    const FieldSamples fields = sample_fields(*body.space, body.material, point, own, Fields::All);
    seen.displacement.middleRows(3 * k, 3) = Eigen::Map<const MatrixXd>(fields.displacement.data(), 3, V.cols());
    seen.stress.middleRows(6 * k, 6) = Eigen::Map<const MatrixXd>(fields.stress.data(), 6, V.cols());
  }
  std::vector<Point3> centroids;
  const auto holds = [&](const char* kind, const RegionReport& region) {
    seen.holders.push_back({kind, region.name});
    centroids.push_back(region.centroid);
  };
  for (const RegionReport& region : regions) holds("support", region);
  for (const PreparedSpring& spring : bound.springs) holds("spring", spring.region.report);
  seen.reaction.resize(6 * static_cast<Index>(centroids.size()), V.cols());
  for (Index j = 0; j < V.cols() && !centroids.empty(); ++j) {
    std::size_t at = 0;
    const auto take = [&](const Point3& force, const Point3& moment) {
      const Index row = 6 * static_cast<Index>(at);
      seen.reaction.col(j).segment<3>(row) = as_vector(force);
      seen.reaction.col(j).segment<3>(row + 3) = as_vector(minus(moment, cross(centroids[at], force)));
      ++at;
    };
    for (const Reaction& r : reactions(system, bound, V.col(j), VectorXd())) take(r.force, r.moment);
    for (const SpringForce& f : spring_forces(system, bound.springs, V.col(j))) take(f.force, f.moment);
  }
  return seen;
}

// Spatial vectors of all excitations, (num_unknowns × excitations).
MatrixXd excite(const RunSettings& run, const PreparedSystem& prepared, ResponseSystem& system) {
  const std::vector<Load>& loads = run.statics.loads;
  const auto& base = run.response.base;
  MatrixXd vectors(system.unknowns, static_cast<Index>(loads.size() + (base ? 1 : 0)));
  for (std::size_t k = 0; k < loads.size(); ++k) {
    SystemLoad one = assemble_load(system.system, loads[k]);
    add_masses(system.system, prepared.bound.masses, loads[k], one);
    vectors.col(static_cast<Index>(k)) = one.load;
    system.loads.push_back(std::move(one.report));
    system.excitations.push_back({fmt::format("load '{}'", loads[k].name), false, 1, run.response.loads[k]});
  }
  if (base) {
    system.base_direction = base->direction;
    vectors.rightCols(1) = -(prepared.M * translation(system.system, base->direction));
    system.excitations.push_back({"base", true, base->in_g ? *base->gravity : 1, base->acceleration});
  }
  return vectors;
}

} // namespace

VectorXd ResponseSystem::base_vector() const {
  const auto probes = static_cast<Index>(observed.probes.size());
  VectorXd all = VectorXd::Zero(3 * probes);
  for (Index k = 0; base_direction && k < probes; ++k) all.segment<3>(3 * k) = as_vector(*base_direction);
  return all;
}

ResponseSystem prepare_response(const RunSettings& run, std::span<const TrimmedModel> models, double highest) {
  refuse_what_is_not_known(run);
  ResponseSystem response;
  PreparedSystem prepared = prepare_system(run, models);
  hand_over(prepared, response);
  const BodySystem& system = response.system;
  const std::vector<LocatedProbe> probes = locate_probes(system, run.statics.probes);
  Stopwatch watch(response.timings);
  const MatrixXd loads = excite(run, prepared, response);
  const std::vector<std::string> warnings = region_warnings(response.loads);
  response.warnings.insert(response.warnings.end(), warnings.begin(), warnings.end());
  watch.stage("loads");

  EigenProblem problem;
  problem.stiffness = &prepared.bound.K;
  problem.mass = &prepared.M;
  problem.progress = run.progress;
  problem.motions = rigid_motions(system, separate_bodies(prepared.bound.K.pattern()));
  problem.lambda_scale = lambda_scale(system);
  const ModeSet modes = lowest_modes(problem, eigen_settings(run, highest));
  response.timings.insert(response.timings.end(), modes.timings.begin(), modes.timings.end());
  response.warnings.insert(response.warnings.end(), modes.warnings.begin(), modes.warnings.end());
  response.sturm = modes.sturm;
  response.basis = modal_basis(modes);

  Stopwatch after(response.timings);
  show_stage(run.progress, "residual vectors");
  response.load_shares = VectorXd::Ones(loads.cols());
  if (run.response.residual_vectors) add_residual_vectors(problem, loads, response.basis, response.load_shares);
  response.modal_loads = response.basis.vectors.transpose() * loads;
  response.damping = modal_damping(run.response.damping, response.basis);
  if (response.base_direction) {
    const Participation moved =
        participation(system, prepared.M, response.basis.vectors.leftCols(response.basis.modes()));
    response.base_mass_share =
        (moved.factors.leftCols<3>() * as_vector(*response.base_direction)).squaredNorm() / moved.total[0];
  }
  after.stage("residual vectors");
  show_stage(run.progress, "probes");
  response.observed = observe(run, system, prepared.bound, response.regions, probes, response.basis.vectors);
  after.stage("probes");
  return response;
}

} // namespace iga::solve
