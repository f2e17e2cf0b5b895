// Multigrid on the spline hierarchy: exact transfers, bounded convergence, the direct solver's answers.
#include "solver/multigrid/multigrid_solver.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/analysis/multigrid_modes.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>
#include <map>
#include <random>
#include <tbb/global_control.h>

namespace iga::solve {
namespace {

using namespace iga::test;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const ElasticMaterial steel = isotropic(210, 0.3, 7.8e-6);

enum class Part { Block, TwoBlocks, Slit };

TriangleMesh mesh_of(Part part) {
  const auto turned = [](const TriangleMesh& mesh) { return transformed(mesh, rotation(13, 9), {}); };
  switch (part) {
  case Part::Block:
    return turned(box({0, 0, 0}, {20, 20, 20}));
  case Part::TwoBlocks: // 0.01 apart
    return turned(join({box({0, 0, 0}, {20, 20, 14.37}), box({0, 0, 14.38}, {20, 20, 30})}));
  default: // a block with a slit of 0.05 from its edge to its middle
    return turned(prism({{0, 0}, {9, 0}, {9, 20}, {9.05, 20}, {9.05, 0}, {20, 0}, {20, 40}, {0, 40}},
                        {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 4, 5}, {3, 5, 6}}, 0, 10));
  }
}

TrimmedModel model_of(Part part, int degree, double span_size) {
  PartOptions options;
  options.degree = degree;
  options.span_size = span_size;
  options.shift = 0.37;
  return make_part(mesh_of(part), options);
}

VectorXd random_vector(Eigen::Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  return VectorXd::NullaryExpr(n, [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); });
}

using Case = std::tuple<Part, int>;
class Transfers : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Parts, Transfers,
                         testing::Combine(testing::Values(Part::Block, Part::TwoBlocks, Part::Slit),
                                          testing::Values(1, 2, 3)));

// Wherever a cell sees terms of a coarse function, they add up to that B-spline.
TEST_P(Transfers, FineTermsAddUpToCoarseFunctions) {
  const auto [part, degree] = GetParam();
  const TrimmedModel model = model_of(part, degree, 5);
  EXPECT_EQ(model.unknowns.empty(), part != Part::Slit || degree == 1);
  const SolutionSpace space(model, {LightFunctions::None});
  Transfer P;
  const SplineLevel coarse = SplineLevel(space).coarsen(P);
  ASSERT_EQ(P.num_fine(), space.num_nodes());
  std::vector<std::array<std::int32_t, 3>> function(static_cast<std::size_t>(P.num_coarse));
  for (std::int64_t u = 0; u < coarse.num_unknowns(); ++u)
    if (coarse.node_of(u) >= 0) function[static_cast<std::size_t>(coarse.node_of(u))] = coarse.function_of(u);
  const std::vector<double> parameter_of_span{0.1, 0.83, 0.4};
  SpanShapes shapes;
  double worst = 0;
  for (std::int64_t c = 0; c < space.num_cells(); ++c) {
    const Box3 span = model.grid.span_box(model.grid.span_index(model.cells.span[static_cast<std::size_t>(c)]));
    std::vector<double> u(3);
    for (std::size_t d = 0; d < 3; ++d) u[d] = span.lower[d] + parameter_of_span[d] * (span.upper[d] - span.lower[d]);
    evaluate(space, c, u, Shapes::Values, shapes);
    std::map<std::int32_t, double> sum;
    const auto nodes = space.nodes(c);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      for (auto t = P.offsets[static_cast<std::size_t>(nodes[k])];
           t < P.offsets[static_cast<std::size_t>(nodes[k]) + 1]; ++t)
        sum[P.nodes[static_cast<std::size_t>(t)]] +=
            P.weights[static_cast<std::size_t>(t)] * shapes.values(0, static_cast<Eigen::Index>(k));
    double one = 0;
    for (const auto& [node, value] : sum) {
      double expected = 1;
      for (int d = 0; d < 3; ++d) {
        const KnotVector& knots = coarse.knots(d);
        const auto at = static_cast<std::size_t>(d);
        const std::int64_t e = knots.find_span(u[at]);
        std::vector<double> N(static_cast<std::size_t>(degree) + 1);
        evaluate_basis(knots, e, u[at], N);
        const std::int64_t local = function[static_cast<std::size_t>(node)][at] - e;
        expected *= local >= 0 && local <= degree ? N[static_cast<std::size_t>(local)] : 0;
      }
      worst = std::max(worst, std::abs(value - expected));
      one += value;
    }
    worst = std::max(worst, std::abs(one - 1));
  }
  EXPECT_LT(worst, 1e-12);
}

