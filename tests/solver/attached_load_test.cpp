// Springs and added masses on loaded and shaken parts: turning masses against the exact potential of rigid bodies,
// mechanisms that buckle, single oscillators.
#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/buckling_analysis.hpp"
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/geometric_stiffness.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/response/harmonic.hpp"
#include "solver/response/random.hpp"
#include "solver/response/response_tables.hpp"
#include "solver/response/transient.hpp"
#include "solver/space/placement.hpp"
#include "solver/supports/read_attached.hpp"
#include "tests/solver/eigen_support.hpp"
#include "tests/solver/static_support.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

TrimmedModel box(const Point3& size, const Index3& spans, int p) {
  return test::make_box_model(test::box_in_grid(size, spans, p, 0.6));
}

RegionChoice facing(const Point3& direction) {
  RegionChoice choice;
  choice.normal = RegionChoice::Direction{direction, 1};
  return choice;
}

RunSettings run_of(const ElasticMaterial& material) {
  RunSettings run;
  run.material = material;
  run.light = test::usual();
  return run;
}

Support held(const std::string& name, const Point3& side, bool along_normal) {
  Support support;
  support.name = name;
  support.region = facing(side);
  support.along_normal = along_normal;
  return support;
}

Spring spring_on(const Point3& side, const Point3& stiffness) {
  Spring spring;
  spring.name = "mount";
  spring.region = facing(side);
  spring.total = stiffness;
  return spring;
}

Load turning(const Point3& axis, const Point3& point, double speed, double acceleration = 0) {
  Load load;
  load.name = "turning";
  load.kind = LoadKind::Centrifugal;
  load.spin = {axis, point, speed, {}, acceleration};
  return load;
}

Load gravity(const Point3& g) {
  Load load;
  load.name = "gravity";
  load.kind = LoadKind::Acceleration;
  load.vector = g;
  return load;
}

AddedMass motor(double mass, const Point3& centre) {
  AddedMass added;
  added.name = "motor";
  added.region = facing({1, 0, 0});
  added.mass = mass;
  added.rigid = true;
  added.centre = centre;
  return added;
}

Matrix3d some_inertia() {
  Matrix3d J;
  J << 0.5, 0.06, -0.04, 0.06, 0.4, 0.05, -0.04, 0.05, 0.3;
  return J;
}

Vector3d as_vector(const Point3& x) {
  return {x[0], x[1], x[2]};
}

Matrix3d turned(const Vector3d& theta) {
  return Eigen::AngleAxisd(theta.norm(), theta.normalized()).toRotationMatrix();
}

// Second derivative of f at 0.
template <class F> double curvature(F&& f) {
  const double h = 1e-3; // of the fourth order
  return (-f(2 * h) + 16 * f(h) - 30 * f(0) + 16 * f(-h) - f(-2 * h)) / (12 * h * h);
}

} // namespace

TEST(LowRank, WeightsOfEitherSignAreThoseOfTheDenseMatrix) {
  test::System s(box({1, 1, 1}, {2, 2, 2}, 2), isotropic(1, 0.3, 1));
  const auto n = static_cast<Eigen::Index>(s.K.size());
  RowMatrix rows(3, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < 3; ++k)
    for (int j = k; j < n; j += 7) entries.emplace_back(k, j, 0.3 * std::sin(3.0 * j + k));
  rows.setFromTriplets(entries.begin(), entries.end());
  const MatrixXd plain = test::dense(s.K, n), R = rows;
  const Vector3d weights{2, -0.7, 1e-3};
  s.K.add_low_rank(rows, weights);
  s.K.add_low_rank(rows.topRows(1));
  const MatrixXd K = plain + R.transpose() * (weights + Vector3d(1, 0, 0)).asDiagonal() * R;
  EXPECT_LT((test::dense(s.K, n) - K).cwiseAbs().maxCoeff(), 1e-13);
  StiffnessMatrix sum(s.connectivity);
  add_scaled(s.K, -0.5, sum);
  EXPECT_LT((test::dense(sum, n) + 0.5 * K).cwiseAbs().maxCoeff(), 1e-13);
  const MassMatrix M = assemble_mass(BodySystem(s.space, s.material), s.connectivity);
  const MatrixXd D = test::dense(M, n);
  const VectorXd lambda =
      Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, D, Eigen::EigenvaluesOnly).eigenvalues();
  ASSERT_LT(lambda[0], 0);
  SystemMatrix system;
  system.stiffness = &s.K;
  system.mass = &M;
  EXPECT_FALSE(holds_without_low_rank(system));
  const VectorXd b = VectorXd::LinSpaced(n, -1, 2);
  for (const Eigen::Index k : {0, 7, 30}) {
    system.shift = 0.5 * (lambda[k] + lambda[k + 1]);
    const Inertia counts = inertia(system);
    EXPECT_EQ(counts.negative, k + 1);
    EXPECT_EQ(counts.positive, n - k - 1);
    const VectorXd solved = (K - system.shift * D).partialPivLu().solve(b);
    EXPECT_LT((factorise_indefinite(system)->solve(b) - solved).norm(), 1e-8 * solved.norm());
  }
}

