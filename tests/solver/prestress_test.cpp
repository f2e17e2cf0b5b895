// Geometric stiffness against closed forms and finite differences; buckling factors against full matrices; modes of
// loaded parts.
#include "format/model/errors.hpp"
#include "solver/analysis/bound_system.hpp"
#include "solver/analysis/buckling_analysis.hpp"
#include "solver/mechanics/geometric_stiffness.hpp"
#include "tests/solver/eigen_support.hpp"
#include "tests/solver/static_support.hpp"

#include <Eigen/Eigenvalues>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>

namespace iga {
namespace {

using namespace solve;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const ElasticMaterial steel = isotropic(210, 0.3, 7.8e-6);

TrimmedModel cut_box() {
  return make_box_model(test::box_in_grid({4, 2, 1.5}, {4, 2, 2}, 2, 0.3));
}

// Nine numbers without pattern.
Matrix3d some_matrix(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix3d A;
  for (Index k = 0; k < 9; ++k) A.data()[k] = uniform(random);
  return A;
}
Matrix3d some_stress(unsigned seed) {
  const Matrix3d A = some_matrix(seed);
  return A + A.transpose();
}

// σ(x) = a + x₀ b at the quadrature points.
std::vector<double> linear_stress(const TrimmedModel& model, const Matrix3d& a, const Matrix3d& b) {
  std::vector<double> stress;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* u = &model.points.parameters[3 * q];
    const Matrix3d s = a + model.grid.to_position({u[0], u[1], u[2]})[0] * b;
    stress.insert(stress.end(), {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)});
  }
  return stress;
}

MassMatrix geometric(const SolutionSpace& space, const std::vector<double>& stress) {
  const std::span<const double> values(stress);
  return assemble_geometric_stiffness(BodySystem(space, steel), std::make_shared<const Connectivity>(space),
                                      std::span(&values, 1));
}

// Coefficients of u(x) = G x.
VectorXd linear_motion(const SolutionSpace& space, const Matrix3d& G) {
  VectorXd u(space.num_unknowns());
  const auto points = space.node_points();
  for (Index i = 0; i < points.rows(); ++i) u.segment<3>(3 * i) = G * points.row(i).transpose();
  return u;
}

struct Moments {
  double volume = 0, first = 0; // ∫ dV, ∫ x₀ dV
};
Moments moments(const TrimmedModel& model) {
  Moments m;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* u = &model.points.parameters[3 * q];
    m.volume += model.points.weights[q];
    m.first += model.points.weights[q] * model.grid.to_position({u[0], u[1], u[2]})[0];
  }
  return m;
}

TEST(GeometricStiffness, OfALinearFieldIsTheWorkOfTheStressOnItsSquares) {
  for (const LightFunctions remedy : {LightFunctions::None, LightFunctions::DegreeP}) {
    const TrimmedModel model = cut_box();
    const SolutionSpace space(model, {remedy, 0.2});
    EXPECT_EQ(space.is_extended(), remedy == LightFunctions::DegreeP);
    const Matrix3d a = some_stress(1), b = some_stress(2), G = some_matrix(3);
    const MassMatrix K = geometric(space, linear_stress(model, a, b));
    const VectorXd u = linear_motion(space, G);
    const Moments m = moments(model);
    const double exact = (G * (m.volume * a + m.first * b) * G.transpose()).trace();
    EXPECT_NEAR(u.dot(K * u), exact, 1e-11 * std::abs(exact));
  }
}

TEST(GeometricStiffness, LeavesTranslationsAlone) {
  const TrimmedModel model = cut_box();
  const SolutionSpace space(model, {});
  const MassMatrix K = geometric(space, linear_stress(model, some_stress(1), some_stress(2)));
  const VectorXd ones = VectorXd::Ones(space.num_unknowns());
  EXPECT_LT((K * ones).norm(), 1e-12 * K.diagonal().norm());
}

