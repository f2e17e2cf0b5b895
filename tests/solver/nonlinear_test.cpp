// Statics at large displacement: uniform deformation on trimmed parts, tangents, Newton's convergence, small loads.
#include "format/model/errors.hpp"
#include "solver/analysis/static_analysis.hpp"
#include "solver/linalg/unsymmetric_solver.hpp"
#include "solver/nonlinear/nonlinear_statics.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/tangent_product.hpp"
#include "tests/solver/trimmed_part.hpp"
#include "tests/support/small_surfaces.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr double E = 10, nu = 0.3;

Law law_of(const std::string& name) {
  if (name == "linear") return LinearElastic(isotropic(E, nu, 1));
  if (name == "st-venant") return st_venant_kirchhoff(E, nu, 1);
  if (name == "neo-hookean") return neo_hookean(E, nu, 1);
  if (name == "j2") return J2Plasticity({.E = E, .nu = nu, .density = 1, .yield = Curve({0, 1}, {0.1, 1.1}, "curve")});
  return CrushableFoam({.E = E, .nu = 0.1, .density = 1, .yield = Curve({0, 1}, {0.2, 0.8}, "curve")});
}

TrimmedModel turned_cube(int degree, double span_size) {
  const TriangleMesh mesh = transformed(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), rotation(20, 35), {0.3, -0.2, 0.1});
  return make_part(mesh, {degree, span_size, 0.3, 0, identity_rotation});
}

TrimmedModel beam(double span_size = 0.5) {
  return make_part(box_mesh({0, 0, 0}, {4, 1, 1}), {2, span_size, 0.3, 0, identity_rotation});
}

Eigen::VectorXd uniform(const SolutionSpace& space, const Eigen::Matrix3d& F) {
  const auto points = space.node_points();
  Eigen::VectorXd u(space.num_unknowns());
  for (Eigen::Index n = 0; n < points.rows(); ++n)
    u.segment<3>(3 * n) = (F - Eigen::Matrix3d::Identity()) * points.row(n).transpose();
  return u;
}

Eigen::Matrix3d stress(const std::string& law, const Eigen::Matrix3d& F) {
  const ElasticMaterial material = isotropic(E, nu, 1);
  const double lambda = material.C(0, 1), mu = material.C(3, 3);
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  if (law == "st-venant") {
    const Eigen::Matrix3d G = 0.5 * (F.transpose() * F - I);
    return F * (lambda * G.trace() * I + 2 * mu * G);
  }
  return mu * F + (lambda * std::log(F.determinant()) - mu) * F.inverse().transpose();
}

Eigen::VectorXd internal_forces(const SolutionSpace& space, const Law& law, const Eigen::VectorXd& u,
                                Locking locking = Locking::None) {
  const FiniteBody body(space, law, std::make_shared<const Connectivity>(space), locking);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(u.size());
  body.add_forces(u, f);
  return f;
}

Support clamp(double x = 0) {
  Support support;
  support.name = x == 0 ? "root" : "tip";
  support.region.plane = RegionChoice::Plane{{x, 0, 0}, {1, 0, 0}, 0};
  support.method = SupportMethod::Penalty;
  return support;
}

NonlinearLoad end_load(LoadKind kind, const Point3& vector, double pressure = 0) {
  NonlinearLoad load;
  load.load.name = "end";
  load.load.kind = kind;
  load.load.vector = vector;
  load.load.pressure = pressure;
  load.load.region.plane = RegionChoice::Plane{{4, 0, 0}, {1, 0, 0}, 0};
  load.follower = kind == LoadKind::Pressure;
  return load;
}

NonlinearRun run_of(const std::string& law) {
  NonlinearRun run;
  run.material.law = law_of(law);
  run.light = usual();
  run.supports = {clamp()};
  return run;
}

Eigen::VectorXd random_vector(Eigen::Index size, double amplitude, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-amplitude, amplitude);
  Eigen::VectorXd v(size);
  for (double& x : v) x = value(random);
  return v;
}

} // namespace

