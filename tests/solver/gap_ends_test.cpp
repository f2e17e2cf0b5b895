// Where a gap ends inside the support of B-splines: the space of continuous functions there.
#include "format/model/glue_gap_ends.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/space/light_functions.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using namespace iga::test;

// Block of 20 × 40 × 10 with a slit of 0.05 from its edge to its middle, in a grid turned against it.
TrimmedModel slit_block(int degree, double span_size, bool split_gap_ends = true, int moment_degree = 0,
                        const char* interior_rule = "gauss") {
  const TriangleMesh mesh =
      transformed(prism({{0, 0}, {9, 0}, {9, 20}, {9.05, 20}, {9.05, 0}, {20, 0}, {20, 40}, {0, 40}},
                        {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 4, 5}, {3, 5, 6}}, 0, 10),
                  rotation(13, 9), {});
  PartOptions options;
  options.degree = degree;
  options.span_size = span_size;
  options.shift = 0.37;
  options.split_gap_ends = split_gap_ends;
  options.moment_degree = moment_degree;
  options.interior_rule = interior_rule;
  return make_part(mesh, options);
}

class GapEnds : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degrees, GapEnds, testing::Values(2, 3, 4));

TEST_P(GapEnds, ModelIsSoundWithEveryInteriorRule) {
  for (const char* rule : {"gauss", "ggq", "ggq-reduced"}) {
    const TrimmedModel model = slit_block(GetParam(), 5, true, 0, rule);
    for (const std::string& problem : check(model)) ADD_FAILURE() << rule << ": " << problem;
    EXPECT_GT(count_cells(model).gap_end_cells, 0);
    EXPECT_EQ(count_cells(model).components, 1);
    EXPECT_EQ(separate_bodies(SolutionSpace(model, {LightFunctions::DegreeP, 1e-6})).count, 1);
  }
}

TEST_P(GapEnds, AreGluedAgain) {
  const TrimmedModel glued = glue_gap_ends(slit_block(GetParam(), 5)), reference = slit_block(GetParam(), 5, false);
  for (const std::string& problem : check(glued)) ADD_FAILURE() << problem;
  EXPECT_TRUE(glued.unknowns.empty());
  // Copies of one B-spline may come in another order.
  const auto sorted = [](const Functions& functions) {
    std::vector<std::pair<std::int64_t, double>> all;
    for (std::size_t f = 0; f < functions.number.size(); ++f)
      all.emplace_back(functions.number[f], functions.mass_fraction[f]);
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto found = sorted(glued.functions), expected = sorted(reference.functions);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t f = 0; f < found.size(); ++f) {
    EXPECT_EQ(found[f].first, expected[f].first);
    EXPECT_NEAR(found[f].second, expected[f].second, 1e-9);
  }
}

TEST_P(GapEnds, CheckSeesDamage) {
  const TrimmedModel sound = slit_block(GetParam(), 5);
  const auto expect_refused = [&](const char* what, auto&& damage) {
    TrimmedModel model = sound;
    damage(model.unknowns);
    bool found = false;
    for (const std::string& problem : check(model))
      found = found || problem.find("unknowns") != std::string::npos || problem.find("shape") != std::string::npos;
    EXPECT_TRUE(found) << what;
  };
  std::size_t row = 0; // of several terms
  while (sound.unknowns.offsets[row + 1] - sound.unknowns.offsets[row] < 4) ++row;
  const auto first = static_cast<std::size_t>(sound.unknowns.offsets[row]);
  expect_refused("factor", [&](Unknowns& u) { u.weights[first] += 1e-2; });
  // Constants are kept, places are not.
  expect_refused("two factors", [&](Unknowns& u) { u.weights[first] += 1e-2, u.weights[first + 1] -= 1e-2; });
  expect_refused("order", [&](Unknowns& u) { std::swap(u.terms[first], u.terms[first + 1]); });
  expect_refused("term", [&](Unknowns& u) { u.terms[first] = -1; });
  expect_refused("offset", [&](Unknowns& u) { u.offsets[row] = u.offsets[row + 1] + 1; });
  expect_refused("function", [&](Unknowns& u) { u.function.back() = 0; });
  expect_refused("mass", [&](Unknowns& u) { u.mass_fraction.back() = 0; });
  expect_refused("length", [&](Unknowns& u) { u.parameters.pop_back(); });
}

TEST_P(GapEnds, ContinuityIsChecked) {
  // A Bernstein function's copy of one cell is taken apart from the same function's of its neighbour: constants and
  // places stay, continuity does not.
  TrimmedModel model = slit_block(GetParam(), 5);
  Unknowns& u = model.unknowns;
  const auto twin = static_cast<std::int32_t>(u.function.size());
  std::size_t cell = 0;
  while (!model.is_at_gap_end(cell)) ++cell;
  std::int32_t chosen = -1; // one that another cell sees too
  for (std::size_t other = cell + 1; other < model.num_cells() && chosen < 0; ++other)
    for (const std::int32_t f : model.functions_of(cell))
      for (const std::int32_t g : model.functions_of(other))
        if (model.is_at_gap_end(other) && chosen < 0)
          for (auto t = u.offsets[static_cast<std::size_t>(f)]; t < u.offsets[static_cast<std::size_t>(f) + 1]; ++t)
            for (auto s = u.offsets[static_cast<std::size_t>(g)]; s < u.offsets[static_cast<std::size_t>(g) + 1]; ++s)
              if (const auto term = u.terms[static_cast<std::size_t>(t)];
                  term == u.terms[static_cast<std::size_t>(s)] && u.function[static_cast<std::size_t>(term)] < 0)
                chosen = term;
  ASSERT_GE(chosen, 0);
  for (const std::int32_t f : model.functions_of(cell)) {
    const auto begin = u.terms.begin() + u.offsets[static_cast<std::size_t>(f)],
               end = u.terms.begin() + u.offsets[static_cast<std::size_t>(f) + 1];
    const auto at = std::find(begin, end, chosen);
    if (at == end) continue;
    // The new unknown has the highest number: it goes to the end of the row.
    const auto w = u.weights.begin() + (at - u.terms.begin());
    std::rotate(at, at + 1, end);
    std::rotate(w, w + 1, u.weights.begin() + (end - u.terms.begin()));
    *(end - 1) = twin;
  }
  u.function.push_back(-1);
  for (std::size_t d = 0; d < 3; ++d) u.parameters.push_back(u.parameters[3 * static_cast<std::size_t>(chosen) + d]);
  u.mass_fraction.push_back(1);
  bool found = false;
  for (const std::string& problem : check(model)) found = found || problem.find("jumps") != std::string::npos;
  EXPECT_TRUE(found);
}

