// What a run is made of, together: contact with a rigid body, constraints of the velocity, initial fields, the end of a
// run, hard vibrations.
#include "format/model/vec3.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "solver/space/placement.hpp"
#include "tests/solver/explicit/contact_scene.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using Eigen::Vector3d;

namespace {

TrimmedModel trimmed_block(int p, double turn = 0.7) {
  return test::make_box_model(
      {{0, 0, 0}, {9, 8, 8}, {9, 8, 8}, {p, p, p}, test::some_rotation(turn), {3, 3, 3.3}, {5.6, 4.5, 4.4}});
}

BodySettings extended() {
  return {.name = "part", .light = {LightFunctions::Linear, 0.05}};
}

Law rubber() {
  return neo_hookean(2.5, 0.3, 1.6);
}

Point3 hard_motion(const Point3& x) {
  return {0.3 * std::sin(x[1] + 0.3), 0.24 * std::cos(x[0] - x[2]), 0.27 * std::sin(2 * x[0] + x[1])};
}

// A ball that falls on a block; all of a run's parts that change.
struct BallOnBlock {
  BallOnBlock()
      : model(test::make_box_model(test::placed_box({0, 0, 0}, {2, 2, 1}, {4, 4, 2}, 2, 0.4))),
        block(model, extended(), rubber()),
        contact({surface()}, {ball()}, {test::pair_of(test::deformable(0), test::rigid(0), 0.3, 0.05)}),
        integrator({&block}, {.end_time = 1e9, .max_steps = 120}) {
    integrator.add(contact);
  }
  ContactSurface surface() const {
    ContactSurface made = make_contact_surface(block.space(), "block", 1.6);
    made.wave_speed = block.forces().reference_wave_speed(); // as every run has it
    return made;
  }
  static RigidBody ball() {
    FreeMotion motion;
    motion.mass = 4;
    for (std::size_t d = 0; d < 3; ++d) motion.inertia[d][d] = 0.4 * 4 * 0.25;
    motion.velocity = {0.2, 0, -0.4};
    return {"ball", SphereShape{0.5}, {0.9, 1.1, 1.6}, motion};
  }
  TrimmedModel model;
  ExplicitBody block;
  ContactModel contact;
  Integrator integrator;
};

// Nodes beyond a plane move as told, by impulses on each of them.
class Grip final : public ConstraintSource {
 public:
  Grip(const ExplicitBody& body, double from, const Vector3d& velocity) : body_(body), velocity_(velocity) {
    for (Eigen::Index n = 0; n < body.space().num_nodes(); ++n)
      if (body.node_points()(n, 0) > from) nodes_.push_back(n);
  }
  void add_reactions(const StepTimes& times, std::span<const ConstrainedBody> bodies) override {
    const ConstrainedBody& b = bodies[0];
    for (const Eigen::Index n : nodes_) {
      const Vector3d target = (velocity_ * (times.time + times.dt) - b.displacement->segment<3>(3 * n)) / times.dt;
      const double mass = (*body_.mass().masses())[n];
      b.reaction->segment<3>(3 * n) = mass / b.gain * (target - b.velocity->segment<3>(3 * n));
    }
  }
  const std::vector<Eigen::Index>& nodes() const { return nodes_; }

 private:
  const ExplicitBody& body_;
  Vector3d velocity_;
  std::vector<Eigen::Index> nodes_;
};

} // namespace

TEST(ExplicitRun, BallOnBlockKeepsItsBooksAndGoesOnBitForBit) {
  BallOnBlock whole, first, second;
  whole.integrator.start();
  double error = 0, force = 0;
  whole.integrator.run([&](const Integrator& run) {
    error = std::max(error, run.energy_error());
    force = std::max(force, whole.contact.report().pairs[0].normal_force);
    return false;
  });
  EXPECT_GT(force, 0);
  EXPECT_LT(error, 1e-2);
  EXPECT_GT(whole.integrator.energy().friction, 0);
  // Block and ball together keep their momentum.
  const Point3 ball = whole.contact.rigid()[0].momentum();
  const Vector3d sum = whole.integrator.momentum(0).linear + Vector3d(ball.data());
  EXPECT_LT((sum - 4 * Vector3d(0.2, 0, -0.4)).norm(), 1e-12);
  first.integrator.start();
  first.integrator.run([](const Integrator& run) { return run.steps() == 61; });
  second.integrator.load(first.integrator.save(), first.integrator.limits());
  second.integrator.run();
  EXPECT_TRUE((second.block.displacement.array() == whole.block.displacement.array()).all());
  EXPECT_TRUE(
      (second.contact.rigid()[0].pose().centre.array() == whole.contact.rigid()[0].pose().centre.array()).all());
  EXPECT_EQ(second.integrator.energy().values(), whole.integrator.energy().values());
}

