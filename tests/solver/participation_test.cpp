// Effective masses against closed forms and sums; all modes below a frequency.
#include "solver/analysis/participation.hpp"

#include "format/model/errors.hpp"
#include "tests/solver/eigen_support.hpp"
#include "tests/solver/static_support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using namespace iga;
using namespace iga::solve;

namespace {

const ElasticMaterial no_poisson = isotropic(1, 0, 1); // a rod's waves travel at speed 1

TrimmedModel rod(int spans = 12) {
  return test::make_box_model(test::box_in_grid({1, 0.1, 0.1}, {spans, 1, 1}, 3));
}

// Held at x = 0 along x, guided on the sides: modes along x are those of the rod.
RunSettings held_rod() {
  Support end, sides;
  end.name = "end";
  end.region.normal = RegionChoice::Direction{{-1, 0, 0}, 1};
  end.fixed = {true, false, false};
  sides.name = "sides";
  sides.along_normal = true;
  sides.region.box = Box3{{-1, -1, -1}, {2, 1e-9, 2}};
  Support bottom = sides;
  bottom.region.box = Box3{{-1, -1, -1}, {2, 2, 1e-9}};
  RunSettings run = test::run_with({end, sides, bottom});
  run.material = no_poisson;
  return run;
}

} // namespace

TEST(Participation, RigidModesOfAFreeBodyCarryTheWholeMass) {
  for (const MassType type : {MassType::Consistent, MassType::Lumped}) {
    const test::System s(test::make_box_model(test::box_in_grid({3, 2, 1}, {3, 2, 2}, 2, 0.6)), isotropic(2, 0.3, 5),
                         type);
    const ModeSet modes = lowest_modes(s.problem(), {.modes = 4, .sturm = true});
    const Participation p = participation(BodySystem(s.space, s.material), s.M, modes.vectors);
    const double mass = 5 * 6;
    ASSERT_EQ(modes.rigid, 6);
    const Eigen::MatrixXd sums = p.summed_shares();
    for (Eigen::Index d = 0; d < 6; ++d) {
      EXPECT_NEAR(sums(5, d), 1, 1e-10) << "direction " << d;
      EXPECT_NEAR(sums(9, d), 1, 1e-10) << "direction " << d;
    }
    for (Eigen::Index d = 0; d < 3; ++d) EXPECT_NEAR(p.total[d], mass, 1e-10 * mass);
    EXPECT_NEAR(p.centre[0], 1.5, 1e-10);
    EXPECT_NEAR(p.centre[1], 1, 1e-10);
    EXPECT_NEAR(p.centre[2], 0.5, 1e-10);
    // Row sums keep mass and centre, but no second moments.
    if (type != MassType::Consistent) continue;
    EXPECT_NEAR(p.total[3], mass * (4 + 1) / 12, 1e-10 * mass);
    EXPECT_NEAR(p.total[4], mass * (9 + 1) / 12, 1e-10 * mass);
    EXPECT_NEAR(p.total[5], mass * (9 + 4) / 12, 1e-10 * mass);
  }
}

TEST(Participation, AllModesOfAHeldBodyTogetherHoldTheWholeMass) {
  const TrimmedModel model = rod(2);
  EigenSettings settings;
  settings.modes_below = 1e6;
  const EigenOutcome outcome = analyse_modes(held_rod(), settings, model);
  EXPECT_EQ(outcome.modes.rigid, 0);
  EXPECT_EQ(outcome.modes.elastic, outcome.unknowns);
  const Eigen::MatrixXd sums = outcome.participation.summed_shares();
  for (Eigen::Index d = 0; d < 6; ++d) EXPECT_NEAR(sums(sums.rows() - 1, d), 1, 1e-9) << "direction " << d;
}

TEST(Participation, AxialModesOfAClampedRodHoldTheirKnownShares) {
  const TrimmedModel model = rod();
  // Below the third axial one, 5/4; those of shear have the speed √½: 0.177, 0.53, 0.884, 1.24.
  EigenSettings settings;
  settings.modes_below = 1.3;
  const EigenOutcome outcome = analyse_modes(held_rod(), settings, model);
  std::vector<double> found;
  const Eigen::MatrixXd masses = outcome.participation.effective_masses() / outcome.mass;
  for (Eigen::Index m = 0; m < masses.rows(); ++m)
    if (masses(m, 0) > 1e-3) found.push_back(masses(m, 0));
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t n = 1; n <= 3; ++n)
    EXPECT_NEAR(found[n - 1], 8 / std::pow(std::numbers::pi * (2.0 * static_cast<double>(n) - 1), 2), 1e-4)
        << "mode " << n;
}

TEST(ModesBelow, AreTheSameWhetherCountedOrSearched) {
  const test::System s(test::make_box_model(test::box_in_grid({1, 1, 1}, {3, 3, 3}, 2, 0.6)), isotropic(2.6, 0.3, 1));
  const ModeSet many = lowest_modes(s.problem(), {.modes = 40, .sturm = true});
  const auto omega = [&](Eigen::Index k) { return std::sqrt(many.lambda[6 + k]); };
  for (const Eigen::Index last : {0, 7, 13, 24}) {
    // Between two modes that are no multiplet.
    Eigen::Index k = last;
    while (omega(k + 1) - omega(k) < 1e-3) ++k;
    EigenSettings settings;
    settings.modes_below = 0.5 * (omega(k) + omega(k + 1)) / (2 * std::numbers::pi);
    for (const bool sturm : {true, false}) {
      settings.sturm = sturm;
      const ModeSet set = lowest_modes(s.problem(), settings);
      ASSERT_EQ(set.elastic, k + 1) << (sturm ? "counted" : "searched");
      EXPECT_EQ(set.sturm.has_value(), sturm);
      for (Eigen::Index m = 0; m <= k; ++m)
        EXPECT_NEAR(set.lambda[6 + m], many.lambda[6 + m], 1e-8 * many.lambda[6 + m]);
      EXPECT_TRUE(set.warnings.empty());
    }
  }
}

TEST(ModesBelow, ALimitBelowAllGivesTheFirstAndSaysSo) {
  const test::System s(test::make_box_model(test::box_in_grid({1, 1, 1}, {2, 2, 2}, 2)), isotropic(2.6, 0.3, 1));
  EigenSettings settings;
  settings.modes_below = 1e-3;
  const ModeSet set = lowest_modes(s.problem(), settings);
  EXPECT_EQ(set.rigid, 6);
  EXPECT_GE(set.elastic, 1);
  ASSERT_EQ(set.warnings.size(), 1U);
  EXPECT_NE(set.warnings[0].find("no elastic mode lies below"), std::string::npos);
}

TEST(ModesBelow, TooManyAreRefusedWithTheirNumber) {
  const test::System s(test::make_box_model(test::box_in_grid({1, 1, 1}, {8, 7, 7}, 2)), isotropic(2.6, 0.3, 1));
  ASSERT_GT(s.K.size(), most_modes_below + 6);
  EigenSettings settings;
  settings.modes_below = 1e6;
  try {
    lowest_modes(s.problem(), settings);
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(fmt::format("{} elastic modes lie below", s.K.size() - 6)),
              std::string::npos)
        << error.what();
  }
}
