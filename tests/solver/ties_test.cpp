// Several bodies as one system: fields across ties of unlike grids, rigid motions, names in messages.
#include "format/model/errors.hpp"
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr double poisson = 0.3;

/// A run of bodies 'a', 'b', … and their models.
struct Assembly {
  RunSettings run;
  std::vector<TrimmedModel> models;

  void add(TrimmedModel model, const ElasticMaterial& material) {
    models.push_back(std::move(model));
    run.bodies.push_back({{std::string(1, static_cast<char>('a' + run.bodies.size())), {}, {}, {}}, material, usual()});
  }
  StaticSolution solve(const StaticSettings& settings = {}) const {
    return run_static(run, settings, make_system(run, models));
  }
};

Support held(const std::string& body, const RegionChoice& region) {
  Support support = linear_support(SupportMethod::Nitsche);
  support.name = body + " held";
  support.body = body;
  support.region = region;
  return support;
}

Tie tie_of(double tolerance = 1e-6) {
  Tie tie;
  tie.name = "joint";
  tie.tolerance = tolerance;
  return tie;
}

RegionChoice facing(const Point3& direction) {
  RegionChoice choice;
  choice.normal = RegionChoice::Direction{direction, 1};
  return choice;
}

void expect_linear(const Assembly& assembly, const StaticSolution& s) {
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const LinearErrors errors = errors_of(s.bodies[b].points, s.bodies[b].positions, assembly.run.bodies[b].material);
    EXPECT_LT(errors.displacement, 1e-9) << "body " << b;
    EXPECT_LT(errors.stress, 1e-8) << "body " << b;
    std::printf("  body %zu: displacement %.1e, stress %.1e\n", b, errors.displacement, errors.stress);
  }
  EXPECT_LT(energy_defect(s.result), 1e-9);
}

/// Elastic frequencies of free bodies.
struct Free {
  EigenOutcome outcome;
  std::vector<double> omega;
};

Free free_modes(const Assembly& assembly, int modes) {
  EigenSettings settings;
  settings.modes = modes;
  Free free{analyse_modes(assembly.run, settings, assembly.models), {}};
  for (Eigen::Index m = free.outcome.modes.rigid; m < free.outcome.modes.lambda.size(); ++m)
    free.omega.push_back(std::sqrt(free.outcome.modes.lambda[m]));
  return free;
}

template <class Action> std::string message_of(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

#define EXPECT_HOLDS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

} // namespace

// The second block is smaller than the face that it stands on: its outline crosses triangles and spans of the other.
TEST(Ties, LinearFieldAcrossUnlikeGridsDegreesAndRotations) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  const Voigt stress = constant_stress(material);
  const Point3 low{0.22, 0.17, 0.5}, high{0.82, 0.77, 1.1};
  StaticSettings loads;
  const auto load = [&](const char* body, const Point3& n, std::optional<Box3> where = {}) {
    Load face;
    face.name = "face";
    face.body = body;
    face.vector = traction(stress, n);
    face.region = facing(n);
    face.region.box = where;
    loads.loads.push_back(face);
  };
  for (const char* body : {"a", "b"})
    for (const int side : {-1, 1}) {
      load(body, {1.0 * side, 0, 0});
      load(body, {0, 1.0 * side, 0});
    }
  load("b", {0, 0, 1});
  // What the second block leaves free of the face.
  for (const Box3& rest :
       {Box3{{0, 0, 0.4}, {low[0], 1, 0.6}}, Box3{{high[0], 0, 0.4}, {1, 1, 0.6}},
        Box3{{low[0], 0, 0.4}, {high[0], low[1], 0.6}}, Box3{{low[0], high[1], 0.4}, {high[0], 1, 0.6}}})
    load("a", {0, 0, 1}, rest);
  for (const auto& [p, q] : {std::pair{1, 2}, std::pair{2, 3}, std::pair{3, 2}}) {
    Assembly assembly;
    assembly.add(make_part(box({0, 0, 0}, {1, 1, 0.5}), {p, 0.3, 0.4, 0, rotation(40, 10)}), material);
    assembly.add(make_part(box(low, high), {q, 0.23, 0.1, 0, rotation(5, 70)}), material);
    assembly.run.ties = {tie_of()};
    assembly.run.supports = {held("a", facing({0, 0, -1}))};
    if (p == 3) assembly.run.supports[0].method = SupportMethod::Lagrange;
    const StaticSolution s = assembly.solve(loads);
    expect_linear(assembly, s);
    ASSERT_EQ(s.ties.size(), 1u);
    EXPECT_NEAR(s.ties[0].area, 0.36, 1e-12);
    EXPECT_LT(s.ties[0].largest_gap, 1e-12);
    EXPECT_LT(s.tie_forces[0].largest_jump, 1e-9 * s.largest_displacement.value);
    const Point3 through = times(traction(stress, {0, 0, 1}), 0.36);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(s.tie_forces[0].force[d], through[d], 1e-9);
  }
}

