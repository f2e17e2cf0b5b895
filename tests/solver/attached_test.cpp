// Springs, added masses and rigid added bodies: rigid blocks on springs, rods with known frequencies, sums and
// balances.
#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/analysis/timestep_analysis.hpp"
#include "solver/linalg/low_rank.hpp"
#include "solver/space/placement.hpp"
#include "solver/supports/average_motion.hpp"
#include "solver/supports/read_attached.hpp"
#include "tests/solver/eigen_support.hpp"
#include "tests/solver/static_support.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const ElasticMaterial unit_rod = isotropic(1, 0, 1); // waves along it travel at speed 1

TrimmedModel box(const Point3& size, const Index3& spans, int p, double cut = 0.6) {
  return test::make_box_model(test::box_in_grid(size, spans, p, cut));
}

RegionChoice facing(const Point3& direction) {
  RegionChoice choice;
  choice.normal = RegionChoice::Direction{direction, 1};
  return choice;
}

RunSettings free_run(const ElasticMaterial& material) {
  RunSettings run;
  run.material = material;
  return run;
}

// A rod along x that moves along itself alone, held at x = 0 where asked for.
RunSettings rod_run(bool held) {
  RunSettings run = free_run(unit_rod);
  for (const Point3& side : {Point3{0, -1, 0}, Point3{0, 0, -1}}) {
    Support support;
    support.name = "guide";
    support.along_normal = true;
    support.region = facing(side);
    run.supports.push_back(support);
  }
  if (!held) return run;
  Support end;
  end.name = "end";
  end.region = facing({-1, 0, 0});
  end.fixed = {true, false, false};
  run.supports.push_back(end);
  return run;
}

// The lowest ω of motion along the rod: of modes whose participation along x counts.
std::vector<double> axial(const EigenOutcome& outcome, double least_share = 1e-3) {
  std::vector<double> omega;
  const MatrixXd masses = outcome.participation.effective_masses();
  for (Eigen::Index m = 0; m < masses.rows(); ++m)
    if (masses(m, 0) > least_share * outcome.mass) omega.push_back(std::sqrt(std::max(outcome.modes.lambda[m], 0.0)));
  return omega;
}

// Root of f between a and b.
template <class F> double root(F&& f, double a, double b) {
  for (int k = 0; k < 100; ++k) {
    const double c = 0.5 * (a + b);
    ((f(a) < 0) == (f(c) < 0) ? a : b) = c;
  }
  return a;
}

AddedMass rigid_body(double mass, const Point3& centre, const Eigen::Vector3d& inertia) {
  AddedMass added;
  added.name = "motor";
  added.region = facing({1, 0, 0});
  added.mass = mass;
  added.rigid = true;
  added.centre = centre;
  added.inertia.diagonal() = inertia;
  return added;
}

std::string refusal(const std::string& text) {
  try {
    io::SettingsTable root = io::SettingsTable::parse(text, "run.toml");
    root.expect_only(attached_keys());
    read_springs(root);
    read_masses(root);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(LowRank, SolutionsAndInertiaAreThoseOfTheDenseMatrix) {
  const TrimmedModel model = box({1, 1, 1}, {2, 2, 2}, 2);
  test::System s(box({1, 1, 1}, {2, 2, 2}, 2), isotropic(1, 0.3, 1));
  const auto n = static_cast<Eigen::Index>(s.K.size());
  RowMatrix rows(3, n), mass_rows(2, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < 3; ++k)
    for (int j = k; j < n; j += 7) entries.emplace_back(k, j, 0.3 * std::sin(3.0 * j + k));
  rows.setFromTriplets(entries.begin(), entries.end());
  entries.resize(static_cast<std::size_t>(n / 7));
  for (auto& entry : entries) entry = {entry.row() % 2, entry.col(), entry.value()};
  mass_rows.setFromTriplets(entries.begin(), entries.end());
  MassMatrix M = assemble_mass(BodySystem(s.space, s.material), s.connectivity);
  s.K.add_low_rank(rows);
  M.add_low_rank(mass_rows);
  const MatrixXd K = test::dense(s.K, n), D = test::dense(M, n);
  EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-14);
  const VectorXd b = VectorXd::LinSpaced(n, -1, 2);
  SystemMatrix system;
  system.stiffness = &s.K;
  system.mass = &M;
  system.shift = -0.5;
  const VectorXd exact = (K + 0.5 * D).ldlt().solve(b);
  EXPECT_LT((factorise_positive_definite(system)->solve(b) - exact).norm(), 1e-10 * exact.norm());
  EXPECT_LT((factorise_indefinite(system)->solve(b) - exact).norm(), 1e-10 * exact.norm());
  const VectorXd lambda =
      Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, D, Eigen::EigenvaluesOnly).eigenvalues();
  for (const Eigen::Index k : {3, 10, 40}) {
    system.shift = 0.5 * (lambda[k] + lambda[k + 1]);
    const Inertia counts = inertia(system);
    EXPECT_EQ(counts.negative, k + 1);
    EXPECT_EQ(counts.zero, 0);
    EXPECT_EQ(counts.positive, n - k - 1);
    const VectorXd solved = (K - system.shift * D).partialPivLu().solve(b);
    EXPECT_LT((factorise_indefinite(system)->solve(b) - solved).norm(), 1e-8 * solved.norm());
  }
  // The mass divides what it multiplies.
  const MassOperator mass = MassOperator::consistent(std::move(M));
  VectorXd back(n);
  const VectorXd product = mass * b;
  mass.divide(product.data(), back.data(), 1);
  EXPECT_LT((back - b).norm(), 1e-9 * b.norm());
}

