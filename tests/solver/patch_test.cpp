// Linear fields on trimmed parts: constant stress, balance with the traction, and every way to impose displacements.
#include "solver/mechanics/assemble.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

TrimmedModel rotated_cube(int degree, int seed, double span_size) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> angle(0, 360), shift(0, 1);
  const double z = angle(random), y = angle(random), s = shift(random);
  const TriangleMesh mesh = transformed(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), rotation(z, y), {0.3, -0.2, 0.1});
  return make_part(mesh, {degree, span_size, s, 0, identity_rotation});
}

TrimmedModel busted(int degree) {
  const TriangleMesh mesh = read_stl(shared_part("valid/busted.STL"), weld_of("busted.STL"));
  return make_part(mesh, {degree, diagonal(mesh) / 6, 0.37, 0, identity_rotation});
}

// Greville points carry linear fields: stress at all points, and K u against the tractions on the whole surface.
void expect_constant_stress(const TrimmedModel& model) {
  const SolutionSpace space(model, usual());
  const ElasticMaterial material = isotropic(210, 0.3, 7.8e-6);
  const auto points = space.node_points();
  Eigen::VectorXd u(space.num_unknowns());
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    const Point3 at = linear_field({points(n, 0), points(n, 1), points(n, 2)});
    u.segment<3>(3 * n) << at[0], at[1], at[2];
  }
  const FieldSamples fields = recover_fields(space, material, u, model.points.offsets, model.points.parameters);
  std::vector<double> positions;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* p = model.points.parameters.data() + 3 * q;
    const Point3 x = model.grid.to_position({p[0], p[1], p[2]});
    positions.insert(positions.end(), x.begin(), x.end());
  }
  const LinearErrors errors = errors_of(fields, positions, material);
  EXPECT_LT(errors.displacement, 1e-12);
  EXPECT_LT(errors.stress, 1e-10);

  const StiffnessMatrix K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
  const Voigt stress = constant_stress(material);
  LoadReport report;
  const Eigen::VectorXd f = traction_load(
      space, choose_region(model, {}, "surface"), [&](const Point3&, const Point3& n) { return traction(stress, n); },
      report);
  EXPECT_LT((K * u - f).norm(), 1e-10 * f.norm());
}

// The linear field given on the whole surface.
void expect_recovered(const TrimmedModel& model, SupportMethod method, double displacement, double stress) {
  const SolutionSpace space(model, usual());
  const RunSettings run = run_with({linear_support(method)});
  const StaticSolution solution = run_static(run, {}, space);
  const LinearErrors errors = errors_of(solution.result.points, solution.result.positions, run.material);
  EXPECT_LT(errors.displacement, displacement);
  EXPECT_LT(errors.stress, stress);
}

// Root mean square of the displacement's error over the volume.
double penalty_error(const TrimmedModel& model, double factor) {
  const SolutionSpace space(model, usual());
  RunSettings run = run_with({linear_support(SupportMethod::Penalty)});
  run.supports[0].penalty_factor = factor;
  const StaticResult result = run_static(run, {}, space).result;
  double squared = 0, volume = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* x = result.positions.data() + 3 * q;
    const double* u = result.points.displacement.data() + 3 * q;
    const Point3 error = minus({u[0], u[1], u[2]}, linear_field({x[0], x[1], x[2]}));
    squared += model.points.weights[q] * dot(error, error);
    volume += model.points.weights[q];
  }
  return std::sqrt(squared / volume);
}

class Patch : public ::testing::TestWithParam<int> {
 protected:
  // Large spans keep the cost of the higher degrees down; every span of the cube is trimmed then.
  static double span_size() { return GetParam() <= 2 ? 0.25 : 0.5; }
};

} // namespace

TEST_P(Patch, StressOfALinearFieldIsConstantOnRotatedCubes) {
  for (const int seed : {1, 2, 3}) expect_constant_stress(rotated_cube(GetParam(), seed, span_size()));
}

