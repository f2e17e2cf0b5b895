// Statics with rigid tools: tangents, patch test, friction, energy, going on from a saved state.
#include "format/model/errors.hpp"
#include "solver/nonlinear/nonlinear_statics.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/tangent_product.hpp"
#include "tests/solver/trimmed_part.hpp"
#include "tests/support/small_surfaces.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr double E = 10, nu = 0.3;

TrimmedModel block() {
  return make_part(box_mesh({0, 0, 0}, {1, 1, 1}), {2, 0.5, 0.3, 0, identity_rotation});
}

TimeCurve ramp(double end) {
  return TimeCurve({0, 1}, {0, end}, TimeCurve::Between::Linear, "ramp");
}

RigidRun tool(const std::string& name, const RigidShape& shape, const Point3& centre,
              const std::vector<std::pair<std::size_t, double>>& moves = {}) {
  RigidRun rigid;
  rigid.body.name = name;
  rigid.body.shape = shape;
  rigid.body.centre = centre;
  if (moves.empty()) return rigid;
  PrescribedMotion motion;
  for (const auto& [axis, end] : moves) motion.translation[axis] = ramp(end);
  rigid.body.motion = motion;
  return rigid;
}

ToolContactSettings contact(const std::string& name, std::size_t number, double friction = 0) {
  ToolContactSettings settings;
  settings.name = name;
  settings.tool = number;
  settings.friction = friction;
  return settings;
}

Support symmetry(const std::string& name, const Point3& normal, bool x, bool y) {
  Support support;
  support.name = name;
  support.region.plane = RegionChoice::Plane{{0, 0, 0}, normal, 0};
  support.fixed = {x, y, false};
  support.method = SupportMethod::Penalty;
  return support;
}

/// A block on a floor at z = 0 that a press at z = 1 comes down on.
NonlinearRun pressed(double way, double friction) {
  NonlinearRun run;
  run.material.law = neo_hookean(E, nu, 1);
  run.light = usual();
  run.rigid = {tool("floor", PlaneShape{{0, 0, 1}}, {0, 0, 0}),
               tool("press", PlaneShape{{0, 0, -1}}, {0, 0, 1}, {{2, -way}})};
  run.contacts = {contact("low", 0, friction), contact("top", 1, friction)};
  run.supports = {symmetry("x", {1, 0, 0}, true, false), symmetry("y", {0, 1, 0}, false, true)};
  run.newton.steps = 2;
  return run;
}

/// Nominal stress and the stretch across of the neo-Hookean law under a stretch along one axis.
std::pair<double, double> uniaxial(double stretch) {
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  const auto nominal = [&](double along, double J) { return mu * along + (lambda * std::log(J) - mu) / along; };
  double low = 0.5, high = 2;
  for (int i = 0; i < 80; ++i) {
    const double across = 0.5 * (low + high);
    (nominal(across, across * across * stretch) > 0 ? high : low) = across;
  }
  return {nominal(stretch, low * low * stretch), low};
}

} // namespace

// Differences of the forces, in directions that change which points touch by none: normal part, curved tools, edges of
// a box, sticking and sliding beside a tool that turns.
TEST(NonlinearContact, StiffnessIsTheDerivativeOfTheForces) {
  const TrimmedModel model = block();
  const SolutionSpace space(model, usual());
  const auto connectivity = std::make_shared<const Connectivity>(space);
  const std::vector<std::pair<RigidShape, Point3>> tools{{PlaneShape{{0, 0, -1}}, {0.4, 0.5, 0.93}},
                                                         {SphereShape{0.8}, {0.45, 0.55, 1.7}},
                                                         {CylinderShape{{0, 1, 0}, 0.6, 2}, {0.5, 0.5, 1.5}},
                                                         {box_shape({0.31, 0.37, 0.2}), {0.52, 0.49, 1.11}}};
  Eigen::VectorXd u(space.num_unknowns()), v(space.num_unknowns());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    u[i] = 0.01 * std::sin(static_cast<double>(3 * i));
    v[i] = std::cos(static_cast<double>(5 * i));
  }
  for (const auto& [shape, centre] : tools)
    for (const double friction : {0.0, 0.05, 10.0}) {
      RigidBody body;
      body.shape = shape;
      body.centre = centre;
      PrescribedMotion motion;
      motion.translation[0] = ramp(0.04);
      motion.rotation = ramp(0.1);
      body.motion = motion;
      ToolContact touching(space, contact("c", 0, friction), body, E / 0.5);
      Eigen::VectorXd f = Eigen::VectorXd::Zero(u.size());
      touching.keep(0.5 * u, 0.5);
      const ToolContactReport report = touching.add_forces(u, 1, f);
      ASSERT_GT(report.points, 0);
      if (friction == 0.05) {
        EXPECT_GT(report.sliding, 0);
      }
      Tangent A(connectivity, false);
      A.set_zero();
      touching.subtract_stiffness(u, 1, A);
      const Eigen::VectorXd exact = -product(A, v);
      const auto forces = [&](double step) {
        Eigen::VectorXd g = Eigen::VectorXd::Zero(u.size());
        EXPECT_EQ(touching.add_forces(u + step * v, 1, g).points, report.points);
        return g;
      };
      constexpr double step = 1e-7;
      const Eigen::VectorXd difference = (forces(step) - forces(-step)) / (2 * step);
      EXPECT_LT((difference - exact).norm(), 1e-6 * exact.norm()) << shape.index() << " " << friction;
      if (touching.is_symmetric()) {
        const Eigen::VectorXd other = product(A, u);
        EXPECT_NEAR(u.dot(-exact), v.dot(other), 1e-10 * u.norm() * exact.norm());
      }
    }
}

