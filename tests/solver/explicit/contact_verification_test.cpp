// Contact in time against closed forms: impact of bars, Hertz, sliding on an incline, bounce, pressed blocks.
#include "solver/explicit/loads/timed_loads.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "solver/output/sample_fields.hpp"
#include "tests/solver/explicit/contact_scene.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

struct BarImpact {
  double plateau = 0;     ///< force / (ρ c V / 2 A) in the middle of the contact
  double duration = 0;    ///< contact time / (2 L / c)
  double exchange = 0;    ///< share of the momentum that changed its body
  double force_error = 0; ///< of the contact forces' sum, / (ρ c V / 2 A)
  double energy_error = 0;
};

// Two bars of length L and nu = 0; the second one runs into the first one at rest.
BarImpact collide(std::int64_t n) {
  const double E = 100, rho = 1e-2, c = std::sqrt(E / rho), V = 0.1, L = 20, width = 2 * L / static_cast<double>(n);
  const ElasticMaterial material = isotropic(E, 0, rho);
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {L, width, width}, {n, 2, 2}, 2), material));
  bodies.push_back(make_body(placed_box({L + 1e-5, 0, 0}, {L, width, width}, {n, 2, 2}, 2), material));
  bodies[1]->set_velocity({-V, 0, 0});
  Scene scene(std::move(bodies), {}, {pair_of(deformable(0), deformable(1))});
  const double unit = rho * c * V / 2 * width * width, momentum = rho * L * width * width * V;
  BarImpact result;
  double first = -1, last = 0, energy = 0;
  int samples = 0;
  while (scene.times.time < 3 * L / c) {
    const double t = scene.times.time;
    scene.step();
    if (energy == 0) energy = scene.energies.balance();
    result.energy_error = std::max(result.energy_error, std::abs(scene.energies.balance() / energy - 1));
    const double force = scene.pair().normal_force / unit;
    if (force > 0.5 && first < 0) first = t;
    if (force > 0.5) last = t;
    if (t > 0.8 * L / c && t < 1.6 * L / c) {
      result.plateau += force;
      ++samples;
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& body : scene.bodies)
      for (Eigen::Index i = 0; i < body->f.size(); i += 3) sum += body->f.segment<3>(i);
    result.force_error = std::max(result.force_error, sum.norm() / unit);
  }
  result.plateau /= samples;
  result.duration = (last - first) / (2 * L / c);
  result.exchange = -scene.bodies[0]->momentum()[0] / momentum;
  return result;
}

} // namespace

TEST(ContactInTime, BarsExchangeTheirMomentumWithinTwiceTheWavesWay) {
  const BarImpact coarse = collide(20), fine = collide(60);
  for (const BarImpact& impact : {coarse, fine})
    std::printf("[          ] force %.4f rho c V/2 A, duration %.4f 2L/c, exchange %.4f, force sum %.1e, energy %.1e\n",
                impact.plateau, impact.duration, impact.exchange, impact.force_error, impact.energy_error);
  EXPECT_NEAR(fine.plateau, 1, 0.02);
  EXPECT_NEAR(fine.duration, 1, 0.05);
  EXPECT_LT(std::abs(fine.duration - 1), std::abs(coarse.duration - 1) + 1e-3);
  EXPECT_NEAR(fine.exchange, 1, 0.02);
  EXPECT_LT(fine.force_error, 1e-12);
  EXPECT_LT(fine.energy_error, 1e-3);
}

TEST(ContactInTime, SphereIndentsAsHertzSays) {
  // With a fifth of the critical step springs are stiff enough for the indentation to be that of the body.
  const double E = 200, nu = 0.3, R = 60, W = 8, H = 5, end = 0.5, depth = 0.02;
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({-W / 2, -W / 2, -H}, {W, W, H}, {8, 8, 5}, 2), isotropic(E, nu, 1e-2)));
  RigidBody ball{"ball", SphereShape{R}, {0, 0, R}, {}};
  PrescribedMotion down;
  down.translation[2] = TimeCurve({0, end}, {0, -depth}, TimeCurve::Between::Smooth, "ball");
  ball.motion = down;
  const RigidBody floor{"floor", PlaneShape{{0, 0, 1}}, {0, 0, -H}, FixedMotion{}};
  Scene scene(std::move(bodies), {ball, floor}, {pair_of(deformable(0), rigid(0)), pair_of(deformable(0), rigid(1))},
              0.3, 0.2);
  while (scene.times.time < end) {
    scene.step();
    scene.bodies[0]->v *= 0.995;
  }
  const double approach = depth - scene.pair(1).largest_depth;
  const double hertz = 4.0 / 3 * E / (1 - nu * nu) * std::sqrt(R) * std::pow(approach, 1.5);
  std::printf("[          ] force %.5g, Hertz %.5g, ratio %.4f; penetration %.3g of %.3g\n", scene.pair().normal_force,
              hertz, scene.pair().normal_force / hertz, scene.pair().largest_depth, approach);
  EXPECT_NEAR(scene.pair().normal_force / hertz, 1, 0.15);
}

