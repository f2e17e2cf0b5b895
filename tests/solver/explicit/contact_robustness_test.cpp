// Contact where it goes wrong first: bodies placed in each other, speed, edges, spinning balls; Hertz' impact.
#include "format/model/errors.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "tests/solver/explicit/contact_scene.hpp"

#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

const ElasticMaterial soft = isotropic(100, 0.2, 1e-2);

RigidBody free_ball(double radius, double mass, const Point3& centre, const Point3& velocity) {
  RigidBody ball{"ball", SphereShape{radius}, centre, {}};
  FreeMotion motion;
  motion.mass = mass;
  for (std::size_t d = 0; d < 3; ++d) motion.inertia[d][d] = 0.4 * mass * radius * radius;
  motion.velocity = velocity;
  ball.motion = motion;
  return ball;
}

RigidBody floor_at(double z) {
  return {"floor", PlaneShape{{0, 0, 1}}, {0, 0, z}, FixedMotion{}};
}

} // namespace

TEST(StartOverlaps, TellDepthAndPlaceHoweverDeep) {
  const auto scene_at = [](double z) {
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({0, 0, 0}, {6, 6, 6}, {6, 6, 6}, 2), soft));
    bodies.push_back(make_body(placed_box({2.1, 2.2, z}, {1.5, 1.5, 1.5}, {3, 3, 3}, 2), soft));
    return std::make_unique<Scene>(
        std::move(bodies), std::vector<RigidBody>{floor_at(0.1)},
        std::vector<ContactPair>{pair_of(deformable(0), deformable(1)), pair_of(deformable(0), rigid(0))});
  };
  const auto apart = scene_at(6), inside = scene_at(2.6), shallow = scene_at(5.8);
  auto states = apart->states();
  const auto floor_only = apart->contact.start_overlaps(states);
  ASSERT_EQ(floor_only.size(), 1U);
  EXPECT_NEAR(floor_only[0].depth, 0.1, 1e-12);
  EXPECT_FALSE(floor_only[0].is_deep());
  apart->evaluate();
  states = shallow->states();
  const auto little = shallow->contact.start_overlaps(states);
  ASSERT_EQ(little.size(), 2U);
  EXPECT_NEAR(little[0].depth, 0.2, 1e-12);
  EXPECT_FALSE(little[0].is_deep());
  EXPECT_TRUE(std::abs(little[0].place[2] - 5.8) < 1e-9 || std::abs(little[0].place[2] - 6) < 1e-9); // either side's
  states = inside->states(); // deeper than any contact sees
  const auto deep = inside->contact.start_overlaps(states);
  ASSERT_EQ(deep.size(), 2U);
  EXPECT_TRUE(deep[0].is_deep());
  EXPECT_GT(deep[0].depth, 2);
  EXPECT_GT(deep[0].vertices, 50);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_GE(deep[0].place[d], 2);
    EXPECT_LE(deep[0].place[d], 4.2);
  }
  EXPECT_THROW(inside->evaluate(), InputError);
}

TEST(StartOverlaps, ASmallBallInsideABodyHoldsNoVertexAndIsFound) {
  const auto scene_with = [](const Point3& centre) {
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({0, 0, 0}, {6, 6, 6}, {6, 6, 6}, 2), soft));
    ContactPair pair = pair_of(deformable(0), rigid(0));
    pair.where = "run.toml:7";
    return std::make_unique<Scene>(std::move(bodies), std::vector<RigidBody>{{"ball", SphereShape{0.1}, centre, {}}},
                                   std::vector<ContactPair>{pair});
  };
  const auto inside = scene_with({3.1, 2.9, 2.3});
  const auto found = inside->contact.start_overlaps(inside->states());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].depth, 2.3, 1e-12);
  try {
    inside->evaluate();
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("run.toml:7: contact '")) << error.what();
  }
  const auto outside = scene_with({3.1, 2.9, 6.3});
  EXPECT_TRUE(outside->contact.start_overlaps(outside->states()).empty());
}

