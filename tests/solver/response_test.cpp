// Modal superposition against closed forms: single oscillators, rods, statics.
#include "format/model/errors.hpp"
#include "solver/analysis/static_analysis.hpp"
#include "solver/response/harmonic.hpp"
#include "solver/response/oscillator.hpp"
#include "solver/response/random.hpp"
#include "solver/response/response_tables.hpp"
#include "solver/response/rms_fields.hpp"
#include "solver/response/stress_forms.hpp"
#include "solver/response/transient.hpp"
#include "tests/solver/eigen_support.hpp"

#include <complex>
#include <numbers>

namespace iga::test {

using namespace solve;

namespace {

using Eigen::Index;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi, two_pi = 2 * pi;

NumberCurve constant(double value) {
  return {{0}, {value}, "here"};
}

NumberCurve curve(std::vector<double> x, std::vector<double> y) {
  return {std::move(x), std::move(y), "here"};
}

// Oscillators side by side on a base, each seen by a probe of its own: relative displacement q_j along x.
ResponseSystem oscillators(const std::vector<double>& frequencies, const std::vector<double>& ratios) {
  ResponseSystem system;
  const auto n = static_cast<Index>(frequencies.size());
  system.basis.elastic = n;
  system.basis.lambda.resize(n);
  system.damping.c.resize(n);
  for (Index j = 0; j < n; ++j) {
    const double omega = two_pi * frequencies[static_cast<std::size_t>(j)];
    system.basis.lambda[j] = omega * omega;
    system.damping.c[j] = 2 * ratios[static_cast<std::size_t>(j)] * omega;
    system.observed.probes.push_back(std::to_string(j));
  }
  system.observed.displacement = Eigen::MatrixXd::Zero(3 * n, n);
  system.observed.stress = Eigen::MatrixXd::Zero(6 * n, n);
  for (Index j = 0; j < n; ++j) {
    system.observed.displacement(3 * j, j) = 1;
    system.observed.stress(6 * j, j) = system.basis.lambda[j]; // of a spring
  }
  system.modal_loads = -Eigen::MatrixXd::Ones(n, 1);
  system.excitations.push_back({"base", true, 1, {}});
  system.base_direction = Point3{1, 0, 0};
  return system;
}

ResponseSettings shaken(ResponseSystem& system, const Variation& variation) {
  system.excitations[0].variation = variation;
  ResponseSettings settings;
  settings.base = BaseMotion{{1, 0, 0}, false, {}, variation};
  return settings;
}

Variation noise(NumberCurve psd) {
  Variation v;
  v.psd = std::move(psd);
  return v;
}

Variation over_time(NumberCurve history) {
  Variation v;
  v.history = std::move(history);
  return v;
}

} // namespace

// ----------------------------------------------------------------------------------------------------- one oscillator

TEST(OscillatorStep, IsTheSameInTwoHalvesWhateverTheDamping) {
  for (const double lambda : {0.0, 1e-6, 0.3, 0.999999, 1.000001, 7.0, 1e4, 1e9})
    for (const double ratio : {0.0, 0.01, 0.7, 1.0, 1 + 1e-9, 1.3, 40.0}) {
      const double c = 2 * ratio * std::sqrt(lambda);
      const OscillatorStep whole(lambda, c, 1), half(lambda, c, 0.5);
      const auto middle = half.advance({0.3, -0.2}, 1.5, 0.5), twice = half.advance(middle, 0.5, -0.5);
      const auto once = whole.advance({0.3, -0.2}, 1.5, -0.5);
      const double speed = 1 + std::sqrt(lambda);
      EXPECT_NEAR(once[0], twice[0], 1e-11 * (1 + ratio)) << lambda << " " << ratio;
      EXPECT_NEAR(once[1], twice[1], 1e-11 * speed * (1 + ratio)) << lambda << " " << ratio;
    }
}

TEST(OscillatorStep, FollowsConstantAndGrowingForces) {
  const auto free = OscillatorStep(0, 0, 2).advance({1, 3}, 0.6, 1.8);
  EXPECT_NEAR(free[0], 1 + 3 * 2 + 4 * (0.6 / 3 + 1.8 / 6), 1e-13);
  EXPECT_NEAR(free[1], 3 + 2 * 1.2, 1e-13);
  const double omega = 5, zeta = 0.1, t = 0.8, wd = omega * std::sqrt(1 - zeta * zeta);
  const auto jump = OscillatorStep(omega * omega, 2 * zeta * omega, t).advance({0, 0}, 1, 1);
  const double decay = std::exp(-zeta * omega * t);
  EXPECT_NEAR(jump[0], (1 - decay * (std::cos(wd * t) + zeta * omega / wd * std::sin(wd * t))) / 25, 1e-15);
  // A rigid motion that is braked: q̇ = (p / c) (1 - e^(-c t)).
  const auto braked = OscillatorStep(0, 3, 2).advance({0, 0}, 1, 1);
  EXPECT_NEAR(braked[1], (1 - std::exp(-6.0)) / 3, 1e-14);
  EXPECT_NEAR(braked[0], 2.0 / 3 - (1 - std::exp(-6.0)) / 9, 1e-14);
}

TEST(Transient, HalfSineShockOfAnUndampedOscillator) {
  const double f = 10, duration = 0.04, amplitude = 3;
  std::vector<double> times, values;
  constexpr int pieces = 4000;
  for (int k = 0; k <= pieces; ++k) {
    times.push_back(duration * k / pieces);
    values.push_back(k == pieces ? 0 : amplitude * std::sin(pi * k / pieces));
  }
  ResponseSystem system = oscillators({f}, {0});
  ResponseSettings settings = shaken(system, over_time(curve(times, values)));
  settings.transient.end = 0.15;
  settings.transient.step = 0.001;
  const TransientResponse response = transient_response(system, settings);
  // q̈ + ω² q = -A sin(Ω t) until the end of the pulse, then free.
  const double omega = two_pi * f, big = pi / duration, scale = -amplitude / (omega * omega - big * big);
  const auto during = [&](double t) { return scale * (std::sin(big * t) - big / omega * std::sin(omega * t)); };
  const auto rate = [&](double t) { return scale * big * (std::cos(big * t) - std::cos(omega * t)); };
  const double largest = amplitude / (omega * omega);
  for (std::size_t k = 0; k < response.times.size(); ++k) {
    const double t = response.times[k], after = t - duration;
    const double exact =
        after <= 0 ? during(t)
                   : during(duration) * std::cos(omega * after) + rate(duration) / omega * std::sin(omega * after);
    EXPECT_NEAR(response.modal(0, static_cast<Index>(k)), exact, 2e-7 * largest) << t; // of the straight pieces
  }
  EXPECT_NEAR(response.base(1, response.base.cols() - 1), 2 * amplitude * duration / pi, 1e-7);
}

TEST(Transient, ASlowLoadIsStatic) {
  ResponseSystem system = oscillators({10, 25}, {0.02, 0.02});
  ResponseSettings settings = shaken(system, over_time(curve({0, 1000}, {0, 2})));
  settings.transient.end = 1000;
  settings.transient.step = 100;
  const TransientResponse response = transient_response(system, settings);
  for (Index j = 0; j < 2; ++j) {
    const double omega = std::sqrt(system.basis.lambda[j]), lag = system.damping.c[j] * 0.002 / std::pow(omega, 4);
    EXPECT_NEAR(response.modal(j, response.modal.cols() - 1), -2 / (omega * omega) + lag, 1e-10 * 2 / (omega * omega));
  }
}

TEST(Random, MilesEquationOfWhiteNoise) {
  const double f = 37, zeta = 0.013, density = 0.2;
  ResponseSystem system = oscillators({f}, {zeta});
  ResponseSettings settings = shaken(system, noise(constant(density)));
  settings.random.from = 0;
  settings.random.to = 1e9 * f;
  const RandomResponse response = random_response(system, settings);
  const double omega = two_pi * f, q = density / (8 * zeta * std::pow(omega, 3));
  EXPECT_NEAR(response.covariance(0, 0) / q, 1, 1e-9);
  EXPECT_NEAR(response.rates(0, 0) / (q * omega * omega), 1,
              1e-6); // the rest beyond the range: 4 ζ / (π 1e9) and rounding
  const double miles = pi / 2 * f * density / (2 * zeta) * (1 + 4 * zeta * zeta);
  EXPECT_NEAR(response.acceleration[0] / miles, 1, 1e-6);
  const ProbeRms rms = rms_of(system, response)[0];
  EXPECT_NEAR(rms.relative_frequency[0], f, 1e-6 * f);
  EXPECT_NEAR(rms.stress[0] / (omega * omega * std::sqrt(q)), 1, 1e-9);
  EXPECT_NEAR(rms.von_mises, rms.stress[0], 1e-9 * rms.stress[0]); // one stress, along one axis
}

TEST(Random, CloseModesAreCorrelatedAsDerKiureghianSays) {
  const double f1 = 20, f2 = 21.5, z1 = 0.03, z2 = 0.05, r = f2 / f1;
  ResponseSystem system = oscillators({f1, f2}, {z1, z2});
  ResponseSettings settings = shaken(system, noise(constant(1)));
  settings.random.from = 0;
  settings.random.to = 1e8;
  const RandomResponse response = random_response(system, settings);
  // Der Kiureghian 1980, A response spectrum method for random vibrations: ρ of the displacements under white noise.
  const double exact = 8 * std::sqrt(z1 * z2) * (z1 + r * z2) * std::pow(r, 1.5) /
                       (std::pow(1 - r * r, 2) + 4 * z1 * z2 * r * (1 + r * r) + 4 * (z1 * z1 + z2 * z2) * r * r);
  const auto& C = response.covariance;
  EXPECT_NEAR(C(0, 1) / std::sqrt(C(0, 0) * C(1, 1)), exact, 1e-9);
  const Eigen::MatrixXd L = independent_parts(C, system.basis);
  EXPECT_LT((L * L.transpose() - C).norm(), 1e-13 * C.norm());
}

TEST(Random, TablesAreStraightOverLogarithms) {
  ResponseSystem system = oscillators({1e5}, {0.02}); // stiff: it moves with the base
  const std::vector<double> f{20, 80, 350, 2000}, g{0.01, 0.04, 0.04, 0.008};
  ResponseSettings settings = shaken(system, noise(curve(f, g)));
  const RandomResponse response = random_response(system, settings);
  double exact = 0;
  for (std::size_t k = 0; k + 1 < f.size(); ++k) {
    const double m = std::log(g[k + 1] / g[k]) / std::log(f[k + 1] / f[k]);
    exact += g[k] / std::pow(f[k], m) * (std::pow(f[k + 1], m + 1) - std::pow(f[k], m + 1)) / (m + 1);
  }
  EXPECT_NEAR(response.base[0] / exact, 1, 1e-12);
  EXPECT_NEAR(response.acceleration[0] / exact, 1, 1e-3);
  EXPECT_EQ(response.from, 20);
  EXPECT_EQ(response.to, 2000);
}

TEST(StressForms, LargestVonMisesOverACycle) {
  Voigt a, b;
  a << 3, -1, 2, 0.5, -2, 1;
  b << -1, 4, 0.3, 2, 1, -0.7;
  double largest = 0;
  for (int k = 0; k < 20000; ++k) {
    const double t = two_pi * k / 20000;
    largest = std::max(largest, von_mises(a * std::cos(t) - b * std::sin(t)));
  }
  EXPECT_NEAR(von_mises_over_cycle(a, b), largest, 1e-7);
  EXPECT_NEAR(von_mises_over_cycle(a, 0 * a), von_mises(a), 1e-13);
  EXPECT_LT(largest, von_mises(a.cwiseAbs()) + von_mises(b.cwiseAbs()));
}

TEST(Harmonic, FrequenciesResolveEachResonance) {
  ResponseSystem system = oscillators({10, 30}, {0.001, 0.02});
  const auto f = response_frequencies(system.basis, system.damping, 1, 100, 20, {5.5});
  EXPECT_TRUE(std::is_sorted(f.begin(), f.end()));
  EXPECT_EQ(std::count(f.begin(), f.end(), 5.5), 1);
  ResponseSettings settings = shaken(system, {});
  system.excitations[0].variation.spectrum = settings.base->acceleration.spectrum = constant(1);
  settings.harmonic.from = 1;
  settings.harmonic.to = 100;
  const HarmonicResponse response = harmonic_response(system, settings);
  const double peak = response.modal.row(0).cwiseAbs().maxCoeff() * system.basis.lambda[0] * 2 * 0.001;
  EXPECT_NEAR(peak, 1, 1e-5);
}

// ------------------------------------------------------------------------------------------------------------- a part

namespace {

constexpr double length = 8, modulus = 210, density = 2;

/// A square bar along x without Poisson's effect: its axial motion is that of a rod.
struct Bar {
  Bar() : model(make_box_model(box_in_grid({length, 1, 1}, {8, 1, 1}, 3))) {
    run.material = isotropic(modulus, 0, density);
    run.light = {LightFunctions::None, 0};
    run.response.damping.given = true;
    run.response.choose_modes = false;
    run.eigen.modes = 3;
    run.eigen.errors = false;
    run.statics.probes = {{"tip", {length, 0.5, 0.5}}, {"middle", {length / 2, 0.5, 0.5}}};
  }
  void clamp() {
    Support support;
    support.name = "clamp";
    support.region.normal = RegionChoice::Direction{{-1, 0, 0}, 1};
    run.supports = {support};
  }
  /// Guides that leave axial motion alone: only modes of a rod remain.
  void guide() {
    for (const Point3& side : {Point3{0, -1, 0}, Point3{0, 1, 0}, Point3{0, 0, -1}, Point3{0, 0, 1}}) {
      Support support;
      support.name = "guide";
      support.region.normal = RegionChoice::Direction{side, 1};
      support.along_normal = true;
      run.supports.push_back(support);
    }
  }
  void pull(const Point3& force, Variation variation = {}) {
    Load load;
    load.name = "pull";
    load.kind = LoadKind::TotalForce;
    load.vector = force;
    load.region.normal = RegionChoice::Direction{{1, 0, 0}, 1};
    run.statics.loads = {load};
    run.response.loads = {std::move(variation)};
  }
  ResponseSystem prepare() const { return prepare_response(run, {&model, 1}, 0); }