TEST(AddedMasses, StretchATurningRodByTheirCentrifugalForce) {
  // u' E A = m ω² R + ρ A ω² (L² - x²) / 2: of the third degree, which splines of that degree hold.
  const TrimmedModel model = box({1, 0.1, 0.1}, {4, 1, 1}, 3);
  const double omega = 0.3, m = 0.02;
  RunSettings run = run_of(isotropic(1, 0, 1));
  run.supports = {held("root", {-1, 0, 0}, false), held("y", {0, -1, 0}, true), held("z", {0, 0, -1}, true)};
  run.supports[0].fixed = {true, false, false};
  StaticSettings statics;
  statics.loads = {turning({0, 0, 1}, {0, 0.05, 0.05}, omega)};
  statics.probes = {{"tip", {1, 0.05, 0.05}}};
  const SolutionSpace space(model, test::usual());
  for (const bool rigid : {true, false}) {
    AddedMass mass = motor(m, {1.5, 0.05, 0.05});
    mass.rigid = rigid;
    const double radius = rigid ? 1.5 : 1;
    if (rigid) mass.inertia = some_inertia();
    run.masses = {mass};
    const StaticSolution s = run_static(run, statics, space);
    const double force = m * radius + 0.01 / 2, stretch = (m * radius / 0.01 + (1 - 1.0 / 3) / 2) * omega * omega;
    EXPECT_NEAR(s.loads[0].force[0], force * omega * omega, 1e-13);
    EXPECT_NEAR(s.loads[0].force[1], 0, 1e-14);
    // About the origin, and of the body itself -ω × J ω.
    const double own = rigid ? some_inertia()(0, 2) : 0;
    EXPECT_NEAR(s.loads[0].moment[1], (0.05 * force - own) * omega * omega, 1e-13);
    // Its forces across the rod shear the end where it is spread.
    if (!rigid) {
      EXPECT_NEAR(s.result.probes.fields.displacement[0], stretch, 1e-3 * stretch);
    }
    EXPECT_NEAR(s.reactions[0].force[0], -force * omega * omega, 1e-11);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(s.moment_balance[d], 0, 1e-11);
    EXPECT_LT(energy_defect(s.result), 1e-9);
  }
  run.masses = {motor(m, {1.5, 0.05, 0.05})};
  const StaticSolution s = run_static(run, statics, space);
  const double stretch = (m * 1.5 / 0.01 + (1 - 1.0 / 3) / 2) * omega * omega;
  EXPECT_NEAR(s.result.probes.fields.displacement[0], stretch, 1e-9 * stretch);
  // A mass that speeds up resists by -m α R across the arm.
  statics.loads = {turning({0, 0, 1}, {0, 0.05, 0.05}, 0, 2)};
  run.supports[0].fixed = {true, true, true};
  run.supports.pop_back();
  run.supports.erase(run.supports.begin() + 1);
  EXPECT_NEAR(run_static(run, statics, space).loads[0].force[1], -2 * (m * 1.5 + 0.005), 1e-13);
}

