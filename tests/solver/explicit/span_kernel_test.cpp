// Internal forces of the explicit kernel against the assembled stiffness, closed forms and themselves.
#include "solver/explicit/kernel/internal_forces.hpp"

#include "solver/mechanics/assemble.hpp"
#include "solver/nonlinear/finite_body.hpp"
#include "tests/support/synthetic_model.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;
using Eigen::Matrix3d;
using Eigen::VectorXd;

namespace {

// Interior spans in several blocks, trimmed ones on all sides.
test::BoxCase a_box(std::array<int, 3> p, const Rotation& R = identity_rotation) {
  return {{0, 0, 0}, {8, 4.4, 6}, {20, 11, 12}, p, R, {1.5, 1.3, 2.0}, {6.7, 3.5, 4.3}};
}

VectorXd some_vector(Eigen::Index n, double size) {
  VectorXd u(n);
  for (Eigen::Index k = 0; k < n; ++k) u[k] = size * std::sin(1.0 + 3.7 * static_cast<double>(k));
  return u;
}

// Eᵀ f of plain functions.
VectorXd gather(const SolutionSpace& space, const VectorXd& f) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  VectorXd nodes(space.num_unknowns());
  Eigen::Map<Rows>(nodes.data(), space.num_nodes(), 3).noalias() =
      space.extension().transpose() * Eigen::Map<const Rows>(f.data(), f.size() / 3, 3);
  return nodes;
}

VectorXd linear_field(const SolutionSpace& space, const Matrix3d& G, const Eigen::Vector3d& c) {
  VectorXd u(space.num_unknowns());
  const auto points = space.node_points();
  for (Eigen::Index n = 0; n < points.rows(); ++n) u.segment<3>(3 * n) = G * points.row(n).transpose() + c;
  return u;
}

constexpr double lambda = 1.5, mu = 0.8, density = 2;
const double young = mu * (3 * lambda + 2 * mu) / (lambda + mu), poisson = lambda / (2 * (lambda + mu));

Matrix3d matrix(const Rotation& R) {
  Matrix3d Q;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) Q(a, b) = R[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  return Q;
}

VectorXd forces_of(InternalForces& kernel, const VectorXd& u) {
  VectorXd f = VectorXd::Constant(u.size(), 1e9); // evaluate overwrites it
  kernel.evaluate(u.data(), 0, f.data());
  return f;
}

class SpanKernels : public ::testing::TestWithParam<std::array<int, 3>> {};

} // namespace

TEST_P(SpanKernels, SmallDisplacementsGiveTheForcesOfTheStiffness) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam(), test::some_rotation(0.7)));
  const ElasticMaterial material = isotropic(young, poisson, density);
  for (const LightFunctions remedy : {LightFunctions::None, LightFunctions::Linear}) {
    const SolutionSpace space(model, {remedy, 0.05});
    const auto K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
    const auto kernel = make_internal_forces(space, LinearElastic(isotropic(young, poisson, density)));
    const VectorXd u = some_vector(space.num_unknowns(), 1), expected = K * u;
    const VectorXd f = gather(space, forces_of(*kernel, space.expand(u)));
    EXPECT_LT((f - expected).norm(), 1e-13 * expected.norm());
    EXPECT_EQ(kernel->plan().num_points, static_cast<std::int64_t>(model.points.weights.size()));
    EXPECT_GT(kernel->plan().num_tensor_points, 0);
  }
}