TEST(ExplicitRun, PoseBeforeIsThatOfTheTimeOfTheBodies) {
  BallOnBlock scene;
  scene.integrator.start();
  // The force of the first touch acts from t_n on: the pose at t_n is still that of the free flight.
  while (true) {
    const double t = scene.integrator.time();
    const Vector3d flown = scene.contact.rigid()[0].pose_before().centre - Vector3d(0.9, 1.1, 1.6);
    EXPECT_LT((flown - t * Vector3d(0.2, 0, -0.4)).norm(), 1e-13);
    if (scene.contact.report().pairs[0].touches > 0 || scene.integrator.finished()) break;
    scene.integrator.step();
  }
  EXPECT_GT(scene.integrator.time(), 0);
  EXPECT_FALSE(scene.integrator.finished());
}

TEST(ExplicitRun, ConstraintsOfTheVelocityHoldAndTheirWorkIsBooked) {
  const TrimmedModel model = trimmed_block(2, 0);
  for (const double damping : {0.0, 0.3}) {
    BodySettings settings = extended();
    settings.damping = damping;
    ExplicitBody body(model, settings, rubber());
    Grip grip(body, 4.5, {0.02, 0.01, 0});
    ASSERT_FALSE(grip.nodes().empty());
    Integrator integrator({&body}, {.end_time = 1e9, .largest_dt = 0.2, .max_steps = 200}); // one step for all
    integrator.add(grip);
    integrator.start();
    integrator.run([&](const Integrator& run) {
      for (const Eigen::Index n : grip.nodes())
        EXPECT_LT((body.displacement.segment<3>(3 * n) - run.time() * Vector3d(0.02, 0.01, 0)).norm(), 1e-12);
      return false;
    });
    EXPECT_GT(integrator.energy().external, 0);
    EXPECT_LT(integrator.energy_error(), 1e-10);
    const MomentumBalance& m = integrator.momentum(0);
    EXPECT_GT(m.linear.norm(), 0);
    EXPECT_LT(m.linear_error().norm(), 1e-11 * m.linear.norm());
    EXPECT_LT(m.angular_error().norm(), 1e-11 * m.angular.norm());
  }
}

TEST(ExplicitRun, TheLastConstraintHoldsWhereTwoMeet) {
  const TrimmedModel model = trimmed_block(2, 0);
  ExplicitBody body(model, extended(), rubber());
  Grip loose(body, 4.0, {1, 0, 0}), tight(body, 4.5, {0.02, 0, 0});
  Integrator integrator({&body}, {.end_time = 1e9, .max_steps = 3});
  integrator.add(loose);
  integrator.add(tight);
  integrator.start();
  for (const Eigen::Index n : tight.nodes())
    EXPECT_LT((body.velocity.segment<3>(3 * n) - Vector3d(0.02, 0, 0)).norm(), 1e-13);
}

// v_i = ∫ N_i v / ∫ N_i: constants exactly, total momentum exactly in the rule, second order else.
TEST(ExplicitRun, InitialFieldsKeepTheirMomentumAndConverge) {
  const auto field = [](const Point3& x) { return Point3{std::sin(x[1]), std::cos(x[0] + x[2]), x[0] * x[1]}; };
  double errors[2];
  for (const int refined : {0, 1}) {
    const std::int64_t n = refined ? 20 : 10;
    const TrimmedModel model = test::make_box_model(
        {{0, 0, 0}, {5, 5, 5}, {n, n, n}, {2, 2, 2}, identity_rotation, {1.6, 1.7, 1.8}, {3.3, 3.2, 3.1}});
    ExplicitBody body(model, {.name = "part"}, rubber());
    body.set_velocity([](const Point3&) { return Point3{1, 2, 3}; });
    for (Eigen::Index i = 0; i < body.space().num_nodes(); ++i)
      EXPECT_LT((body.velocity.segment<3>(3 * i) - Vector3d(1, 2, 3)).norm(), 1e-12);
    body.set_velocity(field);
    Vector3d sum = Vector3d::Zero(), expected = sum;
    for (Eigen::Index i = 0; i < body.space().num_nodes(); ++i) sum += body.momentum.segment<3>(3 * i);
    double largest = 0;
    SpanShapes shapes;
    for (std::int64_t a = 0; a < body.space().num_cells(); ++a) {
      const auto parameters = cell_parameters(model, a), weights = cell_weights(model, a);
      evaluate(body.space(), a, parameters, Shapes::Values, shapes);
      const auto nodes = body.space().nodes(a);
      for (std::size_t q = 0; q < weights.size(); ++q) {
        const Point3 v =
            field(model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]}));
        Vector3d miss = -Vector3d(v.data());
        expected += 1.6 * weights[q] * Vector3d(v.data());
        for (std::size_t i = 0; i < nodes.size(); ++i)
          miss += shapes.values(static_cast<Eigen::Index>(q), static_cast<Eigen::Index>(i)) *
                  body.velocity.segment<3>(3 * nodes[i]);
        largest = std::max(largest, miss.norm());
      }
    }
    EXPECT_LT((sum - expected).norm(), 1e-12 * expected.norm());
    errors[refined] = largest;
  }
  EXPECT_LT(errors[1], 0.6 * errors[0]); // first order at cut faces, where functions lean inward
}