TEST(AddedMasses, StiffnessOfTheirForcesIsTheCurvatureOfTheExactPotential) {
  const TrimmedModel model = box({1, 1, 1}, {2, 2, 2}, 2);
  const SolutionSpace space(model, test::usual());
  const BodySystem system(space, isotropic(1, 0.3, 1));
  AddedMass body = motor(0.8, {1.7, 0.2, 0.9});
  body.inertia = some_inertia();
  AddedMass spread = body;
  spread.rigid = false;
  const auto prepared = prepare_masses(system, std::vector{body, spread});
  const Vector3d region = as_vector(prepared[0].region.report.centroid), arm = as_vector(*body.centre) - region;
  const Vector3d a = Vector3d(1, -2, 3).normalized(), point{0.3, -0.2, 0.1}, g{0.4, -1.2, 0.7};
  const Matrix3d across = Matrix3d::Identity() - a * a.transpose();
  const double omega = 1.3;
  const auto connectivity = system.connectivity(coupled_nodes(system, {}));
  const MatrixXd motions = rigid_motions(system, prepared[0].region.report.centroid);
  const auto energy_of = [&](const PreparedMass& mass, const Load& load, const VectorXd& u) {
    StiffnessMatrix L(connectivity);
    add_inertia_stiffness(system, mass, load, L);
    return u.dot(L * u);
  };
  for (const auto& motion : {(VectorXd(6) << 0.3, -0.2, 0.5, 0.4, 0.7, -0.6).finished(),
                             (VectorXd(6) << -0.1, 0.2, 0.4, -0.5, 0.3, 0.9).finished()}) {
    const VectorXd u = motions * motion;
    const Vector3d v = motion.head<3>(), theta = motion.tail<3>();
    const auto centre = [&](double t) { return Vector3d(region + t * v + turned(t * theta) * arm); };
    const auto turns = [&](double t) {
      const Matrix3d R = turned(t * theta);
      return -0.5 * omega * omega *
             (body.mass * (across * (centre(t) - point)).squaredNorm() + a.dot(R * body.inertia * R.transpose() * a));
    };
    const Load spins = turning({a[0], a[1], a[2]}, {point[0], point[1], point[2]}, omega);
    EXPECT_NEAR(energy_of(prepared[0], spins, u), curvature(turns), 1e-7);
    const auto weighs = [&](double t) { return -body.mass * g.dot(centre(t)); };
    EXPECT_NEAR(energy_of(prepared[0], gravity({g[0], g[1], g[2]}), u), curvature(weighs), 1e-7);
    // Mass on the material itself: of the linear motion alone.
    double exact = 0;
    const SurfaceRegion& r = prepared[1].region;
    for (std::size_t s = 0; s < r.cells.size(); ++s) {
      const PointBatch batch = gather(model, r, s);
      for (std::size_t q = 0; q < batch.size(); ++q)
        exact -= omega * omega * body.mass * batch.weights[q] / r.report.area *
                 (across * (v + theta.cross(as_vector(batch.positions[q]) - region))).squaredNorm();
    }
    EXPECT_NEAR(energy_of(prepared[1], spins, u), exact, 1e-12);
    EXPECT_EQ(energy_of(prepared[1], gravity({1, 2, 3}), u), 0);
  }
}

TEST(PrestressedModes, OfATurningMassOnASpringAreSofterAcrossTheAxis) {
  const TrimmedModel model = box({1, 1, 1}, {1, 1, 1}, 2);
  RunSettings run = run_of(isotropic(1e7, 0.3, 0.5));
  run.springs = {spring_on({-1, 0, 0}, {2, 3, 4})};
  run.supports = {held("y", {0, -1, 0}, true), held("y", {0, 1, 0}, true), held("z", {0, 0, -1}, true),
                  held("z", {0, 0, 1}, true)};
  AddedMass spread = motor(0.7, {});
  spread.rigid = false;
  run.masses = {spread, motor(0.8, {1.5, 0.5, 0.5})};
  EigenSettings settings;
  settings.modes = 1;
  settings.prestress = true;
  const auto lambda = [&](const Point3& axis, double speed) {
    run.statics.loads = {turning(axis, {-1, 0.5, 0.5}, speed)};
    const EigenOutcome outcome = analyse_modes(run, settings, model);
    EXPECT_EQ(outcome.attached.springs.size(), 1U);
    return outcome.modes.lambda[0];
  };
  EXPECT_NEAR(lambda({0, 0, 1}, 0.6), 2 / 2.0 - 0.36, 2e-6);
  EXPECT_NEAR(lambda({1, 0, 0}, 0.6), 2 / 2.0, 2e-6);
  EXPECT_THROW((void)lambda({0, 0, 1}, 1.1), InputError); // faster than its own frequency it flies off
}