TEST(ContactInTime, BlockSlidesOnAnInclineAsCoulombSays) {
  const double angle = std::numbers::pi / 6, g = 10;
  for (const double mu : {0.2, 0.4, 0.7}) {
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({0, 0, 0}, {2, 2, 1}, {3, 3, 2}, 2), isotropic(1000, 0, 1)));
    bodies[0]->gravity = {g * std::sin(angle), 0, -g * std::cos(angle)};
    const RigidBody floor{"floor", PlaneShape{{0, 0, 1}}, {0, 0, 0}, FixedMotion{}};
    Scene scene(std::move(bodies), {floor}, {pair_of(deformable(0), rigid(0), mu, 0.5)});
    const double mass = scene.bodies[0]->masses.sum();
    const auto speed = [&] { return scene.bodies[0]->momentum()[0] / mass; };
    const auto way = [&] { // of the centre of mass
      double sum = 0;
      for (Eigen::Index i = 0; i < scene.bodies[0]->masses.size(); ++i)
        sum += scene.bodies[0]->masses[i] * scene.bodies[0]->u[3 * i] / mass;
      return sum;
    };
    while (scene.times.time < 2) { // settles
      scene.step();
      scene.bodies[0]->v *= 0.9;
    }
    const double t = scene.times.time, v = speed(), x = way();
    double friction = scene.energies.friction;
    while (scene.times.time < 4) {
      scene.step();
      ASSERT_GE(scene.energies.friction, friction);
      friction = scene.energies.friction;
    }
    const double acceleration = (speed() - v) / (scene.times.time - t), moved = way() - x;
    const double expected = g * (std::sin(angle) - mu * std::cos(angle));
    std::printf("[          ] mu %.1f: acceleration %.4f, %.4f by Coulomb; moved %.3g\n", mu, acceleration, expected,
                moved);
    if (mu < std::tan(angle)) {
      EXPECT_NEAR(acceleration, expected, 0.01 * g);
    } else { // it stays
      EXPECT_LT(std::abs(moved), 2e-3);
    }
  }
}

TEST(ContactInTime, SphereBouncesBackWithoutLossAsDampingVanishes) {
  double kept[2];
  for (int k = 0; k < 2; ++k) {
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({-3, -3, -2}, {6, 6, 2}, {6, 6, 2}, 2), isotropic(1000, 0.2, 1e-2)));
    RigidBody ball{"ball", SphereShape{20}, {0, 0, 20.001}, {}};
    FreeMotion motion;
    motion.mass = 50; // heavy: the impact is slow against the waves in the block
    for (std::size_t d = 0; d < 3; ++d) motion.inertia[d][d] = 0.4 * 50 * 400;
    motion.velocity = {0, 0, -1};
    ball.motion = motion;
    const RigidBody floor{"floor", PlaneShape{{0, 0, 1}}, {0, 0, -2}, FixedMotion{}};
    Scene scene(std::move(bodies), {ball, floor},
                {pair_of(deformable(0), rigid(0), 0, k == 0 ? 0 : 0.5), pair_of(deformable(0), rigid(1), 0, 0)});
    double error = 0;
    bool touched = false;
    for (int step = 0; step < 20000; ++step) {
      scene.step();
      if (step == 0) continue;
      error = std::max(error, std::abs(scene.energies.balance() / 25 - 1));
      touched = touched || scene.pair().normal_force > 0;
      if (touched && scene.contact.rigid()[0].pose().centre[2] > 20.002) break;
    }
    kept[k] = scene.contact.rigid()[0].momentum()[2] / 50;
    std::printf("[          ] rebound %.4f, energy error %.2e\n", kept[k], error);
    EXPECT_LT(error, 1e-3);
  }
  EXPECT_GT(kept[0], 0.98);
  EXPECT_LT(kept[0], 1);
  EXPECT_LT(kept[1], kept[0]);
}

TEST(ContactInTime, PressedBlocksWithSurfacesThatDoNotMatchAreUnderUniformStress) {
  const ElasticMaterial material = isotropic(100, 0, 1e-2);
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {3, 3, 2}, {4, 4, 3}, 2), material));
  bodies.push_back(make_body(placed_box({0, 0, 2}, {3, 3, 2}, {5, 5, 3}, 2), material));
  RigidBody press{"press", PlaneShape{{0, 0, -1}}, {1.5, 1.5, 4}, {}};
  PrescribedMotion down;
  down.translation[2] = TimeCurve({0, 0.5}, {0, -0.04}, TimeCurve::Between::Smooth, "press");
  press.motion = down;
  const RigidBody floor{"floor", PlaneShape{{0, 0, 1}}, {1.5, 1.5, 0}, FixedMotion{}};
  Scene scene(
      std::move(bodies), {press, floor},
      {pair_of(deformable(0), deformable(1)), pair_of(deformable(1), rigid(0)), pair_of(deformable(0), rigid(1))}, 0.1);
  while (scene.times.time < 0.9) {
    scene.step();
    for (auto& body : scene.bodies) body->v *= scene.times.time < 0.5 ? 0.999 : 0.98;
  }
  const double pressure = scene.pair(1).normal_force / 9;
  double worst = 0;
  for (const auto& body : scene.bodies) {
    SamplePoints points;
    for (std::int64_t a = 0; a < body->space.num_cells(); ++a)
      for (auto q = body->model.points.offsets[static_cast<std::size_t>(a)];
           q < body->model.points.offsets[static_cast<std::size_t>(a) + 1]; ++q)
        points.cell.push_back(a);
    points.parameters = body->model.points.parameters;
    const FieldSamples fields = sample_fields(body->space, material, points, body->u, Fields::All);
    for (std::size_t q = 0; q < points.cell.size(); ++q)
      worst = std::max(worst, std::abs(fields.stress[6 * q + 2] / -pressure - 1));
  }
  std::printf("[          ] pressure %.5g, largest deviation of the stress %.4f; balance %.3g\n", pressure, worst,
              scene.pair(0).normal_force / scene.pair(1).normal_force - 1);
  EXPECT_LT(worst, 0.02);
}