// Light functions follow the others: what is left of the transfer still has all rigid motions and linear fields.
TEST_P(Transfers, KeepLinearFieldsDownToTheCoarsestLevel) {
  const auto [part, degree] = GetParam();
  const TrimmedModel model = model_of(part, degree, 4);
  const SolutionSpace space(model, usual());
  SplineLevel level(space);
  MatrixXd fine = space.node_points();
  fine.rowwise() -= fine.row(0).eval();
  for (int depth = 0; depth < 3; ++depth) {
    Transfer P;
    const SplineLevel coarse = level.coarsen(P);
    MatrixXd points(P.num_coarse, 3); // along the grid's axes, then in space
    for (std::int64_t u = 0; u < coarse.num_unknowns(); ++u)
      if (const std::int32_t node = coarse.node_of(u); node >= 0) {
        Point3 greville;
        for (std::size_t d = 0; d < 3; ++d)
          greville[d] = coarse.knots(static_cast<int>(d)).greville(coarse.function_of(u)[d]);
        const Point3 x = model.grid.to_position(greville);
        points.row(node) << x[0], x[1], x[2];
      }
    MatrixXd carried = MatrixXd::Zero(P.num_fine(), 3);
    for (std::int64_t i = 0; i < P.num_fine(); ++i)
      for (auto t = P.offsets[static_cast<std::size_t>(i)]; t < P.offsets[static_cast<std::size_t>(i) + 1]; ++t)
        carried.row(i) += P.weights[static_cast<std::size_t>(t)] * points.row(P.nodes[static_cast<std::size_t>(t)]);
    carried.rowwise() -= carried.row(0).eval();
    EXPECT_LT((carried - fine).cwiseAbs().maxCoeff(), 1e-10) << "level " << depth;
    fine = points;
    fine.rowwise() -= fine.row(0).eval();
    level = coarse;
  }
}

TEST(Transfers, KeepBodiesApartOnEveryLevel) {
  const TrimmedModel model = model_of(Part::TwoBlocks, 2, 3);
  const SolutionSpace space(model, usual());
  std::vector<std::int32_t> body = separate_bodies(space).of_node;
  SplineLevel level(space);
  for (int depth = 0; depth < 4; ++depth) {
    Transfer P;
    level = level.coarsen(P);
    std::vector<std::int32_t> coarse(static_cast<std::size_t>(P.num_coarse), -1);
    for (std::size_t i = 0; i < body.size(); ++i)
      for (auto t = P.offsets[i]; t < P.offsets[i + 1]; ++t) {
        auto& own = coarse[static_cast<std::size_t>(P.nodes[static_cast<std::size_t>(t)])];
        EXPECT_TRUE(own < 0 || own == body[i]) << "level " << depth;
        own = body[i];
      }
    body = coarse;
  }
}

struct Problem {
  Problem(TrimmedModel made, bool light = true)
      : model(std::move(made)), space(model, light ? usual() : LightTreatment{LightFunctions::None}),
        system(space, steel), connectivity(system.connectivity({})), K(assemble_stiffness(system, connectivity)),
        M(make_mass(MassType::Consistent, system, connectivity)) {}
  ShiftedStiffness shifted() const { return {&K, &M, -1e-2 * lambda_scale(system)}; }

  TrimmedModel model;
  SolutionSpace space;
  BodySystem system;
  std::shared_ptr<const Connectivity> connectivity;
  StiffnessMatrix K;
  MassOperator M;
};