TEST(Buckling, OfAMotorOnItsArmIsThatOfAnInvertedPendulum) {
  // A stiff block on a foundation that turns under the weight of a mass far above: k_θ = W h, with the block's own
  // stress under the mass.
  const TrimmedModel model = box({1, 1, 1}, {1, 1, 1}, 2);
  RunSettings run = run_of(isotropic(1e7, 0, 1e-9));
  Spring bed;
  bed.name = "bed";
  bed.region = facing({-1, 0, 0});
  bed.normal = 12;
  bed.tangential = 1e6;
  run.springs = {bed};
  run.masses = {motor(1, {4, 0.5, 0.5})};
  run.statics.loads = {gravity({-0.01, 0, 0})};
  run.analysis = Analysis::Buckling;
  BucklingSettings settings;
  settings.factors = 2;
  const BucklingOutcome outcome = analyse_buckling(run, settings, model);
  ASSERT_EQ(outcome.positive.factor.size(), 2);
  const double exact = 12.0 / 12 / (4 * 0.01); // 4 above the bed
  for (Eigen::Index k = 0; k < 2; ++k) EXPECT_NEAR(outcome.positive.factor[k], exact, 2e-5 * exact);
  EXPECT_EQ(outcome.positive.count->expected, outcome.positive.count->found);
}

TEST(Buckling, OfAStrutThatTurnsAsideUnderABlock) {
  // The strut is a spring along x between two blocks; the second one stands on a bed that resists sliding alone.
  const ElasticMaterial stiff = isotropic(3e5, 0, 1);
  const TrimmedModel block = test::make_box_model(test::box_in_grid({1, 1, 1}, {1, 1, 1}, 2));
  std::vector<TrimmedModel> models{block, placed(block, {.shift = {2, 0, 0}})};
  RunSettings run = run_of(stiff);
  for (const char* name : {"first", "second"}) {
    RunBody body;
    body.file.name = name;
    body.material = stiff;
    body.light = test::usual();
    run.bodies.push_back(body);
  }
  run.supports = {held("ground", {-1, 0, 0}, false), held("low", {0, 0, -1}, true), held("high", {0, 0, 1}, true)};
  run.supports[0].body = "first";
  run.supports[1].body = run.supports[2].body = "second";
  const double slide = 3, axial = 5, distance = 1;
  Spring bed, strut;
  bed.name = "bed";
  bed.body = "second";
  bed.region = facing({0, 0, -1});
  bed.tangential = slide;
  strut.name = "strut";
  strut.body = "first";
  strut.region = facing({1, 0, 0});
  strut.to = Spring::End{"second", facing({-1, 0, 0}), {}};
  strut.axial = axial;
  run.springs = {bed, strut};
  Load press;
  press.name = "press";
  press.body = "second";
  press.kind = LoadKind::TotalForce;
  press.region = facing({1, 0, 0});
  press.vector = {-1, 0, 0};
  run.statics.loads = {press};
  run.analysis = Analysis::Buckling;
  BucklingSettings settings;
  settings.factors = 2;
  const BucklingOutcome outcome = analyse_buckling(run, settings, models);
  // Of sliding y and turning θ about the block's centre: the strut's end moves by y - θ/2; the block's own stress has
  // the virial -(F + N) / 2 of the forces on it.
  const double N = axial / (axial + slide);
  const Eigen::Vector2d end{1, -0.5};
  Eigen::Matrix2d K = Eigen::Vector2d(slide, slide / 6).asDiagonal(), L = -N / distance * end * end.transpose();
  L(1, 1) -= 0.5 * (1 + N);
  const Eigen::VectorXd theta =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(-L, K, Eigen::EigenvaluesOnly).eigenvalues();
  ASSERT_EQ(outcome.positive.factor.size(), 2);
  EXPECT_NEAR(outcome.positive.factor[0], 1 / theta[1], 2e-4 / theta[1]);
  EXPECT_NEAR(outcome.positive.factor[1], 1 / theta[0], 2e-4 / theta[0]);
}