// Tractions P n of a uniform deformation balance the internal forces, on a cube whose every cell is cut.
TEST(Nonlinear, LargeUniformDeformation) {
  Eigen::Matrix3d stretch = Eigen::Vector3d(1.6, 0.8, 0.9).asDiagonal(), shear = Eigen::Matrix3d::Identity(), mixed;
  shear(0, 1) = 0.7;
  mixed << 1.2, 0.3, -0.2, -0.1, 0.8, 0.4, 0.2, -0.3, 1.1;
  for (const int degree : {2, 3}) {
    const TrimmedModel model = turned_cube(degree, degree == 2 ? 0.3 : 0.5);
    const SolutionSpace space(model, usual());
    for (const char* law : {"st-venant", "neo-hookean"})
      for (const Eigen::Matrix3d& F : {stretch, shear, mixed}) {
        const Eigen::Matrix3d P = stress(law, F);
        LoadReport report;
        const Eigen::VectorXd t = traction_load(
            space, choose_region(model, {}, "surface"),
            [&](const Point3&, const Point3& n) {
              const Eigen::Vector3d force = P * Eigen::Vector3d(n[0], n[1], n[2]);
              return Point3{force[0], force[1], force[2]};
            },
            report);
        for (const Locking locking : {Locking::None, Locking::FBar})
          EXPECT_LT((internal_forces(space, law_of(law), uniform(space, F), locking) - t).norm(), 1e-10 * t.norm())
              << law;
      }
  }
}

TEST(Nonlinear, QuarterTurnWithoutStress) {
  const TrimmedModel model = turned_cube(2, 0.5);
  const SolutionSpace space(model, usual());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (const char* law : {"st-venant", "neo-hookean", "j2", "foam"})
    for (const Locking locking : {Locking::None, Locking::FBar})
      EXPECT_LT(internal_forces(space, law_of(law), uniform(space, turn), locking).cwiseAbs().maxCoeff(), 1e-12 * E)
          << law;
}

// -∂r/∂u against central differences along a random direction, following pressure and supports included; where points
// yield too.
TEST(Nonlinear, TangentIsDerivativeOfResidual) {
  const TrimmedModel model = beam(1);
  const SolutionSpace space(model, usual());
  for (const char* law : {"linear", "st-venant", "neo-hookean", "j2", "foam"})
    for (const bool pressure : {false, true}) {
      NonlinearRun run = run_of(law);
      if (pressure) run.loads = {end_load(LoadKind::Pressure, {}, 0.5)};
      const NonlinearStatics statics(run, space);
      Eigen::Matrix3d F;
      if (std::string(law) == "foam") // its stress has kinks: a state in which all points are crushed along all axes
        F << 0.7, 0.02, 0, -0.02, 0.75, 0.02, 0.02, 0, 0.8;
      else
        F << 0.9, 0.1, 0, -0.1, 1.05, 0.1, 0.1, 0, 1.1;
      const Eigen::VectorXd u = uniform(space, F) + random_vector(space.num_unknowns(), 0.01, 1);
      const Eigen::VectorXd v = random_vector(space.num_unknowns(), 1, 2);
      constexpr double step = 1e-6;
      const Eigen::VectorXd difference =
          (statics.residual(u - step * v, 0.7).r - statics.residual(u + step * v, 0.7).r) / (2 * step);
      Tangent A = statics.make_tangent();
      EXPECT_EQ(A.symmetric, !pressure && std::string(law) != "j2" && std::string(law) != "foam");
      statics.tangent(u, 0.7, A);
      EXPECT_LT((product(A, v) - difference).norm(), 1e-6 * difference.norm()) << law;
      if (!A.symmetric) { // what it is factorised for
        const Eigen::VectorXd solved = factorise_unsymmetric(A.lower, A.upper)->solve(difference);
        EXPECT_LT((product(A, solved) - difference).norm(), 1e-10 * difference.norm()) << law;
      }
    }
}

// The same of F-bar, with a nearly incompressible law too; where the law has an energy, so has F-bar: a symmetric
// tangent.
TEST(Nonlinear, TangentOfFBarIsDerivativeOfResidual) {
  const TrimmedModel model = beam(1);
  const SolutionSpace space(model, usual());
  const auto connectivity = std::make_shared<const Connectivity>(space);
  for (const char* name : {"st-venant", "neo-hookean", "rubber", "j2", "foam"}) {
    const Law law = std::string(name) == "rubber" ? Law(neo_hookean(E, 0.4999, 1)) : law_of(name);
    const FiniteBody body(space, law, connectivity, Locking::FBar);
    Eigen::Matrix3d F;
    if (std::string(name) == "foam")
      F << 0.7, 0.02, 0, -0.02, 0.75, 0.02, 0.02, 0, 0.8;
    else
      F << 0.9, 0.1, 0, -0.1, 1.05, 0.1, 0.1, 0, 1.1;
    const Eigen::VectorXd u = uniform(space, F) + random_vector(space.num_unknowns(), 0.02, 1);
    const Eigen::VectorXd v = random_vector(space.num_unknowns(), 1, 2), w = random_vector(space.num_unknowns(), 1, 3);
    const auto forces = [&](double step) {
      Eigen::VectorXd f = Eigen::VectorXd::Zero(u.size());
      EXPECT_EQ(body.add_forces(u + step * v, f).inverted, 0);
      return f;
    };
    constexpr double step = 1e-6;
    const Eigen::VectorXd difference = (forces(step) - forces(-step)) / (2 * step);
    Tangent A(connectivity, false);
    A.set_zero();
    body.add_tangent(u, A);
    EXPECT_LT((product(A, v) - difference).norm(), 1e-6 * difference.norm()) << name;
    if (!body.law().is_symmetric()) continue;
    EXPECT_NEAR(w.dot(product(A, v)), v.dot(product(A, w)), 1e-10 * w.norm() * difference.norm()) << name;
  }
}

