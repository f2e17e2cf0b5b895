// Explicit runs against closed forms and conservation laws.
#include "solver/explicit/motion/integrator.hpp"

#include "format/model/errors.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>

using namespace iga;
using namespace iga::solve;
using Eigen::VectorXd;

namespace {

constexpr double young = 2.5, density = 1.6;

// A small body with trimmed spans all around.
TrimmedModel small_body(int p) {
  return test::make_box_model(
      {{0, 0, 0}, {9, 8, 8}, {9, 8, 8}, {p, p, p}, test::some_rotation(0.7), {3, 3, 3.3}, {5.6, 4.5, 4.4}});
}

// A bar along u of unit span size, its ends inside spans, its cross-section aligned with the grid.
TrimmedModel bar(int p, double length, double h) {
  const double n = std::ceil(length / h) + 2 * p + 2;
  return test::make_box_model({{0, 0, 0},
                               {n * h, 2.0 * p + 1, 2.0 * p + 1},
                               {static_cast<std::int64_t>(n), 2 * p + 1, 2 * p + 1},
                               {p, p, p},
                               identity_rotation,
                               {(p + 0.5) * h, static_cast<double>(p), static_cast<double>(p)},
                               {(p + 0.5) * h + length, p + 1.0, p + 1.0}});
}

Law linear(double nu) {
  return LinearElastic(isotropic(young, nu, density));
}
Law large_strain(double nu) {
  return neo_hookean(young, nu, density);
}

Point3 swirl(const Point3& x) { // some smooth motion without symmetry
  return {0.1 * std::sin(x[1] + 0.3), 0.08 * std::cos(x[0] - x[2]), 0.09 * std::sin(2 * x[0] + x[1])};
}

BodySettings lumped() {
  return {.name = "part", .light = {LightFunctions::Linear, 0.05}};
}

} // namespace

TEST(Integrator, ElasticVibrationKeepsItsEnergyCloseToTheStabilityLimit) {
  for (const int p : {1, 2, 3}) {
    const TrimmedModel model = small_body(p);
    ExplicitBody body(model, lumped(), linear(0.3));
    body.set_velocity(swirl);
    const std::int64_t steps = p < 3 ? 10000 : 2000;
    Integrator integrator({&body}, {.end_time = 1e9, .safety = 0.9, .max_steps = steps});
    integrator.start();
    double worst = 0;
    integrator.run([&](const Integrator& run) {
      worst = std::max(worst, run.energy_error());
      return false;
    });
    EXPECT_GT(integrator.energy().internal, 0);
    // The discrete energy ½ v- M v+ + ½ u K u of a linear body is an invariant of the scheme.
    EXPECT_LT(worst, 1e-9) << "p = " << p;
    EXPECT_EQ(integrator.steps(), steps);
  }
}

TEST(Integrator, LargeVibrationsDoNotDriftWhileTheStepVaries) {
  const TrimmedModel model = small_body(2);
  ExplicitBody body(model, lumped(), large_strain(0.3));
  body.set_velocity([](const Point3& x) {
    const Point3 v = swirl(x);
    return Point3{3 * v[0], 3 * v[1], 3 * v[2]};
  });
  Integrator integrator({&body}, {.end_time = 1e9, .safety = 0.5, .max_steps = 10000});
  integrator.start();
  double early = 0, late = 0, shortest = 1e9, longest = 0;
  integrator.run([&](const Integrator& run) {
    (run.steps() < 5000 ? early : late) = std::max(run.steps() < 5000 ? early : late, run.energy_error());
    shortest = std::min(shortest, run.dt());
    longest = std::max(longest, run.dt());
    return false;
  });
  EXPECT_GT(longest, 1.05 * shortest);
  EXPECT_LT(early, 6e-3);
  EXPECT_LT(late, 1.5 * early);
}