  TrimmedModel model;
  RunSettings run;
};

} // namespace

TEST(Harmonic, FrequencyZeroIsTheStaticAnswer) {
  Bar bar;
  bar.clamp();
  bar.pull({0.3, 0.01, -0.02});
  bar.run.response.damping.ratio = 0.02;
  bar.run.response.harmonic.frequencies = {0};
  const ResponseSystem system = bar.prepare();
  EXPECT_EQ(system.basis.elastic, 3);
  EXPECT_EQ(system.basis.residual, 1);
  EXPECT_GT(system.load_shares[0], 0.01);
  EXPECT_LT(system.load_shares[0], 0.999);
  const auto tables = tables_of(system, harmonic_response(system, bar.run.response));
  const StaticSolution exact = run_static(bar.run, bar.run.statics, SolutionSpace(bar.model, bar.run.light));
  const auto& probe = exact.result.probes.fields;
  const auto entry = [&](std::size_t table, const std::string& column) {
    const auto& columns = tables[table].columns;
    const auto at = std::find(columns.begin(), columns.end(), column);
    EXPECT_NE(at, columns.end()) << column;
    return tables[table].values[static_cast<std::size_t>(at - columns.begin())];
  };
  const double largest = std::abs(probe.displacement[2]), stress = probe.von_mises[1];
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t d = 0; d < 3; ++d)
      EXPECT_NEAR(entry(p, std::string("displacement_") + "xyz"[d]), std::abs(probe.displacement[3 * p + d]),
                  1e-8 * largest);
    EXPECT_NEAR(entry(p, "stress_xx"), std::abs(probe.stress[6 * p]), 1e-8 * stress);
    EXPECT_NEAR(entry(p, "von_mises"), probe.von_mises[p], 1e-8 * stress);
  }
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_NEAR(entry(2, std::string("force_") + "xyz"[d]), std::abs(exact.reactions[0].force[d]), 1e-8 * 0.3);
  EXPECT_NEAR(entry(2, "moment_z"), std::abs(0.01 * length), 1e-6 * 0.01 * length);
}