// ∫ P ∂N_i/∂X dV = ∮ N_i P n dA for a constant P, function by function.
TEST_P(SpanKernels, ConstantStressIsHeldByTheTractionOnTheSurface) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam(), test::some_rotation(0.7)));
  const Matrix3d G = (Matrix3d() << 0.1, -0.2, 0.3, 0.04, 0.15, -0.06, 0.07, 0.08, 0.09).finished();
  const Matrix3d F = Matrix3d::Identity() + G, inverse = F.inverse().transpose();
  const Matrix3d P = mu * (F - inverse) + lambda * std::log(F.determinant()) * inverse;
  for (const LightFunctions remedy : {LightFunctions::None, LightFunctions::Linear}) {
    const SolutionSpace space(model, {remedy, 0.05});
    const auto kernel = make_internal_forces(space, neo_hookean(young, poisson, density));
    const VectorXd f =
        gather(space, forces_of(*kernel, space.expand(linear_field(space, G, Eigen::Vector3d(1, 2, 3)))));
    VectorXd expected = VectorXd::Zero(f.size());
    SpanShapes shapes;
    const SurfacePoints& surface = model.surface.quadrature;
    for (std::int64_t a = 0; a < space.num_cells(); ++a) {
      evaluate(space, a, surface_parameters(model, a), Shapes::Values, shapes);
      const auto first = surface.offsets[static_cast<std::size_t>(a)];
      for (Eigen::Index q = 0; q < shapes.values.rows(); ++q) {
        const auto k = static_cast<std::size_t>(first + q);
        const Eigen::Vector3d t = surface.weights[k] * P * Eigen::Map<const Eigen::Vector3d>(&surface.normals[3 * k]);
        for (std::size_t i = 0; i < space.nodes(a).size(); ++i)
          expected.segment<3>(3 * space.nodes(a)[i]) += shapes.values(q, static_cast<Eigen::Index>(i)) * t;
      }
    }
    EXPECT_LT((f - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST_P(SpanKernels, FiniteRigidMotionsGiveNoForce) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam(), test::some_rotation(0.7)));
  const Matrix3d Q = matrix(test::some_rotation(0.52));
  for (const LightFunctions remedy : {LightFunctions::None, LightFunctions::Linear}) {
    const SolutionSpace space(model, {remedy, 0.05});
    const auto kernel = make_internal_forces(space, neo_hookean(young, poisson, density));
    const VectorXd u = linear_field(space, Q - Matrix3d::Identity(), Eigen::Vector3d(10, -5, 2));
    EXPECT_LT(forces_of(*kernel, space.expand(u)).lpNorm<Eigen::Infinity>(), 1e-13);
  }
}

// The same part in a turned grid, under the turned displacements, gives the turned forces: F, not the frame, counts.
TEST_P(SpanKernels, ForcesTurnWithTheGrid) {
  const Rotation R = test::some_rotation(0.9);
  const TrimmedModel straight = test::make_box_model(a_box(GetParam())),
                     turned = test::make_box_model(a_box(GetParam(), R));
  const SolutionSpace space(straight, {}), turned_space(turned, {});
  VectorXd u = some_vector(space.num_unknowns(), 0.02), v = u;
  for (Eigen::Index n = 0; n < space.num_nodes(); ++n) v.segment<3>(3 * n) = matrix(R) * u.segment<3>(3 * n);
  VectorXd f = forces_of(*make_internal_forces(space, neo_hookean(young, poisson, density)), u);
  const VectorXd g = forces_of(*make_internal_forces(turned_space, neo_hookean(young, poisson, density)), v);
  for (Eigen::Index n = 0; n < space.num_nodes(); ++n) f.segment<3>(3 * n) = (matrix(R) * f.segment<3>(3 * n)).eval();
  EXPECT_LT((f - g).norm(), 1e-12 * g.norm());
}

TEST_P(SpanKernels, ResultantAndMomentOfInternalForcesVanish) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam()));
  const SolutionSpace space(model, {LightFunctions::Linear, 0.05});
  const auto kernel = make_internal_forces(space, neo_hookean(young, poisson, density));
  const VectorXd u = some_vector(space.num_unknowns(), 0.02);
  const VectorXd f = gather(space, forces_of(*kernel, space.expand(u)));
  const auto points = space.node_points();
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = force;
  double scale = 0;
  for (Eigen::Index n = 0; n < space.num_nodes(); ++n) {
    const Eigen::Vector3d x = points.row(n).transpose() + u.segment<3>(3 * n), part = f.segment<3>(3 * n);
    force += part;
    moment += x.cross(part);
    scale += part.norm();
  }
  EXPECT_LT(force.norm(), 1e-14 * scale);
  EXPECT_LT(moment.norm(), 1e-13 * scale);
}