// Uniform stress to rounding between a floor and a press, at the depth that the penalty says; Newton is quadratic.
TEST(NonlinearContact, BlockBetweenPlanesIsUniform) {
  const TrimmedModel model = block();
  const SolutionSpace space(model, usual());
  const NonlinearRun run = pressed(0.2, 0);
  NonlinearStatics statics(run, space);
  StepReport step;
  for (int k = 1; k <= run.newton.steps; ++k) step = statics.advance(k / 2.0);
  const std::vector<ToolContactReport>& reports = statics.contact_reports();
  const double depth = reports[0].depth, force = reports[0].force[2];
  const auto [nominal, across] = uniaxial(1 - 0.2 + 2 * depth);
  EXPECT_NEAR(force, -nominal, 1e-7 * force);
  EXPECT_NEAR(depth, force / (run.contacts[0].stiffness * E / 0.5), 1e-9);
  EXPECT_NEAR(reports[1].force[2], -force, 1e-7 * force);
  EXPECT_NEAR(reports[0].area, 1, 1e-12);
  EXPECT_NEAR(reports[0].normal_force, force, 1e-12);
  EXPECT_EQ(reports[0].friction_force, 0);
  ASSERT_GE(step.residuals.size(), 3U);
  EXPECT_LT(step.residuals.back(), 1e-8);
  // Nothing but trapezia over two steps is missing from the balance, and contact is linear in them: nothing.
  const double missing = statics.external_work() - statics.internal_work() - statics.contact_energy();
  EXPECT_LT(std::abs(missing), 1e-6 * statics.internal_work());
}

// A block pulled sideways by the press sticks below μ N, and slides at exactly that force.
TEST(NonlinearContact, SlidesAtTheLimitOfFriction) {
  const TrimmedModel model = block();
  const SolutionSpace space(model, usual());
  constexpr double mu = 0.3;
  NonlinearRun run = pressed(0.05, mu);
  run.material.law = neo_hookean(E, 0, 1); // no friction but that of the pull
  run.supports.clear();
  run.contacts[1].friction = 0;
  run.contacts[1].rough = true;
  run.newton.steps = 8;
  // Down in the first quarter, then sideways.
  PrescribedMotion motion;
  motion.translation[2] = TimeCurve({0, 0.25, 1}, {0, -0.05, -0.05}, TimeCurve::Between::Linear, "down");
  motion.translation[0] = TimeCurve({0, 0.25, 1}, {0, 0, 0.15}, TimeCurve::Between::Linear, "sideways");
  run.rigid[1].body.motion = motion;
  NonlinearStatics statics(run, space);
  statics.advance(0.25);
  statics.advance(0.26); // a hair of the way
  EXPECT_EQ(statics.contact_reports()[0].sliding, 0);
  EXPECT_LT(statics.contact_reports()[0].friction_force, mu * statics.contact_reports()[0].normal_force);
  for (const double factor : {0.375, 0.5, 0.75, 1.0}) statics.advance(factor);
  const ToolContactReport& floor = statics.contact_reports()[0];
  EXPECT_EQ(floor.sliding, floor.points);
  EXPECT_NEAR(floor.friction_force, mu * floor.normal_force, 1e-12 * floor.normal_force);
  EXPECT_NEAR(floor.force[0], -mu * floor.force[2], 1e-5 * floor.force[2]); // hardly turned by what shear does across
  EXPECT_NEAR(floor.force[0], -statics.contact_reports()[1].force[0], 1e-6 * floor.force[2]);
  EXPECT_GT(statics.friction_energy(), 0);
  const double missing =
      statics.external_work() - statics.internal_work() - statics.contact_energy() - statics.friction_energy();
  EXPECT_LT(std::abs(missing), 0.01 * statics.external_work());
}

TEST(NonlinearContact, GoesOnFromASavedState) {
  const TrimmedModel model = block();
  const SolutionSpace space(model, usual());
  const NonlinearRun run = pressed(0.1, 0.2);
  NonlinearStatics whole(run, space), first(run, space), second(run, space);
  whole.advance(0.5);
  whole.advance(1);
  first.advance(0.5);
  second.load(first.save());
  second.advance(1);
  EXPECT_EQ(whole.displacement(), second.displacement());
  EXPECT_EQ(whole.external_work(), second.external_work());
  EXPECT_EQ(whole.friction_energy(), second.friction_energy());
}

TEST(NonlinearContact, RefusesWhatNothingHolds) {
  const TrimmedModel model = block();
  const SolutionSpace space(model, usual());
  NonlinearRun slippery = pressed(0.1, 0), apart = pressed(0.1, 0.5), inside = pressed(0.1, 0.5);
  slippery.supports.clear();
  EXPECT_THROW(NonlinearStatics(slippery, space), InputError);
  for (RigidRun& rigid : apart.rigid) rigid.body.centre[2] *= 1.5, rigid.body.centre[2] -= 0.1;
  apart.supports.clear();
  EXPECT_THROW(NonlinearStatics(apart, space), InputError);
  inside.rigid[0].body.centre[2] = 0.3;
  EXPECT_THROW(NonlinearStatics(inside, space), InputError);
}