TEST(Harmonic, AShakenRodIsOneOverCosine) {
  Bar bar;
  bar.clamp();
  bar.guide();
  bar.run.response.damping.structural = 0.06;
  BaseMotion base;
  base.direction = {1, 0, 0};
  base.acceleration.spectrum = constant(5);
  bar.run.response.base = base;
  bar.run.eigen.modes = 4;
  const double speed = std::sqrt(modulus / density), first = speed / (4 * length);
  bar.run.response.harmonic.from = 0.01 * first;
  bar.run.response.harmonic.to = 2.2 * first;
  const ResponseSystem system = bar.prepare();
  const HarmonicResponse response = harmonic_response(system, bar.run.response);
  EXPECT_EQ(system.basis.residual, 1);
  for (std::size_t k = 0; k < response.frequencies.size(); ++k) {
    const double omega = two_pi * response.frequencies[k];
    const auto column = static_cast<Index>(k);
    const Complex wave = omega / speed / std::sqrt(Complex(1, 0.06));
    const Complex u = -omega * omega * (system.observed.displacement.row(0) * response.modal.col(column))(0) + 5.0;
    const Complex exact = 5.0 / std::cos(wave * length);
    // Modes 9, 11, … of the rod answer statically, through the residual vector.
    const double share = response.frequencies[k] / first, left_out = 4 / (9 * pi) * std::pow(share / 9, 4);
    EXPECT_LT(std::abs(u - exact), 1e-5 * std::abs(exact) + 5 * left_out) << share;
  }
  // σ = E u' at the middle: elastic stress, the loss factor left out.
  const double omega = two_pi * response.frequencies[5];
  const Complex wave = omega / speed / std::sqrt(Complex(1, 0.06));
  const Complex strain = -5 / (omega * omega) * wave *
                         (-std::sin(wave * length / 2.0) + std::tan(wave * length) * std::cos(wave * length / 2.0));
  const Complex stress = (system.observed.stress.row(6) * response.modal.col(5))(0);
  EXPECT_LT(std::abs(stress - modulus * strain), 1e-4 * std::abs(modulus * strain));
}