// A block of rubber pressed between two held ends: far too stiff at degree 2, with F-bar hardly so at two spans an
// edge.
TEST(Nonlinear, RubberDoesNotLock) {
  const auto force = [](double span_size, Locking locking) {
    const TrimmedModel model = make_part(box_mesh({0, 0, 0}, {1, 1, 1}), {2, span_size, 0.3, 0, identity_rotation});
    const SolutionSpace space(model, usual());
    NonlinearRun run = run_of("neo-hookean");
    run.material.law = neo_hookean(E, 0.4999, 1);
    run.locking = locking;
    run.supports = {clamp(0), clamp(1)};
    run.supports[1].name = "press";
    run.supports[1].value = {-0.05, 0, 0};
    run.newton.steps = 1;
    NonlinearStatics statics(run, space);
    statics.advance(1);
    return statics.support_forces()[0].force[0];
  };
  const double locked = force(0.5, Locking::None), coarse = force(0.5, Locking::FBar),
               fine = force(0.34, Locking::FBar);
  EXPECT_GT(locked, 2 * fine);
  EXPECT_NEAR(coarse, fine, 0.02 * fine);
}

// A cell turned inside out at one point has no F-bar: its forces are no numbers, so that Newton's method steps back.
TEST(Nonlinear, FBarOfCrushedCells) {
  const TrimmedModel model = beam(1);
  const SolutionSpace space(model, usual());
  Eigen::Matrix3d flat = Eigen::Matrix3d::Identity();
  flat(0, 0) = -0.1;
  const Eigen::VectorXd f = internal_forces(space, law_of("neo-hookean"), uniform(space, flat), Locking::FBar);
  EXPECT_FALSE(f.allFinite());
}

// The residual falls at least as its power 1.6 per iteration once it is small.
TEST(Nonlinear, NewtonConvergesQuadratically) {
  const TrimmedModel model = beam();
  const SolutionSpace space(model, usual());
  for (const char* law : {"neo-hookean", "st-venant", "j2", "foam"}) {
    NonlinearRun run = run_of(law);
    run.newton = {.steps = 2, .tolerance = 1e-11};
    const bool soft = std::string(law) == "j2" || std::string(law) == "foam";
    run.loads = {end_load(LoadKind::TotalForce, {0, 0, soft ? -0.01 : -0.08})};
    NonlinearStatics statics(run, space);
    const StepReport step = statics.advance(0.5);
    EXPECT_EQ(step.cuts, 0) << law;
    EXPECT_LE(step.iterations, 10) << law;
    const auto& r = step.residuals;
    ASSERT_GE(r.size(), 3u) << law;
    bool fast = false;
    for (std::size_t k = 0; k + 1 < r.size(); ++k)
      if (r[k] < 1e-2 && r[k] > 1e-6) fast = fast || r[k + 1] < std::max(std::pow(r[k], 1.6), 1e-11);
    EXPECT_TRUE(fast) << law << ": " << ::testing::PrintToString(r);
  }
}

TEST(Nonlinear, SmallLoadsAreLinear) {
  const TrimmedModel model = beam(1);
  const SolutionSpace space(model, usual());
  constexpr double force = 1e-7;
  for (const char* law : {"linear", "st-venant", "neo-hookean", "j2"}) {
    NonlinearRun run = run_of(law);
    run.newton.steps = 1;
    run.loads = {end_load(LoadKind::TotalForce, {force, 0, force})};
    NonlinearStatics statics(run, space);
    statics.advance(1);
    RunSettings linear;
    linear.material = isotropic(E, nu, 1);
    linear.supports = run.supports;
    StaticSettings settings;
    settings.loads = {run.loads[0].load};
    const StaticSolution solution = run_static(linear, settings, space);
    EXPECT_LT((statics.displacement() - solution.unknowns).norm(), 1e-6 * solution.unknowns.norm()) << law;
  }
}

