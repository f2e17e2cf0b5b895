// Eigenfrequencies of free bodies that are turned in the grid, so that every face is trimmed, against exact values.
#include "solver/analysis/eigen_analysis.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"
#include "tests/support/rate.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;

namespace {

constexpr double pi = std::numbers::pi, nu = 0.3, mu = 1 / (2 * (1 + nu)); // E = rho = 1

EigenOutcome modes_of(const TrimmedModel& model, MassType mass, int count, bool extended = true) {
  RunSettings run;
  run.material = isotropic(1, nu, 1);
  run.mass = mass;
  if (extended) run.light = default_light_treatment(mass);
  EigenSettings settings;
  settings.modes = count;
  return analyse_modes(run, settings, model);
}

// ω √(ρ/μ) of the elastic modes.
std::vector<double> dimensionless(const EigenOutcome& outcome) {
  std::vector<double> values;
  for (Eigen::Index m = outcome.modes.rigid; m < outcome.modes.lambda.size(); ++m)
    values.push_back(std::sqrt(outcome.modes.lambda[m] / mu));
  return values;
}

// ∫ u_h · u dV of a mode with a field given in the cube's own axes.
double overlap(const TrimmedModel& model, const SolutionSpace& space, const Eigen::VectorXd& mode, const Rotation& turn,
               const std::function<Point3(const Point3&)>& field) {
  double sum = 0;
  SpanShapes shapes;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const auto u = cell_parameters(model, a), w = cell_weights(model, a);
    evaluate(space, a, u, Shapes::Values, shapes);
    const auto nodes = space.nodes(a);
    for (std::size_t q = 0; q < w.size(); ++q) {
      const Point3 x = model.grid.to_position({u[3 * q], u[3 * q + 1], u[3 * q + 2]});
      Point3 own{}, value{};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) own[i] += turn[j][i] * x[j];
      const Point3 local = field(own);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) value[i] += turn[i][j] * local[j];
      for (std::size_t n = 0; n < nodes.size(); ++n)
        for (std::size_t d = 0; d < 3; ++d)
          sum += w[q] * value[d] * shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(n)) *
                 mode[3 * nodes[n] + static_cast<Eigen::Index>(d)];
    }
  }
  return sum;
}

// Mean relative error of the three Lamé modes, Ω = √2 π: the modes with the largest shares of the exact fields.
double lame_error(int p, double spans, MassType mass) {
  const Rotation turn = test::some_rotation(0.6);
  const TriangleMesh cube = test::transformed(test::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), turn, {});
  const TrimmedModel model = test::make_part(cube, {p, 1 / spans, 0.3, 2 * p, identity_rotation});
  const EigenOutcome outcome = modes_of(model, mass, 14);
  std::vector<std::pair<double, double>> shares; // share of the Lamé fields, frequency
  const auto values = dimensionless(outcome);
  for (std::size_t m = 0; m < values.size(); ++m) {
    double share = 0;
    for (std::size_t plane = 0; plane < 3; ++plane) {
      const std::size_t i = plane, j = (plane + 1) % 3;
      const double projection = overlap(model, *outcome.system[0].space,
                                        outcome.modes.vectors.col(outcome.modes.rigid + static_cast<Eigen::Index>(m)),
                                        turn, [&](const Point3& x) {
                                          Point3 u{};
                                          u[i] = std::cos(pi * (x[i] + 0.5)) * std::sin(pi * (x[j] + 0.5));
                                          u[j] = -std::sin(pi * (x[i] + 0.5)) * std::cos(pi * (x[j] + 0.5));
                                          return u;
                                        });
      share += 2 * projection * projection; // ∫ u² = 1/2
    }
    shares.emplace_back(share, values[m]);
  }
  std::sort(shares.rbegin(), shares.rend());
  double error = 0;
  for (int k = 0; k < 3; ++k) {
    // the three fields are not orthogonal: their Gram matrix has the eigenvalues 1 - 8/π² and twice 1 + 4/π²
    EXPECT_GT(shares[static_cast<std::size_t>(k)].first, 0.15) << "p = " << p << ", " << spans << " spans";
    error += (shares[static_cast<std::size_t>(k)].second / (std::sqrt(2.0) * pi) - 1) / 3;
  }
  return error;
}

double lame_rate(int p, const std::vector<double>& spans, MassType mass) {
  std::vector<double> h, error;
  for (const double n : spans) {
    h.push_back(1 / n);
    error.push_back(lame_error(p, n, mass));
  }
  return test::print_rates(
      "Lamé modes of a turned cube, " + std::string(name_of(mass)) + " mass, p = " + std::to_string(p), h, error);
}

} // namespace

TEST(FreeCube, ConsistentMassConvergesWithTwiceTheDegree) {
  EXPECT_GE(lame_rate(1, {4, 6, 9}, MassType::Consistent), 2 - 0.3);
  EXPECT_GE(lame_rate(2, {3, 4, 6}, MassType::Consistent), 4 - 0.3);
  EXPECT_GE(lame_rate(3, {3, 4}, MassType::Consistent), 6 - 0.3);
}

// Ω of the free cube, nu = 0.3 (numerics after Demarest 1971): aligned and turned alike.
TEST(FreeCube, FrequenciesAndMultiplicitiesAlignedAndTurned) {
  const double exact[] = {2.85605, 2.85605, 3.84597, 3.84597, 3.84597, 3.91125,
                          3.91125, 3.91125, 4.44288, 4.44288, 4.44288};
  for (const double angle : {0.0, 0.6}) {
    const TriangleMesh cube =
        test::transformed(test::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), test::some_rotation(angle), {});
    const TrimmedModel model = test::make_part(cube, {2, 1.0 / 6, 0.3, 0, identity_rotation});
    const auto values = dimensionless(modes_of(model, MassType::Consistent, 11));
    std::printf("turned by %.1f:", angle);
    for (std::size_t m = 0; m < std::size(exact); ++m) {
      std::printf(" %+.1e", values[m] / exact[m] - 1);
      EXPECT_NEAR(values[m] / exact[m], 1, 1.5e-3) << angle << " " << m;
      EXPECT_GT(values[m] / exact[m], 1 - 3e-4) << angle << " " << m; // moments of degree p soften a little
    }
    std::printf("\n");
  }
}

// ω a / c_s of the free sphere, nu = 0.3 (Lamb 1882): T2 ×5, S2 ×5, S1 ×3, T3 ×7. The facets of the sphere are part of
// the error: their volume is 1 - O(N⁻²) of the ball's.
TEST(FreeSphere, FrequenciesAndMultiplicities) {
  const TrimmedModel model = test::make_part(test::sphere({0, 0, 0}, 1, 5), {2, 1.0 / 4, 0.3, 0, identity_rotation});
  const auto values = dimensionless(modes_of(model, MassType::Consistent, 20));
  std::vector<double> exact(5, 2.50113);
  exact.insert(exact.end(), 5, 2.64622);
  exact.insert(exact.end(), 3, 3.52999);
  exact.insert(exact.end(), 7, 3.86470);
  for (std::size_t m = 0; m < exact.size(); ++m) {
    std::printf(" %+.1e", values[m] / exact[m] - 1);
    EXPECT_NEAR(values[m] / exact[m], 1, 5e-3) << m;
  }
  std::printf("\n");
}