TEST(Harmonic, AFreeRodSwingsAboutItsRigidMotion) {
  Bar bar;
  bar.pull({0.3, 0, 0});
  bar.run.eigen.modes = 8; // bending ones, twisting ones, an axial one
  const double speed = std::sqrt(modulus / density), first = speed / (2 * length);
  for (const double share : {1e-3, 0.1, 0.3}) bar.run.response.harmonic.frequencies.push_back(share * first);
  const ResponseSystem system = bar.prepare();
  EXPECT_EQ(system.basis.rigid, 6);
  EXPECT_EQ(system.basis.residual, 1);
  const HarmonicResponse response = harmonic_response(system, bar.run.response);
  for (const double share : {1e-3, 0.1, 0.3}) {
    const double f = share * first, k = two_pi * f / speed;
    const auto at = std::find(response.frequencies.begin(), response.frequencies.end(), f);
    ASSERT_NE(at, response.frequencies.end());
    const auto column = static_cast<Index>(at - response.frequencies.begin());
    const Complex tip = (system.observed.displacement.row(0) * response.modal.col(column))(0);
    const double exact = -0.3 * std::cos(k * length) / (modulus * k * std::sin(k * length));
    EXPECT_NEAR(tip.real(), exact, 1e-4 * std::abs(exact)) << share;
  }
}