TEST(AddedMasses, ThatHoldTheirRegionKeepItFromContracting) {
  const TrimmedModel model = box({1, 1, 1}, {3, 3, 3}, 2);
  RunSettings run = run_of(isotropic(100, 0.3, 2));
  run.supports = {held("clamp", {-1, 0, 0}, false)};
  StaticSettings statics;
  statics.loads = {gravity({3, 0, 0})};
  statics.probes = {{"corner", {1, 1, 1}}};
  const SolutionSpace space(model, test::usual());
  std::array<double, 2> across{}, lambda{};
  for (const bool holds : {false, true}) {
    AddedMass mass = motor(5, {2, 0.5, 0.5});
    mass.inertia = some_inertia();
    mass.holds_region = holds;
    run.masses = {mass};
    const StaticSolution s = run_static(run, statics, space);
    across[holds ? 1 : 0] = s.result.probes.fields.displacement[1];
    EXPECT_LT(energy_defect(s.result), 1e-10);
    EXPECT_NEAR(s.reactions[0].force[0], -3 * 7, 1e-8);
    EigenSettings settings;
    settings.modes = 3;
    const EigenOutcome modes = analyse_modes(run, settings, model);
    EXPECT_EQ(modes.modes.sturm->expected, modes.modes.sturm->found);
    lambda[holds ? 1 : 0] = modes.modes.lambda[0];
  }
  EXPECT_LT(across[0], -0.01);
  EXPECT_LT(std::abs(across[1]), 0.02 * std::abs(across[0])); // by the penalty, at a corner
  EXPECT_GT(lambda[1], 1.001 * lambda[0]);
}

TEST(ReadAttached, SpreadSaysWhetherAMassHoldsItsRegion) {
  const auto read = [](const std::string& text) {
    io::SettingsTable root = io::SettingsTable::parse("[[added_mass]]\nmass = 1\n" + text, "run.toml");
    root.expect_only(attached_keys());
    return read_masses(root)[0];
  };
  EXPECT_TRUE(read("region = 0\nspread = \"rigid\"\n").holds_region);
  EXPECT_TRUE(read("region = 0\nspread = \"rigid\"\n").rigid);
  EXPECT_FALSE(read("region = 0\nat = [0, 0, 1]\nspread = \"average\"\n").holds_region);
  EXPECT_THROW(read("region = 0\nspread = \"even\"\n"), InputError);
  EXPECT_THROW(read("at = [0, 0, 0]\nspread = \"rigid\"\n"), InputError);
}

// --------------------------------------------------------------------------------------------------------- oscillator

namespace {

NumberCurve curve(std::vector<double> x, std::vector<double> y) {
  NumberCurve all;
  all.x = std::move(x);
  all.y = std::move(y);
  return all;
}

/// A stiff block with a motor on a spring along x: mass 2, ω₀ = 3.
struct Oscillator {
  Oscillator() : model(box({1, 1, 1}, {1, 1, 1}, 2)), run(run_of(isotropic(1e7, 0.3, 0.5))) {
    run.springs = {spring_on({-1, 0, 0}, {stiffness, 1, 1})};
    run.masses = {motor(1.5, {1.5, 0.5, 0.5})};
    run.response.damping.given = true;
    run.response.damping.ratio = ratio;
    run.response.choose_modes = false;
    run.eigen.modes = 6;
    run.statics.probes = {{"middle", {0.5, 0.5, 0.5}}};
    run.response.base = BaseMotion{{1, 0, 0}, false, {}, {}};
  }
  ResponseSystem prepare() { return prepare_response(run, {&model, 1}, 0); }
  static constexpr double mass = 2, omega = 3, stiffness = mass * omega * omega, ratio = 0.05;
  TrimmedModel model;
  RunSettings run;
};

double entry(const ResultTable& table, const std::string& column, std::size_t row) {
  const auto at = std::find(table.columns.begin(), table.columns.end(), column);
  EXPECT_NE(at, table.columns.end()) << column;
  return table.values[row * table.columns.size() + static_cast<std::size_t>(at - table.columns.begin())];
}

const ResultTable& named(const std::vector<ResultTable>& tables, const std::string& name) {
  const auto at =
      std::find_if(tables.begin(), tables.end(), [&](const ResultTable& table) { return table.name == name; });
  EXPECT_NE(at, tables.end()) << name;
  return *at;
}

} // namespace