TEST(BlockRows, CoarseMatrixIsTheGalerkinProduct) {
  const Problem problem(model_of(Part::Slit, 2, 5));
  const ShiftedStiffness A = problem.shifted();
  const SplineHierarchy spaces = spline_hierarchy(problem.system, 100);
  const Transfer &P = spaces.transfers[0], transpose = transposed(P);
  MatrixXd full(3 * P.num_fine(), 3 * P.num_coarse);
  full.setZero();
  for (std::int64_t i = 0; i < P.num_fine(); ++i)
    for (auto t = P.offsets[static_cast<std::size_t>(i)]; t < P.offsets[static_cast<std::size_t>(i) + 1]; ++t)
      for (int d = 0; d < 3; ++d)
        full(3 * i + d, 3 * P.nodes[static_cast<std::size_t>(t)] + d) = P.weights[static_cast<std::size_t>(t)];
  MatrixXd product(full.rows(), full.cols());
  for (Eigen::Index c = 0; c < full.cols(); ++c)
    product.col(c) = problem.K * VectorXd(full.col(c)) - A.shift * (problem.M * VectorXd(full.col(c)));
  const MatrixXd expected = full.transpose() * product;
  const auto pattern = coarse_pattern(*row_pattern(problem.K.pattern()), P, transpose);
  const BlockRows<double, 9> coarse = coarse_stiffness(A, P, transpose, pattern);
  MatrixXd found = MatrixXd::Zero(expected.rows(), expected.cols());
  for (std::int64_t i = 0; i < pattern->size(); ++i)
    for (auto k = pattern->offsets[static_cast<std::size_t>(i)]; k < pattern->offsets[static_cast<std::size_t>(i) + 1];
         ++k)
      for (int e = 0; e < 9; ++e)
        found(3 * i + e / 3, 3 * pattern->columns[static_cast<std::size_t>(k)] + e % 3) =
            coarse.values.data()[9 * k + e];
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
}

class Cycle : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Parts, Cycle,
                         testing::Values(Case{Part::Block, 1}, Case{Part::Block, 2}, Case{Part::TwoBlocks, 1},
                                         Case{Part::TwoBlocks, 2}, Case{Part::Slit, 1}));

// The spectrum of T A, T one cycle: symmetric in A, no eigenvalue above one, none near zero. Small levels, so that
// there are several of them.
TEST_P(Cycle, IsSymmetricAndItsSpectrumIsBounded) {
  const auto [part, degree] = GetParam();
  const Problem problem(model_of(part, degree, 7));
  const ShiftedStiffness A = problem.shifted();
  const Multigrid multigrid(A, problem.system, {.few_nodes = 40});
  ASSERT_GE(multigrid.level_nodes().size(), 2U);
  const std::int64_t n = multigrid.size();
  MatrixXd T(n, n);
  const MatrixXd unit = MatrixXd::Identity(n, n);
  multigrid.apply(unit.data(), T.data(), static_cast<int>(n));
  VectorXd root = problem.K.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = root.cwiseInverse().asDiagonal() * T * root.cwiseInverse().asDiagonal();
  EXPECT_LT((scaled - scaled.transpose()).cwiseAbs().maxCoeff(), 1e-3 * scaled.cwiseAbs().maxCoeff());
  const VectorXd one = random_vector(n, 1);
  VectorXd z(n);
  multigrid.apply(one.data(), z.data(), 1); // another width
  EXPECT_LT((z - T * one).norm(), 1e-3 * z.norm());

  MatrixXd full(n, n);
  for (Eigen::Index c = 0; c < n; ++c)
    full.col(c) = problem.K * VectorXd(unit.col(c)) - A.shift * (problem.M * VectorXd(unit.col(c)));
  const SymmetricEigen spectrum = symmetric_eigen(full * (0.5 * (T + T.transpose())) * full, full);
  EXPECT_LT(spectrum.values.maxCoeff(), 1.01);
  EXPECT_GT(spectrum.values.minCoeff(), degree == 1 ? 0.1 : 0.04);
}

TEST(Cycle, HasTheSameBitsForAnyNumberOfThreads) {
  const Problem problem(model_of(Part::Slit, 2, 3));
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Multigrid multigrid(problem.shifted(), problem.system, {.few_nodes = 100});
    const VectorXd r = random_vector(5 * multigrid.size(), 2);
    VectorXd z(r.size());
    multigrid.apply(r.data(), z.data(), 5);
    return z;
  };
  EXPECT_EQ(run(1), run(2));
}

class Steps : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degrees, Steps, testing::Values(1, 2));

// Smaller spans, hardly more steps.
TEST_P(Steps, HardlyDependOnTheSpans) {
  std::array<int, 2> steps;
  for (std::size_t k = 0; k < 2; ++k) {
    const Problem problem(model_of(Part::Slit, GetParam(), k == 0 ? 6 : 4));
    const MultigridSolver solver(problem.shifted(), problem.system, nullptr, {.few_nodes = 150});
    const VectorXd b = random_vector(solver.size(), 3), x = solver.solve(b);
    const VectorXd r = b - problem.K * x + problem.shifted().shift * (problem.M * x);
    EXPECT_LT(r.norm(), 1.01 * MultigridSolver::tolerance * b.norm());
    steps[k] = solver.steps();
  }
  EXPECT_LT(steps[1], steps[0] + 12);
  constexpr std::array most{20, 45};
  EXPECT_LT(steps[1], most[static_cast<std::size_t>(GetParam() - 1)]);
}