// Two layers without Poisson's effect bend like one beam: u = κ (x (z - z0), 0, -x²/2) is exact in both, whatever their
// moduli, and of degree 2. The reaction's moment is κ Σ E I. (Grids lie along the faces: on others the surface's rules,
// of degree 3 p, miss linear stress times a function by 1e-8.)
class CompositeBeam : public ::testing::TestWithParam<double> {};

TEST_P(CompositeBeam, BendsExactly) {
  constexpr double L = 2, kappa = 1e-2, split = 0.3, height = 0.8, soft = 1;
  const double stiff = GetParam();
  const double z0 = (soft * split * split / 2 + stiff * (height * height - split * split) / 2) /
                    (soft * split + stiff * (height - split));
  Assembly assembly;
  assembly.add(make_part(box({0, 0, 0}, {L, 0.5, split}), {2, 0.27, 0.4, 4, identity_rotation}), isotropic(soft, 0, 1));
  assembly.add(make_part(box({0, 0, split}, {L, 0.5, height}), {3, 0.4, 0.2, 6, identity_rotation}),
               isotropic(stiff, 0, 1));
  assembly.run.ties = {tie_of()};
  for (const char* body : {"a", "b"}) {
    Support root = held(body, facing({-1, 0, 0})), end = held(body, facing({1, 0, 0}));
    root.value = {};
    root.gradient = {};
    end.name += " at the end";
    end.fixed = {true, false, false};
    end.value = {-kappa * L * z0, 0, 0};
    end.gradient = {{{0, 0, kappa * L}, {}, {}}};
    assembly.run.supports.push_back(root);
    assembly.run.supports.push_back(end);
  }
  const StaticSolution s = assembly.solve();
  double worst = 0;
  for (const StaticBody& body : s.bodies)
    for (std::size_t q = 0; 3 * q < body.positions.size(); ++q) {
      const double x = body.positions[3 * q], z = body.positions[3 * q + 2];
      const Point3 exact{kappa * x * (z - z0), 0, -kappa * x * x / 2};
      for (std::size_t d = 0; d < 3; ++d)
        worst = std::max(worst, std::abs(body.points.displacement[3 * q + d] - exact[d]));
    }
  std::printf("  composite beam: error %.1e of %.1e\n", worst, kappa * L * L / 2);
  EXPECT_LT(worst, 1e-9 * kappa * L * L / 2);
  const auto second_moment = [&](double from, double to) {
    return 0.5 * (std::pow(to - z0, 3) - std::pow(from - z0, 3)) / 3;
  };
  const double moment = kappa * (soft * second_moment(0, split) + stiff * second_moment(split, height));
  double reaction = 0, force = 0;
  for (const Reaction& r : s.reactions)
    if (r.name.ends_with("end")) {
      reaction += r.moment[1];
      force += r.force[0];
    }
  EXPECT_NEAR(reaction, moment, 1e-8 * moment);
  EXPECT_NEAR(force, 0, 1e-8 * moment);
}

INSTANTIATE_TEST_SUITE_P(Ratio, CompositeBeam, ::testing::Values(1.0, 3.0, 1000.0));

// Springs of the penalty give way by t / β, β = C E / h of the softer body.
TEST(Ties, PenaltyGivesWayByTractionOverBeta) {
  constexpr double pull = 0.01, factor = 1e3, h = 0.4;
  const ElasticMaterial material = isotropic(210, 0, 7.8e-6);
  Assembly assembly;
  assembly.add(make_part(box({0, 0, 0}, {1, 1, 0.5}), {2, h, 0.4, 0, identity_rotation}), material);
  assembly.add(make_part(box({0, 0, 0.5}, {1, 1, 1}), {2, h, 0.1, 0, identity_rotation}), material);
  Tie& tie = assembly.run.ties.emplace_back(tie_of());
  tie.method = TieMethod::Penalty;
  tie.penalty_factor = factor;
  assembly.run.supports = {held("a", facing({0, 0, -1}))};
  assembly.run.supports[0].value = {};
  assembly.run.supports[0].gradient = {};
  StaticSettings loads;
  loads.loads.emplace_back().vector = {0, 0, pull};
  loads.loads[0].name = "pull";
  loads.loads[0].body = "b";
  loads.loads[0].region = facing({0, 0, 1});
  const StaticSolution s = assembly.solve(loads);
  EXPECT_NEAR(s.tie_forces[0].largest_jump, pull / (factor * 210 / h), 1e-9 * pull);
  EXPECT_NEAR(s.tie_forces[0].force[2], pull, 1e-12);
  EXPECT_LT(energy_defect(s.result), 1e-9);
}

