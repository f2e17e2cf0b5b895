// How the lowest frequencies of a free rod converge with each mass. A box with nu = 0 holds the rod exactly: fields
// u_x(x) that do not depend on y and z are an invariant subspace of stiffness and of every mass.
#include "solver/analysis/run_settings.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/mass_operator.hpp"
#include "tests/support/rate.hpp"
#include "tests/support/synthetic_model.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;

namespace {

constexpr double length = 1, E = 3, rho = 2;

// Lowest elastic frequency of the rod over its exact value, less one: trimmed ends (0.3 and 0.45 of a span), `spans`
// of them along the rod.
double relative_error(int p, double spans, MassType type) {
  const double h = length / spans;
  const std::int64_t margin = p + 1, n = static_cast<std::int64_t>(spans) + 1 + 2 * margin, m = 3 + 2 * margin;
  const double first = (static_cast<double>(margin) + 0.3) * h, side = static_cast<double>(margin) * h;
  const TrimmedModel model =
      test::make_box_model({{0, 0, 0},
                            {static_cast<double>(n) * h, static_cast<double>(m) * h, static_cast<double>(m) * h},
                            {n, m, m},
                            {p, p, p},
                            identity_rotation,
                            {first, side + 0.4 * h, side},
                            {first + length, side + 2.7 * h, side + 2 * h}});
  const SolutionSpace space(model, {});
  const auto connectivity = std::make_shared<const Connectivity>(space);
  const StiffnessMatrix K = assemble_stiffness(space, connectivity, isotropic(E, 0, rho));
  const MassOperator M = make_mass(type, space, connectivity, rho);

  // one vector per layer of functions along the rod, and one node of each layer to read coefficients from
  std::vector<std::int64_t> layer(static_cast<std::size_t>(space.num_nodes()));
  for (std::size_t i = 0; i < layer.size(); ++i)
    layer[i] = model.grid.function_index(model.functions.number[static_cast<std::size_t>(space.node_unknowns()[i])])[0];
  const auto [low, high] = std::minmax_element(layer.begin(), layer.end());
  const std::int64_t lowest = *low;
  const Eigen::Index size = *high - lowest + 1;
  std::vector<Eigen::Index> reader(static_cast<std::size_t>(size), -1);
  const Eigen::VectorXd mass = lumped_mass(space, rho);
  for (std::size_t i = 0; i < layer.size(); ++i) { // the heaviest one
    Eigen::Index& node = reader[static_cast<std::size_t>(layer[i] - lowest)];
    if (node < 0 || mass[static_cast<Eigen::Index>(i)] > mass[node / 3]) node = static_cast<Eigen::Index>(3 * i);
  }
  Eigen::MatrixXd A(size, size);
  Eigen::VectorXd y(space.num_unknowns());
  for (Eigen::Index j = 0; j < size; ++j) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(space.num_unknowns());
    for (std::size_t i = 0; i < layer.size(); ++i)
      if (layer[i] - lowest == j) x[static_cast<Eigen::Index>(3 * i)] = 1;
    M.divide((K * x).eval().data(), y.data(), 1);
    for (Eigen::Index i = 0; i < size; ++i) A(i, j) = y[reader[static_cast<std::size_t>(i)]];
  }
  std::vector<double> omega;
  const Eigen::VectorXcd lambda = Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
  for (const auto& value : lambda) omega.push_back(std::sqrt(std::max(value.real(), 0.0)));
  // light end functions bring spurious low frequencies under a lumped mass: the rod's own is the nearest one
  const double exact = std::numbers::pi * std::sqrt(E / rho) / length;
  double best = omega.front();
  for (const double w : omega)
    if (std::abs(w - exact) < std::abs(best - exact)) best = w;
  return best / exact - 1;
}

struct Case {
  MassType mass;
  int p;
  std::vector<double> spans;
  double order;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << name_of(c.mass) << ", p = " << c.p;
}

class RodMass : public ::testing::TestWithParam<Case> {};

} // namespace

TEST_P(RodMass, ConvergesAtItsOrder) {
  const auto& [mass, p, spans, order] = GetParam();
  std::vector<double> h, error;
  for (const double n : spans) {
    h.push_back(1 / n);
    error.push_back(relative_error(p, n, mass));
  }
  const double rate = test::print_rates(std::string(name_of(mass)) + ", p = " + std::to_string(p), h, error);
  EXPECT_NEAR(rate, order, mass == MassType::Consistent ? 0.3 : 0.2);
}

INSTANTIATE_TEST_SUITE_P(
    Masses, RodMass,
    ::testing::Values(Case{MassType::Consistent, 1, {8, 16, 32}, 2}, Case{MassType::Consistent, 2, {8, 16, 32}, 4},
                      Case{MassType::Consistent, 3, {4, 6, 8}, 6}, Case{MassType::Lumped, 2, {8, 16, 32}, 2},
                      Case{MassType::Lumped, 3, {8, 16, 32}, 2}, Case{MassType::TwoPass, 2, {8, 16, 32}, 4},
                      Case{MassType::TwoPass, 3, {8, 16, 32}, 4}));

TEST(RodMass, LumpedErrorIsTheOneOfTheory) {
  // -(p + 1) (k h)² / 24, numerics of row-sum lumping
  for (const int p : {2, 3}) {
    const double kh = std::numbers::pi / 16;
    EXPECT_NEAR(relative_error(p, 16, MassType::Lumped) / (-(p + 1) * kh * kh / 24), 1, 0.03) << p;
  }
}
