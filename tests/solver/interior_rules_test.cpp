// Generalised Gaussian rules of interior spans as matrices, frequencies and bounds see them.
#include "solver/mechanics/element_bound.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/eigen_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;

namespace {

constexpr double nu = 0.3, mu = 1 / (2 * (1 + nu)); // E = rho = 1
const ElasticMaterial material = isotropic(1, nu, 1);

// The unit cube on e³ whole spans inside a margin of p empty ones: every function is a cardinal B-spline.
TrimmedModel aligned_cube(int p, std::int64_t e, const char* rule) {
  const test::BoxCase box = test::box_in_grid({1, 1, 1}, {e, e, e}, p);
  return test::make_part(test::box(box.lower, box.upper), SplineGrid(box.A, box.B, box.spans, box.degree), 0, rule);
}

// A block turned in its grid: all of its faces are trimmed, a box of spans stays inside.
TrimmedModel turned_block(int p, double span_size, const char* rule) {
  const TriangleMesh block =
      test::transformed(test::box({-0.6, -0.5, -0.5}, {0.6, 0.5, 0.5}), test::rotation(20, 12), {});
  return test::make_part(block, {p, span_size, 0.3, 0, identity_rotation, rule});
}

EigenOutcome modes_of(const TrimmedModel& model, int count, const LightTreatment& light = {}) {
  RunSettings run;
  run.material = material;
  run.light = light;
  EigenSettings settings;
  settings.modes = count;
  settings.sturm = true;
  return analyse_modes(run, settings, model);
}

double largest_entry(const StiffnessMatrix& K) {
  double largest = 0;
  for (const double v : K.values()) largest = std::max(largest, std::abs(v));
  return largest;
}

template <class Matrix> double difference(const Matrix& A, const Matrix& B) {
  double largest = 0;
  for (std::size_t i = 0; i < A.values().size(); ++i)
    largest = std::max(largest, std::abs(A.values()[i] - B.values()[i]));
  return largest;
}

std::int64_t interior_points(const TrimmedModel& model) {
  std::int64_t points = 0;
  for (std::size_t a = 0; a < model.cells.span.size(); ++a)
    if (static_cast<SpanState>(model.state[static_cast<std::size_t>(model.cells.span[a])]) == SpanState::Interior)
      points += model.points.offsets[a + 1] - model.points.offsets[a];
  return points;
}

} // namespace

// Errors of the first three multiplets of the free cube (Ω = 2.85605, 3.84597, 3.91125; Demarest 1971), measured once
// with an independent program.
TEST(InteriorRules, FrequenciesOfTheFreeCubeAsMeasuredBefore) {
  struct Row {
    int p;
    std::int64_t e;
    const char* rule;
    std::int64_t points; ///< per direction
    double error[3];
    double digits; ///< to which they were given
  };
  // The dimension of the last row's space is odd: such rules form a family, and the one measured was another member.
  const Row rows[] = {{2, 6, "gauss", 18, {4.4e-4, 5.6e-4, 4.6e-4}, 1e-5},
                      {2, 6, "ggq", 13, {4.4e-4, 5.6e-4, 4.6e-4}, 1e-5},
                      {2, 6, "ggq-reduced", 10, {1.3e-4, 4.1e-4, 2.5e-4}, 1e-5},
                      {3, 5, "ggq", 14, {4.9e-5, 3.8e-5, 3.8e-5}, 1e-6},
                      {3, 5, "ggq-reduced", 11, {3.2e-5, 2.9e-5, 2.7e-5}, 1e-6},
                      {3, 5, "ggq-reduced2", 9, {-1.3e-4, -5.4e-5, -4.5e-5}, 1e-5}};
  const double exact[] = {2.85605, 3.84597, 3.91125};
  const std::size_t first[] = {0, 2, 5};
  for (const Row& row : rows) {
    SCOPED_TRACE(std::string(row.rule) + " p " + std::to_string(row.p));
    const TrimmedModel model = aligned_cube(row.p, row.e, row.rule);
    EXPECT_EQ(interior_points(model), row.points * row.points * row.points);
    const EigenOutcome outcome = modes_of(model, 8);
    EXPECT_EQ(outcome.modes.rigid, 6);
    EXPECT_EQ(outcome.modes.mechanisms, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const double omega = std::sqrt(outcome.modes.lambda[6 + static_cast<Eigen::Index>(first[k])] / mu);
      // Half a unit of the last digit, and the six digits of the reference.
      EXPECT_NEAR(omega / exact[k] - 1, row.error[k], 0.5 * row.digits + 2e-6);
    }
  }
}