TEST(ExplicitLoads, FollowerPressureTurnsWithTheBodyAndLoadsFollowTheirCurves) {
  const auto body = make_body(placed_box({0, 0, 0}, {2, 3, 1}, {3, 3, 2}, 2, 0.5), isotropic(1, 0.3, 1),
                              {LightFunctions::Linear, 0.05});
  Load pressure;
  pressure.name = "air";
  pressure.kind = LoadKind::Pressure;
  pressure.pressure = 2;
  pressure.region.names = {"u+"};
  Load traction = pressure;
  traction.kind = LoadKind::Traction;
  traction.vector = {0, 0, 3};
  TimedLoads loads(body->space, 0, 1,
                   {{pressure, TimeCurve({0, 1}, {0, 1}, TimeCurve::Between::Linear, "ramp"), true},
                    {traction, TimeCurve(0.5), false}});
  const double area = loads.reports()[0].region.area;
  // Turned by 90 degrees about z and stretched twice along it.
  const auto points = body->space.node_points();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    body->u.segment<3>(3 * i) << -points(i, 1) - points(i, 0), points(i, 0) - points(i, 1), points(i, 2);
  std::vector<BodyState> states{body->state()};
  loads.add_forces({0.5, 0.1, 0.1, 0.76}, states);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < points.rows(); ++i) sum += body->f.segment<3>(3 * i);
  EXPECT_NEAR(sum[0], 0, 1e-12);
  EXPECT_NEAR(sum[1], -1 * 2 * area, 1e-10); // half of the pressure on twice the area
  EXPECT_NEAR(sum[2], 1.5 * area, 1e-10);
}

TEST(ContactInTime, IntegratorKeepsEnergyAndMomentumOfALargeDeformationImpact) {
  const TrimmedModel block = make_box_model(placed_box({0, 0, 0}, {2, 2, 2}, {4, 4, 4}, 2, 0.4));
  const TrimmedModel other = make_box_model(placed_box({0.3, 0.4, 2.01}, {1.5, 1.5, 1.5}, {3, 3, 3}, 2, 0.6));
  const Law law = NeoHookean{.lambda = 50, .mu = 40, .density = 1e-2};
  BodySettings settings;
  settings.light = {LightFunctions::Linear, 0.05};
  ExplicitBody first(block, settings, law), second(other, settings, law);
  second.set_rigid_velocity({1, 0.5, -5}, {}, {});
  std::vector<ContactSurface> surfaces{make_contact_surface(first.space(), "first", 1e-2),
                                       make_contact_surface(second.space(), "second", 1e-2)};
  ContactModel contact(std::move(surfaces), {}, {pair_of(deformable(0), deformable(1), 0.3, 0.05)});
  IntegratorSettings run;
  run.end_time = 0.3;
  Integrator integrator({&first, &second}, run);
  integrator.add(contact);
  integrator.start();
  const auto momentum = [&] {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (const ExplicitBody* body : {&first, &second})
      for (Eigen::Index i = 0; i < body->momentum.size(); i += 3) p += body->momentum.segment<3>(i);
    return p;
  };
  const Eigen::Vector3d before = momentum();
  double error = 0, friction = 0, force = 0, depth = 0;
  while (!integrator.finished()) {
    integrator.step();
    error = std::max(error, integrator.energy_error());
    EXPECT_GE(integrator.energy().friction, friction);
    friction = integrator.energy().friction;
    force = std::max(force, contact.report().pairs[0].normal_force);
    depth = std::max(depth, contact.report().pairs[0].largest_depth);
  }
  std::printf("[          ] peak force %.4g, depth %.3g, friction %.3g, energy error %.2e, momentum %.1e, steps %ld\n",
              force, depth, friction, error, (momentum() - before).norm() / before.norm(),
              static_cast<long>(integrator.steps()));
  EXPECT_GT(force, 0);
  EXPECT_LT((momentum() - before).norm(), 1e-12 * before.norm());
  EXPECT_LT(error, 1e-2);
}
