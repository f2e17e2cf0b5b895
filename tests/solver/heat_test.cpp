// Steady conduction of heat: exact fields, balance, convergence, refusals.
#include "solver/analysis/heat_analysis.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include "format/model/errors.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr double k = 0.7;

HeatBoundary boundary(HeatKind kind, double value, std::optional<Point3> normal = {}, double ambient = 0) {
  HeatBoundary one;
  one.name = "heat";
  one.kind = kind;
  one.value = value;
  one.ambient = ambient;
  if (normal) one.region.normal = RegionChoice::Direction{*normal, 1};
  return one;
}

RunSettings run_of(std::vector<HeatBoundary> heat) {
  RunSettings run;
  run.material = isotropic(1, 0, 1);
  run.material.conductivity = k;
  run.heat = std::move(heat);
  return run;
}

// Largest error of the temperature at the quadrature points of volume and surface.
double temperature_error(const SolutionSpace& space, const HeatSolution& s,
                         const std::function<double(const Point3&)>& exact) {
  const TrimmedModel& model = space.model();
  double error = 0;
  for (std::int64_t a = 0; a < space.num_cells(); ++a)
    for (const auto parameters : {cell_parameters(model, a), surface_parameters(model, a)}) {
      const std::vector<std::int64_t> cells(parameters.size() / 3, a);
      const HeatSamples samples = sample_heat(space, k, s.temperature, cells, parameters);
      for (std::size_t q = 0; q < cells.size(); ++q)
        error = std::max(
            error,
            std::abs(samples.temperature[q] -
                     exact(model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]}))));
    }
  return error;
}

TrimmedModel wall(int degree, int moment_degree = 0) {
  return make_part(box({0, 0, 0}, {1, 0.6, 0.5}), {degree, 0.3, 0.4, moment_degree, rotation(23, 11)});
}

} // namespace

// Two temperatures: T linear, power k A ΔT / L, at every degree and any cut.
TEST(Heat, LinearFieldBetweenTwoTemperaturesIsExact) {
  for (const int degree : {1, 2, 3}) {
    const TrimmedModel model = wall(degree);
    const SolutionSpace space(model, usual());
    const HeatSolution s = run_heat(run_of({boundary(HeatKind::Temperature, 100, Point3{-1, 0, 0}),
                                            boundary(HeatKind::Temperature, 20, Point3{1, 0, 0})}),
                                    space);
    EXPECT_LT(temperature_error(space, s, [](const Point3& x) { return 100 - 80 * x[0]; }), 1e-9) << degree;
    EXPECT_NEAR(s.result.boundaries[0].power, k * 0.3 * 80, 1e-9) << degree;
    EXPECT_NEAR(s.result.boundaries[0].temperature, 100, 1e-9) << degree;
    EXPECT_NEAR(s.balance, 0, 1e-10) << degree;
    EXPECT_NEAR(s.least, 20, 0.5);
  }
}

// A source and a flux: T = T0 + q/k x + s/k (L x - x²/2), of degree 2.
TEST(Heat, QuadraticFieldWithSourceFluxAndPowerIsExact) {
  const TrimmedModel model = wall(2, 4);
  const SolutionSpace space(model, usual());
  for (const bool total : {false, true}) {
    const HeatSolution s = run_heat(run_of({boundary(HeatKind::Temperature, 5, Point3{-1, 0, 0}),
                                            total ? boundary(HeatKind::Power, 3 * 0.3, Point3{1, 0, 0})
                                                  : boundary(HeatKind::Flux, 3, Point3{1, 0, 0}),
                                            boundary(HeatKind::Source, 11)}),
                                    space);
    EXPECT_LT(temperature_error(space, s,
                                [](const Point3& x) { return 5 + 3 / k * x[0] + 11 / k * (x[0] - 0.5 * x[0] * x[0]); }),
              1e-9);
    EXPECT_NEAR(s.result.boundaries[0].power, -(3 * 0.3 + 11 * 0.3), 1e-9);
    EXPECT_NEAR(s.result.boundaries[1].power, 0.9, 1e-12);
    EXPECT_NEAR(s.result.boundaries[2].power, 3.3, 1e-11);
    EXPECT_NEAR(s.balance, 0, 1e-9);
  }
}