TEST(InteriorRules, GgqGivesTheMatricesOfGauss) {
  for (const int p : {1, 2, 3}) {
    const double size = p == 3 ? 0.17 : 0.12;
    const test::System gauss(turned_block(p, size, "gauss"), material), ggq(turned_block(p, size, "ggq"), material);
    EXPECT_LT(difference(gauss.K, ggq.K), 1e-12 * largest_entry(gauss.K));
    EXPECT_LT(difference(*gauss.M.matrix(), *ggq.M.matrix()), 1e-12 * gauss.M.matrix()->diagonal().maxCoeff());
    if (p > 1) {
      EXPECT_LT(interior_points(ggq.model), interior_points(gauss.model));
    }
  }
}

TEST(InteriorRules, GgqGivesTheFrequenciesOfGauss) {
  for (const int p : {2, 3}) {
    const double size = p == 2 ? 0.2 : 0.25;
    const EigenOutcome gauss = modes_of(turned_block(p, size, "gauss"), 6),
                       ggq = modes_of(turned_block(p, size, "ggq"), 6);
    ASSERT_EQ(gauss.modes.lambda.size(), ggq.modes.lambda.size());
    for (Eigen::Index m = 6; m < gauss.modes.lambda.size(); ++m)
      EXPECT_NEAR(std::sqrt(ggq.modes.lambda[m] / gauss.modes.lambda[m]), 1, 1e-10);
  }
}

TEST(InteriorRules, ReducedRulesLeaveSixRigidModesAndTheRowSumsOfTheMass) {
  for (const auto& [p, rule] :
       {std::pair(2, "ggq-reduced"), std::pair(3, "ggq-reduced"), std::pair(3, "ggq-reduced2")}) {
    SCOPED_TRACE(std::string(rule) + " p " + std::to_string(p));
    const double size = p == 2 ? 0.18 : 0.24;
    const TrimmedModel model = turned_block(p, size, rule), exact = turned_block(p, size, "gauss");
    const EigenOutcome outcome = modes_of(model, 4);
    EXPECT_EQ(outcome.modes.rigid, 6);
    EXPECT_EQ(outcome.modes.mechanisms, 0);
    ASSERT_TRUE(outcome.modes.sturm);
    EXPECT_EQ(outcome.modes.sturm->expected, outcome.modes.sturm->found);
    const Eigen::VectorXd lumped = lumped_mass(SolutionSpace(exact, {}), 1);
    EXPECT_LT((lumped_mass(SolutionSpace(model, {}), 1) - lumped).cwiseAbs().maxCoeff(), 1e-13 * lumped.maxCoeff());
  }
}

TEST(InteriorRules, TheBoundFromTheSpansHolds) {
  for (const int p : {2, 3})
    for (const char* rule : {"ggq", "ggq-reduced", "ggq-reduced2"}) {
      if (p < 3 && std::string(rule) == "ggq-reduced2") continue;
      SCOPED_TRACE(std::string(rule) + " p " + std::to_string(p));
      for (const bool aligned : {true, false}) {
        const test::System s(aligned ? aligned_cube(p, 3, rule) : turned_block(p, 0.3, rule), material,
                             MassType::Lumped);
        const auto bound = element_bound(s.space, material, MassType::Lumped);
        ASSERT_TRUE(bound);
        const double omega = largest_eigenvalue(s.K, s.M, 1e-4).omega;
        EXPECT_GT(bound->omega, omega);
        EXPECT_LT(bound->omega, 2.5 * omega);
        if (std::string(rule) == "ggq") {
          const TrimmedModel exact = aligned ? aligned_cube(p, 3, "gauss") : turned_block(p, 0.3, "gauss");
          const auto by_gauss = element_bound(SolutionSpace(exact, {}), material, MassType::Lumped);
          EXPECT_NEAR(bound->omega / by_gauss->omega, 1, 1e-10);
        }
      }
    }
}

TEST(InteriorRules, PointsDoNotDependOnTheNumberOfThreads) {
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return turned_block(2, 0.06, "ggq").points;
  };
  const IntegrationPoints one = run(1), four = run(4);
  EXPECT_EQ(one.offsets, four.offsets);
  EXPECT_EQ(one.parameters, four.parameters);
  EXPECT_EQ(one.weights, four.weights);
}

TEST(InteriorRules, ModelsPassTheirChecks) {
  for (const char* rule : {"gauss", "ggq", "ggq-reduced"}) {
    const TrimmedModel model = turned_block(2, 0.1, rule);
    const auto faults = check(model);
    EXPECT_TRUE(faults.empty()) << rule << ": " << faults.front();
  }
}
