// Errors estimated from what fields leave of the equations: nothing for exact fields, the true error of smooth ones.
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/estimate/oscillation.hpp"
#include "solver/estimate/residual_estimate.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

double integral(const std::function<double(double)>& f) {
  const Eigen::MatrixX2d rule = gauss_rule(10);
  double sum = 0;
  for (Eigen::Index q = 0; q < rule.rows(); ++q) sum += rule(q, 1) * f(rule(q, 0));
  return sum;
}

// Rods of length 1 between walls without friction: only u_x(x) moves, lateral strain is free of stress at nu = 0.
TrimmedModel rod(int spans, int degree, const Rotation& R = identity_rotation) {
  const double margin = R == identity_rotation ? 0 : 0.02;
  const SplineGrid grid({-margin, -margin, -margin}, {1 + margin, 0.25 + margin, 0.25 + margin}, {spans, 2, 2},
                        {degree, degree, degree}, R);
  TriangleMesh mesh = box({0, 0, 0}, {1, 0.25, 0.25});
  for (Point3& x : mesh.vertices) x = grid.to_position(x);
  return make_part(mesh, grid);
}

RunSettings rod_run(const SplineGrid& grid) {
  RunSettings run;
  run.material = isotropic(1, 0, 1);
  for (const std::size_t d : {std::size_t{1}, std::size_t{2}})
    for (const double side : {-1.0, 1.0}) {
      Support wall;
      wall.name = "wall";
      wall.along_normal = true;
      Point3 normal{};
      for (std::size_t r = 0; r < 3; ++r) normal[r] = side * grid.rotation()[r][d];
      wall.region.normal = RegionChoice::Direction{normal, 10};
      run.supports.push_back(wall);
    }
  return run;
}

class RodModes : public testing::TestWithParam<int> {};

} // namespace

TEST(Oscillation, HasNoMeanAndTheTabulatedSlope) {
  for (int n = 2; n <= max_degree + 2; ++n) {
    const Oscillation B(n);
    const auto slope = [&](double t) { return (B.value(t + 1e-5) - B.value(t - 1e-5)) / 2e-5; };
    EXPECT_NEAR(integral([&](double t) { return B.value(t); }), 0, 1e-15) << n;
    EXPECT_NEAR(integral([&](double t) { return slope(t) * slope(t); }), B.slope_squared(), 1e-8) << n;
    EXPECT_NEAR(B.value(0), B.value(1), 1e-15) << n;
    if (n > 2) {
      EXPECT_NEAR(slope(0), slope(1), 1e-8) << n;
    }
  }
}

TEST(ResidualEstimate, LinearFieldsLeaveNothing) {
  for (const int degree : {2, 3}) {
    const TriangleMesh mesh = transformed(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), rotation(31, 17), {0.3, -0.2, 0.1});
    const TrimmedModel model = make_part(mesh, {degree, 0.3, 0.4, 0, rotation(20, 5)});
    const SolutionSpace space(model, usual());
    const ElasticMaterial material = isotropic(210, 0.3, 7.8e-6);
    const auto points = space.node_points();
    ResidualProblem problem;
    problem.space = &space;
    problem.material = &material;
    problem.unknowns.resize(space.num_unknowns(), 1);
    problem.lambda = Eigen::VectorXd::Zero(1);
    for (Eigen::Index n = 0; n < points.rows(); ++n) {
      const Point3 at = linear_field({points(n, 0), points(n, 1), points(n, 2)});
      problem.unknowns.block<3, 1>(3 * n, 0) << at[0], at[1], at[2];
    }
    const double free = residual_energy(problem).sum();
    const Point3 expected = traction(constant_stress(material), {1, 0, 0});
    EXPECT_GT(free, 1e-3 * norm(expected) * norm(expected) / 210) << "traction on a free surface counts";
    const Voigt stress = constant_stress(material);
    const SurfaceRegion surface = choose_region(model, {}, "surface");
    problem.loaded.push_back({&surface, [&](const Point3&, const Point3& n, const Eigen::Vector3d& own) {
                                const Eigen::Vector3d t(traction(stress, n).data());
                                EXPECT_LT((own - t).norm(), 1e-9 * stress.norm());
                                return t;
                              }});
    EXPECT_LT(residual_energy(problem).sum(), 1e-18 * free);
  }
}

TEST_P(RodModes, HaveTheirTrueError) {
  const int degree = GetParam();
  // In the turned grid all spans are cut. At p = 3 their points are then not exact enough for errors of 1e-6.
  for (const Rotation& R : {identity_rotation, rotation(25, 40)}) {
    if (degree > 2 && R != identity_rotation) continue;
    const TrimmedModel model = rod(6, degree, R);
    EigenSettings settings;
    settings.modes = 3;
    const EigenOutcome outcome = analyse_modes(rod_run(model.grid), settings, model);
    ASSERT_TRUE(outcome.lambda_error);
    for (Eigen::Index m = 1; m <= 2; ++m) { // the first is the rod's free motion along itself
      const double exact = std::pow(static_cast<double>(m) * std::numbers::pi, 2);
      const double error = outcome.modes.lambda[m] - exact;
      ASSERT_GT(error, 1e-8 * exact);
      EXPECT_NEAR((*outcome.lambda_error)[m] / error, 1, 0.5) << "p = " << degree << ", mode " << m;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Degrees, RodModes, testing::Values(2, 3));

TEST(ResidualEstimate, IsNothingForSolutionsThatTheSplinesHold) {
  const TrimmedModel model = rod(3, 2);
  const SolutionSpace space(model, usual());
  RunSettings run = rod_run(model.grid);
  Support end;
  end.name = "end";
  end.fixed = {true, false, false};
  end.region.normal = RegionChoice::Direction{{-1, 0, 0}, 10};
  run.supports.push_back(end);
  StaticSettings settings;
  Load weight, pull;
  weight.name = "weight";
  weight.kind = LoadKind::Acceleration;
  weight.vector = {2, 0, 0};
  pull.name = "pull";
  pull.kind = LoadKind::TotalForce;
  pull.vector = {0.1, 0, 0};
  pull.region.normal = RegionChoice::Direction{{1, 0, 0}, 10};
  settings.loads = {weight, pull};
  const StaticSolution solution = run_static(run, settings, space);
  ASSERT_TRUE(solution.energy_error);
  EXPECT_LT(*solution.energy_error, 1e-12 * solution.result.strain_energy);
  settings.loads[1].vector = {0.1, 0.05, 0}; // bends: no quadratic polynomial
  run.supports.resize(1);
  run.supports[0] = end;
  run.supports[0].fixed = {true, true, true};
  const StaticSolution bent = run_static(run, settings, space);
  EXPECT_GT(relative_errors(bent)->strain_energy, 1e-4);
  EXPECT_LT(relative_errors(bent)->strain_energy, 0.2);
}

TEST(ResidualEstimate, SaysWhyThereIsNone) {
  const TrimmedModel linear = rod(4, 1);
  EigenSettings settings;
  settings.modes = 2;
  EXPECT_FALSE(analyse_modes(rod_run(linear.grid), settings, linear).lambda_error);
  settings.errors = true;
  const EigenOutcome asked = analyse_modes(rod_run(linear.grid), settings, linear);
  ASSERT_FALSE(asked.warnings.empty());
  EXPECT_NE(asked.warnings.back().find("degree 1"), std::string::npos) << asked.warnings.back();
  settings.errors = false;
  const TrimmedModel quadratic = rod(4, 2);
  EXPECT_FALSE(analyse_modes(rod_run(quadratic.grid), settings, quadratic).lambda_error);
}