TEST_P(Patch, NitscheAndMultipliersRecoverTheLinearFieldOnRotatedCubes) {
  for (const int seed : GetParam() < 4 ? std::vector{1, 2} : std::vector{1}) {
    const TrimmedModel model = rotated_cube(GetParam(), seed, span_size());
    // At degree 4 the extended functions of slivers cost Nitsche's matrix a digit or two.
    expect_recovered(model, SupportMethod::Nitsche, 1e-10, GetParam() < 4 ? 1e-9 : 1e-8);
    expect_recovered(model, SupportMethod::Lagrange, 1e-10, 1e-9);
  }
}

// The surface yields like springs: u - u_D = -t / β with β = C E / h.
TEST_P(Patch, ReducedSurfacePointsAreMadeExactWhereSupportsAct) {
  const TriangleMesh mesh = transformed(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), rotation(37, 21), {0.3, -0.2, 0.1});
  PartOptions options;
  options.degree = GetParam();
  options.shift = 0.3;
  options.surface_rule = "reduced";
  const TrimmedModel model = make_part(mesh, options);
  expect_constant_stress(model);
  expect_recovered(model, SupportMethod::Nitsche, 1e-11, 1e-8);
}

TEST_P(Patch, PenaltyMissesTheLinearFieldByTractionOverBeta) {
  const TrimmedModel model = rotated_cube(GetParam(), 1, span_size());
  const ElasticMaterial material = isotropic(210, 0.3, 7.8e-6);
  const double few = penalty_error(model, 1e2), some = penalty_error(model, 1e3);
  EXPECT_NEAR(few / some, 10, 1);
  const double largest_traction = 1.5 * constant_stress(material).cwiseAbs().maxCoeff();
  EXPECT_LT(some, largest_traction / (1e3 * 210 / span_size()));
}

TEST_P(Patch, BustedPart) {
  if (shared_part("valid/busted.STL").empty()) GTEST_SKIP() << "the shared parts are not here";
  const TrimmedModel model = busted(GetParam());
  expect_constant_stress(model);
  if (GetParam() > 2) return;
  expect_recovered(model, SupportMethod::Nitsche, 1e-10, 1e-9);
  expect_recovered(model, SupportMethod::Lagrange, 1e-10, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Degrees, Patch, ::testing::Values(1, 2, 3, 4));

// Displacements on one face, tractions on the others: all three kinds of terms at work at once.
TEST(Patch, ClampedFaceAndTractionsOnTheOthers) {
  const Rotation R = rotation(25, 35);
  const TriangleMesh mesh = transformed(box({0, 0, 0}, {1, 1, 1}), R, {});
  const TrimmedModel model = make_part(mesh, {2, 0.3, 0.4, 0, identity_rotation});
  const SolutionSpace space(model, usual());
  const Point3 face{-R[0][0], -R[1][0], -R[2][0]};
  for (const auto method : {SupportMethod::Nitsche, SupportMethod::Lagrange}) {
    Support support = linear_support(method);
    support.region.normal = RegionChoice::Direction{face, 1};
    const RunSettings run = run_with({support});
    const Voigt stress = constant_stress(run.material);
    StaticSettings settings;
    for (const int side : {-1, 1})
      for (std::size_t d = 0; d < 3; ++d) {
        const Point3 n = times({R[0][d], R[1][d], R[2][d]}, side);
        if (d == 0 && side < 0) continue;
        Load load;
        load.name = "face";
        load.vector = traction(stress, n);
        load.region.normal = RegionChoice::Direction{n, 1};
        settings.loads.push_back(load);
      }
    const StaticSolution solution = run_static(run, settings, space);
    const LinearErrors errors = errors_of(solution.result.points, solution.result.positions, run.material);
    EXPECT_LT(errors.displacement, 1e-10);
    EXPECT_LT(errors.stress, 1e-9);
    const Point3 expected = traction(stress, face);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(solution.reactions[0].force[d], expected[d], 1e-10);
  }
}
