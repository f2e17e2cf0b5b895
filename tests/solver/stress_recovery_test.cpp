// Stress recovered at the surface: exact for fields that splines hold, and how far it is from closed solutions.
#include "format/model/vec3.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/initial_strain.hpp"
#include "solver/stress/stress_recovery.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/exact_solutions.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <Eigen/Cholesky>
#include <functional>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

using DisplacementField = std::function<Point3(const Point3&)>;
using StressField = std::function<Voigt(const Point3&)>;

/// Coefficients of the nodes that a displacement has in a space, by least squares over points in all cells.
Eigen::VectorXd coefficients_of(const SolutionSpace& space, const DisplacementField& field) {
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(space.num_nodes(), space.num_nodes());
  Eigen::MatrixX3d f = Eigen::MatrixX3d::Zero(space.num_nodes(), 3);
  SpanShapes shapes;
  SpanPointStorage storage;
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const SpanPoints points = span_points(space, a, storage, InteriorPoints::Gauss);
    evaluate(space, a, points.parameters, Shapes::Values, shapes);
    const auto nodes = space.nodes(a);
    for (Eigen::Index q = 0; q < shapes.values.rows(); ++q) {
      const double* u = &points.parameters[static_cast<std::size_t>(3 * q)];
      const Point3 value = field(space.model().grid.to_position({u[0], u[1], u[2]}));
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double w = shapes.values(q, static_cast<Eigen::Index>(i));
        for (std::size_t d = 0; d < 3; ++d) f(nodes[i], static_cast<Eigen::Index>(d)) += w * value[d];
        for (std::size_t j = 0; j < nodes.size(); ++j)
          N(nodes[i], nodes[j]) += w * shapes.values(q, static_cast<Eigen::Index>(j));
      }
    }
  }
  const Eigen::LDLT<Eigen::MatrixXd> factor(N);
  const Eigen::MatrixX3d c = factor.solve(f);
  Eigen::VectorXd unknowns(3 * c.rows());
  for (Eigen::Index i = 0; i < c.rows(); ++i) unknowns.segment<3>(3 * i) = c.row(i).transpose();
  return unknowns;
}

SamplePoints surface_points(const TrimmedModel& model) {
  SamplePoints points;
  const SurfacePoints& q = model.surface.quadrature;
  points.parameters = q.parameters;
  for (std::size_t a = 0; a < model.num_cells(); ++a)
    points.cell.insert(points.cell.end(), static_cast<std::size_t>(q.offsets[a + 1] - q.offsets[a]),
                       static_cast<std::int64_t>(a));
  return points;
}

std::vector<std::int64_t> triangles_where(const TrimmedModel& model, const std::function<bool(const Point3&)>& test) {
  std::vector<std::int64_t> found;
  const TriangleMesh& mesh = model.surface.mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    bool all = true;
    for (const std::int32_t v : mesh.triangles[t]) all = all && test(mesh.vertices[static_cast<std::size_t>(v)]);
    if (all) found.push_back(static_cast<std::int64_t>(t));
  }
  return found;
}

/// Largest error of all components at the surface, relative to the largest stress there.
double largest_error(const TrimmedModel& model, const SamplePoints& points, const std::vector<double>& stress,
                     const StressField& exact) {
  double error = 0, size = 0;
  for (std::size_t k = 0; k < points.cell.size(); ++k) {
    const double* u = &points.parameters[3 * k];
    const Voigt s = exact(model.grid.to_position({u[0], u[1], u[2]}));
    size = std::max(size, s.cwiseAbs().maxCoeff());
    error = std::max(error, (Eigen::Map<const Voigt>(&stress[6 * k]) - s).cwiseAbs().maxCoeff());
  }
  return error / size;
}

RecoveryProblem problem_of(const SolutionSpace& space, const ElasticMaterial& material, Eigen::VectorXd unknowns,
                           const SurfaceConditions& conditions) {
  RecoveryProblem problem;
  problem.space = &space;
  problem.material = &material;
  problem.unknowns = std::move(unknowns);
  problem.tractions = known_tractions(space, conditions);
  return problem;
}

const ElasticMaterial material = isotropic(1, exact_nu, 1);

Voigt strain_of(const Eigen::Matrix3d& gradient) {
  Voigt strain;
  strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
      gradient(1, 2) + gradient(2, 1), gradient(2, 0) + gradient(0, 2);
  return strain;
}

} // namespace

TEST(EquilibratedPolynomials, HaveTheNumberThatEquilibriumLeaves) {
  const SplineGrid grid({0, 0, 0}, {1, 2, 4}, {2, 2, 2}, {2, 2, 2}, rotation(20, 15));
  const EquilibratedPolynomials polynomials(grid, material, 4);
  EXPECT_EQ(polynomials.size(1), 6);
  EXPECT_EQ(polynomials.size(2), 6 + 15);
  EXPECT_EQ(polynomials.size(4), 6 + 15 + 21 + 27);
}