TEST(AverageMotion, IsThatOfARigidRegionAndLeavesOutWhatIsNone) {
  const TrimmedModel model = box({1, 2, 3}, {2, 2, 2}, 2);
  const SolutionSpace space(model, test::usual());
  const BodySystem system(space, unit_rod);
  const SurfaceRegion region = choose_region(model, facing({1, 0, 0}), "region");
  const RowMatrix average = average_motion(system, 0, region);
  const MatrixXd motions = rigid_motions(system, region.report.centroid);
  EXPECT_LT((average * motions - MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-12);
  // Seen from another place: v + ω × r.
  const Point3 place{4, -1, 2};
  const MatrixXd there = rigid_motions(system, place);
  EXPECT_LT(
      (moved_to(place, region.report.centroid) * (average * there) - MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(),
      1e-12);
  // Stretching about the centroid is no rigid motion.
  VectorXd stretched(space.num_unknowns());
  const auto points = system.node_points();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    stretched.segment<3>(3 * i) << 0, points(i, 1) - region.report.centroid[1], 0;
  EXPECT_LT((average * stretched).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Springs, AStiffBlockOnAFoundationHopsAndSlidesAsARigidBody) {
  const TrimmedModel model = box({2, 3, 1}, {2, 3, 1}, 2);
  RunSettings run = free_run(isotropic(1e7, 0.3, 0.5));
  Spring bed;
  bed.name = "bed";
  bed.region = facing({0, 0, -1});
  bed.normal = 4;
  run.springs = {bed};
  EigenSettings settings;
  settings.modes = 3;
  const EigenOutcome outcome = analyse_modes(run, settings, model);
  const double mass = 0.5 * 6, area = 6;
  EXPECT_EQ(outcome.modes.rigid, 3); // sliding twice, turning about z
  const VectorXd lambda = outcome.modes.lambda.tail(3);
  EXPECT_NEAR(outcome.mass, mass, 1e-12);
  // Hopping, and rocking about axes in the bed's plane: k ∫ y² dA over the inertia about the centre, coupled with free
  // sliding, so that the block turns about its centre of mass.
  std::vector<double> exact{4 * area / mass, 4 * (2 * 27.0 / 12) / (mass * (9 + 1) / 12),
                            4 * (3 * 8.0 / 12) / (mass * (4 + 1) / 12)};
  std::sort(exact.begin(), exact.end());
  for (Eigen::Index k = 0; k < 3; ++k)
    EXPECT_NEAR(lambda[k], exact[static_cast<std::size_t>(k)], 2e-5 * lambda[k]) << k;
  EXPECT_EQ(outcome.modes.sturm->expected, outcome.modes.sturm->found);
}

TEST(Springs, ARodOnAnEndSpringHasItsExactFrequencies) {
  const TrimmedModel model = box({1, 0.1, 0.1}, {10, 1, 1}, 3);
  RunSettings run = rod_run(false);
  Spring end;
  end.name = "end";
  end.region = facing({-1, 0, 0});
  end.total = Point3{0.02, 0, 0}; // k L / (E A) = 2
  run.springs = {end};
  EigenSettings settings;
  settings.modes_below = 5.0 / (2 * std::numbers::pi);
  const std::vector<double> omega = axial(analyse_modes(run, settings, model));
  ASSERT_EQ(omega.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const double first = static_cast<double>(k) * std::numbers::pi;
    const double exact =
        root([](double x) { return x * std::sin(x) - 2 * std::cos(x); }, first, first + 0.5 * std::numbers::pi);
    EXPECT_NEAR(omega[k], exact, 1e-6 * exact);
  }
}

TEST(Springs, HoldAPartAndBalanceItsLoads) {
  const TrimmedModel model = box({2, 1, 1}, {2, 2, 2}, 2);
  RunSettings run = free_run(isotropic(1e3, 0.3, 2));
  Spring base, edge;
  base.name = "base";
  base.region = facing({-1, 0, 0});
  base.normal = 7;
  base.tangential = 3;
  edge.name = "corner";
  edge.place.at = Point3{2, 1, 1};
  edge.total = Point3{0, 5, 0};
  run.springs = {base, edge};
  StaticSettings statics;
  Load load;
  load.name = "pull";
  load.kind = LoadKind::TotalForce;
  load.region = facing({1, 0, 0});
  load.vector = {1, 2, -3};
  statics.loads = {load};
  const SolutionSpace space(model, test::usual());
  const StaticSolution solution = run_static(run, statics, space);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(solution.force_balance[d], 0, 1e-9);
    EXPECT_NEAR(solution.moment_balance[d], 0, 1e-9);
  }
  EXPECT_LT(energy_defect(solution.result), 1e-10);
  ASSERT_EQ(solution.result.springs.size(), 2U);
  EXPECT_NEAR(solution.result.springs[0].force[0], -1, 1e-9);
  EXPECT_GT(solution.result.springs[1].energy, 0);
  EXPECT_NEAR(solution.result.springs[0].force[1] + solution.result.springs[1].force[1], -2, 1e-9);
  // Without the tangential part nothing holds it along z.
  run.springs[0].tangential = 0;
  try {
    run_static(run, statics, space);
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("translation along (0, 0, 1)"), std::string::npos) << error.what();
  }
}

namespace {

// Two blocks with a gap of 1 between them along x, no ties.
struct TwoBlocks {
  TwoBlocks() {
    models = {box({1, 1, 1}, {2, 2, 2}, 2), placed(box({1, 1, 1}, {2, 2, 2}, 2), {.shift = {2, 0, 0}})};
    for (std::size_t b = 0; b < 2; ++b)
      system.add(b == 0 ? "first" : "second", std::make_shared<const SolutionSpace>(models[b], test::usual()),
                 material);
    coil.name = "coil";
    coil.body = "first";
    coil.region = facing({1, 0, 0});
    coil.to = Spring::End{"second", facing({-1, 0, 0}), {}};
  }
  ElasticMaterial material = isotropic(1e3, 0.3, 2);
  std::vector<TrimmedModel> models;
  BodySystem system;
  Spring coil;
};

} // namespace

TEST(Springs, BetweenTwoBodiesLeaveRigidMotionsOfBothFree) {
  TwoBlocks blocks;
  blocks.coil.total = Point3{3, 4, 5};
  const auto springs = prepare_springs(blocks.system, std::vector<Spring>{blocks.coil});
  const MatrixXd motions = rigid_motions(blocks.system, Point3{7, -2, 3});
  EXPECT_LT((springs[0].rows * motions).cwiseAbs().maxCoeff(), 1e-11);
  blocks.coil.total.reset();
  blocks.coil.axial = 2;
  const auto axial = prepare_springs(blocks.system, std::vector<Spring>{blocks.coil});
  EXPECT_LT((axial[0].rows * motions).cwiseAbs().maxCoeff(), 1e-11);
  // The second block moves away by 1: the spring pulls the first after it.
  VectorXd apart = VectorXd::Zero(blocks.system.num_unknowns());
  for (Eigen::Index i = blocks.system[1].first_node; i < blocks.system.num_nodes(); ++i) apart[3 * i] = 1;
  const SpringForce force = spring_forces(blocks.system, axial, apart)[0];
  EXPECT_NEAR(force.force[0], 2, 1e-12);
  EXPECT_NEAR(force.energy, 1, 1e-12);
}

TEST(Springs, CarryABodyThatNothingElseHolds) {
  TwoBlocks blocks;
  Support clamp;
  clamp.name = "clamp";
  clamp.body = "first";
  clamp.region = facing({-1, 0, 0});
  RunSettings run = free_run(blocks.material);
  run.supports = {clamp};
  blocks.coil.axial = 2;
  run.springs = {blocks.coil};
  StaticSettings statics;
  Load load;
  load.name = "pull";
  load.body = "second";
  load.kind = LoadKind::TotalForce;
  load.region = facing({1, 0, 0});
  load.vector = {4, 0, 0};
  statics.loads = {load};
  try {
    run_static(run, statics, blocks.system);
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("body 2 of 2"), std::string::npos) << text;
    EXPECT_EQ(text.find("body 1 of 2"), std::string::npos) << text;
    EXPECT_EQ(text.find("translation along (1, 0, 0)"), std::string::npos) << text;
    EXPECT_NE(text.find("translation along (0, 1, 0)"), std::string::npos) << text;
  }
  // Beside it a soft bed that holds the rest.
  Spring bed;
  bed.name = "bed";
  bed.body = "second";
  bed.region = facing({0, 0, -1});
  bed.total = Point3{0, 1, 1};
  Spring turn = bed;
  turn.name = "turn";
  turn.region = facing({0, -1, 0});
  turn.total = Point3{0, 0, 1};
  run.springs = {blocks.coil, bed, turn};
  const StaticSolution solution = run_static(run, statics, blocks.system);
  EXPECT_NEAR(solution.spring_forces[0].force[0], 4, 1e-8);
  EXPECT_NEAR(solution.result.springs[0].energy, 4, 1e-7); // F² / (2 k)
  EXPECT_NEAR(solution.reactions[0].force[0], -4, 1e-8);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(solution.moment_balance[d], 0, 1e-8);
  EXPECT_LT(energy_defect(solution.result), 1e-9);
}