TEST(ExplicitRun, EndsOnTimeWithoutATinyStep) {
  const TrimmedModel model = trimmed_block(1);
  ExplicitBody body(model, extended(), rubber());
  const StartStep limit = body.start_step();
  for (const double steps : {1.0, 7.001, 7.5, 7.999, 8.0}) {
    body.displacement.setZero();
    body.set_velocity(hard_motion);
    const double dt = 0.5 * limit.dt, end = steps * dt;
    Integrator integrator({&body}, {.end_time = end, .largest_dt = dt});
    integrator.start({limit});
    double shortest = dt;
    while (!integrator.finished()) {
      shortest = std::min(shortest, integrator.dt());
      integrator.step();
    }
    EXPECT_EQ(integrator.time(), end);
    EXPECT_GE(shortest, 0.499 * dt) << steps;
    EXPECT_EQ(integrator.steps(), static_cast<std::int64_t>(std::ceil(steps)));
  }
}

// A first step that has to shrink in the first compression costs energy; one that starts where it will have to be not.
TEST(ExplicitRun, HardVibrationsKeepTheirEnergyAtNineTenthsOfTheLimit) {
  const TrimmedModel model = trimmed_block(2);
  ExplicitBody body(model, extended(), rubber());
  body.set_velocity(hard_motion);
  Integrator integrator({&body}, {.end_time = 1e9, .safety = 0.9, .start_share = 0.7, .max_steps = 4000});
  integrator.start();
  double worst = 0, smallest = 1;
  integrator.run([&](const Integrator& run) {
    worst = std::max(worst, run.energy_error());
    smallest = std::min(smallest, run.report(0).min_J);
    return false;
  });
  EXPECT_LT(smallest, 0.75);
  EXPECT_LT(worst, 1e-2);
}

TEST(Placement, MovesAModelAsARigidBody) {
  const TrimmedModel before = trimmed_block(2);
  const Placement place{rotation_about({0, 0.6, 0.8}, 0.9), {1, -2, 3}, {40, 5, -7}};
  const TrimmedModel after = placed(before, place);
  EXPECT_TRUE(check(after).empty());
  const auto expect_near = [](const Point3& a, const Point3& b) {
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(a[d], b[d], 1e-12);
  };
  const auto row = [](const std::vector<double>& rows, std::size_t k) {
    return Point3{rows[3 * k], rows[3 * k + 1], rows[3 * k + 2]};
  };
  for (std::size_t q = 0; q < before.points.weights.size(); q += 7)
    expect_near(after.grid.to_position(row(after.points.parameters, q)),
                place.moved(before.grid.to_position(row(before.points.parameters, q))));
  const EmbeddedSurface &own = before.surface, &moved = after.surface;
  for (std::size_t v = 0; v < own.mesh.vertices.size(); ++v)
    expect_near(moved.mesh.vertices[v], place.moved(own.mesh.vertices[v]));
  for (std::size_t q = 0; q < own.quadrature.weights.size(); q += 5) {
    expect_near(row(moved.quadrature.normals, q), place.turned(row(own.quadrature.normals, q)));
    expect_near(after.grid.to_position(row(moved.quadrature.parameters, q)),
                place.moved(before.grid.to_position(row(own.quadrature.parameters, q))));
  }
  expect_near(rotation_about({0, 0, 1}, std::numbers::pi / 2)[0], {0, -1, 0});
}

TEST(Placement, APlacedBodyVibratesAsItWould) {
  const TrimmedModel before = trimmed_block(2);
  const Placement place{rotation_about({0, 0.6, 0.8}, 0.9), {1, -2, 3}, {40, 5, -7}};
  const TrimmedModel after = placed(before, place);
  ExplicitBody here(before, extended(), rubber()), there(after, extended(), rubber());
  here.set_velocity([](const Point3& x) { return hard_motion(x); });
  Placement back = place; // its inverse, of directions about a point
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) back.R[a][b] = place.R[b][a];
  there.set_velocity([&](const Point3& x) {
    const Point3 y = plus(back.turned(minus(minus(x, place.shift), place.about)), place.about);
    return place.turned(hard_motion(y));
  });
  Integrator first({&here}, {.end_time = 1e9, .max_steps = 200}), second({&there}, {.end_time = 1e9, .max_steps = 200});
  const StartStep limit = here.start_step(); // Lanczos begins with vectors of its own in each of them
  EXPECT_NEAR(there.start_step().dt, limit.dt, 1e-5 * limit.dt);
  first.start({limit});
  second.start({limit});
  first.run();
  second.run();
  EXPECT_NEAR(second.time(), first.time(), 1e-9 * first.time());
  EXPECT_NEAR(second.energy().internal, first.energy().internal, 1e-8 * first.energy().kinetic);
  for (Eigen::Index n = 0; n < here.space().num_nodes(); ++n) {
    const Vector3d u = here.displacement.segment<3>(3 * n);
    const Point3 turned = place.turned({u[0], u[1], u[2]});
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_NEAR(there.displacement[3 * n + static_cast<Eigen::Index>(d)], turned[d], 1e-8);
  }
}
