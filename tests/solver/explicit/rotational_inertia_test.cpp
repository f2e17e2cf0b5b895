// Rotational inertia of mass matrices beside that of the quadrature points.
#include "solver/analysis/run_settings.hpp"
#include "solver/explicit/motion/rotational_inertia.hpp"

#include "tests/support/synthetic_model.hpp"

#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;

namespace {

constexpr double density = 1.6;

// A box of n spans of unit size a side that fills its grid.
TrimmedModel full_cube(std::int64_t n, int p) {
  const auto size = static_cast<double>(n);
  return test::make_box_model(
      {{0, 0, 0}, {size, size, size}, {n, n, n}, {p, p, p}, test::some_rotation(0.7), {0, 0, 0}, {size, size, size}});
}

double error_of(const TrimmedModel& model, MassType type, const Point3& axis = {}) {
  const SolutionSpace space(model, default_light_treatment(type));
  const Point3 centre = centre_of_mass(model);
  const MassOperator mass = make_mass(type, space, std::make_shared<const Connectivity>(space), density);
  return inertia_error(inertia_of_mass(mass, space.node_points(), centre), inertia_of_points(model, density, centre),
                       axis);
}

} // namespace

TEST(RotationalInertia, OfTheConsistentMassIsThatOfThePoints) {
  for (const int p : {1, 2, 3}) EXPECT_NEAR(error_of(full_cube(4, p), MassType::Consistent), 0, 1e-12);
}

// Row sums of n spans, p = 2: Σ N_i g_i² - x² is h²/4 inside and h²/6 on average in the spans at the ends.
TEST(RotationalInertia, OfTheLumpedMassIsTooLargeByTheSpreadOfTheFunctions) {
  for (const std::int64_t n : {4, 8, 16}) {
    const auto size = static_cast<double>(n);
    const double spread = ((size - 2) / 4 + 2.0 / 6) / size;
    EXPECT_NEAR(error_of(full_cube(n, 2), MassType::Lumped), 12 * spread / (size * size), 1e-12);
    EXPECT_NEAR(error_of(full_cube(n, 2), MassType::Lumped, {1, 2, -1}), 12 * spread / (size * size), 1e-12);
  }
}

TEST(RotationalInertia, OfTwoPassesIsFarBetter) {
  EXPECT_LT(std::abs(error_of(full_cube(4, 2), MassType::TwoPass)), 0.25 * error_of(full_cube(4, 2), MassType::Lumped));
}

TEST(RotationalInertia, IsWarnedOfWhereItIsWrongByTwoPercent) {
  const TrimmedModel coarse = full_cube(4, 2), fine = full_cube(12, 2);
  const auto warning = [](const TrimmedModel& model, MassType mass, const Point3& spin) {
    const ExplicitBody body(model, {.name = "top", .light = default_light_treatment(mass), .mass = mass},
                            LinearElastic(isotropic(2.5, 0.3, density)));
    return inertia_warning(body, spin).value_or("");
  };
  const std::string spinning = warning(coarse, MassType::Lumped, {0, 0, 1});
  EXPECT_NE(spinning.find("body 'top'"), std::string::npos) << spinning;
  EXPECT_NE(spinning.find("+15.6 % about the axis of its spin"), std::string::npos) << spinning;
  EXPECT_NE(spinning.find("mass = \"two-pass\" gives"), std::string::npos) << spinning;
  EXPECT_NE(warning(coarse, MassType::Lumped, {}).find("about its worst axis"), std::string::npos);
  EXPECT_EQ(warning(coarse, MassType::TwoPass, {0, 0, 1}), "");
  EXPECT_EQ(warning(fine, MassType::Lumped, {0, 0, 1}), ""); // 1.9 %
}