RunSettings bent(SupportMethod method, SolverKind solver) {
  Support foot;
  foot.name = "foot";
  foot.region.box = Box3{{-100, -100, -100}, {100, 3, 100}};
  foot.method = method;
  RunSettings run = run_with({foot});
  run.solver = solver;
  return run;
}

StaticSettings pulled() {
  Load pull;
  pull.name = "pull";
  pull.kind = LoadKind::Acceleration;
  pull.vector = {1, 2, 3};
  StaticSettings statics;
  statics.loads.push_back(pull);
  return statics;
}

TEST(MultigridStatics, GiveTheDirectSolversAnswer) {
  const TrimmedModel model = model_of(Part::Slit, 2, 4);
  const SolutionSpace space(model, usual());
  for (const SupportMethod method : {SupportMethod::Nitsche, SupportMethod::Penalty}) {
    const StaticSolution direct = run_static(bent(method, SolverKind::Direct), pulled(), space),
                         iterative = run_static(bent(method, SolverKind::Multigrid), pulled(), space);
    EXPECT_FALSE(direct.solver.multigrid);
    EXPECT_TRUE(iterative.solver.multigrid);
    EXPECT_GT(iterative.solver.steps, 0);
    EXPECT_LT(iterative.residual, 1e-11);
    EXPECT_LT((direct.unknowns - iterative.unknowns).norm(), 1e-8 * direct.unknowns.norm());
    EXPECT_NEAR(iterative.result.strain_energy, direct.result.strain_energy, 1e-10 * direct.result.strain_energy);
  }
}

TEST(MultigridStatics, SayWhatTheyCannotTreat) {
  const TrimmedModel model = model_of(Part::Slit, 2, 5);
  const SolutionSpace space(model, usual());
  EXPECT_THROW(run_static(bent(SupportMethod::Lagrange, SolverKind::Multigrid), pulled(), space), InputError);
  const StaticSolution small = run_static(bent(SupportMethod::Nitsche, SolverKind::Auto), pulled(), space);
  EXPECT_FALSE(small.solver.multigrid);
  EXPECT_EQ(small.solver.reason, "fewer than " + std::to_string(multigrid_from) + " unknowns");
  EXPECT_THROW(solver_kind("amg"), InputError);
}

// Symmetric parts have multiplets: none of their modes is lost.
TEST(MultigridModes, AreTheDirectSolvers) {
  for (const Part part : {Part::Block, Part::TwoBlocks}) {
    const TrimmedModel model = model_of(part, 2, 4);
    for (const MassType mass : {MassType::Consistent, MassType::Lumped}) {
      RunSettings run = run_with({});
      run.mass = mass;
      run.light = default_light_treatment(mass);
      run.solver = SolverKind::Direct;
      EigenSettings settings;
      settings.modes = 8;
      const EigenOutcome direct = analyse_modes(run, settings, model);
      run.solver = SolverKind::Multigrid;
      const EigenOutcome iterative = analyse_modes(run, settings, model);
      EXPECT_TRUE(iterative.solver.multigrid);
      EXPECT_FALSE(iterative.modes.sturm);
      ASSERT_EQ(iterative.modes.rigid, direct.modes.rigid);
      const Eigen::Index rigid = direct.modes.rigid;
      for (Eigen::Index k = rigid; k < rigid + 8; ++k) {
        EXPECT_NEAR(iterative.modes.lambda[k], direct.modes.lambda[k], 1e-9 * direct.modes.lambda[k]);
        EXPECT_LT(iterative.modes.residual[k], multigrid_residual * 1.01);
      }
    }
  }
}

TEST(MultigridModes, OfAHeldPart) {
  const TrimmedModel model = model_of(Part::Slit, 2, 5);
  EigenSettings settings;
  settings.modes = 4;
  RunSettings run = bent(SupportMethod::Nitsche, SolverKind::Direct);
  run.light = usual();
  const EigenOutcome direct = analyse_modes(run, settings, model);
  run.solver = SolverKind::Multigrid;
  const EigenOutcome iterative = analyse_modes(run, settings, model);
  EXPECT_EQ(iterative.modes.rigid, 0);
  EXPECT_LT((iterative.modes.lambda - direct.modes.lambda).cwiseAbs().maxCoeff(), 1e-9 * direct.modes.lambda[0]);
  settings.modes_below = 100;
  EXPECT_THROW(analyse_modes(run, settings, model), InputError);
}

} // namespace
} // namespace iga::solve