TEST(GeometricStiffness, HasTheSameBitsForAnyNumberOfThreads) {
  const TrimmedModel model = cut_box();
  const SolutionSpace space(model, {});
  const std::vector<double> stress = linear_stress(model, some_stress(1), some_stress(2));
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const MassMatrix K = geometric(space, stress);
    return std::vector<double>(K.values().begin(), K.values().end());
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

// The internal force of a St. Venant–Kirchhoff material that is under the stress σ at rest: ∫ F (σ + C : E) ∇N dV.
VectorXd internal_force(const SolutionSpace& space, const std::vector<double>& stress, const VectorXd& u) {
  const TrimmedModel& model = space.model();
  VectorXd f = VectorXd::Zero(space.num_unknowns());
  SpanShapes shapes;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const auto nodes = space.nodes(a);
    const auto weights = cell_weights(model, a);
    evaluate(space, a, cell_parameters(model, a), Shapes::Gradients, shapes);
    for (std::size_t q = 0; q < weights.size(); ++q) {
      Matrix3d F = Matrix3d::Identity();
      const auto gradient = [&](std::size_t i) {
        return Eigen::Vector3d(shapes.gradients.row(static_cast<Index>(q)).segment<3>(3 * static_cast<Index>(i)));
      };
      for (std::size_t i = 0; i < nodes.size(); ++i) F += u.segment<3>(3 * nodes[i]) * gradient(i).transpose();
      const Matrix3d E = 0.5 * (F.transpose() * F - Matrix3d::Identity());
      Voigt strain;
      strain << E(0, 0), E(1, 1), E(2, 2), 2 * E(0, 1), 2 * E(1, 2), 2 * E(2, 0);
      const auto point = static_cast<std::size_t>(model.points.offsets[static_cast<std::size_t>(a)]) + q;
      const Voigt s = steel.C * strain + Eigen::Map<const Voigt>(&stress[6 * point]);
      Matrix3d S;
      S << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
      for (std::size_t i = 0; i < nodes.size(); ++i) f.segment<3>(3 * nodes[i]) += weights[q] * F * S * gradient(i);
    }
  }
  return f;
}

TEST(GeometricStiffness, IsWhatStressAddsToTheDerivativeOfInternalForces) {
  const TrimmedModel model = cut_box();
  const SolutionSpace space(model, {});
  const std::vector<double> stress = linear_stress(model, 20 * some_stress(1), 10 * some_stress(2));
  const auto connectivity = std::make_shared<const Connectivity>(space);
  StiffnessMatrix K = assemble_stiffness(space, connectivity, steel);
  add_blocks(geometric(space, stress), Matrix3d::Identity(), K, 0, space.num_nodes());
  std::srand(5);
  const VectorXd v = VectorXd::Random(space.num_unknowns());
  constexpr double step = 1e-4; // the error of central differences is of its square
  const VectorXd derivative =
      (internal_force(space, stress, step * v) - internal_force(space, stress, -step * v)) / (2 * step);
  EXPECT_LT((derivative - K * v).norm(), 1e-6 * (K * v).norm());
}

TEST(AddBlocks, GivesTheProductOfBothMatrices) {
  const TrimmedModel model = cut_box();
  const test::System s(cut_box(), steel);
  StiffnessMatrix K(s.connectivity);
  const Matrix3d P = some_stress(4);
  add_blocks(*s.M.matrix(), P, K, 0, s.space.num_nodes());
  std::srand(6);
  const VectorXd x = VectorXd::Random(K.size());
  VectorXd turned(x.size());
  for (Index i = 0; i < x.size() / 3; ++i) turned.segment<3>(3 * i) = P * x.segment<3>(3 * i);
  const VectorXd exact = s.M * turned;
  EXPECT_LT((K * x - exact).norm(), 1e-13 * exact.norm());
}