// Film on both sides: resistances in series 1/h₁ + L/k + 1/h₂.
TEST(Heat, ConvectionOnBothSidesIsExact) {
  const TrimmedModel model = wall(2);
  const SolutionSpace space(model, usual());
  const double h1 = 2, h2 = 5, q = (90.0 - 10) / (1 / h1 + 1 / k + 1 / h2);
  const HeatSolution s = run_heat(run_of({boundary(HeatKind::Convection, h1, Point3{-1, 0, 0}, 90),
                                          boundary(HeatKind::Convection, h2, Point3{1, 0, 0}, 10)}),
                                  space);
  EXPECT_LT(temperature_error(space, s, [&](const Point3& x) { return 90 - q / h1 - q / k * x[0]; }), 1e-9);
  EXPECT_NEAR(s.result.boundaries[0].power, 0.3 * q, 1e-9);
  EXPECT_NEAR(s.balance, 0, 1e-10);
}

// A square bar with a source, its sides at 0: the series of Poisson's problem. Cut cells, corners of 90°.
TEST(Heat, ConvergesOnACutSquareBar) {
  const auto error_at = [](double span) {
    const TrimmedModel model = make_part(box({0, 0, 0}, {1, 1, 0.3}), {2, span, 0.3, 0, identity_rotation});
    const SolutionSpace space(model, usual());
    std::vector<HeatBoundary> heat{boundary(HeatKind::Source, k)};
    for (const Point3& n : {Point3{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}})
      heat.push_back(boundary(HeatKind::Temperature, 0, n));
    const auto exact = [](const Point3& x) {
      constexpr double pi = std::numbers::pi;
      double T = 0.5 * x[0] * (1 - x[0]);
      for (int n = 1; n < 60; n += 2)
        T -= 4 / std::pow(n * pi, 3) * std::sin(n * pi * x[0]) * std::cosh(n * pi * (x[1] - 0.5)) /
             std::cosh(n * pi / 2);
      return T;
    };
    return temperature_error(space, run_heat(run_of(heat), space), exact);
  };
  const double coarse = error_at(0.2), fine = error_at(0.1);
  EXPECT_GT(std::log2(coarse / fine), 1.8); // of the largest error, which lies in the corners: T ~ r² ln r there
  EXPECT_LT(fine, 1e-3);
}

TEST(Heat, TemperatureOfItsCoefficientsIsTheField) {
  const TrimmedModel model = wall(2);
  const SolutionSpace space(model, usual());
  const HeatSolution s = run_heat(run_of({boundary(HeatKind::Temperature, 100, Point3{-1, 0, 0}),
                                          boundary(HeatKind::Convection, 3, Point3{0, 1, 0}, 20)}),
                                  space);
  const auto field = spline_temperature(model, s.result.temperature);
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const auto parameters = cell_parameters(model, a);
    const std::vector<std::int64_t> cells(parameters.size() / 3, a);
    const HeatSamples samples = sample_heat(space, k, s.temperature, cells, parameters);
    const Eigen::VectorXd T = field->at(a, parameters);
    for (std::size_t q = 0; q < cells.size(); ++q)
      EXPECT_NEAR(T[static_cast<Eigen::Index>(q)], samples.temperature[q], 1e-10);
  }
}

TEST(Heat, RefusesWhatHasNoAnswer) {
  const TrimmedModel model = wall(1);
  const SolutionSpace space(model, usual());
  const auto message_of = [&](const RunSettings& run) -> std::string {
    try {
      run_heat(run, space);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(
      message_of(run_of({boundary(HeatKind::Flux, 1, Point3{1, 0, 0})})).find("nothing determines the temperature"),
      std::string::npos);
  EXPECT_NE(message_of(run_of({})).find("no [[heat]]"), std::string::npos);
  RunSettings none = run_of({boundary(HeatKind::Temperature, 1, Point3{1, 0, 0})});
  none.material.conductivity.reset();
  EXPECT_NE(message_of(none).find("conductivity"), std::string::npos);
}