TEST(Ties, ATiedPairHasSixRigidMotionsAndAnUntiedOneTwelve) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  Assembly assembly;
  assembly.add(make_part(box({0, 0, 0}, {1, 1, 0.5}), {2, 0.4, 0.4, 0, rotation(40, 10)}), material);
  assembly.add(make_part(box({0, 0, 0.5}, {1, 1, 1}), {2, 0.35, 0.1, 0, rotation(5, 70)}), material);
  const Free apart = free_modes(assembly, 2);
  EXPECT_EQ(apart.outcome.bodies, 2);
  EXPECT_EQ(apart.outcome.modes.rigid, 12);
  assembly.run.ties = {tie_of()};
  const Free tied = free_modes(assembly, 2);
  EXPECT_EQ(tied.outcome.bodies, 1);
  EXPECT_EQ(tied.outcome.modes.rigid, 6);
  EXPECT_EQ(tied.outcome.modes.mechanisms, 0);
  for (Eigen::Index m = 0; m < 6; ++m)
    EXPECT_LT(std::abs(tied.outcome.modes.lambda[m]), 1e-9 * tied.omega[0] * tied.omega[0]);
}

// The uncut block's own error is 8e-6 … 1.4e-3 in these modes.
TEST(Ties, APartCutInTwoAndTiedHasTheFrequenciesOfTheWhole) {
  const ElasticMaterial material = isotropic(1, poisson, 1);
  Assembly whole, halves;
  whole.add(make_part(box({0, 0, 0}, {2, 0.6, 0.5}), {2, 0.2, 0.3, 4, rotation(10, 20)}), material);
  halves.add(make_part(box({0, 0, 0}, {0.9, 0.6, 0.5}), {2, 0.2, 0.3, 4, rotation(10, 20)}), material);
  halves.add(make_part(box({0.9, 0, 0}, {2, 0.6, 0.5}), {2, 0.18, 0.1, 4, rotation(30, 5)}), material);
  halves.run.ties = {tie_of()};
  const Free one = free_modes(whole, 6), two = free_modes(halves, 6);
  for (std::size_t m = 0; m < 6; ++m) {
    std::printf("  mode %zu: %.6f, tied %+.1e\n", m, one.omega[m], two.omega[m] / one.omega[m] - 1);
    EXPECT_NEAR(two.omega[m] / one.omega[m], 1, 5e-4);
  }
}

// Facets of two unlike meshes of one sphere do not meet: gaps and overlaps. The radial mode of the ball is known:
// tan k = 4 k / (4 - (c_L / c_S)² k²) at radius 1.
TEST(Ties, BallInAShellPulsatesAsOneBall) {
  const ElasticMaterial material = isotropic(1, poisson, 1);
  const auto shell = join({sphere({0, 0, 0}, 1, 4), flipped(sphere({0, 0, 0}, 0.55, 3))});
  Assembly assembly;
  assembly.add(make_part(sphere({0, 0, 0}, 0.55, 4), {2, 0.2, 0.3, 4, rotation(10, 20)}), material);
  assembly.add(make_part(shell, {2, 0.2, 0.1, 4, rotation(50, 3)}), material);
  assembly.run.ties = {tie_of(0.02)};
  const Free free = free_modes(assembly, 30);
  EXPECT_EQ(free.outcome.modes.rigid, 6);
  ASSERT_EQ(free.outcome.ties.size(), 1u);
  EXPECT_NEAR(free.outcome.ties[0].area, 4 * std::numbers::pi * 0.55 * 0.55, 0.02);
  EXPECT_GT(free.outcome.ties[0].largest_gap, 1e-4);
  const double ratio = 2 * (1 - poisson) / (1 - 2 * poisson); // (c_L / c_S)²
  double k = 2.5;
  for (int step = 0; step < 50; ++step) { // Newton
    const auto f = [&](double x) { return std::tan(x) * (4 - ratio * x * x) - 4 * x; };
    k -= f(k) * 2e-7 / (f(k + 1e-7) - f(k - 1e-7));
  }
  const double c_L = std::sqrt((1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)));
  double nearest = 1e9;
  for (const double omega : free.omega)
    if (std::abs(omega - k * c_L) < std::abs(nearest - k * c_L)) nearest = omega;
  std::printf("  radial mode %.5f, exact %.5f; area %.5f, gap %.1e\n", nearest, k * c_L, free.outcome.ties[0].area,
              free.outcome.ties[0].largest_gap);
  EXPECT_NEAR(nearest / (k * c_L), 1, 5e-3);
}

