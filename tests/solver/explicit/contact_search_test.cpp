// What contact looks for and how stiff it makes what it finds later: bounds on motion, folds of a smooth wall, springs
// that begin after the step has shrunk.
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/pair_motion.hpp"
#include "tests/solver/explicit/contact_scene.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

const ElasticMaterial soft = isotropic(100, 0.2, 1e-2);

/// One body, its surface and the sides of a contact with itself.
struct OwnSurface {
  OwnSurface()
      : body(make_body(placed_box({0, 0, 0}, {5, 3, 2}, {5, 3, 2}, 2, 0.3), soft, {LightFunctions::Linear, 0.05})),
        surface(make_contact_surface(body->space, "body", 1, 0), 0), points(body->space.node_points()) {
    sides.first = sides.second = &surface;
    sides.first_displacement = sides.second_displacement = &body->u;
    place();
  }
  void place() { surface.move_all(body->state()); }

  std::unique_ptr<ElasticBody> body;
  MovingSurface surface;
  Eigen::MatrixXd points;
  PairSides sides;
};

/// Largest change of the vector between two vertices that were within `near` of each other.
double largest_change(const std::vector<Point3>& then, const std::vector<Point3>& now, double near) {
  double largest = 0;
  for (std::size_t a = 0; a < then.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (norm(minus(then[a], then[b])) <= near)
        largest = std::max(largest, norm(minus(minus(now[a], now[b]), minus(then[a], then[b]))));
  return largest;
}

/// A wall whose middle, at x = 0, becomes the tip of a fold; coefficients of its half at x > 0 stand at `gap` + depth
/// below the top. @return coefficients (functions · 3)
Eigen::VectorXd folded(const ElasticBody& body, double top, double gap) {
  const auto points = body.space.node_points();
  Eigen::VectorXd u(3 * points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double s = points(i, 0), below = top - points(i, 2), side = s > 0.25 ? 1 : s < -0.25 ? -1 : 0;
    u.segment<3>(3 * i) << side * (gap + below) - s, 0, std::abs(s) - (side == 0 ? below : 0) - points(i, 2);
  }
  return u;
}

} // namespace

TEST(Bvh, FindsTheClosePairsOfTwoTrees) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0, 10);
  const auto scatter = [&](std::size_t n, double size) {
    std::vector<Box3> boxes(n);
    for (Box3& box : boxes) {
      const Point3 x{any(random), any(random), any(random)};
      box = {x, plus(x, {size, 0.5 * size, size})};
    }
    return boxes;
  };
  const std::vector<Box3> first = scatter(300, 0), second = scatter(500, 0.6);
  const double reach = 0.4;
  std::vector<std::pair<std::int32_t, std::int32_t>> found, expected;
  Bvh(first).each_close_pair(
      Bvh(second), reach, [](const Box3&, const Box3&) { return false; },
      [&](std::int32_t a, std::int32_t b) { found.emplace_back(a, b); });
  for (std::size_t a = 0; a < first.size(); ++a)
    for (std::size_t b = 0; b < second.size(); ++b) {
      const Box3 grown{minus(second[b].lower, {reach, reach, reach}), plus(second[b].upper, {reach, reach, reach})};
      if (overlap(first[a], grown)) expected.emplace_back(a, b);
    }
  std::sort(found.begin(), found.end());
  EXPECT_GT(expected.size(), 20u);
  EXPECT_EQ(found, expected);
}

TEST(PairMotion, BoundsTheMotionOfWhatWasNear) {
  OwnSurface own;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  const double near = 0.8;
  for (Eigen::Index i = 0; i < own.body->u.size(); ++i) own.body->u[i] = 0.1 * any(random);
  own.place();
  PairMotion motion;
  motion.start(own.sides, 0);
  const std::vector<Point3> then = own.surface.positions();
  EXPECT_EQ(motion.bound(own.sides), 0);
  for (int step = 0; step < 4; ++step) {
    const Eigen::Vector3d drift(0.2, -0.1, 0.05 * step);
    for (Eigen::Index i = 0; i < own.points.rows(); ++i) {
      own.body->u.segment<3>(3 * i) += drift - 0.05 * own.points(i, 0) * Eigen::Vector3d::UnitX();
      for (Eigen::Index d = 0; d < 3; ++d) own.body->u[3 * i + d] += 0.01 * any(random);
    }
    own.place();
    const double true_change = largest_change(then, own.surface.positions(), near), before = motion.bound(own.sides);
    EXPECT_GE(before, true_change);
    const double measured = motion.measure(own.sides, near);
    EXPECT_GE(measured, true_change);
    EXPECT_LT(measured, before);
    EXPECT_DOUBLE_EQ(motion.bound(own.sides), measured); // goes on from here
  }
}

