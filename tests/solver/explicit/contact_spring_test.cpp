// The spring of one touch: its force is the derivative of its potential, and whatever happens to its stiffness it never
// gives back more than it took.
#include "solver/explicit/contact/contact_spring.hpp"

#include <gtest/gtest.h>

#include <random>

namespace iga::solve {
namespace {

TEST(DepthPotential, ForceAndStiffnessAreItsDerivatives) {
  for (const double largest : {1.0, 5.0, 300.0, DepthPotential::hardest}) {
    const DepthPotential potential{3, largest};
    for (double e = 0.05; e < 3.5; e += 0.0371) {
      const double step = 1e-5;
      const auto low = potential.at(e - step), here = potential.at(e), high = potential.at(e + step);
      EXPECT_NEAR((high.energy - low.energy) / (2 * step), here.force, 1e-6 * here.force + 1e-9) << e;
      // The stiffness has a corner where the spring begins to stiffen and where its parabola begins.
      EXPECT_NEAR((high.force - low.force) / (2 * step), here.stiffness, 2e-3 * here.stiffness) << e;
      EXPECT_GE(high.stiffness, here.stiffness);
      EXPECT_LE(here.stiffness, std::max(largest, 1.0) * (1 + 1e-12));
    }
  }
}

TEST(DepthPotential, IsLinearToAThirdAndGrowsWithoutBoundTowardsTheLimit) {
  const DepthPotential potential{3, 1e300};
  EXPECT_EQ(potential.at(1).force, 1);
  EXPECT_EQ(potential.at(1).stiffness, 1);
  EXPECT_NEAR(potential.at(2).stiffness, 15, 1e-12);     // q = 2
  EXPECT_NEAR(potential.at(2.9).stiffness, 15999, 1e-6); // q = 20, from where on it would be a parabola
  EXPECT_GT(potential.at(2.9).force, 700);
  EXPECT_EQ(potential.at(-1).energy, 0);
}

TEST(SpringEnergy, ALastingSpringIsLeftAlone) {
  const DepthPotential potential{1, DepthPotential::hardest};
  SpringEnergy spring;
  for (int i = 0; i < 1000; ++i) {
    const double e = 0.9 * std::abs(std::sin(0.01 * i));
    spring.take_over(7, potential);
    EXPECT_EQ(spring.move_to(e, 7, potential).force, potential.at(e).force);
    EXPECT_LE(spring.reserve, 1e-14 * (1 + spring.stored));
  }
  EXPECT_EQ(spring.shift, 0);
}

// Depth goes in and out while the stiffness, and how far it may grow, jump about.
TEST(SpringEnergy, GivesBackNoMoreThanItTook) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int run = 0; run < 200; ++run) {
    SpringEnergy spring;
    double work = 0, largest = 0, last_depth = 0, last_force = 0; // work put in, trapezoidal
    const double speed = 1e-3 * (1 + 5 * unit(random));
    double k = 1, ratio = 10;
    for (int i = 0; i < 4000; ++i) {
      if (unit(random) < 0.02) k = std::pow(10, 3 * unit(random) - 2); // 0.01 … 10, as a face turns into the contact
      if (unit(random) < 0.02) ratio = std::pow(10, 3 * unit(random));
      const DepthPotential potential{1, ratio};
      const double depth = std::max(0.0, 0.8 * std::sin(speed * i) + 0.1 * std::sin(7 * speed * i));
      spring.take_over(k, potential);
      spring.shift = std::min(spring.shift, depth);
      const double force = k * spring.move_to(depth - spring.shift, k, potential).force;
      EXPECT_GE(force, 0);
      EXPECT_GE(spring.reserve, 0);
      work += 0.5 * (last_force + force) * (depth - last_depth);
      largest = std::max(largest, work);
      EXPECT_GE(work, -0.02 * largest - 1e-6) << run << " " << i;
      last_depth = depth;
      last_force = force;
    }
  }
}

// What made 4765 of 400: a touch that had no area behind it goes deep without force, then its faces turn back.
TEST(SpringEnergy, AStiffSpringDoesNotAppearAtDepth) {
  const DepthPotential potential{10, DepthPotential::hardest};
  SpringEnergy spring;
  double work = 0, last = 0;
  for (int i = 1; i <= 2000; ++i) {
    const double depth = i <= 1000 ? 5e-3 * i : 5e-3 * (2000 - i), k = i <= 1000 ? 1e-4 : 100;
    spring.take_over(k, potential);
    spring.shift = std::min(spring.shift, depth);
    const double force = k * spring.move_to(depth - spring.shift, k, potential).force;
    work += 0.5 * (last + force) * (i <= 1000 ? 5e-3 : -5e-3);
    last = force;
  }
  EXPECT_GE(work, -1e-4);
  EXPECT_LE(work, 1e-4 * 20); // half of k d² at most
}

} // namespace
} // namespace iga::solve
