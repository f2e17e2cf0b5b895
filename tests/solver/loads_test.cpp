// Loads of the whole part: turning, heat, inertia; load cases. Exact answers, invariants, superposition.
#include "solver/analysis/inertia_relief.hpp"
#include "solver/base/formula.hpp"
#include "solver/base/scattered_values.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include "format/model/errors.hpp"

#include <gtest/gtest.h>
#include <numbers>
#include <random>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr double E = 210, nu = 0.3, alpha = 1.2e-5, density = 7.8e-6;

// A cut bar of length 2 along x in a turned grid, middle at the origin.
TrimmedModel bar(int degree = 2, double span = 0.35, int moment_degree = 0) {
  return make_part(box({-1, -0.25, -0.2}, {1, 0.25, 0.2}), {degree, span, 0.4, moment_degree, rotation(14, 9)});
}

RegionChoice face(const Point3& normal) {
  RegionChoice choice;
  choice.normal = RegionChoice::Direction{normal, 1};
  return choice;
}

Support held(const char* name, const Point3& normal, std::array<bool, 3> fixed, SupportMethod method) {
  Support support;
  support.name = name;
  support.region = face(normal);
  support.fixed = fixed;
  support.method = method;
  return support;
}

RunSettings run_of(std::vector<Support> supports) {
  RunSettings run;
  run.material = isotropic(E, nu, density);
  run.material.expansion = alpha;
  run.supports = std::move(supports);
  return run;
}

StaticSettings heated(const std::string& formula, double reference) {
  StaticSettings settings;
  settings.temperature = TemperatureSettings{};
  settings.temperature->where = "run.toml:1";
  settings.temperature->formula = Formula(formula);
  settings.temperature->reference = reference;
  return settings;
}

// Largest difference of the stress at quadrature points of volume and surface from a field of the position.
double stress_error(const StaticSolution& s, const TrimmedModel& model,
                    const std::function<Voigt(const Point3&)>& exact) {
  double error = 0;
  const auto compare = [&](const std::vector<double>& parameters, const FieldSamples& fields) {
    for (std::size_t q = 0; 6 * q < fields.stress.size(); ++q) {
      const Point3 x = model.grid.to_position({parameters[3 * q], parameters[3 * q + 1], parameters[3 * q + 2]});
      error = std::max(error, (Eigen::Map<const Voigt>(&fields.stress[6 * q]) - exact(x)).cwiseAbs().maxCoeff());
    }
  };
  compare(model.points.parameters, s.result.points);
  compare(model.surface.quadrature.parameters, s.surface);
  return error;
}

Voigt along_x(double stress) {
  Voigt s = Voigt::Zero();
  s[0] = stress;
  return s;
}

} // namespace

// ---------------------------------------------------------------------------------------------------------- turning

// ω² r is the gradient of a potential: force ρ ω² ∫ r, moment zero about the axis; α gives the moment -α J.
TEST(Centrifugal, ResultantsAreThoseOfTheMassAndItsInertia) {
  const TrimmedModel model = make_part(box({1, 0.5, -0.2}, {3, 1, 0.2}), {2, 0.35, 0.4, 0, rotation(14, 9)});
  const SolutionSpace space(model, usual());
  Load load;
  load.kind = LoadKind::Centrifugal;
  load.spin = {{0, 0, 1}, {0, 0, 5}, 3, {}, 0.5};
  const LoadTerms terms = assemble_loads(space, density, std::span(&load, 1));
  const double mass = density * 2 * 0.5 * 0.4, w2 = 9;
  const LoadReport& r = terms.reports[0];
  // r = (2, 0.75, 0) on average; -α × r = α (y, -x, 0).
  const Point3 force{mass * (w2 * 2 + 0.5 * 0.75), mass * (w2 * 0.75 - 0.5 * 2), 0};
  const double inertia = mass * ((4.0 + 0.25) / 12 + 4 + 0.75 * 0.75);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(r.force[d], force[d], 1e-12 * mass * w2);
  EXPECT_NEAR(r.moment[2], -0.5 * inertia, 1e-11 * inertia);
  // The load vector has the same resultants: Greville points are the coefficients of x.
  const auto points = space.node_points();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double about_z = 0;
  for (Eigen::Index n = 0; n < points.rows(); ++n) {
    const Eigen::Vector3d f = terms.load.segment<3>(3 * n);
    sum += f;
    about_z += points(n, 0) * f[1] - points(n, 1) * f[0];
  }
  for (Eigen::Index d = 0; d < 3; ++d) EXPECT_NEAR(sum[d], force[static_cast<std::size_t>(d)], 1e-11 * mass * w2);
  EXPECT_NEAR(about_z, -0.5 * inertia, 1e-11 * inertia);
}