TEST(Ties, UnheldBodiesAreNamed) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  Assembly assembly;
  for (const double z : {0.0, 0.5, 2.0})
    assembly.add(make_part(box({0, 0, z}, {1, 1, z + 0.5}), {1, 0.4, 0.4, 0, identity_rotation}), material);
  assembly.run.ties = {tie_of()};
  assembly.run.supports = {held("a", facing({0, 0, -1}))};
  const std::string text = message_of([&] { assembly.solve(); });
  EXPECT_HOLDS(text, "body 2 of 2, 'c' (centre (0.5, 0.5, 2.25)");
  EXPECT_HOLDS(text, "[[ties]]");
  EXPECT_EQ(text.find("'a'"), std::string::npos) << text;
  assembly.run.supports = {held("c", facing({0, 0, -1}))};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "tied: 'a', 'b'");
}

TEST(Ties, SurfaceThatTwoBodiesHaveNeedsTheBodysName) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  Assembly assembly;
  for (const double z : {0.0, 0.5})
    assembly.add(make_part(box({0, 0, z}, {1, 1, z + 0.5}), {1, 0.4, 0.4, 0, identity_rotation}), material);
  assembly.run.ties = {tie_of()};
  RegionChoice bottom = facing({0, 0, -1});
  assembly.run.supports = {held("", bottom)};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "support ' held': the bodies 'a' and 'b' all have");
  bottom.box = Box3{{0, 0, -0.1}, {1, 1, 0.1}};
  assembly.run.supports = {held("", bottom)};
  EXPECT_EQ(message_of([&] { assembly.solve(); }), "");
  assembly.run.supports = {held("A", bottom)};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "there is no body 'A'");
  assembly.run.supports = {held("a", bottom)};
  StaticSettings settings;
  settings.probes = {{"at the joint", {0.5, 0.5, 0.5}}};
  EXPECT_HOLDS(message_of([&] { assembly.solve(settings); }), "probe 'at the joint': the bodies 'a' and 'b'");
  settings.probes = {{"nowhere", {5, 5, 5}}};
  EXPECT_HOLDS(message_of([&] { assembly.solve(settings); }), "in body 'b': ");
  settings.probes = {{"inside b", {0.5, 0.5, 0.8}}};
  EXPECT_EQ(message_of([&] { assembly.solve(settings); }), "");
}

// A line is looked for in every body, a rigid region moves with its own.
TEST(Ties, LinesAndRigidRegionsBelongToBodies) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  Assembly assembly;
  for (const double z : {0.0, 0.5})
    assembly.add(make_part(box({0, 0, z}, {1, 1, z + 0.5}), {2, 0.3, 0.4, 0, identity_rotation}), material);
  assembly.run.ties = {tie_of()};
  RegionChoice bottom = facing({0, 0, -1}), top = facing({0, 0, 1});
  bottom.box = Box3{{0, 0, -0.1}, {1, 1, 0.1}};
  top.box = Box3{{0, 0, 0.9}, {1, 1, 1.1}};
  Support base = held("a", bottom), edge;
  base.value = {};
  base.gradient = {};
  edge.name = "edge";
  edge.place.line = {{0, 0, 1}, {1, 0, 1}};
  edge.fixed = {false, true, false};
  edge.method = SupportMethod::Penalty;
  assembly.run.supports = {base, edge};
  Load load;
  load.name = "lever";
  load.kind = LoadKind::Remote;
  load.region = top;
  load.vector = {0.1, 0, -0.2};
  load.moment = {0, 0, 0.05};
  load.remote = Point3{0.5, 0.5, 2};
  load.rigid = true;
  StaticSettings settings;
  settings.loads = {load};
  settings.probes = {{"corner", {0, 0, 1}}};
  const StaticSolution s = assembly.solve(settings);
  EXPECT_EQ(s.regions[1].body, "b");
  EXPECT_NEAR(s.regions[1].length, 1, 1e-12);
  ASSERT_EQ(s.motions.size(), 1u);
  const RegionMotion& motion = s.motions[0].second;
  const double work = 0.5 * (dot(load.vector, motion.displacement) + dot(load.moment, motion.rotation));
  EXPECT_NEAR(s.result.external_work / work, 1, 1e-9);
  EXPECT_LT(energy_defect(s.result), 1e-8);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(s.force_balance[d], 0, 1e-9);
  EXPECT_EQ(singular_place_near(s, "b", {0, 0, 1}), "support 'edge'");
  EXPECT_EQ(singular_place_near(s, "a", {0, 0, 0.9}), std::nullopt);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_HOLDS(s.warnings[0], "support 'edge' acts along a line");
  assembly.run.supports[1].place.line = {{0, 0, 0.5}, {1, 0, 0.5}}; // where both bodies are
  EXPECT_HOLDS(message_of([&] { assembly.solve(settings); }), "support 'edge': the bodies 'a' and 'b' all have");
}