// Prescribed motion: the end is pushed in by 30 % and aside; reactions are balanced.
TEST(Nonlinear, PrescribedLargeMotion) {
  const TrimmedModel model = beam(1);
  const SolutionSpace space(model, usual());
  NonlinearRun run = run_of("neo-hookean");
  run.supports.push_back(clamp(4));
  run.supports.back().value = {-1.2, 0.4, 0};
  run.newton.steps = 3;
  NonlinearStatics statics(run, space);
  const StepReport step = statics.advance(1);
  EXPECT_EQ(statics.factor(), 1);
  EXPECT_LT(step.residual, 1e-8);
  const auto forces = statics.support_forces();
  ASSERT_EQ(forces.size(), 2u);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(forces[0].force[d] + forces[1].force[d], 0, 1e-7);
  EXPECT_LT(forces[1].force[0], -2); // pressed together by 30 %: about E times that
  EXPECT_LT(forces[1].gap, 2e-3);
}

TEST(Nonlinear, SameBitsForAnyNumberOfThreads) {
  const TrimmedModel model = beam();
  const SolutionSpace space(model, usual());
  std::vector<Eigen::VectorXd> found;
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    NonlinearRun run = run_of("j2");
    run.loads = {end_load(LoadKind::Pressure, {}, 0.12)};
    run.newton.steps = 2;
    NonlinearStatics statics(run, space);
    Tangent A = statics.make_tangent();
    const Eigen::VectorXd u = random_vector(space.num_unknowns(), 0.05, 3);
    statics.tangent(u, 1, A);
    Eigen::VectorXd all = statics.residual(u, 1).r;
    const auto keep = [&](std::span<const double> values) {
      const Eigen::Index before = all.size();
      all.conservativeResize(before + static_cast<Eigen::Index>(values.size()));
      std::copy(values.begin(), values.end(), all.data() + before);
    };
    keep(A.lower.values());
    keep(A.upper.values());
    found.push_back(std::move(all));
  }
  EXPECT_TRUE(found[0] == found[1]);
}

// A step that finds no equilibrium leaves the state of the last converged one; and a state that was saved goes on bit
// for bit.
TEST(Nonlinear, StateIsThatOfConvergedSteps) {
  const TrimmedModel model = beam(1);
  const SolutionSpace space(model, usual());
  NonlinearRun run = run_of("j2");
  run.newton.steps = 4;
  run.loads = {end_load(LoadKind::TotalForce, {0.16, 0, 0})};
  NonlinearStatics whole(run, space), parts(run, space);
  for (const double factor : {0.25, 0.5, 0.75}) whole.advance(factor);
  parts.advance(0.25);
  parts.advance(0.5);
  const StaticState saved = parts.save();
  NonlinearStatics later(run, space);
  later.load(saved);
  later.advance(0.75);
  EXPECT_TRUE(later.displacement() == whole.displacement());
  EXPECT_EQ(later.internal_work(), whole.internal_work());

  run.newton.max_iterations = 1;
  run.newton.smallest_step = 0.3;
  NonlinearStatics stuck(run, space);
  stuck.load(saved);
  EXPECT_THROW(stuck.advance(1), NumericalError);
  EXPECT_TRUE(stuck.displacement() == saved.u);
  EXPECT_EQ(stuck.save().points.history, saved.points.history);
}

// A pressure on the whole surface of a free-floating block keeps it in balance however it is deformed.
TEST(Nonlinear, FollowingPressureOnClosedSurface) {
  const TrimmedModel model = turned_cube(2, 0.5);
  const SolutionSpace space(model, usual());
  const FollowerPressure pressure(space, choose_region(model, {}, "surface"), 2);
  const Eigen::VectorXd u = random_vector(space.num_unknowns(), 0.1, 4);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(u.size());
  const Point3 sum = pressure.add_forces(u, 1, f);
  for (const double x : sum) EXPECT_NEAR(x, 0, 0.05); // points of a rule made for flat facets, not for cof F
  // Uniform deformation: exactly zero, and the force on one half is -p times its deformed area vector.
  Eigen::Matrix3d F;
  F << 1.2, 0.3, -0.2, -0.1, 0.8, 0.4, 0.2, -0.3, 1.1;
  f.setZero();
  const Point3 none = pressure.add_forces(uniform(space, F), 1, f);
  for (const double x : none) EXPECT_NEAR(x, 0, 1e-12);
}