TEST(Integrator, MomentaAreKeptToRounding) {
  const TrimmedModel model = small_body(2);
  for (const MassType mass : {MassType::Lumped, MassType::TwoPass}) {
    BodySettings settings = lumped();
    settings.mass = mass;
    settings.light.threshold = mass == MassType::Lumped ? 0.05 : 0.01;
    ExplicitBody body(model, settings, large_strain(0.3));
    body.set_velocity([](const Point3& x) {
      const Point3 v = swirl(x);
      return Point3{v[0] + 0.2 - 0.1 * x[1], v[1] + 0.1 * x[0], v[2] - 0.3};
    });
    Integrator integrator({&body}, {.end_time = 1e9, .max_steps = 2000});
    integrator.start();
    integrator.run();
    const MomentumBalance& m = integrator.momentum(0);
    EXPECT_GT(m.linear_start.norm(), 0.1);
    EXPECT_LT(m.linear_error().norm(), 1e-12 * m.linear_start.norm());
    EXPECT_LT(m.angular_error().norm(), 1e-12 * m.angular_start.norm());
    EXPECT_LT(m.relative_linear_error(), 1e-12);
    EXPECT_LT(m.relative_angular_error(), 1e-12);
    EXPECT_LT(integrator.energy_error(), 1e-2);
  }
}

TEST(Integrator, RigidMotionGoesOnUnstrained) {
  const TrimmedModel model = small_body(2);
  ExplicitBody body(model, lumped(), large_strain(0.3));
  body.set_rigid_velocity({1, 2, 3}, {}, {});
  Integrator integrator({&body}, {.end_time = 100, .max_steps = 100});
  integrator.start();
  integrator.run();
  const double t = integrator.time();
  for (Eigen::Index n = 0; n < body.space().num_nodes(); ++n)
    EXPECT_LT((body.displacement.segment<3>(3 * n) - t * Eigen::Vector3d(1, 2, 3)).norm(), 1e-12 * t);
}

TEST(Integrator, StepsBeyondTheCriticalOneBlowUp) {
  const TrimmedModel model = small_body(2);
  for (const double factor : {0.98, 1.02}) {
    ExplicitBody body(model, lumped(), linear(0.3));
    body.set_velocity(swirl);
    StartStep limit = body.start_step();
    limit.dt *= 1.01 * factor; // Lanczos' own value, without the 1 % above it
    Integrator integrator({&body}, {.end_time = 1e9, .safety = 1, .max_steps = 1500});
    integrator.start({limit});
    const double start = integrator.energy().total();
    double largest = 0;
    integrator.run([&](const Integrator& run) {
      largest = std::max(largest, run.energy().internal);
      return largest > 1e7 * start;
    });
    if (factor < 1) {
      EXPECT_LT(largest, 10 * start);
    } else {
      EXPECT_GT(largest, 1e6 * start);
    }
  }
}

TEST(Integrator, MassProportionalDampingDecaysAtItsRate) {
  const TrimmedModel model = small_body(2);
  BodySettings settings = lumped();
  settings.damping = 0.5;
  ExplicitBody body(model, settings, linear(0.3));
  body.set_rigid_velocity({1, 0, 0}, {}, {});
  Integrator integrator({&body}, {.end_time = 4, .largest_dt = 0.02});
  integrator.start();
  integrator.run();
  // p is known half a step beyond t.
  const double t = integrator.time() + integrator.dt() / 2;
  const MomentumBalance& m = integrator.momentum(0);
  EXPECT_NEAR(m.linear[0] / (m.linear_start[0] * std::exp(-0.5 * t)), 1, 1e-4);
  EXPECT_LT(m.linear_error().norm(), 1e-13 * m.linear_start.norm());
  EXPECT_LT(integrator.energy_error(), 1e-4);
  EXPECT_GT(integrator.energy().damping, 0.9 * (integrator.energy().total() - integrator.energy().kinetic));
}

TEST(Integrator, GravityLetsABodyFall) {
  const TrimmedModel model = small_body(2);
  for (const MassType mass : {MassType::Lumped, MassType::ThreePass}) {
    BodySettings settings = lumped();
    settings.acceleration = {0, 0.3, -2};
    settings.mass = mass;
    settings.light.threshold = mass == MassType::Lumped ? 0.05 : 0.01;
    ExplicitBody body(model, settings, large_strain(0.3));
    Integrator integrator({&body}, {.end_time = 5, .largest_dt = 0.25});
    integrator.start();
    integrator.run();
    EXPECT_DOUBLE_EQ(integrator.time(), 5);
    const Eigen::Vector3d fall = Eigen::Vector3d(0, 0.3, -2) * 12.5;
    for (Eigen::Index n = 0; n < body.space().num_nodes(); ++n)
      EXPECT_LT((body.displacement.segment<3>(3 * n) - fall).norm(), 1e-9);
    EXPECT_LT(integrator.energy_error(), 1e-11);
  }
}