TEST_P(GapEnds, LinearFieldsAndRigidMotionsAreKept) {
  const TrimmedModel model = slit_block(GetParam(), 5);
  for (const LightTreatment& light : {LightTreatment{}, LightTreatment{LightFunctions::Linear, 0.01},
                                      LightTreatment{LightFunctions::DegreeP, 1e-6}}) {
    const SolutionSpace space(model, light);
    const auto points = space.node_points();
    const ElasticMaterial material = isotropic(210, 0.3, 7.85e-3);
    const auto K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
    Eigen::Matrix3d G;
    G << 1e-3, 2e-3, 0, 5e-4, -1e-3, 3e-4, 0, 7e-4, 2e-3;
    const auto energy = [&](const Eigen::Matrix3d& gradient) {
      Eigen::VectorXd u(space.num_unknowns()), Ku(space.num_unknowns());
      for (Eigen::Index n = 0; n < points.rows(); ++n)
        u.segment<3>(3 * n) = gradient * points.row(n).transpose() + Eigen::Vector3d(1, 2, 3) * 1e-3;
      K.multiply(u.data(), Ku.data());
      return 0.5 * u.dot(Ku);
    };
    const Eigen::Matrix3d strain = 0.5 * (G + G.transpose());
    const double mu = 210 / 2.6, lambda = 210 * 0.3 / (1.3 * 0.4), volume = model.quadrature.part_volume;
    const double exact = volume * (mu * strain.squaredNorm() + 0.5 * lambda * strain.trace() * strain.trace());
    EXPECT_NEAR(energy(G), exact, 1e-9 * exact);
    EXPECT_LT(std::abs(energy(0.5 * (G - G.transpose()))), 1e-12 * exact);
  }
}

class GapEndPolynomials : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degrees, GapEndPolynomials, testing::Values(2, 3)); // at 4 the dense system takes minutes

TEST_P(GapEndPolynomials, LieInTheSpace) {
  const int p = GetParam();
  const TrimmedModel model = slit_block(p, p == 2 ? 6 : 12);
  ASSERT_GT(count_cells(model).gap_end_cells, 0);
  const SolutionSpace space(model, {});
  const auto rows = static_cast<Eigen::Index>(model.points.weights.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, space.num_nodes()), b(rows, 4);
  SpanShapes shapes;
  Eigen::Index row = 0;
  for (std::int64_t c = 0; c < space.num_cells(); ++c) {
    const auto parameters = cell_parameters(model, c);
    evaluate(space, c, parameters, Shapes::Values, shapes);
    const auto nodes = space.nodes(c);
    for (Eigen::Index q = 0; q < shapes.values.rows(); ++q, ++row) {
      for (std::size_t i = 0; i < nodes.size(); ++i) A(row, nodes[i]) = shapes.values(q, static_cast<Eigen::Index>(i));
      const double* at = &parameters[3 * static_cast<std::size_t>(q)];
      const double x = at[0] / 10, y = at[1] / 10, z = at[2] / 10;
      b.row(row) << std::pow(x, p), std::pow(x + y - z, p), std::pow(x, p - 1) * y, std::pow(z, p) - x * y;
    }
  }
  const Eigen::MatrixXd rest = A * A.colPivHouseholderQr().solve(b) - b;
  EXPECT_LT(rest.cwiseAbs().maxCoeff(), 1e-9 * b.cwiseAbs().maxCoeff());
}

TEST_P(GapEnds, ShapeFunctionsAddUpToOneAndBernsteinMassesArePositive) {
  const TrimmedModel model = slit_block(GetParam(), 5);
  const SolutionSpace space(model, {});
  SpanShapes shapes;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(space.num_nodes());
  for (std::int64_t c = 0; c < space.num_cells(); ++c) {
    evaluate(space, c, cell_parameters(model, c), Shapes::Values, shapes);
    for (Eigen::Index q = 0; q < shapes.values.rows(); ++q) EXPECT_NEAR(shapes.values.row(q).sum(), 1, 1e-9);
    EXPECT_GT(shapes.values.minCoeff(), -1e-9); // every function of the space is positive
    const auto weights = cell_weights(model, c);
    for (std::size_t i = 0; i < space.nodes(c).size(); ++i)
      mass[space.nodes(c)[i]] += shapes.values.col(static_cast<Eigen::Index>(i))
                                     .dot(Eigen::Map<const Eigen::VectorXd>(weights.data(), shapes.values.rows()));
  }
  EXPECT_GT(mass.minCoeff(), -1e-12 * mass.maxCoeff());
  // The fractions in the file are those of the masses, to the error of the moments.
  for (Eigen::Index n = 0; n < mass.size(); ++n)
    EXPECT_LE(model.unknowns.mass_fraction[static_cast<std::size_t>(n)], 1);
}

} // namespace
} // namespace iga::solve