// A slender box, one end clamped, and its load stiffness under an uneven stress.
struct Column {
  explicit Column(SupportMethod method)
      : model(make_box_model(test::box_in_grid({6, 1, 1.2}, {6, 1, 1}, 2))), space(model, test::usual()),
        system(space, steel) {
    Support clamp;
    clamp.name = "clamp";
    clamp.method = method;
    clamp.region.plane = RegionChoice::Plane{{0, 0, 0}, {1, 0, 0}, 1e-6};
    run = test::run_with({clamp});
    Stopwatch watch(timings);
    bound = bind_system(system, run, watch);
    const std::vector<double> stress = linear_stress(model, -some_stress(1) - 3 * Matrix3d::Identity(), some_stress(2));
    const std::span<const double> values(stress);
    L = StiffnessMatrix(bound.K.shared_connectivity());
    add_blocks(assemble_geometric_stiffness(system, bound.K.shared_connectivity(), std::span(&values, 1)),
               Matrix3d::Identity(), L, 0, system.num_nodes());
  }
  BucklingProblem problem() const {
    BucklingProblem p;
    p.stiffness = &bound.K;
    p.load_stiffness = &L;
    p.constraints = bound.constraints.rows() > 0 ? &bound.constraints : nullptr;
    return p;
  }
  // All θ = -1/λ by full matrices, in the null space of the constraints.
  VectorXd inverse_factors() const {
    const MatrixXd K = test::dense(bound.K, bound.K.size()), G = test::dense(L, L.size());
    MatrixXd Z = MatrixXd::Identity(K.rows(), K.rows());
    if (bound.constraints.rows() > 0) {
      const Eigen::FullPivLU<MatrixXd> lu{MatrixXd(bound.constraints)};
      Z = lu.kernel();
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(-Z.transpose() * G * Z, Z.transpose() * K * Z,
                                                                   Eigen::EigenvaluesOnly);
    return eigen.eigenvalues();
  }

  TrimmedModel model;
  SolutionSpace space;
  BodySystem system;
  RunSettings run;
  std::vector<std::pair<std::string, double>> timings;
  BoundSystem bound;
  StiffnessMatrix L;
};

TEST(BucklingSolver, FindsTheFactorsOfFullMatricesOfBothSigns) {
  for (const SupportMethod method : {SupportMethod::Nitsche, SupportMethod::Lagrange}) {
    const Column column(method);
    const VectorXd theta = column.inverse_factors();
    const BucklingProblem problem = column.problem();
    BucklingSolver solver(problem);
    const BucklingModes up = solver.lowest(5, LoadSign::Positive, true),
                        down = solver.lowest(5, LoadSign::Negative, true);
    ASSERT_EQ(up.factor.size(), 5);
    ASSERT_EQ(down.factor.size(), 5);
    for (Index k = 0; k < 5; ++k) {
      EXPECT_NEAR(up.factor[k] * theta[theta.size() - 1 - k], 1, 1e-9);
      EXPECT_NEAR(down.factor[k] * theta[k], 1, 1e-9);
    }
    for (const BucklingModes* modes : {&up, &down}) {
      ASSERT_TRUE(modes->count);
      EXPECT_EQ(modes->count->expected, modes->count->found);
      EXPECT_GE(modes->count->found, 5);
      EXPECT_LE(modes->residual.maxCoeff(), residual_limit);
    }
  }
}

TEST(BucklingSolver, SaysThatTensionDoesNotBuckle) {
  const Column column(SupportMethod::Nitsche);
  StiffnessMatrix tension(column.bound.K.shared_connectivity());
  const std::vector<double> stress = linear_stress(column.model, Matrix3d::Identity(), Matrix3d::Zero());
  const std::span<const double> values(stress);
  add_blocks(assemble_geometric_stiffness(column.system, column.bound.K.shared_connectivity(), std::span(&values, 1)),
             Matrix3d::Identity(), tension, 0, column.system.num_nodes());
  BucklingProblem problem = column.problem();
  problem.load_stiffness = &tension;
  problem.limit = 50;
  const BucklingModes modes = BucklingSolver(problem).lowest(3, LoadSign::Positive, true);
  EXPECT_EQ(modes.factor.size(), 0);
  ASSERT_TRUE(modes.count);
  EXPECT_EQ(modes.count->expected, 0);
  EXPECT_DOUBLE_EQ(modes.count->at, 50);
}

// The column pressed along its axis by its end.
RunSettings pressed(const Column& column, double force) {
  RunSettings run = column.run;
  Load load;
  load.name = "press";
  load.kind = LoadKind::TotalForce;
  load.vector = {-force, 0, 0};
  load.region.plane = RegionChoice::Plane{{6, 0, 0}, {1, 0, 0}, 1e-6};
  run.statics.loads = {load};
  run.analysis = Analysis::Buckling;
  run.light = test::usual();
  return run;
}

TEST(Buckling, OfLoadsThatAreTwiceAsLargeHasHalfTheFactor) {
  const Column column(SupportMethod::Nitsche);
  BucklingSettings settings;
  settings.factors = 2;
  const BucklingOutcome one = analyse_buckling(pressed(column, 0.01), settings, column.model),
                        two = analyse_buckling(pressed(column, 0.02), settings, column.model);
  EXPECT_NEAR(one.positive.factor[0], 2 * two.positive.factor[0], 1e-8 * one.positive.factor[0]);
  // Euler's load, clamped and free, with the shear of a stocky column: within what one span across it gives.
  const double I = 1.2 / 12, euler = std::numbers::pi * std::numbers::pi * 210 * I / (4 * 36);
  const double engesser = euler / (1 + euler / (5.0 / 6 * 210 / 2.6 * 1.2));
  EXPECT_NEAR(0.01 * one.positive.factor[0] / engesser, 1, 0.05);
}

TEST(Buckling, ConstantLoadsTakeTheirShareOfTheFactor) {
  const Column column(SupportMethod::Nitsche);
  BucklingSettings settings;
  settings.factors = 1;
  RunSettings run = pressed(column, 0.01);
  const double alone = analyse_buckling(run, settings, column.model).positive.factor[0];
  run.statics.loads.push_back(run.statics.loads[0]);
  run.statics.loads[1].name = "weight";
  run.statics.loads[1].vector[0] *= 0.4 * alone;
  settings.constant = {"weight"};
  EXPECT_NEAR(analyse_buckling(run, settings, column.model).positive.factor[0], 0.6 * alone, 1e-7 * alone);
  run.statics.loads[1].vector[0] *= 1.1 / 0.4;
  EXPECT_THROW((void)analyse_buckling(run, settings, column.model), InputError);
}

TEST(PrestressedModes, LoseTheirFrequencyAtTheBucklingLoad) {
  const Column column(SupportMethod::Nitsche);
  BucklingSettings buckling;
  buckling.factors = 1;
  const double critical = 0.01 * analyse_buckling(pressed(column, 0.01), buckling, column.model).positive.factor[0];
  EigenSettings settings;
  settings.modes = 2;
  settings.prestress = true;
  const auto lambda = [&](double force) {
    RunSettings run = pressed(column, force);
    run.analysis = Analysis::Eigen;
    return analyse_modes(run, settings, column.model).modes.lambda[0];
  };
  const double free = lambda(1e-9 * critical), half = lambda(0.5 * critical), pulled = lambda(-critical);
  // omega² of the load is concave, 0 at the buckling load and 1 at rest: it lies above the straight line through both
  // between them, below it outside; the shape changes little.
  EXPECT_GT(half / free, 0.5);
  EXPECT_LT(half / free, 0.55);
  EXPECT_LT(pulled / free, 2);
  EXPECT_GT(pulled / free, 1.7);
  EXPECT_LT(lambda(0.9999 * critical), 2e-4 * free);
  try {
    (void)lambda(1.25 * critical);
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("buckles at 0.8 times"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)lambda(50 * critical), InputError);
}

TEST(PrestressedModes, NeedLoads) {
  const Column column(SupportMethod::Nitsche);
  EigenSettings settings;
  settings.prestress = true;
  EXPECT_THROW((void)analyse_modes(column.run, settings, column.model), InputError);
}

} // namespace
} // namespace iga