// Two halves of a bar run into each other: ρ c v0 in the middle, fronts at c t.
TEST(Integrator, WavesInABarCarryRhoCVAndRunAtC) {
  const double length = 40, v0 = 1e-3, c = std::sqrt(young / density);
  const TrimmedModel model = bar(2, length, 1);
  const double middle = 2.5 + length / 2;
  ExplicitBody body(model, {.name = "bar"}, linear(0));
  body.set_velocity([&](const Point3& x) { return Point3{x[0] < middle ? v0 : x[0] > middle ? -v0 : 0, 0, 0}; });
  const auto half_momentum = [&] {
    double sum = 0;
    for (Eigen::Index n = 0; n < body.space().num_nodes(); ++n) {
      const double x = body.node_points()(n, 0) - middle;
      sum += (x < -1e-9 ? 1 : x < 1e-9 ? 0.5 : 0) * body.momentum[3 * n];
    }
    return sum;
  };
  Integrator integrator({&body}, {.end_time = 0.7 * length / 2 / c});
  integrator.start();
  const auto later = [&] { return integrator.time() + integrator.dt() / 2; }; // momenta
  // The jump is some spans wide at the start: not counted.
  integrator.run([&](const Integrator& run) { return run.time() > 4 / c; });
  const double before = half_momentum(), t0 = later();
  integrator.run();
  const double t = later();
  EXPECT_NEAR((before - half_momentum()) / (density * c * v0 * (t - t0)), 1, 0.02); // cross-section 1
  for (Eigen::Index n = 0; n < body.space().num_nodes(); ++n) {
    const double x = std::abs(body.node_points()(n, 0) - middle);
    if (x > c * t + 3 && x < length / 2) {
      EXPECT_NEAR(std::abs(body.velocity[3 * n]), v0, 0.05 * v0) << x;
    }
    if (x < 0.5 * c * t) {
      EXPECT_LT(std::abs(body.velocity[3 * n]), 0.25 * v0) << x;
    }
    // Displacement: v0 t until the front passes, then it stands still.
    if (x < length / 2) {
      EXPECT_NEAR(std::abs(body.displacement[3 * n]), v0 * std::min(integrator.time(), x / c),
                  0.06 * v0 * integrator.time());
    }
  }
}

// ω_h / ω - 1 = -(p + 1)(k h)² / 24 for the lumped mass; two passes leave a fourth-order rest.
TEST(Integrator, ARodVibratesAtTheFrequencyOfItsMass) {
  constexpr int p = 2;
  const double length = 8, c = std::sqrt(young / density), k = std::numbers::pi / length;
  const TrimmedModel model = bar(p, length, 1);
  for (const auto& [mass, expected, tolerance] :
       {std::tuple{MassType::Lumped, -(p + 1) * k * k / 24, 1.5e-3}, std::tuple{MassType::TwoPass, -7.2e-4, 2e-4}}) {
    BodySettings settings{.name = "rod"};
    settings.mass = mass;
    ExplicitBody body(model, settings, linear(0));
    body.set_velocity([&](const Point3& x) { return Point3{1e-3 * std::cos(k * (x[0] - 2.5)), 0, 0}; });
    const VectorXd shape = body.momentum;
    const double dt = 0.01, period = 2 * length / c;
    Integrator integrator({&body}, {.end_time = 5.3 * period, .largest_dt = dt});
    integrator.start();
    double before = 1, zero = 0;
    integrator.run([&](const Integrator& run) {
      const double now = shape.dot(body.velocity);
      // Upward zero crossings; the velocity stands half a step beyond t.
      if (before < 0 && now >= 0) zero = run.time() + run.dt() / 2 - run.dt() * now / (now - before);
      before = now;
      return false;
    });
    const double omega = 2 * std::numbers::pi * 4.75 / zero;
    EXPECT_NEAR(omega / (k * c) - 1, expected, tolerance);
    EXPECT_LT(integrator.energy_error(), 1e-7);
  }
}