TEST(Random, RmsFieldsAgreeWithTheProbe) {
  Bar bar;
  bar.clamp();
  bar.pull({0.3, 0.1, -0.2}, noise(curve({0.01, 10}, {2, 1})));
  bar.run.response.damping.ratio = 0.03;
  const ResponseSystem system = bar.prepare();
  const RandomResponse response = random_response(system, bar.run.response);
  const ProbeRms rms = rms_of(system, response)[1];
  const SystemBody& body = system.system[0];
  const auto located = locate_probes(bar.model, bar.run.statics.probes);
  const SamplePoints point{{located[1].cell}, {located[1].parameter.begin(), located[1].parameter.end()}};
  const FieldSamples fields = rms_fields(*body.space, body.material, point,
                                         system.basis.vectors * independent_parts(response.covariance, system.basis));
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_NEAR(fields.displacement[d], rms.relative[static_cast<Index>(d)], 1e-10 * rms.relative.norm());
  for (std::size_t d = 0; d < 6; ++d)
    EXPECT_NEAR(fields.stress[d], rms.stress[static_cast<Index>(d)], 1e-10 * rms.von_mises);
  EXPECT_NEAR(fields.von_mises[0], rms.von_mises, 1e-10 * rms.von_mises);
  // Segalman et al. 1998: the quadratic form of the stresses' covariance.
  const Eigen::MatrixXd S = system.observed.stress.middleRows(6, 6), T = S * response.covariance * S.transpose();
  double square = 0;
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j) square += T(i, j) * von_mises_product(Voigt::Unit(i), Voigt::Unit(j));
  EXPECT_NEAR(rms.von_mises, std::sqrt(square), 1e-10 * rms.von_mises);
}