TEST(Harmonic, ABaseShakesAMotorThroughItsSpring) {
  Oscillator o;
  o.run.response.base->acceleration.spectrum = curve({0}, {4});
  const double f = 0.9 * Oscillator::omega / (2 * std::numbers::pi);
  o.run.response.harmonic.frequencies = {f};
  const ResponseSystem system = o.prepare();
  EXPECT_NEAR(system.base_mass_share, 1, 1e-6);
  const auto tables = tables_of(system, harmonic_response(system, o.run.response));
  const double w = 0.9 * Oscillator::omega, w0 = Oscillator::omega;
  const double relative = 4 / std::hypot(w0 * w0 - w * w, 2 * Oscillator::ratio * w0 * w);
  EXPECT_NEAR(entry(named(tables, "probe_middle"), "relative_x", 0), relative, 1e-5 * relative);
  EXPECT_NEAR(entry(named(tables, "spring_mount"), "force_x", 0), Oscillator::stiffness * relative,
              1e-5 * Oscillator::stiffness * relative);
}

TEST(Transient, AStepOfGravityLetsAMotorSwing) {
  Oscillator o;
  o.run.response.base.reset();
  o.run.statics.loads = {gravity({0.7, 0, 0})};
  Variation step;
  step.history = curve({0, 100}, {1, 1});
  o.run.response.loads = {step};
  o.run.response.transient.end = 0.8;
  o.run.response.transient.step = 0.8;
  const ResponseSystem system = o.prepare();
  EXPECT_NEAR(system.loads[0].force[0], 0.7 * Oscillator::mass, 1e-12);
  const auto tables = tables_of(system, transient_response(system, o.run.response));
  const double w = Oscillator::omega, z = Oscillator::ratio, d = w * std::sqrt(1 - z * z), t = 0.8;
  const double exact = 0.7 / (w * w) * (1 - std::exp(-z * w * t) * (std::cos(d * t) + z * w / d * std::sin(d * t)));
  EXPECT_NEAR(entry(named(tables, "probe_middle"), "displacement_x", 1), exact, 1e-5 * exact);
  EXPECT_NEAR(entry(named(tables, "spring_mount"), "force_x", 1), -Oscillator::stiffness * exact,
              1e-5 * Oscillator::stiffness * exact);
}

TEST(Random, AMotorOnASpringUnderNoiseOfItsBase) {
  Oscillator o;
  o.run.response.base->acceleration.psd = curve({1e-3, 1e3}, {0.2, 0.2});
  const ResponseSystem system = o.prepare();
  const auto tables = tables_of(system, random_response(system, o.run.response));
  // ∫ S / |ω₀² - ω² + 2 i ζ ω₀ ω|² df = S / (8 ζ ω₀³) over all frequencies.
  const double w = Oscillator::omega;
  const double exact = std::sqrt(0.2 / (8 * Oscillator::ratio * w * w * w));
  EXPECT_NEAR(entry(named(tables, "rms_spring_mount"), "force_x", 0), Oscillator::stiffness * exact,
              2e-3 * Oscillator::stiffness * exact);
}

TEST(ResponseSystem, ABaseNeedsSupportsOrSpringsToTheGround) {
  Oscillator o;
  o.run.springs.clear();
  EXPECT_THROW((void)o.prepare(), InputError);
}