TEST(Ties, TiesThatCannotBeRightAreRefused) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  Assembly assembly;
  for (const double z : {0.0, 0.53})
    assembly.add(make_part(box({0, 0, z}, {1, 1, z + 0.5}), {1, 0.4, 0.4, 0, identity_rotation}), material);
  assembly.run.supports = {held("a", facing({0, 0, -1}))};
  Tie& tie = assembly.run.ties.emplace_back(tie_of(0.01));
  const std::string nothing = message_of([&] { assembly.solve(); });
  EXPECT_HOLDS(nothing, "tie 'joint': nothing is tied");
  EXPECT_HOLDS(nothing, "the tolerance of 0.01; the smallest distance found is 0.03");
  tie.tolerance = 0.3;
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "expected at most 0.2, half the smallest span of 'a' and 'b'");
  tie.tolerance = 0.05;
  tie.bodies = {"a", "c"};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "there is no body 'c'");
  tie.bodies = {"a", "a"};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "both bodies are 'a'");
  tie.bodies = {"b", "a"};
  tie.choice = {facing({0, 0, 1}), facing({0, 0, 1})};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "nothing is tied");
  tie.choice[0] = facing({0, 0, -1});
  const StaticSolution s = assembly.solve();
  EXPECT_NEAR(s.ties[0].largest_gap, 0.03, 1e-9);
  EXPECT_NEAR(s.ties[0].area, 1, 1e-9);
}

// Two thin plates of one body above the other body, both within the tolerance.
TEST(Ties, SurfaceOnSeveralLayersIsRefused) {
  const ElasticMaterial material = isotropic(210, poisson, 7.8e-6);
  Assembly assembly;
  assembly.add(make_part(box({0, 0, 0}, {1, 1, 0.5}), {1, 0.4, 0.4, 0, identity_rotation}), material);
  assembly.add(make_part(join({box({0, 0, 0.5}, {1, 1, 0.52}), box({0, 0, 0.54}, {1, 1, 0.9})}),
                         {1, 0.4, 0.4, 0, identity_rotation}),
               material);
  assembly.run.ties = {tie_of(0.1)};
  assembly.run.supports = {held("a", facing({0, 0, -1}))};
  EXPECT_HOLDS(message_of([&] { assembly.solve(); }), "lies on several layers of the other body");
}

// Slivers of any depth beside the joint and a modulus ten thousand times the other's: no eigenvalue below zero.
TEST(Ties, SystemsStayPositiveWhateverTheCutsAndMaterials) {
  for (const double shift : {0.0, 1e-4, 0.5, 0.9999}) {
    Assembly assembly;
    assembly.add(make_part(box({0, 0, 0}, {1, 1, 0.5}), {2, 0.25, shift, 4, identity_rotation}),
                 isotropic(1e4, poisson, 1));
    assembly.add(make_part(box({0.1, 0.1, 0.5}, {0.9, 1.2, 1}), {2, 0.21, 1 - shift, 4, rotation(0.01, 0)}),
                 isotropic(1, poisson, 1));
    assembly.run.ties = {tie_of()};
    const Free free = free_modes(assembly, 3);
    EXPECT_EQ(free.outcome.modes.rigid, 6);
    EXPECT_EQ(free.outcome.modes.mechanisms, 0);
    ASSERT_TRUE(free.outcome.modes.sturm);
    EXPECT_EQ(free.outcome.modes.sturm->found, free.outcome.modes.sturm->expected);
    EXPECT_GT(free.omega[0], 0.1);
  }
}