TEST(Springs, RaiseTheLargestFrequencyOfATimeStep) {
  const TrimmedModel model = box({1, 1, 1}, {2, 2, 2}, 2, 1);
  RunSettings run = free_run(isotropic(1, 0.3, 1));
  run.mass = MassType::Lumped;
  const double free = analyse_timestep(run, {&model, 1}).omega_max;
  Spring bed;
  bed.name = "bed";
  bed.region = facing({0, 0, -1});
  bed.normal = 1e4;
  run.springs = {bed};
  const TimestepOutcome held = analyse_timestep(run, {&model, 1});
  EXPECT_GT(held.omega_max, 5 * free);
  EXPECT_FALSE(held.element.has_value());
}

TEST(AddedMasses, ARodWithAMassAtItsEndHasItsExactFrequencies) {
  const TrimmedModel model = box({1, 0.1, 0.1}, {10, 1, 1}, 3);
  EigenSettings settings;
  settings.modes_below = 5.0 / (2 * std::numbers::pi);
  for (const bool rigid : {false, true}) {
    RunSettings run = rod_run(true);
    AddedMass end = rigid_body(0.02, {1, 0.05, 0.05}, {0, 0, 0});
    end.rigid = rigid;
    run.masses = {end};
    const EigenOutcome outcome = analyse_modes(run, settings, model);
    EXPECT_NEAR(outcome.mass, 0.03, 1e-14);
    EXPECT_NEAR(outcome.participation.total[0], 0.03, 1e-14);
    EXPECT_EQ(outcome.modes.sturm->expected, outcome.modes.sturm->found);
    const std::vector<double> omega = axial(outcome);
    ASSERT_EQ(omega.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) { // x tan x = m / M = 1/2
      const double first = static_cast<double>(k) * std::numbers::pi;
      const double exact =
          root([](double x) { return x * std::sin(x) - 0.5 * std::cos(x); }, first, first + 0.5 * std::numbers::pi);
      EXPECT_NEAR(omega[k], exact, 1e-6 * exact) << (rigid ? "rigid" : "spread");
    }
  }
}

