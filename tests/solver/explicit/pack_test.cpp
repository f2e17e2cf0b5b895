#include "solver/explicit/laws/principal.hpp"
#include "solver/explicit/simd/pack_math.hpp"
#include "tests/solver/explicit/law_driver.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

// Values over many magnitudes: largest error in units of the last place of `exact`.
template <class Function, class Exact>
double worst_ulps(Function function, Exact exact, double first, double last, bool geometric) {
  double worst = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; i += pack_size) {
    Pack x;
    for (int l = 0; l < pack_size; ++l) {
      const double s = (i + l) / static_cast<double>(n - 1);
      x[l] = geometric ? first * std::pow(last / first, s) : first + (last - first) * s;
    }
    const Pack y = function(x);
    for (int l = 0; l < pack_size; ++l) {
      const double e = exact(x[l]), ulp = std::nextafter(std::abs(e), INFINITY) - std::abs(e);
      worst = std::max(worst, std::abs(y[l] - e) / ulp);
    }
  }
  return worst;
}

TEST(PackMath, LogarithmIsRightToOneUnitInTheLastPlace) {
  const auto exact = [](double x) { return std::log(x); };
  EXPECT_LE(worst_ulps([](const Pack& x) { return log(x); }, exact, 1e-300, 1e300, true), 1.0);
  EXPECT_LE(worst_ulps([](const Pack& x) { return log(x); }, exact, 0.5, 2, false), 1.0);
  EXPECT_EQ(log(pack(1))[0], 0.0);
}

TEST(PackMath, ExponentialIsRightToOneUnitInTheLastPlace) {
  const auto exact = [](double x) { return std::exp(x); };
  EXPECT_LE(worst_ulps([](const Pack& x) { return exp(x); }, exact, -700, 700, false), 1.0);
  EXPECT_LE(worst_ulps([](const Pack& x) { return exp(x); }, exact, -1, 1, false), 1.0);
  EXPECT_TRUE(std::isfinite(exp(pack(1e9))[0]));
}

TEST(PackMath, PowersAndCubeRoots) {
  EXPECT_LE(worst_ulps([](const Pack& x) { return cbrt(x); }, [](double x) { return std::cbrt(x); }, 1e-6, 1e6, true),
            4.0);
  EXPECT_LE(
      worst_ulps([](const Pack& x) { return pow(x, 0.2); }, [](double x) { return std::pow(x, 0.2); }, 1e-6, 1e6, true),
      8.0);
}

PackSymmetric symmetric(const Eigen::Matrix3d& m) {
  return {{pack(m(0, 0)), pack(m(1, 1)), pack(m(2, 2)), pack(m(0, 1)), pack(m(1, 2)), pack(m(2, 0))}};
}

Eigen::Matrix3d matrix(const PackSymmetric& s) {
  Eigen::Matrix3d m;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) m(a, b) = s(a, b)[0];
  return m;
}

// Principal values that are distinct, equal in pairs, equal up to a small gap, all equal, zero.
std::vector<Eigen::Vector3d> principal_values() {
  std::vector<Eigen::Vector3d> all{{0, 0, 0},  {1, 1, 1},  {-3, -3, -3}, {1, 0, 0},           {0, 0, -1},
                                   {2, 2, -1}, {1, -1, 0}, {5, 4, 3},    {1e-9, 2e-9, -5e-9}, {1e6, 1, 1e-6}};
  for (double gap = 1e-1; gap > 1e-17; gap /= 7) {
    all.emplace_back(1 + gap, 1, -1);
    all.emplace_back(-1 - gap, -1, 2);
    all.emplace_back(1 + gap, 1, 1 - gap / 2);
  }
  return all;
}

TEST(PrincipalValues, CuttingIsAccurateAlsoForEqualValues) {
  RandomTensors random;
  for (const Eigen::Vector3d& values : principal_values()) {
    const double scale = values.cwiseAbs().maxCoeff();
    for (int turn = 0; turn < 20; ++turn) {
      const Eigen::Matrix3d R = turn ? random.turn() : Eigen::Matrix3d::Identity();
      const Eigen::Matrix3d a = R * values.asDiagonal() * R.transpose();
      for (const double limit : {0.3 * scale, 0.999 * scale, scale, 2 * scale}) {
        const auto cut = [&](double x) { return std::clamp(x, -limit, 0.5 * limit); };
        const Eigen::Matrix3d exact = R * values.unaryExpr(cut).asDiagonal() * R.transpose();
        const PackSymmetric result = isotropic_function(
            symmetric((a + a.transpose()) / 2), [&](const Pack& s) { return min(max(s, -limit), 0.5 * limit); });
        EXPECT_LE((matrix(result) - exact).cwiseAbs().maxCoeff(), 1e-14 * scale) << values.transpose();
      }
    }
  }
}

TEST(PrincipalValues, TheTestWhetherAllLieInsideIsExact) {
  RandomTensors random;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d values = random.tensor(1).col(0);
    const Eigen::Matrix3d R = random.turn(), a = R * values.asDiagonal() * R.transpose();
    for (const double margin : {-1e-3, 1e-3}) {
      const bool low_inside = any(principal_values_inside(symmetric(a), pack(values.minCoeff() - margin), pack(2)));
      const bool high_inside = any(principal_values_inside(symmetric(a), pack(-2), pack(values.maxCoeff() + margin)));
      EXPECT_EQ(low_inside, margin > 0);
      EXPECT_EQ(high_inside, margin > 0);
    }
  }
}

} // namespace
} // namespace iga::solve