TEST(ContactAtSpeed, FastBallsBounceAndTooFastOnesAreRefused) {
  const auto scene_with = [](double share) { // of a span in a step
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({-2, -2, -2}, {4, 4, 2}, {4, 4, 2}, 2), soft));
    const double omega = bodies[0]->largest_omega(), dt = 1.8 / omega;
    return std::make_unique<Scene>(
        std::move(bodies),
        std::vector<RigidBody>{free_ball(2, 0.02, {0.1, 0.05, 3}, {0, 0, -share / dt}), floor_at(-2)},
        std::vector<ContactPair>{pair_of(deformable(0), rigid(0)), pair_of(deformable(0), rigid(1))});
  };
  const auto fast = scene_with(0.3);
  double lowest = 3;
  for (int step = 0; step < 200; ++step) {
    fast->step();
    lowest = std::min(lowest, fast->contact.rigid()[0].pose().centre[2]);
  }
  EXPECT_GT(lowest, 0.5); // the ball's lowest point stayed within the block
  EXPECT_GT(fast->contact.rigid()[0].momentum()[2], 0);
  const auto too_fast = scene_with(0.8);
  EXPECT_THROW(
      {
        for (int step = 0; step < 200; ++step) too_fast->step();
      },
      NumericalError);
}

TEST(ContactInTime, FrictionSpinsASlidingBall) {
  // Sliding under its weight: spin grows by μ N R / I until it rolls.
  const double mu = 0.2, R = 3, m = 0.05, g = 50, v = 20;
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({-4, -2, -1}, {10, 4, 1}, {10, 4, 1}, 2), isotropic(1000, 0.2, 1e-2)));
  RigidBody ball = free_ball(R, m, {-2, 0, R}, {v, 0, 0});
  std::get<FreeMotion>(ball.motion).acceleration = {0, 0, -g};
  Scene scene(std::move(bodies), {ball, floor_at(-1)},
              {pair_of(deformable(0), rigid(0), mu, 0.1), pair_of(deformable(0), rigid(1), 0.5, 0.1)}, 0.25, 0.5);
  double impulse = 0, friction = 0;
  while (scene.times.time < 0.15) {
    scene.step();
    impulse += mu * scene.pair().normal_force * scene.times.dt;
    EXPECT_GE(scene.energies.friction, friction);
    friction = scene.energies.friction;
  }
  const RigidState& moved = scene.contact.rigid()[0];
  const Point3 c{moved.pose().centre[0], moved.pose().centre[1], moved.pose().centre[2]}, p = moved.momentum();
  const Point3 L = moved.angular_momentum();
  const double spin = L[1] - (c[2] * p[0] - c[0] * p[2]); // about the centre
  std::printf("[          ] spin %.5g of %.5g, slowed by %.5g of %.5g; normal force / weight %.4f\n", spin, impulse * R,
              m * v - p[0], impulse, impulse / (mu * m * g * scene.times.time));
  EXPECT_NEAR(spin / (impulse * R), 1, 0.02);
  EXPECT_NEAR((m * v - p[0]) / impulse, 1, 0.02);
}

TEST(ContactInTime, HeavyBallTakesHertzTimeToBounce) {
  const double E = 200, nu = 0.3, R = 60, W = 8, H = 5, v = 0.04, wanted = 0.02;
  const double stiffness = E / (1 - nu * nu) * std::sqrt(R), m = 16 * stiffness * std::pow(wanted, 2.5) / (15 * v * v);
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({-W / 2, -W / 2, -H}, {W, W, H}, {8, 8, 5}, 2), isotropic(E, nu, 1e-2)));
  Scene scene(std::move(bodies), {free_ball(R, m, {0, 0, R + 1e-5}, {0, 0, -v}), floor_at(-H)},
              {pair_of(deformable(0), rigid(0)), pair_of(deformable(0), rigid(1))}, 0.3, 0.25);
  double first = -1, last = 0, deepest = 0, strongest = 0;
  while (scene.times.time < 1.3 * 2.9432 * wanted / v) {
    scene.step();
    const double force = scene.pair().normal_force;
    if (force > 0 && first < 0) first = scene.times.time;
    if (force > 0) last = scene.times.time;
    const double approach = R - scene.contact.rigid()[0].pose().centre[2] - scene.pair(1).largest_depth;
    deepest = std::max(deepest, approach);
    strongest = std::max(strongest, force);
  }
  const double hertz = 4.0 / 3 * stiffness * std::pow(deepest, 1.5);
  std::printf(
      "[          ] depth %.4f of Hertz', time %.4f of 2.9432 d/v and %.4f of Hertz', force %.4f of that at the "
      "depth\n",
      deepest / wanted, (last - first) / (2.9432 * deepest / v), (last - first) / (2.9432 * wanted / v),
      strongest / hertz);
  // The block is finite: a floor 4.5 contact radii below stiffens it, free sides soften it.
  EXPECT_NEAR((last - first) / (2.9432 * deepest / v), 1, 0.05);
  EXPECT_NEAR(deepest / wanted, 1, 0.1);
  EXPECT_NEAR(strongest / hertz, 1, 0.15);
}