TEST(AddedMasses, AFreePartWithARigidBodyKeepsSixRigidModesThatCarryEverything) {
  const TrimmedModel model = box({1, 1, 1}, {2, 2, 2}, 2);
  RunSettings run = free_run(isotropic(1, 0.3, 2));
  run.masses = {rigid_body(3, {2, 0.5, 0.5}, {0.3, 0.4, 0.5})};
  EigenSettings settings;
  settings.modes = 8;
  const EigenOutcome outcome = analyse_modes(run, settings, model);
  EXPECT_EQ(outcome.modes.rigid, 6);
  EXPECT_EQ(outcome.modes.sturm->expected, outcome.modes.sturm->found);
  EXPECT_LT(outcome.modes.residual.maxCoeff(), residual_limit);
  const Participation& p = outcome.participation;
  const MatrixXd sums = p.summed_shares();
  for (Eigen::Index d = 0; d < 6; ++d) EXPECT_NEAR(sums(5, d), 1, 1e-10);
  EXPECT_NEAR(outcome.mass, 5, 1e-12);
  for (Eigen::Index d = 0; d < 3; ++d) EXPECT_NEAR(p.total[d], 5, 1e-11);
  const double x = (2 * 0.5 + 3 * 2) / 5.0;
  EXPECT_NEAR(p.centre[0], x, 1e-11);
  EXPECT_NEAR(p.total[3], 2.0 / 6 + 0.3, 1e-10);
  const double apart = 2 * (x - 0.5) * (x - 0.5) + 3 * (2 - x) * (2 - x);
  EXPECT_NEAR(p.total[4], 2.0 / 6 + 0.4 + apart, 1e-10);
  EXPECT_NEAR(p.total[5], 2.0 / 6 + 0.5 + apart, 1e-10);
}