TEST(Integrator, ASavedStateGoesOnBitForBit) {
  const TrimmedModel model = small_body(2);
  for (const MassType mass : {MassType::Lumped, MassType::ThreePass}) {
    BodySettings settings = lumped();
    settings.mass = mass;
    settings.light.threshold = 0.01;
    settings.damping = 0.01;
    settings.acceleration = {0, 0, -0.1};
    const IntegratorSettings run{.end_time = 1e9, .max_steps = 60};
    const auto make = [&] { return std::make_unique<ExplicitBody>(model, settings, large_strain(0.3)); };
    const auto whole = make(), first = make(), second = make();
    Integrator a({whole.get()}, run), b({first.get()}, run), c({second.get()}, run);
    whole->set_velocity(swirl);
    first->set_velocity(swirl);
    a.start();
    a.run();
    {
      const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
      b.start();
      b.run([](const Integrator& i) { return i.steps() == 23; });
    }
    c.load(b.save(), b.limits());
    EXPECT_EQ(c.energy().values(), b.energy().values());
    c.run();
    EXPECT_EQ(a.time(), c.time());
    EXPECT_EQ(a.dt(), c.dt());
    EXPECT_TRUE((whole->displacement.array() == second->displacement.array()).all());
    EXPECT_TRUE((whole->momentum.array() == second->momentum.array()).all());
    EXPECT_EQ(a.energy().values(), c.energy().values());
    EXPECT_EQ(a.energy_error(), c.energy_error());
    EXPECT_EQ(a.momentum(0).angular_impulse, c.momentum(0).angular_impulse);
  }
}

// Laws with history and rate go on bit for bit too, threads or not; and the foam's crushing is paid for.
TEST(Integrator, CrushedFoamKeepsItsBooksAndItsHistory) {
  const TrimmedModel model = small_body(2);
  FoamSettings foam{.E = 2.5, .nu = 0, .density = density, .yield = Curve({0, 0.6, 0.9}, {0.05, 0.08, 0.8}, "foam")};
  foam.damping = 0.1;
  foam.tension_limit = 0.05;
  const auto make = [&] { return std::make_unique<ExplicitBody>(model, lumped(), CrushableFoam(foam)); };
  const auto inward = [](const Point3& x) {
    return Point3{-0.3 * (x[0] - 4.3), -0.3 * (x[1] - 3.8), -0.3 * (x[2] - 3.8)};
  };
  const IntegratorSettings run{.end_time = 1e9, .safety = 0.5, .max_steps = 200};
  const auto whole = make(), first = make(), second = make();
  Integrator a({whole.get()}, run), b({first.get()}, run), c({second.get()}, run);
  whole->set_velocity(inward);
  first->set_velocity(inward);
  a.start();
  a.run();
  EXPECT_LT(a.energy_error(), 1e-2);
  EXPECT_GT(a.energy().internal, 0.3 * a.energy().total());
  EXPECT_GT(a.energy().damping, 0);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    b.start();
    b.run([](const Integrator& i) { return i.steps() == 71; });
  }
  c.load(b.save(), b.limits());
  c.run();
  EXPECT_TRUE((whole->displacement.array() == second->displacement.array()).all());
  EXPECT_EQ(a.energy().values(), c.energy().values());
  const IntegratorState state = a.save();
  EXPECT_EQ(state.bodies[0].points.history, c.save().bodies[0].points.history);
  IntegratorState wrong = state;
  wrong.bodies[0].points.history.pop_back();
  EXPECT_THROW(c.load(wrong, a.limits()), InputError);
}

