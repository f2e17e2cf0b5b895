// Linear fields on trimmed parts: constant stress, recovered with every way to impose displacements.
#include "format/model/vec3.hpp"
#include "solver/assemble.hpp"
#include "solver/free_motions.hpp"
#include "solver/static_analysis.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <random>

using namespace iga;
using namespace iga::solve;

namespace {

const std::array<Point3, 3> some_gradient{{{1e-3, 4e-4, -2e-4}, {-3e-4, -5e-4, 6e-4}, {7e-4, -1e-4, 2e-4}}};
const Point3 some_offset{1e-3, -2e-3, 3e-3};

Point3 linear_field(const Point3& x) {
  Point3 u{};
  for (std::size_t d = 0; d < 3; ++d) u[d] = some_offset[d] + dot(some_gradient[d], x);
  return u;
}

Voigt constant_stress(const ElasticMaterial& material) {
  const auto& G = some_gradient;
  Voigt strain;
  strain << G[0][0], G[1][1], G[2][2], G[0][1] + G[1][0], G[1][2] + G[2][1], G[2][0] + G[0][2];
  return material.C * strain;
}

Support linear_support(SupportMethod method) {
  Support support;
  support.name = "clamp";
  support.value = some_offset;
  support.gradient = some_gradient;
  support.method = method;
  return support;
}

LightTreatment usual() {
  return {LightFunctions::DegreeP, 1e-3};
}

RunSettings run_with(std::vector<Support> supports) {
  RunSettings run;
  run.material = isotropic(210, 0.3, 7.8e-6);
  run.supports = std::move(supports);
  return run;
}

/// Largest errors of displacement (relative to the largest displacement) and stress (relative to the largest one).
struct Errors {
  double displacement = 0, stress = 0;
};

Errors errors_of(const StaticSolution& solution, const TrimmedModel& model, const ElasticMaterial& material) {
  const Voigt exact = constant_stress(material);
  Errors errors;
  double largest = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* x = solution.result.positions.data() + 3 * q;
    const Point3 u = linear_field({x[0], x[1], x[2]});
    for (std::size_t d = 0; d < 3; ++d) {
      largest = std::max(largest, std::abs(u[d]));
      errors.displacement =
          std::max(errors.displacement, std::abs(solution.result.points.displacement[3 * q + d] - u[d]));
    }
    for (std::size_t k = 0; k < 6; ++k)
      errors.stress = std::max(
          errors.stress, std::abs(solution.result.points.stress[6 * q + k] - exact[static_cast<Eigen::Index>(k)]));
  }
  errors.displacement /= largest;
  errors.stress /= exact.cwiseAbs().maxCoeff();
  return errors;
}

TrimmedModel rotated_cube(int degree, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> angle(0, 360), shift(0, 1);
  const double z = angle(random), y = angle(random), s = shift(random);
  const TriangleMesh mesh =
      test::transformed(test::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), test::rotation(z, y), {0.3, -0.2, 0.1});
  return test::make_part(mesh, {degree, 1.0 / 3, s, 0, identity_rotation});
}

class PatchTest : public ::testing::TestWithParam<int> {};

} // namespace

TEST_P(PatchTest, LinearFieldIsRecoveredOnTheWholeSurfaceOfRotatedCubes) {
  const int p = GetParam();
  for (const int seed : {1, 2}) {
    const TrimmedModel model = rotated_cube(p, seed);
    const SolutionSpace space(model, usual());
    for (const auto method : {SupportMethod::Nitsche, SupportMethod::Lagrange}) {
      const RunSettings run = run_with({linear_support(method)});
      const StaticSolution solution = run_static(run, {}, space);
      const Errors errors = errors_of(solution, model, run.material);
      printf("p %d seed %d method %d: %g %g res %g c %ld\n", p, seed, int(method), errors.displacement, errors.stress,
             solution.residual, solution.num_constraints);
      for (auto& [n, t] : solution.timings) printf("   %s %.3f\n", n.c_str(), t);
      EXPECT_LT(errors.displacement, 1e-10);
      EXPECT_LT(errors.stress, 1e-10);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, PatchTest, ::testing::Values(1, 2, 3, 4));
