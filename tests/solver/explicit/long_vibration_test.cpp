// Free vibration over 100 000 steps: neither energy nor momenta may creep.
#include "solver/explicit/motion/integrator.hpp"
#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;

TEST(LongVibration, KeepsEnergyAndMomentaOverAHundredThousandSteps) {
  const TrimmedModel model = test::make_box_model(
      {{0, 0, 0}, {9, 8, 8}, {9, 8, 8}, {2, 2, 2}, test::some_rotation(0.7), {3, 3, 3.3}, {5.6, 4.5, 4.4}});
  ExplicitBody body(model, {.name = "part", .light = {LightFunctions::Linear, 0.05}}, neo_hookean(2.5, 0.3, 1.6));
  body.set_velocity([](const Point3& x) {
    return Point3{0.1 * std::sin(x[1] + 0.3), 0.08 * std::cos(x[0] - x[2]) - 0.05 * x[1], 0.09 * std::sin(2 * x[0])};
  });
  Integrator integrator({&body}, {.end_time = 1e9, .safety = 0.9, .max_steps = 100000});
  integrator.start();
  double early = 0, late = 0;
  integrator.run([&](const Integrator& run) {
    double& worst = run.steps() < 10000 ? early : late;
    worst = std::max(worst, run.energy_error());
    return false;
  });
  EXPECT_EQ(integrator.steps(), 100000);
  EXPECT_LT(early, 1e-2);
  EXPECT_LT(late, 1e-2);
  EXPECT_LT(late - early, 2e-3);
  const MomentumBalance& m = integrator.momentum(0);
  EXPECT_LT(m.linear_error().norm(), 1e-11 * m.linear_start.norm());
  EXPECT_LT(m.angular_error().norm(), 1e-11 * m.angular_start.norm());
}
