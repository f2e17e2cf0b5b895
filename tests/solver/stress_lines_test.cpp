// Stress along lines through walls, singular places, principal stresses.
#include "format/model/errors.hpp"
#include "solver/stress/principal.hpp"
#include "solver/stress/singular_places.hpp"
#include "solver/stress/stress_lines.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

LinePoints line_through(const TrimmedModel& model, const Point3& from, const Point3& to) {
  StressLine line;
  line.name = "wall";
  line.where = "run.toml:7";
  line.from = from;
  line.to = to;
  return points_of(model, line);
}

// Stress zz = f(distance) along the line, tension p along it.
template <class Field> RecoveredStress stress_along(const LinePoints& line, Field field) {
  RecoveredStress stress;
  for (const double s : line.distance) {
    const std::array<double, 6> one{7, 0, field(s), 0, 0, 3};
    stress.stress.insert(stress.stress.end(), one.begin(), one.end());
    stress.von_mises.push_back(0);
    stress.error.push_back(0.5);
  }
  return stress;
}

TrimmedModel plate() {
  return make_part(box({-1, -1, -0.5}, {1, 1, 0.5}), {2, 0.4, 0.3, 0, rotation(20, 15)});
}

} // namespace

// Bending Mc/I: no membrane stress, no peak.
TEST(StressLines, TakeBendingFromMembrane) {
  const LinePoints line = line_through(plate(), {-1, 0, 0.1}, {1, 0.2, 0.1});
  const double t = std::sqrt(4.04);
  EXPECT_NEAR(line.length, t, 1e-12);
  double sum = 0;
  for (const double w : line.weight) sum += w;
  EXPECT_NEAR(sum, t, 1e-12);
  const LinearisedStress linear = linearise(line, stress_along(line, [t](double s) { return 12 * (1 - 2 * s / t); }));
  EXPECT_NEAR(linear.membrane[2], 0, 1e-12);
  EXPECT_NEAR(linear.bending[2], 12, 1e-11);
  EXPECT_NEAR(linear.peak[0][2], 0, 1e-11);
  EXPECT_NEAR(linear.peak[1][2], 0, 1e-11);
  EXPECT_NEAR(linear.membrane[0], 7, 1e-12);
  EXPECT_EQ(linear.error, 0.5);
}

// σ = s³: membrane t³/4, bending at the start -0.45 t³.
TEST(StressLines, LeavesThePeakOfACubicStress) {
  const LinePoints line = line_through(plate(), {-1, 0, 0.1}, {1, 0, 0.1});
  const LinearisedStress linear = linearise(line, stress_along(line, [](double s) { return s * s * s; }));
  EXPECT_NEAR(linear.membrane[2], 2, 1e-12);
  EXPECT_NEAR(linear.bending[2], -3.6, 1e-11);
  EXPECT_NEAR(linear.peak[1][2], 8 - 2 - 3.6, 1e-11);
  EXPECT_NEAR(linear.bending[0], 0, 1e-12); // along the line
  EXPECT_NEAR(linear.bending[5], 0, 1e-12); // shear with it
}

TEST(StressLines, RefuseWhatLeavesThePart) {
  try {
    line_through(plate(), {-1, 0, 0.1}, {1.5, 0, 0.1});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("run.toml:7: line 'wall'"), std::string::npos) << error.what();
  }
}

TEST(SingularPlaces, AreReentrantEdgesAndEndsOfSupports) {
  const std::vector<std::array<double, 2>> corner{{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}};
  const TriangleMesh mesh = prism(corner, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 0, 2);
  const TrimmedModel model = make_part(mesh, {2, 0.4, 0.3, 0, identity_rotation});
  Support support;
  support.name = "foot";
  support.region.normal = RegionChoice::Direction{{0, -1, 0}, 1};
  const std::vector<Support> supports{support};
  const SingularPlaces places(model, supports, {});
  EXPECT_EQ(places.near({2.1, 2.1, 1}), "a sharp re-entrant edge");
  EXPECT_EQ(places.near({0, 0.3, 1}), "the end of support 'foot'");
  EXPECT_EQ(places.near({0, 3, 1}), std::nullopt);
  const std::vector<std::pair<std::string, RegionReport>> none;
  Support sliding = support; // the part goes on beyond a plane of symmetry
  sliding.along_normal = true;
  EXPECT_EQ(SingularPlaces(model, std::vector{sliding}, none).near({0, 0.3, 1}), std::nullopt);
}

TEST(PrincipalStresses, AreSortedAndKeepTheInvariants) {
  Voigt s;
  s << 3, -1, 2, 0.5, -0.7, 1.1;
  const Eigen::Vector3d p = principal_stresses(s);
  EXPECT_GE(p[0], p[1]);
  EXPECT_GE(p[1], p[2]);
  EXPECT_NEAR(p.sum(), 4, 1e-12);
  EXPECT_NEAR(std::sqrt(0.5 * (std::pow(p[0] - p[1], 2) + std::pow(p[1] - p[2], 2) + std::pow(p[2] - p[0], 2))),
              von_mises(s), 1e-12);
}