TEST(Integrator, ErodedPointsTakeTheirEnergyIntoTheBooks) {
  const TrimmedModel model = small_body(2);
  BodySettings settings = lumped();
  settings.kernel.erosion_J = 0.85;
  ExplicitBody body(model, settings, large_strain(0.3));
  body.set_velocity([](const Point3& x) { return Point3{-0.4 * (x[0] - 4.3), 0, 0}; });
  Integrator integrator({&body}, {.end_time = 1e9, .safety = 0.3, .max_steps = 400});
  integrator.start();
  integrator.run();
  EXPECT_GT(integrator.eroded(0), 0);
  EXPECT_LT(integrator.eroded(0), static_cast<std::int64_t>(model.points.weights.size()));
  EXPECT_GT(integrator.energy().eroded, 0);
  EXPECT_GT(integrator.energy().internal, -1e-3 * integrator.energy().eroded);
  EXPECT_LT(integrator.energy_error(), 1e-2);
}

TEST(Integrator, ABodyWithoutPointsHasFiniteFigures) {
  const TrimmedModel model = small_body(2);
  BodySettings settings = lumped();
  settings.kernel.erosion_J = 2; // all of them, at once
  ExplicitBody body(model, settings, large_strain(0.3));
  body.set_velocity([](const Point3&) { return Point3{1, 0, 0}; });
  Integrator integrator({&body}, {.end_time = 1});
  integrator.start();
  integrator.run();
  EXPECT_EQ(integrator.report(0).min_J, 0);
  EXPECT_EQ(integrator.report(0).step_factor, 1);
  EXPECT_TRUE(std::isfinite(integrator.dt()));
  EXPECT_EQ(integrator.time(), 1);
}

TEST(Integrator, ARunThatBlowsUpSaysWhenAndWhere) {
  const TrimmedModel model = small_body(2);
  ExplicitBody body(model, lumped(), large_strain(0.3));
  body.set_velocity(swirl);
  StartStep limit = body.start_step();
  limit.dt *= 1.5;
  Integrator integrator({&body}, {.end_time = 1e9, .safety = 1, .energy_limit = 0.5, .max_steps = 100000});
  integrator.start({limit});
  try {
    integrator.run();
    FAIL() << "a step beyond the critical one must end the run";
  } catch (const NumericalError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("t = "), std::string::npos) << text;
    EXPECT_NE(text.find("body 'part'"), std::string::npos) << text;
  }
}

TEST(Integrator, InvertedPointsAreCountedAndCanEndTheRun) {
  const TrimmedModel model = small_body(2);
  for (const bool stops : {false, true}) {
    BodySettings settings = lumped();
    settings.stop_at_inverted = stops;
    ExplicitBody body(model, settings, large_strain(0.3));
    body.set_velocity([](const Point3& x) { return Point3{x[0] > 4.3 ? -8.0 : 8.0, 0, 0}; });
    // Crushing is resisted ever more stiffly, in ever shorter steps: only until points are counted.
    Integrator integrator({&body}, {.end_time = 0.5, .safety = 0.1, .floor = 0, .max_steps = 5000});
    integrator.start();
    if (stops) {
      EXPECT_THROW(integrator.run(), NumericalError);
    } else {
      integrator.run();
    }
    EXPECT_GT(integrator.inverted(0), 0);
    EXPECT_GE(integrator.report(0).min_J_span, 0);
  }
}

namespace {

// The same acceleration of all nodes along x.
class Push final : public LoadSource {
 public:
  void add_forces(const StepTimes& times, std::span<const BodyState> bodies) override {
    for (const BodyState& body : bodies)
      for (Eigen::Index n = 0; n < body.masses->size(); ++n)
        (*body.force)[3 * n] += (*body.masses)[n] * std::sin(0.3 * times.time);
  }
};

} // namespace

TEST(Integrator, LoadsDoTheWorkThatTheBodyGains) {
  const TrimmedModel model = small_body(2);
  ExplicitBody body(model, lumped(), large_strain(0.3));
  Push push;
  Integrator integrator({&body}, {.end_time = 10, .largest_dt = 0.1});
  integrator.add(push);
  integrator.start();
  integrator.run();
  const double mass = body.mass().masses()->sum(), v = (1 - std::cos(3.0)) / 0.3;
  EXPECT_NEAR(integrator.energy().external / (0.5 * mass * v * v), 1, 2e-3);
  EXPECT_LT(integrator.energy_error(), 1e-10);
  EXPECT_LT(integrator.momentum(0).linear_error().norm(), 1e-12 * integrator.momentum(0).linear.norm());
}