TEST(Centrifugal, FrameTurnsTheAxis) {
  const TrimmedModel model = bar();
  const SolutionSpace space(model, usual());
  Load plain, turned;
  plain.kind = turned.kind = LoadKind::Centrifugal;
  plain.spin = {{1, 0, 0}, {0, 2, 0}, 2, {}, 0.3};
  turned.spin = {{0, 0, 1}, {0, 2, 0}, 2, {}, 0.3};
  turned.frame = {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}}; // columns: its z is the part's x
  const Eigen::VectorXd a = assemble_loads(space, density, std::span(&plain, 1)).load,
                        b = assemble_loads(space, density, std::span(&turned, 1)).load;
  EXPECT_LT((a - b).norm(), 1e-14 * a.norm());
}

// A bar at nu = 0 that turns about its end between walls without friction: u = (f(x), g(y), 0) of degree 3,
// σ_xx = ρ ω² (L² - x²) / 2, σ_yy = ρ ω² (b² - 3 y²) / 6 with walls at ±b.
TEST(Centrifugal, BarAboutItsEndIsExactAtDegreeThree) {
  const TrimmedModel model = make_part(box({0, -0.25, -0.2}, {2, 0.25, 0.2}), {3, 0.5, 0.4, 6, identity_rotation});
  const SolutionSpace space(model, usual());
  RunSettings run;
  run.material = isotropic(E, 0, density);
  for (const Point3& n : {Point3{-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    Support wall = held("wall", n, {true, true, true}, SupportMethod::Nitsche);
    wall.along_normal = true;
    run.supports.push_back(wall);
  }
  StaticSettings settings;
  Load load;
  load.kind = LoadKind::Centrifugal;
  load.spin = {{0, 0, 1}, {0, 0, 0}, 5, {}, 0};
  settings.loads = {load};
  const StaticSolution s = run_static(run, settings, space);
  const double most = density * 25 * 2;
  const auto exact = [&](const Point3& x) {
    Voigt stress = along_x(density * 25 * (4 - x[0] * x[0]) / 2);
    stress[1] = density * 25 * (0.0625 - 3 * x[1] * x[1]) / 6;
    return stress;
  };
  EXPECT_LT(stress_error(s, model, exact), 1e-9 * most);
  EXPECT_LT(energy_defect(s.result), 1e-9);
  for (const double f : s.force_balance) EXPECT_NEAR(f, 0, 1e-10 * most);
  ASSERT_TRUE(s.energy_error);
  EXPECT_LT(relative_errors(s)->strain_energy, 1e-10);
}

// ------------------------------------------------------------------------------------------------------------- heat

TEST(ThermalStrain, FreePartsExpandWithoutStress) {
  for (const int degree : {1, 2, 3}) {
    const TrimmedModel model = bar(degree, degree < 3 ? 0.35 : 0.6);
    const SolutionSpace space(model, usual());
    // Held in one point, as it were: three planes of symmetry do not exist in the middle, so inertia relief holds
    // nothing.
    StaticSettings settings = heated("120", 20);
    settings.inertia_relief = true;
    const StaticSolution s = run_static(run_of({}), settings, space);
    EXPECT_LT(stress_error(s, model, [](const Point3&) { return Voigt::Zero().eval(); }), 1e-11 * E * alpha * 100)
        << degree;
    double error = 0;
    for (std::size_t q = 0; q < model.points.weights.size(); ++q)
      for (std::size_t d = 0; d < 3; ++d)
        error = std::max(
            error, std::abs(s.result.points.displacement[3 * q + d] - alpha * 100 * s.result.positions[3 * q + d]));
    EXPECT_LT(error, 1e-10 * alpha * 100) << degree; // without rigid motion: about the centre of mass, the origin
    EXPECT_NEAR(s.result.strain_energy, 0, 1e-16 * E);
  }
}

// A linear temperature bends a free part without stress: the strains are compatible, u is of degree 2.
TEST(ThermalStrain, LinearTemperatureIsFreeOfStressAtDegreeTwo) {
  const TrimmedModel model = bar();
  const SolutionSpace space(model, usual());
  StaticSettings settings = heated("20 + 30*x - 50*y + 10*z", 20);
  settings.inertia_relief = true;
  const StaticSolution s = run_static(run_of({}), settings, space);
  EXPECT_LT(stress_error(s, model, [](const Point3&) { return Voigt::Zero().eval(); }), 1e-10 * E * alpha * 50);
  ASSERT_TRUE(s.energy_error);
  EXPECT_LT(*s.energy_error, 1e-18 * E);
}

// Clamped between two walls: σ = -E α ΔT, whatever holds it; the reactions are that stress times the area.
TEST(ThermalStrain, BarBetweenWallsHasTheExactStress) {
  const TrimmedModel model = bar();
  const SolutionSpace space(model, usual());
  for (const auto method : {SupportMethod::Nitsche, SupportMethod::Lagrange}) {
    std::vector<Support> supports{
        held("left", {-1, 0, 0}, {true, false, false}, method), held("right", {1, 0, 0}, {true, false, false}, method),
        held("side", {0, -1, 0}, {false, true, false}, method), held("low", {0, 0, -1}, {false, false, true}, method)};
    const StaticSolution s = run_static(run_of(supports), heated("100", 20), space);
    const double stress = -E * alpha * 80;
    EXPECT_LT(stress_error(s, model, [&](const Point3&) { return along_x(stress); }), 1e-9 * std::abs(stress));
    EXPECT_NEAR(s.reactions[0].force[0], -stress * 0.5 * 0.4, 1e-10 * std::abs(stress));
    EXPECT_NEAR(s.reactions[1].force[0], stress * 0.5 * 0.4, 1e-10 * std::abs(stress));
    EXPECT_NEAR(s.result.strain_energy, 0.5 * stress * stress / E * 2 * 0.5 * 0.4, 1e-10 * stress * stress / E);
    EXPECT_LT(energy_defect(s.result), 1e-9);
    ASSERT_TRUE(s.energy_error);
    EXPECT_LT(relative_errors(s)->strain_energy, 1e-12);
  }
}

// Penalty supports yield by σ / β; energies balance all the same, here under a temperature that no spline follows.
TEST(ThermalStrain, EnergiesBalanceWithEveryMethod) {
  const TrimmedModel model = bar();
  const SolutionSpace space(model, usual());
  for (const auto method : {SupportMethod::Nitsche, SupportMethod::Penalty, SupportMethod::Lagrange}) {
    Support moved = held("right", {1, 0, 0}, {true, true, true}, method);
    moved.value = {2e-3, -1e-3, 0};
    StaticSettings settings = heated("20 + 100*exp(-3*x*x) + 40*sin(4*y)", 20);
    Load pull;
    pull.name = "pull";
    pull.vector = {0.01, 0.02, 0};
    pull.region = face({0, 1, 0});
    settings.loads = {pull};
    const StaticSolution s =
        run_static(run_of({held("left", {-1, 0, 0}, {true, true, true}, method), moved}), settings, space);
    EXPECT_LT(energy_defect(s.result), 1e-8);
    for (const double f : s.force_balance) EXPECT_NEAR(f, 0, 1e-10);
    for (const double m : s.moment_balance) EXPECT_NEAR(m, 0, 1e-10);
  }
}

TEST(ThermalStrain, ErrorEstimateFollowsTheTrueError) {
  // Reference: the energy on a grid of half the spans.
  const auto solve_with = [](double span) {
    const TrimmedModel model = make_part(box({-1, -0.25, -0.2}, {1, 0.25, 0.2}), {2, span, 0.4, 4, identity_rotation});
    const SolutionSpace space(model, usual());
    StaticSettings settings = heated("100*cos(3*x)*cos(2*y)", 0);
    settings.inertia_relief = true;
    return run_static(run_of({}), settings, space);
  };
  const StaticSolution coarse = solve_with(0.25), fine = solve_with(0.125);
  ASSERT_TRUE(coarse.energy_error && fine.energy_error);
  // a(e, e) = 2 (W_h - W): without supports the energy of σ = C (ε - ε₀) falls to its least as spans shrink.
  const double error = 2 * (coarse.result.strain_energy - fine.result.strain_energy) + *fine.energy_error;
  EXPECT_GT(*coarse.energy_error, 0.4 * error);
  EXPECT_LT(*coarse.energy_error, 3 * error);
}

TEST(ThermalStrain, NeedsAnExpansion) {
  const TrimmedModel model = bar(1, 0.6);
  const SolutionSpace space(model, usual());
  RunSettings run = run_of({});
  run.material.expansion.reset();
  StaticSettings settings = heated("20", 20);
  settings.inertia_relief = true;
  try {
    run_static(run, settings, space);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("expansion"), std::string::npos) << error.what();
  }
}

// Two bars in series in a rigid channel, tied, of unlike stiffness and expansion at nu = 0: one stress along both,
// whatever the grids.
TEST(ThermalStrain, TiedBarsShareOneStress) {
  const TrimmedModel left = make_part(box({-1, -0.25, -0.2}, {0, 0.25, 0.2}), {2, 0.35, 0.4, 0, rotation(14, 9)}),
                     right = make_part(box({0, -0.25, -0.2}, {1, 0.25, 0.2}), {1, 0.3, 0.1, 0, rotation(-20, 30)});
  ElasticMaterial first = isotropic(E, 0, density), second = isotropic(2 * E, 0, density);
  first.expansion = alpha;
  second.expansion = 3 * alpha;
  BodySystem system;
  system.add("a", std::make_shared<const SolutionSpace>(left, usual()), first);
  system.add("b", std::make_shared<const SolutionSpace>(right, usual()), second);
  RunSettings run;
  Tie tie;
  tie.name = "joint";
  tie.tolerance = 1e-6;
  run.ties = {tie};
  for (const char* body : {"a", "b"})
    for (const Point3& n : {Point3{body[0] == 'a' ? -1.0 : 1.0, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
      run.supports.push_back(held("wall", n, {true, true, true}, SupportMethod::Nitsche));
      run.supports.back().along_normal = true;
      run.supports.back().body = body;
    }
  const StaticSolution s = run_static(run, heated("120", 20), system);
  // The whole length is fixed: α₁ ΔT + σ/E + α₂ ΔT + σ/(2E) = 0; across, each body is held by itself.
  const double first_strain = alpha * 100, second_strain = 3 * alpha * 100;
  const double stress = -(first_strain + second_strain) / (1 / E + 1 / (2 * E));
  for (std::size_t b = 0; b < 2; ++b) {
    const double across = b == 0 ? -E * first_strain : -2 * E * second_strain;
    const std::array<double, 6> exact{stress, across, across, 0, 0, 0};
    for (std::size_t q = 0; 6 * q < s.bodies[b].points.stress.size(); ++q)
      for (std::size_t k = 0; k < 6; ++k)
        ASSERT_NEAR(s.bodies[b].points.stress[6 * q + k], exact[k], 1e-9 * std::abs(stress)) << b;
  }
  EXPECT_NEAR(s.reactions[0].force[0], -stress * 0.2, 1e-9 * std::abs(stress));
  EXPECT_NEAR(std::abs(s.tie_forces[0].force[0]), std::abs(stress) * 0.2, 1e-9 * std::abs(stress));
  EXPECT_LT(energy_defect(s.result), 1e-9);
}

// A bimetal strip: stresses differ from body to body, energies and forces still balance.
TEST(ThermalStrain, TiedStripBalances) {
  const TrimmedModel low = make_part(box({-1, -0.25, -0.2}, {1, 0.25, 0}), {2, 0.35, 0.4, 0, rotation(14, 9)}),
                     high = make_part(box({-1, -0.25, 0}, {1, 0.25, 0.2}), {2, 0.3, 0.1, 0, rotation(-20, 30)});
  for (const auto method : {TieMethod::Nitsche, TieMethod::Penalty}) {
    ElasticMaterial first = isotropic(E, nu, density), second = isotropic(2 * E, nu, density);
    first.expansion = alpha;
    second.expansion = 3 * alpha;
    BodySystem system;
    system.add("a", std::make_shared<const SolutionSpace>(low, usual()), first);
    system.add("b", std::make_shared<const SolutionSpace>(high, usual()), second);
    RunSettings run;
    Tie tie;
    tie.name = "joint";
    tie.tolerance = 1e-6;
    tie.method = method;
    run.ties = {tie};
    run.supports = {held("end", {-1, 0, 0}, {true, true, true}, SupportMethod::Nitsche)};
    run.supports[0].body = "a";
    const StaticSolution s = run_static(run, heated("120 + 20*x", 20), system);
    EXPECT_LT(energy_defect(s.result), 1e-9);
    for (const double f : s.force_balance) EXPECT_NEAR(f, 0, 1e-9);
    EXPECT_GT(s.largest_von_mises.value, 0.2 * E * alpha * 100);
  }
}

// ------------------------------------------------------------------------------------------------------------ cases

TEST(LoadCases, AreTheSolutionsOfTheirLoadsAlone) {
  const TrimmedModel model = bar(2, 0.5);
  const SolutionSpace space(model, usual());
  for (const auto method : {SupportMethod::Nitsche, SupportMethod::Lagrange}) {
    Support left = held("left", {-1, 0, 0}, {true, true, true}, method);
    left.value = {1e-4, 0, -2e-4};
    const RunSettings run = run_of({left});
    StaticSettings all = heated("20 + 60*x", 20);
    Load pull, weight;
    pull.name = "pull";
    pull.kind = LoadKind::TotalForce;
    pull.vector = {0.3, 0, 0.1};
    pull.region = face({1, 0, 0});
    weight.name = "weight";
    weight.kind = LoadKind::Acceleration;
    weight.vector = {0, 0, -9.81};
    all.loads = {pull, weight};
    all.cases = {{"a", {1.5, 0}, {}, 0, 1}, {"b", {-1, 2}, {}, 0.5, 3}};
    const std::vector<StaticSolution> cases = run_static_cases(run, all, BodySystem(space, run.material));
    ASSERT_EQ(cases.size(), 2u);
    for (std::size_t c = 0; c < 2; ++c) {
      RunSettings alone = run;
      alone.supports[0].value = times(left.value, all.cases[c].prescribed);
      StaticSettings settings = heated("20 + 60*x", 20);
      settings.temperature->formula = Formula(c == 0 ? "20" : "20 + 30*x");
      settings.loads = all.loads;
      for (std::size_t k = 0; k < 2; ++k)
        settings.loads[k].vector = times(settings.loads[k].vector, all.cases[c].factors[k]);
      const StaticSolution one = run_static(alone, settings, space);
      EXPECT_LT((cases[c].unknowns - one.unknowns).norm(), 1e-10 * one.unknowns.norm());
      for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_NEAR(cases[c].reactions[0].force[d], one.reactions[0].force[d], 1e-10);
        EXPECT_NEAR(cases[c].loads[0].force[d], one.loads[0].force[d], 1e-13);
      }
      EXPECT_NEAR(cases[c].result.strain_energy, one.result.strain_energy, 1e-9 * one.result.strain_energy);
      EXPECT_NEAR(*cases[c].energy_error, *one.energy_error, 1e-6 * *one.energy_error + 1e-20);
      EXPECT_LT(energy_defect(cases[c].result), 1e-8);
    }
  }
}

// ------------------------------------------------------------------------------------------------------------ bolts

// A bar between walls at nu = 0, shortened until it bears 3: one stress in all of it, exactly.
TEST(Bolts, BearTheirPreloadAndTheLoads) {
  const TrimmedModel model = make_part(box({-1, -0.25, -0.2}, {1, 0.25, 0.2}), {2, 0.17, 0.4, 0, identity_rotation});
  const SolutionSpace space(model, usual());
  RunSettings run = run_of({held("left", {-1, 0, 0}, {true, true, true}, SupportMethod::Nitsche),
                            held("right", {1, 0, 0}, {true, true, true}, SupportMethod::Nitsche)});
  run.material = isotropic(E, 0, density);
  StaticSettings settings;
  Bolt bolt;
  bolt.name = "bolt";
  bolt.point = {0.1, 0, 0};
  bolt.axis = {1, 0, 0};
  bolt.force = 3;
  settings.bolts = {bolt};
  const StaticSolution s = run_static(run, settings, space);
  ASSERT_EQ(s.bolts.size(), 1u);
  EXPECT_NEAR(s.bolts[0].force, 3, 1e-10);
  EXPECT_NEAR(s.bolts[0].section, 0.2, 1e-9);
  // A bar of length 2 that is shortened by F L / (E A).
  EXPECT_NEAR(s.bolts[0].shortening, 3 * 2 / (E * 0.2), 1e-9);
  EXPECT_NEAR(s.reactions[0].force[0], -3, 1e-8);
  EXPECT_LT(stress_error(s, model, [](const Point3&) { return along_x(3 / 0.2); }), 1e-7);
  EXPECT_NEAR(s.force_balance[0], 0, 1e-10);
  EXPECT_LT(energy_defect(s.result), 1e-8);
  ASSERT_TRUE(s.energy_error);
  EXPECT_LT(relative_errors(s)->strain_energy, 1e-10);
  // The right wall moves outwards: the same as without bolts, on top.
  StaticSettings cases = settings;
  cases.cases = {{"tight", {}, {1}, 0, 0}, {"pulled", {}, {0}, 0, 1}, {"both", {}, {1}, 0, 1}};
  run.supports[1].value = {1e-3, 0, 0};
  const std::vector<StaticSolution> all = run_static_cases(run, cases, BodySystem(space, run.material));
  EXPECT_NEAR(all[0].bolts[0].force, 3, 1e-10);
  EXPECT_NEAR(all[1].bolts[0].force, E * 0.2 * 1e-3 / 2, 1e-8);
  EXPECT_NEAR(all[2].bolts[0].force, all[0].bolts[0].force + all[1].bolts[0].force, 1e-9);
  // A shank with a free end bears nothing; a plane beside the part has no shank.
  run.supports.pop_back();
  EXPECT_THROW(run_static(run, settings, space), InputError);
  settings.bolts[0].point = {5, 0, 0};
  EXPECT_THROW(run_static(run, settings, space), InputError);
}

TEST(Bolts, EachHasItsOwnForce) {
  const TrimmedModel model = make_part(box({-1, -0.6, -0.2}, {1, 0.6, 0.2}), {2, 0.2, 0.4, 0, identity_rotation});
  const SolutionSpace space(model, usual());
  const RunSettings run = run_of({held("left", {-1, 0, 0}, {true, true, true}, SupportMethod::Nitsche),
                                  held("right", {1, 0, 0}, {true, true, true}, SupportMethod::Nitsche)});
  StaticSettings settings;
  for (const double side : {-1.0, 1.0}) {
    Bolt bolt;
    bolt.name = side < 0 ? "low" : "high";
    bolt.axis = {1, 0, 0};
    bolt.force = 2 + side;
    bolt.box = Box3{{-2, side < 0 ? -1.0 : 0, -1}, {2, side < 0 ? 0.0 : 1, 1}};
    settings.bolts.push_back(bolt);
  }
  const StaticSolution s = run_static(run, settings, space);
  EXPECT_NEAR(s.bolts[0].force, 1, 1e-9);
  EXPECT_NEAR(s.bolts[1].force, 3, 1e-9);
}

// ---------------------------------------------------------------------------------------------------- inertia relief

// Pulled at one end, a free bar has a stress that grows linearly from the other one: u of degree 2.
TEST(InertiaRelief, PulledBarIsExact) {
  const TrimmedModel model = bar(2, 0.5, 4); // N ρ x is integrated exactly
  const SolutionSpace space(model, usual());
  RunSettings run = run_of({});
  run.material = isotropic(E, 0, density);
  StaticSettings settings;
  settings.inertia_relief = true;
  Load pull;
  pull.name = "pull";
  pull.kind = LoadKind::TotalForce;
  pull.vector = {0.4, 0, 0};
  pull.region = face({1, 0, 0});
  settings.loads = {pull};
  const StaticSolution s = run_static(run, settings, space);
  const double area = 0.5 * 0.4, mass = density * 2 * area;
  EXPECT_LT(stress_error(s, model, [&](const Point3& x) { return along_x(0.4 / area * (x[0] + 1) / 2); }), 1e-9);
  ASSERT_EQ(s.relief.size(), 1u);
  EXPECT_NEAR(s.relief[0].mass, mass, 1e-12 * mass);
  EXPECT_NEAR(s.relief[0].acceleration[0], 0.4 / mass, 1e-10 * 0.4 / mass);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(s.relief[0].centre[d], 0, 1e-12);
    EXPECT_NEAR(s.relief[0].angular[d], 0, 1e-9 * 0.4 / mass);
    EXPECT_NEAR(s.force_balance[d], 0, 1e-12);
    EXPECT_NEAR(s.moment_balance[d], 0, 1e-12);
  }
  EXPECT_LT(energy_defect(s.result), 1e-9);
  ASSERT_TRUE(s.energy_error);
  EXPECT_LT(relative_errors(s)->strain_energy, 1e-10);
}

// A couple of forces turns the part: α = J⁻¹ M.
TEST(InertiaRelief, MomentsTurnThePart) {
  const TrimmedModel model = bar(2, 0.5);
  const SolutionSpace space(model, usual());
  StaticSettings settings;
  settings.inertia_relief = true;
  for (const double side : {-1.0, 1.0}) {
    Load push;
    push.name = "push";
    push.kind = LoadKind::TotalForce;
    push.vector = {0, 0.1 * side, 0};
    push.region = face({side, 0, 0});
    settings.loads.push_back(push);
  }
  const StaticSolution s = run_static(run_of({}), settings, space);
  const double mass = density * 2 * 0.5 * 0.4, inertia = mass * (4.0 + 0.25) / 12;
  EXPECT_NEAR(s.relief[0].angular[2], 0.2 / inertia, 1e-9 * 0.2 / inertia);
  EXPECT_NEAR(s.relief[0].acceleration[1], 0, 1e-9 * 0.2 / mass);
  for (const double m : s.moment_balance) EXPECT_NEAR(m, 0, 1e-11);
}

TEST(InertiaRelief, AcceptsNoSupport) {
  const TrimmedModel model = bar(1, 0.6);
  const SolutionSpace space(model, usual());
  StaticSettings settings;
  settings.inertia_relief = true;
  EXPECT_THROW(
      run_static(run_of({held("left", {-1, 0, 0}, {true, false, false}, SupportMethod::Nitsche)}), settings, space),
      InputError);
}

// --------------------------------------------------------------------------------------------- formulas and points

TEST(Formula, FollowsTheUsualPrecedence) {
  const Point3 x{2, 3, 5};
  for (const auto& [text, value] :
       std::vector<std::pair<const char*, double>>{{"1 + 2*3", 7},
                                                   {"-x^2", -4},
                                                   {"2^3^2", 512},
                                                   {"2^-1", 0.5},
                                                   {"(x + y)/z", 1},
                                                   {"10 - 4 - 3", 3},
                                                   {"12/2/3", 2},
                                                   {"sqrt(x*x + hypot(y, 4)*5 - 25) + z", 7},
                                                   {"max(x, min(y, z)) * 1e-1", 0.3},
                                                   {"atan2(1, 1)*4 - pi", 0},
                                                   {"--x", 2},
                                                   {"+.5e1", 5}})
    EXPECT_DOUBLE_EQ(Formula(text)(x), value) << text;
}

TEST(Formula, SaysWhatIsWrongAndWhere) {
  for (const auto& [text, words] : std::vector<std::pair<std::string, const char*>>{{"", "it ends at character 1"},
                                                                                    {"20 + ", "it ends"},
                                                                                    {"2 ** x", "written with ^"},
                                                                                    {"3 x", "found 'x' at character 3"},
                                                                                    {"sqr(x)", "did you mean sqrt"},
                                                                                    {"t + 1", "there is no 't'"},
                                                                                    {"min(x)", "takes two values"},
                                                                                    {"(x", "expected ')'"},
                                                                                    {std::string(1000, '('), "fewer"},
                                                                                    {std::string(1000, '-'), "fewer"},
                                                                                    {"1e999", "finite"},
                                                                                    {"x; y", "found ';'"}}) {
    try {
      Formula formula(text);
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

TEST(ScatteredValues, LinearFieldsAreExactAndPointsAreMet) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto field = [](const Point3& x) { return 20 + 3 * x[0] - 7 * x[1] + 2 * x[2]; };
  std::vector<Point3> points;
  std::vector<double> values, others;
  for (int k = 0; k < 300; ++k) {
    points.push_back({unit(random), unit(random), unit(random)});
    values.push_back(field(points.back()));
    others.push_back(unit(random));
  }
  const ScatteredValues linear(points, values), rough(points, others);
  for (int k = 0; k < 50; ++k) {
    const Point3 x{unit(random), unit(random), unit(random)};
    EXPECT_NEAR(linear.at(x), field(x), 1e-11);
    double nearest = 10;
    for (const Point3& p : points) nearest = std::min(nearest, norm(minus(p, x)));
    EXPECT_NEAR(linear.distance_to_nearest(x), nearest, 1e-14);
  }
  for (std::size_t k = 0; k < 50; ++k) {
    EXPECT_NEAR(rough.at(points[k]), others[k], 1e-12);
    EXPECT_NEAR(rough.at(plus(points[k], {1e-7, 0, 0})), others[k], 1e-3);
  }
}

// Thermocouples in one plane: what they say holds across it.
TEST(ScatteredValues, PointsInAPlaneAreConstantAcrossIt) {
  std::vector<Point3> points;
  std::vector<double> values;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      points.push_back({0.2 * i, 0.2 * j, 3});
      values.push_back(5 * 0.2 * i - 0.2 * j);
    }
  const ScatteredValues plane(points, values);
  EXPECT_NEAR(plane.at({0.47, 0.31, 3.2}), 5 * 0.47 - 0.31, 1e-9);
  EXPECT_NEAR(ScatteredValues({{0, 0, 0}}, {4}).at({1, 2, 3}), 4, 0);
  EXPECT_NEAR(ScatteredValues({{0, 0, 0}, {1, 0, 0}}, {4, 8}).at({0.5, 0.2, 0}), 6, 1e-12);
}

// ---------------------------------------------------------------------------------------------------------- run files

namespace {

StaticSettings read(const std::string& text) {
  io::SettingsTable root = io::SettingsTable::parse(text, "run.toml");
  std::vector<io::TableKeys> keys{
      {"", {"inertia_relief"}}, {"load", {"body"}}, {"probe", {"name", "body", "position"}}};
  for (const auto& more : {load_keys("load"), case_keys(root), temperature_keys(), bolt_keys()})
    keys.insert(keys.end(), more.begin(), more.end());
  root.expect_only(keys);
  return read_static_settings(root);
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(ReadLoads, TurningCasesAndTemperature) {
  const StaticSettings s = read(R"(
    inertia_relief = true
    [[load]]
    name = "turning"
    centrifugal = { axis = [0, 0, 2], point = [1, 2, 3], speed = 5, angular_acceleration = 0.5 }
    [[load]]
    acceleration = [0, 0, -9.81]
    [[load]]
    name = "fast"
    centrifugal = { axis = [1, 0, 0], rpm = 3000 }
    [[case]]
    name = "both"
    loads = { turning = 1.5, "load 2" = 1, temperature = 0.5 }
    [[case]]
    loads = { fast = -1 }
    prescribed = 2
    [temperature]
    formula = "20 + x"
    reference = 20)");
  EXPECT_TRUE(s.inertia_relief);
  ASSERT_EQ(s.loads.size(), 3u);
  EXPECT_EQ(s.loads[0].kind, LoadKind::Centrifugal);
  EXPECT_EQ(s.loads[0].spin.axis, (Point3{0, 0, 1}));
  EXPECT_EQ(s.loads[0].spin.point, (Point3{1, 2, 3}));
  EXPECT_EQ(s.loads[0].spin.speed, 5);
  EXPECT_EQ(s.loads[0].spin.acceleration, 0.5);
  EXPECT_EQ(s.loads[2].spin.rpm, 3000);
  ASSERT_EQ(s.cases.size(), 2u);
  EXPECT_EQ(s.cases[0].name, "both");
  EXPECT_EQ(s.cases[0].factors, (std::vector<double>{1.5, 1, 0}));
  EXPECT_EQ(s.cases[0].temperature, 0.5);
  EXPECT_EQ(s.cases[1].name, "case 2");
  EXPECT_EQ(s.cases[1].factors, (std::vector<double>{0, 0, -1}));
  EXPECT_EQ(s.cases[1].temperature, 0);
  EXPECT_EQ(s.cases[1].prescribed, 2);
  ASSERT_TRUE(s.temperature);
  EXPECT_EQ((*s.temperature->formula)({2, 0, 0}), 22);
  EXPECT_EQ(s.temperature->reference, 20);
}

TEST(ReadLoads, RefusesWhatCannotBeMeant) {
  const std::string turn = "[[load]]\nname = \"turn\"\ncentrifugal = ";
  const std::string hot = "[temperature]\n";
  for (const auto& [text, words] : std::vector<std::pair<std::string, const char*>>{
           {turn + "{ speed = 3 }", "axis"},
           {turn + "{ axis = [0, 0, 0], speed = 3 }", "the axis has no length"},
           {turn + "{ axis = [0, 0, 1] }", "give speed in radians"},
           {turn + "{ axis = [0, 0, 1], speed = 1, rpm = 2 }", "given together with speed"},
           {turn + "{ axis = [0, 0, 1], speeed = 1 }", "did you mean 'speed'"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\nregion = \"a\"", "acts on no surface"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\nat = [0, 0, 0]", "only a force acts"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\nbody_force = [0, 0, 1]", "more than one value"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\n[[case]]\nloads = { turned = 1 }", "did you mean 'turn'"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\n[[case]]\nname = \"a\"", "give factors by the names"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\n[[case]]\nloads = { turn = 1, temperature = 1 }",
            "has no [temperature]"},
           {turn + "{ axis = [0, 0, 1], speed = 1 }\n[[case]]\nname = \"a\"\nloads = { turn = 1 }\n[[case]]\nname = "
                   "\"a\"\nloads = { turn = 2 }",
            "another case 'a'"},
           {hot + "uniform = 3", "reference"},
           {hot + "reference = 3", "missing; give the temperature by one of"},
           {hot + "uniform = 3\nformula = \"x\"\nreference = 3", "given together with uniform"},
           {hot + "formula = \"3 t\"\nreference = 3", "found 't' at character 3"}})
    EXPECT_NE(refusal(text).find(words), std::string::npos) << text << "\n" << refusal(text);
}