TEST_P(SpanKernels, AnyNumberOfThreadsGivesTheSameBits) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam()));
  const SolutionSpace space(model, {});
  const VectorXd u = some_vector(space.num_unknowns(), 0.02);
  std::vector<VectorXd> results;
  std::vector<ForceReport> reports;
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const auto kernel = make_internal_forces(space, neo_hookean(young, poisson, density));
    VectorXd f(u.size());
    reports.push_back(kernel->evaluate(u.data(), 0, f.data()));
    results.push_back(f);
  }
  for (std::size_t k = 1; k < results.size(); ++k) {
    EXPECT_TRUE((results[k].array() == results[0].array()).all());
    EXPECT_EQ(reports[k].step_factor, reports[0].step_factor);
    EXPECT_EQ(reports[k].step_span, reports[0].step_span);
    EXPECT_EQ(reports[k].min_J, reports[0].min_J);
  }
}

// Rules over runs of spans: each interior span owns 0 … 3 points per direction, at places that depend on its position;
// fitted rules: trimmed spans own any number of points anywhere.
TEST_P(SpanKernels, SpansMayOwnAnyTensorProductOfPoints) {
  TrimmedModel model = test::make_box_model(a_box(GetParam()));
  IntegrationPoints points;
  points.offsets = {0};
  for (std::size_t a = 0; a < model.cells.span.size(); ++a) {
    const auto parameters = cell_parameters(model, static_cast<std::int64_t>(a));
    const auto weights = cell_weights(model, static_cast<std::int64_t>(a));
    if (model.state[static_cast<std::size_t>(model.cells.span[a])] == static_cast<std::uint8_t>(SpanState::Interior)) {
      const Index3 ijk = model.grid.span_index(model.cells.span[a]);
      const Box3 box = model.grid.span_box(ijk);
      const auto count = [&](std::size_t d) {
        return (ijk[d] + (d == 0 ? 0 : 1)) % (d == 0 ? 4 : 3) + (d == 0 ? 0 : 1);
      };
      const auto place = [&](std::size_t d, std::int64_t q) {
        const double t = (static_cast<double>(q) + 0.3) / static_cast<double>(count(d));
        return box.lower[d] + t * (box.upper[d] - box.lower[d]);
      };
      for (std::int64_t k = 0; k < count(2); ++k)
        for (std::int64_t j = 0; j < count(1); ++j)
          for (std::int64_t i = 0; i < count(0); ++i) {
            points.parameters.insert(points.parameters.end(), {place(0, i), place(1, j), place(2, k)});
            points.weights.push_back(model.grid.span_volume() / static_cast<double>((1 + i) * (2 + j) * (1 + 3 * k)));
          }
    } else {
      // No tensor product, and rarely as many as the neighbour's.
      const std::size_t n = std::max<std::size_t>(1, weights.size() - a % 6);
      for (std::size_t q = 0; q < n; ++q) {
        const double inward = q % 3 == 0 ? 0.9 : 1;
        for (std::size_t d = 0; d < 3; ++d)
          points.parameters.push_back(inward * parameters[3 * q + d] + (1 - inward) * parameters[d]);
        points.weights.push_back(weights[q]);
      }
    }
    points.offsets.push_back(static_cast<std::int64_t>(points.weights.size()));
  }
  model.points = std::move(points);
  const SolutionSpace space(model, {LightFunctions::Remove, 0.01});
  const ElasticMaterial material = isotropic(young, poisson, density);
  const auto K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
  const auto kernel = make_internal_forces(space, LinearElastic(material));
  const VectorXd u = some_vector(space.num_unknowns(), 1), expected = K * u;
  EXPECT_LT((gather(space, forces_of(*kernel, space.expand(u))) - expected).norm(), 1e-13 * expected.norm());
  EXPECT_GT(kernel->plan().num_tensor_points, 0);
  EXPECT_GT(kernel->plan().num_lane_points, 0);
  EXPECT_GT(kernel->plan().num_points, kernel->plan().num_tensor_points + kernel->plan().num_lane_points);
  EXPECT_EQ(kernel->plan().num_points, static_cast<std::int64_t>(model.points.weights.size()));
}