TEST(AddedMasses, OfAllKindsBringTheirWeightToAHeldPart) {
  const TrimmedModel model = box({1, 1, 1}, {2, 2, 2}, 2);
  Support clamp;
  clamp.name = "clamp";
  clamp.region = facing({-1, 0, 0});
  RunSettings run = free_run(isotropic(100, 0.3, 2));
  run.supports = {clamp};
  AddedMass spread = rigid_body(4, {}, {0, 0, 0}), point = spread;
  spread.rigid = false;
  spread.centre.reset();
  point = spread;
  point.region = {};
  point.place.at = Point3{1, 1, 0};
  run.masses = {rigid_body(3, {2, 3, 4}, {0.1, 0.1, 0.1}), spread, point};
  StaticSettings statics;
  Load gravity;
  gravity.name = "gravity";
  gravity.kind = LoadKind::Acceleration;
  gravity.vector = {1, 0, -10};
  statics.loads = {gravity};
  const SolutionSpace space(model, test::usual());
  const StaticSolution solution = run_static(run, statics, space);
  const double mass = 2 + 3 + 4 + 4;
  EXPECT_NEAR(solution.loads[0].force[2], -10 * mass, 1e-10);
  EXPECT_NEAR(solution.loads[0].force[0], mass, 1e-10);
  EXPECT_NEAR(solution.reactions[0].force[2], 10 * mass, 1e-8);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(solution.moment_balance[d], 0, 1e-8);
  // About the origin: Σ m x × a.
  const Point3 first{2 * 0.5 + 3 * 2 + 4 * 1 + 4 * 1, 2 * 0.5 + 3 * 3 + 4 * 0.5 + 4 * 1, 2 * 0.5 + 3 * 4 + 4 * 0.5};
  const Point3 moment = cross(first, gravity.vector);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(solution.loads[0].moment[d], moment[d], 1e-9);
  EXPECT_LT(energy_defect(solution.result), 1e-10);
}