TEST(PairMotion, APartThatIsCrushedEvenlyDoesNotComeCloserToItself) {
  OwnSurface own;
  PairMotion motion;
  motion.start(own.sides, 0);
  for (Eigen::Index i = 0; i < own.points.rows(); ++i) own.body->u[3 * i] += 7 - 0.1 * own.points(i, 0);
  own.place();
  EXPECT_NEAR(motion.measure(own.sides, 0.8), 0.08, 1e-6);
}

TEST(ContactForce, ASmoothWallFoldsOntoItself) {
  // Three spans of a wall are folded in the middle. Facing points are up to three spans from each other at rest, most
  // of them on what was one flat face; all but the tip itself touch.
  const BoxCase box = placed_box({-1.5, 0, 0}, {3, 2, 1}, {3, 2, 1}, 2);
  ElasticBodies bodies;
  bodies.push_back(make_body(box, soft));
  ContactPair pair = pair_of(deformable(0), deformable(0));
  pair.edges = false;
  Scene scene(std::move(bodies), {}, {pair}, 0.2);
  ElasticBody& body = *scene.bodies[0];
  const double top = box.upper[2];
  body.u = folded(body, top, 0.01);
  scene.evaluate();
  EXPECT_EQ(scene.pair().touches, 0);
  const Eigen::VectorXd before = body.u;
  body.u = folded(body, top, -0.01);
  body.v = (body.u - before) / scene.times.dt;
  scene.times.dt_last = scene.times.dt;
  scene.evaluate();
  const double width = box.upper[1] - box.lower[1];
  EXPECT_GT(scene.pair().area, 0.5 * 2 * 0.9 * width); // each half counts by half; 0.75 of 1.5 without near ones
  EXPECT_LT(scene.pair().area, 0.5 * 2 * 1.5 * width);
  EXPECT_GT(scene.pair().normal_force, 0);
}

TEST(ContactForce, WhatTouchesAfterTheStepHasShrunkGetsStifferSprings) {
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {6, 6, 3}, {6, 6, 3}, 2), soft));
  ContactPair pair = pair_of(deformable(0), rigid(0));
  const RigidBody floor{"floor", PlaneShape{{0, 0, 1}}, {0, 0, -1e-3}, FixedMotion{}};
  Scene scene(std::move(bodies), {floor}, {pair});
  const auto move = [&](double by) {
    scene.times.dt_last = scene.times.dt;
    for (Eigen::Index i = 0; i < scene.bodies[0]->masses.size(); ++i) {
      scene.bodies[0]->u[3 * i + 2] += by;
      scene.bodies[0]->v[3 * i + 2] = by / scene.times.dt;
    }
    scene.evaluate();
    return scene.pair().force[2];
  };
  scene.evaluate();
  const double at_first = move(-0.002); // a few springs at the edges are lowered by the budget of this step
  EXPECT_EQ(move(0.002), 0);            // apart again
  scene.times.dt *= 0.5;
  const double later = move(-0.002);
  EXPECT_GE(later / at_first, 4 / 1.21);
  EXPECT_LT(later / at_first, 4 / 1.2);
  EXPECT_EQ(scene.contact.report().least_scale, 1); // within the budget
  scene.times.dt *= 0.5;
  EXPECT_NEAR(move(-0.001), 2 * later, 1e-9 * later); // constant while it lasts
  const std::vector<SavedArray> saved = scene.contact.save();
  scene.evaluate();
  const Eigen::VectorXd expected = scene.bodies[0]->f;
  scene.contact.load(saved);
  scene.evaluate();
  EXPECT_EQ(scene.bodies[0]->f, expected);
}