TEST_P(SpanKernels, FictitiousMaterialOfThinPartsIsCounted) {
  const auto p = GetParam();
  const TrimmedModel model = test::make_box_model(
      {{0, 0, 0}, {14, 14, 14}, {14, 14, 14}, p, identity_rotation, {4, 4, 6.45}, {8, 8, 6.45 + 1e-10}});
  const SolutionSpace space(model, {LightFunctions::Linear, 0.05});
  double share = 0;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) share = std::max(share, space.fictitious_share(a));
  const ElasticMaterial material = isotropic(young, poisson, density);
  const auto K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
  const auto kernel = make_internal_forces(space, LinearElastic(material));
  const VectorXd u = some_vector(space.num_unknowns(), 1), expected = K * u;
  EXPECT_LT((gather(space, forces_of(*kernel, space.expand(u))) - expected).norm(), 1e-13 * expected.norm());
  EXPECT_GT(kernel->plan().num_points, static_cast<std::int64_t>(model.points.weights.size()));
  EXPECT_GT(share, 0);
}

// Two programs for one method: eight points at a time here, matrices of a cell there.
TEST_P(SpanKernels, FBarGivesTheForcesOfStatics) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam(), test::some_rotation(0.7)));
  const SolutionSpace space(model, {});
  const Law law = neo_hookean(young, poisson, density);
  const auto kernel = make_internal_forces(space, law, {.mean_volume = true});
  const FiniteBody body(space, law, std::make_shared<const Connectivity>(space), Locking::FBar);
  const VectorXd u = some_vector(space.num_unknowns(), 0.02);
  VectorXd expected = VectorXd::Zero(u.size());
  const PointsReport report = body.add_forces(u, expected);
  ASSERT_GT(report.min_J, 0.5);
  const VectorXd f = forces_of(*kernel, u);
  EXPECT_LT((f - expected).norm(), 1e-12 * expected.norm());
  const VectorXd plain = forces_of(*make_internal_forces(space, law), u);
  EXPECT_GT((f - plain).norm(), 1e-3 * expected.norm());
  VectorXd again(u.size());
  EXPECT_NEAR(kernel->evaluate(u.data(), 0, again.data()).min_J, report.min_J, 1e-12);
}

TEST_P(SpanKernels, FBarLeavesHomogeneousDeformationAlone) {
  const TrimmedModel model = test::make_box_model(a_box(GetParam(), test::some_rotation(0.7)));
  Matrix3d G;
  G << 0.1, 0.3, -0.2, -0.1, -0.3, 0.05, 0.2, 0.1, 0.2;
  const SolutionSpace space(model, {LightFunctions::Linear, 0.05});
  const Law law = neo_hookean(young, poisson, density);
  const VectorXd u = space.expand(linear_field(space, G, {1, 2, 3}));
  const VectorXd expected = forces_of(*make_internal_forces(space, law), u);
  const VectorXd f = forces_of(*make_internal_forces(space, law, {.mean_volume = true}), u);
  EXPECT_LT((f - expected).norm(), 1e-13 * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Degrees, SpanKernels,
                         ::testing::Values(std::array{1, 1, 1}, std::array{2, 2, 2}, std::array{3, 3, 3},
                                           std::array{4, 4, 4}, std::array{1, 3, 2}));