TEST(AddedMasses, LumpedOnesKeepTheTotalAndRigidOnesAreRefused) {
  const TrimmedModel model = box({1, 1, 1}, {2, 2, 2}, 2);
  RunSettings run = free_run(isotropic(1, 0.3, 2));
  run.mass = MassType::Lumped;
  run.light = default_light_treatment(run.mass);
  AddedMass spread = rigid_body(3, {}, {0, 0, 0});
  spread.rigid = false;
  spread.centre.reset();
  run.masses = {spread};
  EXPECT_NEAR(analyse_timestep(run, {&model, 1}).mass, 5, 1e-12);
  run.masses = {rigid_body(3, {2, 0.5, 0.5}, {0.3, 0.4, 0.5})};
  EXPECT_THROW(analyse_timestep(run, {&model, 1}), InputError);
}

TEST(ReadAttached, TakesEveryKind) {
  io::SettingsTable root = io::SettingsTable::parse(R"([[spring]]
region = "bottom"
normal_stiffness = 2
[[spring]]
name = "mount"
at = [1, 2, 3]
stiffness = [1, 0, 2]
rotate_axis_angle = [0, 0, 1, 90]
[[added_mass]]
name = "motor"
mass = 1.2
inertia = [1, 2, 2.5, 0.1, 0, 0]
at = [0, 0, 5]
normal = { direction = [0, 0, 1] }
[[added_mass]]
mass = 3
box = [0, 0, 0, 1, 1, 1]
[[added_mass]]
mass = 0.5
point = "vertex 3"
)",
                                                    "run.toml");
  root.expect_only(attached_keys());
  const auto springs = read_springs(root);
  const auto masses = read_masses(root);
  root.refuse_unknown_keys();
  ASSERT_EQ(springs.size(), 2U);
  EXPECT_EQ(springs[0].normal, 2);
  EXPECT_EQ(springs[0].name, "spring 1");
  EXPECT_EQ(springs[1].total, (Point3{1, 0, 2}));
  EXPECT_NEAR(springs[1].frame[1][0], 1, 1e-15);
  ASSERT_EQ(masses.size(), 3U);
  EXPECT_TRUE(masses[0].rigid);
  EXPECT_EQ(masses[0].centre, (Point3{0, 0, 5}));
  EXPECT_EQ(masses[0].inertia(1, 0), 0.1);
  EXPECT_FALSE(masses[1].rigid);
  EXPECT_EQ(masses[2].place.marker, "vertex 3");
}

TEST(ReadAttached, RefusesWhatMakesNoSense) {
  const auto expect = [](const std::string& text, const char* words) {
    const std::string found = refusal(text);
    EXPECT_NE(found.find(words), std::string::npos) << text << "\n" << found;
    EXPECT_NE(found.find("run.toml:"), std::string::npos) << found;
  };
  expect("[[spring]]\nstiffness = [1, 1, 1]\n", "choose surface");
  expect("[[spring]]\nregion = 0\n", "give stiffness = [kx, ky, kz]");
  expect("[[spring]]\nregion = 0\nstiffness = [1, -1, 0]\n", "below 0");
  expect("[[spring]]\nregion = 0\nnormal_stiffness = 0\n", "no stiffness at all");
  expect("[[spring]]\nat = [0, 0, 0]\nnormal_stiffness = 1\n", "needs a surface");
  expect("[[spring]]\nregion = 0\nnormal_stiffness = 1\nstiffness = [1, 1, 1]\n", "given together");
  expect("[[spring]]\nregion = 0\nstifness = [1, 1, 1]\n", "stiffness");
  expect("[[spring]]\nregion = 0\naxial = 1\n", "only a spring between two ends");
  expect("[[spring]]\nregion = 0\naxial = 1\nto = { body = \"b\" }\n", "choose surface");
  expect("[[spring]]\nat = [0, 0, 0]\nstiffness = [1, 1, 1]\nto = { region = 0 }\n", "give axial");
  expect("[[added_mass]]\nregion = 0\n", "the mass that is added");
  expect("[[added_mass]]\nmass = -1\nregion = 0\n", "at least 0");
  expect("[[added_mass]]\nmass = 1\n", "choose surface");
  expect("[[added_mass]]\nmass = 1\nat = [0, 0, 0]\ninertia = [1, 1, 1]\n", "join the body to a choice of surface");
  expect("[[added_mass]]\nmass = 1\nregion = 0\ninertia = [1, 1, 3]\n", "no body has such");
  expect("[[added_mass]]\nmass = 0\nregion = 0\n", "nothing is added");
}