// div σ by central differences, exact for stresses of degree 2.
TEST(EquilibratedPolynomials, LeaveNoVolumeForce) {
  const Rotation R = rotation(20, 15);
  const SplineGrid grid({0, 0, 0}, {1, 2, 4}, {2, 2, 2}, {2, 2, 2}, R);
  VoigtMatrix C = material.C;
  C(0, 0) *= 2; // no isotropy
  C(3, 3) *= 0.7;
  const ElasticMaterial own = anisotropic(C, 1);
  const EquilibratedPolynomials polynomials(grid, own, 3);
  constexpr double step = 0.25;
  const Point3 h = grid.span_size();
  Eigen::MatrixX3d s(6, 3);
  for (Eigen::Index k = 0; k < 6; ++k) { // a step along x, y, z in space, in spans
    for (std::size_t d = 0; d < 3; ++d)
      s(k, static_cast<Eigen::Index>(d)) =
          0.3 + (k % 2 == 0 ? step : -step) * R[static_cast<std::size_t>(k / 2)][d] / h[d];
  }
  const FieldStrains strains = polynomials.strains(s, 3);
  const auto force =
      (EquilibratedPolynomials::monomials(s, 2) * polynomials.strain_of_force({{1, -2, 3}, Eigen::Matrix3d::Zero()}))
          .eval();
  const auto divergence = [&](const std::function<Voigt(Eigen::Index)>& strain) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int d = 0; d < 3; ++d) {
      const Voigt change = C * (strain(2 * d) - strain(2 * d + 1)) / (2 * step);
      for (int i = 0; i < 3; ++i) sum[i] += change[voigt_place[i][d]];
    }
    return sum;
  };
  for (Eigen::Index f = 0; f < polynomials.size(); ++f)
    EXPECT_LT(divergence([&](Eigen::Index k) {
                Voigt e;
                for (std::size_t c = 0; c < 6; ++c) e[static_cast<Eigen::Index>(c)] = strains[c](k, f);
                return e;
              }).norm(),
              1e-12)
        << f;
  EXPECT_LT(
      (divergence([&](Eigen::Index k) { return Voigt(force.row(k).transpose()); }) - Eigen::Vector3d(-1, 2, -3)).norm(),
      1e-12);
}

// Pure bending (degree 2) and a field of degree 3 on a cube that lies anyhow in its grid: what the splines hold is
// recovered to rounding, and the estimated error says so.
TEST(StressRecovery, IsExactForFieldsOfTheSplines) {
  const auto bending = [](const Point3& x) {
    return Point3{x[0] * x[2], -exact_nu * x[1] * x[2], -0.5 * (x[0] * x[0] + exact_nu * (x[2] * x[2] - x[1] * x[1]))};
  };
  const auto bending_stress = [](const Point3& x) {
    Voigt s = Voigt::Zero();
    s[0] = x[2];
    return s;
  };
  const auto cubic = [](const Point3& x) { // gradient of x⁴ - 6 x² y² + y⁴
    return Point3{4 * x[0] * x[0] * x[0] - 12 * x[0] * x[1] * x[1], -12 * x[0] * x[0] * x[1] + 4 * x[1] * x[1] * x[1],
                  0};
  };
  const auto cubic_stress = [](const Point3& x) {
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    gradient(0, 0) = 12 * (x[0] * x[0] - x[1] * x[1]);
    gradient(1, 1) = -gradient(0, 0);
    gradient(0, 1) = gradient(1, 0) = -24 * x[0] * x[1];
    return Voigt(material.C * strain_of(gradient));
  };
  const TriangleMesh mesh = box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const auto all = [](const Point3&) { return true; };
  for (const int p : {2, 3}) {
    const TrimmedModel model = make_part(mesh, {p, 0.4, 0.3, 0, rotation(20, 15)});
    const SolutionSpace space(model, usual());
    const SamplePoints points = surface_points(model);
    const auto check = [&](const DisplacementField& u, const StressField& exact, const SurfaceConditions& conditions) {
      StressRecovery recovery(problem_of(space, material, coefficients_of(space, u), conditions));
      const RecoveredStress found = recovery.at(points);
      EXPECT_LT(largest_error(model, points, found.stress, exact), 1e-7) << p;
      EXPECT_LT(*std::max_element(found.error.begin(), found.error.end()), 1e-6) << p;
    };
    SurfaceConditions nothing;
    nothing.unknown = triangles_where(model, all);
    check(bending, bending_stress, nothing);
    SurfaceConditions free; // but at the ends, where the bending moment acts
    free.unknown = triangles_where(model, [](const Point3& x) { return x[0] < -0.5 + 1e-9; });
    const auto other = triangles_where(model, [](const Point3& x) { return x[0] > 0.5 - 1e-9; });
    free.unknown.insert(free.unknown.end(), other.begin(), other.end());
    check(bending, bending_stress, free);
    if (p == 3) check(cubic, cubic_stress, nothing);
  }
}