TEST(Transient, ALoadThatGrowsSlowlyIsStaticEverywhere) {
  Bar bar;
  bar.clamp();
  bar.pull({0, 0, 0.01}, over_time(curve({0, 1e9}, {0, 1})));
  bar.run.response.damping.ratio = 0.1;
  bar.run.response.transient.end = 1e9;
  bar.run.response.transient.step = 1e9;
  const ResponseSystem system = bar.prepare();
  const TransientResponse response = transient_response(system, bar.run.response);
  const StaticSolution exact = run_static(bar.run, bar.run.statics, SolutionSpace(bar.model, bar.run.light));
  const Eigen::VectorXd u = system.observed.displacement * response.modal.rightCols(1);
  EXPECT_NEAR(u[2], exact.result.probes.fields.displacement[2], 1e-8 * std::abs(u[2])); // it lags by 2 ζ / ω
}

TEST(ResponseSystem, RefusesWhatItDoesNotKnow) {
  Bar bar;
  EXPECT_THROW(bar.prepare(), InputError); // nothing excites it
  bar.pull({1, 0, 0});
  bar.run.response.damping.given = false;
  EXPECT_THROW(bar.prepare(), InputError);
  bar.run.response.damping.given = true;
  bar.run.response.base = BaseMotion{{1, 0, 0}, false, {}, {}};
  EXPECT_THROW(bar.prepare(), InputError); // a base without supports
  bar.clamp();
  bar.run.supports[0].value = {0.1, 0, 0};
  EXPECT_THROW(bar.prepare(), InputError);
  bar.run.supports[0].value = {};
  bar.run.supports[0].method = SupportMethod::Lagrange;
  EXPECT_THROW(bar.prepare(), InputError);
}

} // namespace iga::test
