// Motion prescribed on a part of the surface: by springs within the budget of stability, and by projection.
#include "solver/explicit/loads/driven_region.hpp"
#include "solver/explicit/loads/projected_region.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "tests/solver/explicit/contact_scene.hpp"

#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

DrivenRegion grip() {
  DrivenRegion region;
  region.name = "grip";
  region.region.names = {"u-"};
  region.motion[0] = TimeCurve({0, 1, 2}, {0, 0.5, 0.5}, TimeCurve::Between::Smooth, "pull");
  region.motion[1] = TimeCurve(0.0);
  return region;
}

struct Pulled {
  double moved = 0; ///< the block's nodes in the mean, of 0.5
  double miss = 0;  ///< largest of the region beside its table
  double energy_error = 0;
};

// A trimmed block pulled by one of its faces. @tparam MakeDrive  of the body
template <class MakeDrive> Pulled pull(MassType mass, MakeDrive make_drive) {
  const TrimmedModel model = make_box_model(placed_box({0, 0, 0}, {3, 2, 2}, {4, 3, 3}, 2, 0.5));
  BodySettings settings;
  settings.mass = mass;
  if (mass == MassType::Lumped) settings.light = {LightFunctions::Linear, 0.05};
  ExplicitBody body(model, settings, NeoHookean{.lambda = 50, .mu = 40, .density = 1e-2});
  auto drive = make_drive(body);
  Integrator integrator({&body}, {.end_time = 2});
  integrator.add(drive);
  integrator.start();
  Pulled pulled;
  while (!integrator.finished()) {
    integrator.step();
    pulled.miss = std::max(pulled.miss, drive.largest_miss());
    if (integrator.time() > 0.5) pulled.energy_error = std::max(pulled.energy_error, integrator.energy_error());
  }
  const auto points = body.node_points();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    pulled.moved += body.displacement[3 * i] / static_cast<double>(points.rows());
  std::printf("[          ] moved %.4f of 0.5, largest miss %.3g, energy error %.2e\n", pulled.moved, pulled.miss,
              pulled.energy_error);
  return pulled;
}

} // namespace

TEST(RegionDrive, PullsABlockAlongItsTableAndBooksItsWork) {
  const Pulled pulled = pull(MassType::Lumped, [](const ExplicitBody& body) {
    DrivenRegion region = grip();
    region.motion[2] = TimeCurve(0.0);
    return RegionDrive(body.space(), 0, 1e-2, region);
  });
  EXPECT_NEAR(pulled.moved, 0.5, 0.01);
  EXPECT_LT(pulled.miss, 0.02);
  EXPECT_LT(pulled.energy_error, 1e-2);
}

TEST(ProjectedRegion, MovesARegionExactlyAndBooksItsWork) {
  for (const MassType mass : {MassType::Lumped, MassType::TwoPass}) {
    const Pulled pulled = pull(mass, [](const ExplicitBody& body) { return ProjectedRegion(body.space(), 0, grip()); });
    EXPECT_NEAR(pulled.moved, 0.5, 0.02);
    EXPECT_LT(pulled.miss, 1e-8);
    EXPECT_LT(pulled.energy_error, 1e-2);
  }
}