namespace {

/// T(x), the part's frame.
class GivenTemperature : public TemperatureField {
 public:
  GivenTemperature(const SplineGrid& grid, std::function<double(const Point3&)> value)
      : grid_(grid), value_(std::move(value)) {}
  Eigen::VectorXd at(std::int64_t /*cell*/, std::span<const double> u) const override {
    Eigen::VectorXd values(static_cast<Eigen::Index>(u.size() / 3));
    for (std::size_t k = 0; k < u.size() / 3; ++k)
      values[static_cast<Eigen::Index>(k)] = value_(grid_.to_position({u[3 * k], u[3 * k + 1], u[3 * k + 2]}));
    return values;
  }

 private:
  const SplineGrid& grid_;
  std::function<double(const Point3&)> value_;
};

} // namespace

// A body that turns about z under a temperature T = x² - x y + 2 z² + y, held by its ends: u = a (x³, y³, 0) balances
// the centrifugal force, and a volume force the thermal stress. Stress is C (ε - α T), of degree 2: exact to rounding
// with p = 3, which the told error knows; so is each part alone.
TEST(StressRecovery, IsExactUnderTemperatureAndRotation) {
  constexpr double expansion = 0.01, a = -0.05;
  const TriangleMesh mesh = box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
  const TrimmedModel model = make_part(mesh, {3, 0.4, 0.3, 0, rotation(20, 15)});
  const SolutionSpace space(model, usual());
  const SamplePoints points = surface_points(model);
  SurfaceConditions nothing;
  nothing.unknown = triangles_where(model, [](const Point3&) { return true; });
  const auto temperature = [](const Point3& x) { return x[0] * x[0] - x[0] * x[1] + 2 * x[2] * x[2] + x[1]; };
  for (const auto& [hot, turning] : {std::pair{1.0, 0.0}, std::pair{0.0, 1.0}, std::pair{1.0, 1.0}}) {
    ElasticMaterial own = material;
    if (hot > 0)
      own.initial_strain = thermal_strain(std::make_shared<GivenTemperature>(model.grid, temperature), 0, expansion);
    const double thermal = hot * expansion * own.C.row(0).head<3>().sum(); // stress of a degree
    const double b = -6 * a * turning * own.C(0, 0);                       // density · speed²
    const auto displacement = [&, turn = turning](const Point3& x) {
      return times({x[0] * x[0] * x[0], x[1] * x[1] * x[1], 0}, a * turn);
    };
    const auto exact = [&, turn = turning](const Point3& x) {
      Voigt strain = Voigt::Zero();
      strain[0] = 3 * a * turn * x[0] * x[0];
      strain[1] = 3 * a * turn * x[1] * x[1];
      Voigt stress = own.C * strain;
      stress.head<3>().array() -= thermal * temperature(x);
      return stress;
    };
    RecoveryProblem problem = problem_of(space, own, coefficients_of(space, displacement), nothing);
    problem.body_force = [&](const Point3& x) { // b - (-∇(thermal T)): what remains in equilibrium
      return plus({b * x[0], b * x[1], 0}, times({2 * x[0] - x[1], 1 - x[0], 4 * x[2]}, thermal));
    };
    const RecoveredStress found = StressRecovery(problem).at(points);
    EXPECT_LT(largest_error(model, points, found.stress, exact), 1e-7) << hot << turning;
    EXPECT_LT(*std::max_element(found.error.begin(), found.error.end()), 1e-7) << hot << turning;
  }
}

// To the bit with any number of threads; what is asked for first, and how often, changes no more than the rounding of a
// sum.
TEST(StressRecovery, FitsAreTheSameInAnyOrder) {
  const TrimmedModel model = make_part(box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}), {2, 0.4, 0.3, 0, rotation(20, 15)});
  const SolutionSpace space(model, usual());
  const auto field = [](const Point3& x) { return Point3{x[0] * x[2] * x[1], x[1] * x[1], std::sin(x[0])}; };
  const SamplePoints points = surface_points(model);
  const RecoveryProblem problem = problem_of(space, material, coefficients_of(space, field), {});
  const RecoveredStress all = StressRecovery(problem).at(points);
  {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const RecoveredStress alone = StressRecovery(problem).at(points);
    EXPECT_EQ(alone.stress, all.stress);
    EXPECT_EQ(alone.error, all.error);
  }
  StressRecovery piecewise(problem);
  const std::size_t n = points.cell.size();
  for (const std::size_t k : {n - 1, n / 2, std::size_t{0}, n / 2}) {
    const RecoveredStress one = piecewise.at({{points.cell[k]},
                                              {points.parameters.begin() + static_cast<std::ptrdiff_t>(3 * k),
                                               points.parameters.begin() + static_cast<std::ptrdiff_t>(3 * k + 3)}});
    for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(one.stress[c], all.stress[6 * k + c], 1e-13);
    EXPECT_NEAR(one.error[0], all.error[k], 1e-13);
  }
}
