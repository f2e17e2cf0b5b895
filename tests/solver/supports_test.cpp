// Reactions, definiteness and refusals of supports and loads on exact boxes.
#include "format/model/errors.hpp"
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/supports/support_check.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/support/synthetic_model.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

BoxCase tilted_box(int p) {
  BoxCase box;
  box.A = {0, 0, 0};
  box.B = {7, 7, 7};
  box.spans = {7, 7, 7};
  box.degree = {p, p, p};
  box.rotation = some_rotation(0.6);
  box.lower = {2.4, 2.2, 2.7};
  box.upper = {4.7, 4.6, 4.3};
  return box;
}

Point3 axis(const TrimmedModel& model, std::size_t d) {
  const Rotation& R = model.grid.rotation();
  return {R[0][d], R[1][d], R[2][d]};
}

Support on_face(const std::string& name, SupportMethod method = SupportMethod::Nitsche) {
  Support support;
  support.name = name;
  support.region.names = {name};
  support.method = method;
  return support;
}

StaticSettings all_kinds_of_loads(const TrimmedModel& model) {
  StaticSettings settings;
  Load load;
  load.name = "weight";
  load.kind = LoadKind::BodyForce;
  load.vector = {0.01, -0.02, 0.03};
  settings.loads.push_back(load);
  load = {};
  load.name = "pressure";
  load.kind = LoadKind::Pressure;
  load.pressure = 0.5;
  load.region.names = {"u+"};
  settings.loads.push_back(load);
  load = {};
  load.name = "shear";
  load.vector = {0.1, 0, 0};
  load.frame = model.grid.rotation();
  load.region.names = {"w+"};
  settings.loads.push_back(load);
  load = {};
  load.name = "pull";
  load.kind = LoadKind::Point;
  load.vector = {0, 0, 0.2};
  load.place.at = model.grid.to_position({4, 4, 4});
  settings.loads.push_back(load);
  return settings;
}

Eigen::MatrixXd dense(const StiffnessMatrix& K) {
  Eigen::MatrixXd D(K.size(), K.size());
  for (Eigen::Index i = 0; i < K.size(); ++i) D.col(i) = K * Eigen::VectorXd::Unit(K.size(), i);
  return D;
}

class EveryMethod : public ::testing::TestWithParam<SupportMethod> {};

} // namespace

TEST_P(EveryMethod, ReactionsBalanceTheLoads) {
  const TrimmedModel model = make_box_model(tilted_box(2));
  const SolutionSpace space(model, usual());
  const StaticSettings settings = all_kinds_of_loads(model);
  const RunSettings run = run_with({on_face("u-", GetParam())});
  const StaticSolution s = run_static(run, settings, space);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(s.force_balance[d], 0, 1e-10);
    EXPECT_NEAR(s.moment_balance[d], 0, 1e-9);
  }
  // Clapeyron: strain energy = work of the loads and of the reactions, up to what the weak condition leaves open.
  EXPECT_NEAR(s.result.strain_energy / (s.result.external_work + s.result.support_work), 1, 0.02);
  EXPECT_LT(energy_defect(s.result), 1e-9);
  EXPECT_LT(s.residual, 1e-12);
}

TEST_P(EveryMethod, ResultantsOfLoadsAreExact) {
  const TrimmedModel model = make_box_model(tilted_box(2));
  const SolutionSpace space(model, usual());
  const LoadTerms terms = assemble_loads(space, 1, all_kinds_of_loads(model).loads);
  const double volume = 2.3 * 2.4 * 1.6;
  const Point3 u = axis(model, 0);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(terms.reports[0].force[d], volume * (Point3{0.01, -0.02, 0.03}[d]), 1e-12);
    EXPECT_NEAR(terms.reports[1].force[d], -0.5 * 2.4 * 1.6 * u[d], 1e-12);
    EXPECT_NEAR(terms.reports[2].force[d], 0.1 * 2.3 * 2.4 * u[d], 1e-12);
    EXPECT_NEAR(terms.reports[3].force[d], (Point3{0, 0, 0.2}[d]), 1e-15);
    double sum = 0, expected = 0; // the shape functions sum to one
    for (Eigen::Index i = 0; i < terms.load.size() / 3; ++i) sum += terms.load[3 * i + static_cast<Eigen::Index>(d)];
    for (const LoadReport& report : terms.reports) expected += report.force[d];
    EXPECT_NEAR(sum, expected, 1e-12);
  }
}

// A bar on frictionless walls, pulled: uniaxial stress, exact for every method.
TEST_P(EveryMethod, GuidesAndSymmetryPlanesLetTheRestSlide) {
  for (const int p : {1, 2, 3}) {
    const TrimmedModel model = make_box_model(tilted_box(p));
    const SolutionSpace space(model, usual());
    std::vector<Support> supports;
    for (const char* face : {"u-", "v-", "w-"}) {
      supports.push_back(on_face(face, GetParam()));
      supports.back().along_normal = face[0] != 'v';
      supports.back().fixed = {false, true, false}; // v-: the same through a turned frame
      supports.back().frame = model.grid.rotation();
      supports.back().penalty_factor = 1e8;
    }
    Load pull;
    pull.name = "pull";
    pull.region.names = {"u+"};
    pull.vector = times(axis(model, 0), 2.0);
    const RunSettings run = run_with(supports);
    StaticSettings settings;
    settings.loads = {pull};
    settings.probes = {{"end", model.grid.to_position({4.7, 4.6, 4.3})}};
    const StaticSolution s = run_static(run, settings, space);
    for (const double stress : s.result.points.von_mises) EXPECT_NEAR(stress, 2, 1e-5);
    const Point3 u{s.result.probes.fields.displacement[0], s.result.probes.fields.displacement[1],
                   s.result.probes.fields.displacement[2]};
    EXPECT_NEAR(dot(u, axis(model, 0)), 2.0 / 210 * 2.3, 1e-6);
    EXPECT_NEAR(dot(u, axis(model, 1)), -0.3 * 2.0 / 210 * 2.4, 1e-6);
    EXPECT_NEAR(dot(s.reactions[0].force, axis(model, 0)), -2.0 * 2.4 * 1.6, 1e-7);
  }
}

// The same conditions in an eigenvalue run: a bar between frictionless walls, held at one end, is a quarter of a wave.
TEST_P(EveryMethod, HoldsTheModesOfABar) {
  BoxCase box = tilted_box(2);
  box.spans = {14, 14, 14};
  const TrimmedModel model = make_box_model(box);
  RunSettings run;
  run.light = usual();
  run.material = isotropic(210, 0, 2);
  for (const char* face : {"u-", "v-", "v+", "w-", "w+"}) {
    run.supports.push_back(on_face(face, GetParam()));
    run.supports.back().along_normal = true;
    run.supports.back().penalty_factor = 1e5;
  }
  EigenSettings settings;
  settings.modes = 1;
  const EigenOutcome outcome = analyse_modes(run, settings, model);
  EXPECT_EQ(outcome.modes.rigid, 0);
  ASSERT_GE(outcome.modes.lambda.size(), 1);
  const double quarter_wave = std::numbers::pi / 2 / (4.7 - 2.4) * std::sqrt(210.0 / 2);
  EXPECT_NEAR(std::sqrt(outcome.modes.lambda[0]) / quarter_wave, 1, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         ::testing::Values(SupportMethod::Nitsche, SupportMethod::Penalty, SupportMethod::Lagrange));

// Layers from a whole span down to a millionth on all sides, without and with treatment of light functions.
TEST(Nitsche, IsPositiveDefiniteOnAnyCut) {
  for (const int p : {1, 2})
    for (const double layer : {1.0, 0.5, 1e-1, 1e-2, 1e-3, 1e-4})
      for (const LightTreatment& treatment : {usual(), LightTreatment{}}) {
        BoxCase box;
        box.B = {7, 7, 7};
        box.spans = {7, 7, 7};
        box.degree = {p, p, p};
        box.lower = {3 - layer, 3 - 0.3 * layer, 3};
        box.upper = {4 + layer, 4, 4 + 0.6 * layer};
        const TrimmedModel model = make_box_model(box);
        const SolutionSpace space(model, treatment);
        StiffnessMatrix K =
            assemble_stiffness(space, std::make_shared<const Connectivity>(space), isotropic(1, 0.3, 1));
        std::vector<Support> supports;
        for (const char* face : {"u-", "u+", "v+", "w-"}) supports.push_back(on_face(face));
        supports[1].along_normal = true;
        apply_supports(space, isotropic(1, 0.3, 1), supports, K);
        const Eigen::VectorXd scale = K.diagonal().cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * dense(K) * scale.asDiagonal();
        const double least =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()[0];
        EXPECT_GT(least, 1e-13) << "p " << p << ", layer " << layer << " " << least;
      }
}

TEST_P(EveryMethod, GivesTheSameBitsForAnyNumberOfThreads) {
  const TrimmedModel model = make_box_model(tilted_box(2));
  const SolutionSpace space(model, usual());
  const std::vector<Support> supports{on_face("u-", GetParam()), on_face("v+", GetParam())};
  struct Terms {
    std::vector<double> stiffness, constraints;
    Eigen::VectorXd load;
  };
  const auto terms = [&] {
    StiffnessMatrix K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), isotropic(1, 0.3, 1));
    const SupportTerms added = apply_supports(space, isotropic(1, 0.3, 1), supports, K);
    const auto& C = added.constraints;
    return Terms{{K.values().begin(), K.values().end()}, {C.valuePtr(), C.valuePtr() + C.nonZeros()}, added.load};
  };
  const Terms many = terms();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Terms few = terms();
  EXPECT_EQ(many.stiffness, few.stiffness);
  EXPECT_EQ(many.constraints, few.constraints);
  EXPECT_EQ(many.load, few.load);
}

TEST(FreeMotions, AreNamed) {
  BoxCase box;
  box.degree = {2, 2, 2};
  const TrimmedModel model = make_box_model(box); // 1.25 … 4.75, 1.5 … 3.5, 1 … 2.6
  const SolutionSpace space(model, usual());
  const auto message = [&](const std::vector<Support>& supports) -> std::string {
    try {
      run_static(run_with(supports), {}, space);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto has = [](const std::string& text, const char* words) {
    EXPECT_NE(text.find(words), std::string::npos) << words << " in:\n" << text;
  };
  const std::string none = message({});
  has(none, "no support is given");
  for (const char* motion :
       {"translation along (1, 0, 0)", "translation along (0, 1, 0)", "translation along (0, 0, 1)",
        "rotation about the axis (1, 0, 0)", "rotation about the axis (0, 0, 1)"})
    has(none, motion);
  Support floor = on_face("w-");
  floor.along_normal = true;
  const std::string slides = message({floor});
  has(slides, "translation along (1, 0, 0), translation along (0, 1, 0), rotation about the axis (0, 0, 1)");
  EXPECT_EQ(slides.find("translation along (0, 0, 1)"), std::string::npos) << slides;
  Support wall = on_face("u-");
  wall.along_normal = true;
  EXPECT_EQ(message({floor, wall}).find("rotation"), std::string::npos);
  EXPECT_EQ(message({on_face("v+")}), "");
}

TEST(Regions, AreChosenInEveryWayAndTheirIntersections) {
  const TrimmedModel model = make_box_model(); // 1.25 … 4.75, 1.5 … 3.5, 1 … 2.6
  const auto area = [&](const RegionChoice& choice) { return choose_region(model, choice, "test").report.area; };
  RegionChoice choice;
  EXPECT_NEAR(area(choice), 2 * (3.5 * 2 + 3.5 * 1.6 + 2 * 1.6), 1e-12);
  choice.names = {"u+"};
  EXPECT_NEAR(area(choice), 2 * 1.6, 1e-12);
  const RegionReport report = choose_region(model, choice, "test").report;
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(report.centroid[d], (Point3{4.75, 2.5, 1.8}[d]), 1e-12);
  choice = {};
  choice.numbers = {4};
  EXPECT_NEAR(area(choice), 3.5 * 2, 1e-12);
  choice = {};
  choice.box = Box3{{0, 0, 0}, {2, 10, 10}}; // up to a grid plane
  EXPECT_NEAR(area(choice), 2 * 1.6 + 2 * 0.75 * (2 + 1.6), 1e-12);
  choice.normal = RegionChoice::Direction{{0, 0, 5}, 1};
  EXPECT_NEAR(area(choice), 0.75 * 2, 1e-12);
  choice = {};
  choice.plane = RegionChoice::Plane{{0, 3.5, 0}, {0, -2, 0}, 0};
  EXPECT_NEAR(area(choice), 3.5 * 1.6, 1e-12);
}

TEST(Regions, BoxesAndPlanesCutTrianglesExactly) {
  const TrimmedModel model = make_box_model(); // 1.25 … 4.75, 1.5 … 3.5, 1 … 2.6
  const auto report = [&](const RegionChoice& choice) { return choose_region(model, choice, "test").report; };
  const auto near = [](const RegionReport& found, double area, const Point3& centroid) {
    // A place is a double near 5, wrong by up to 4.4e-16, along edges of up to 2: narrow strips feel it.
    EXPECT_NEAR(found.area, area, 1e-13 * area + 2 * 4.4e-16);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(found.centroid[d], centroid[d], 1e-12) << "xyz"[d];
  };
  RegionChoice strip; // along an edge of the upper face, much narrower than a span and than points lie apart
  strip.names = {"w+"};
  strip.box = Box3{{1.25, 0, 0}, {1.25 + 1e-3, 10, 10}};
  near(report(strip), 1e-3 * 2, {1.25 + 5e-4, 2.5, 2.6});
  RegionChoice window; // within a face, no corner of a triangle in it
  window.names = {"w-"};
  window.box = Box3{{2.1, 1.9, 0}, {2.103, 1.95, 1.5}};
  near(report(window), 0.003 * 0.05, {2.1015, 1.925, 1});
  RegionChoice band; // all around
  band.plane = RegionChoice::Plane{{3, 0, 0}, {2, 0, 0}, 0.01};
  near(report(band), 0.02 * 2 * (2 + 1.6), {3, 2.5, 1.8});
  RegionChoice slant; // a corner of the upper face cut off by a slanted plane: x + y <= 1.25 + 1.5 + 0.1
  slant.names = {"w+"};
  slant.plane = RegionChoice::Plane{{1.25, 1.5, 0}, {1, 1, 0}, 0.1 / std::sqrt(2.0)};
  near(report(slant), 0.005, {1.25 + 0.1 / 3, 1.5 + 0.1 / 3, 2.6});
}

TEST(Regions, PartsOfADividedChoiceAddUp) {
  const TrimmedModel model = make_box_model();
  const auto report = [&](const RegionChoice& choice) { return choose_region(model, choice, "test").report; };
  const RegionReport whole = report({});
  double area = 0;
  Point3 moment{};
  const double cuts[]{0, 1.7, 2.05, 2.051, 3.9, 10};
  for (std::size_t k = 0; k + 1 < std::size(cuts); ++k) {
    RegionChoice slice;
    slice.box = Box3{{cuts[k], 0, 0}, {cuts[k + 1], 10, 10}};
    const RegionReport part = report(slice);
    area += part.area;
    moment = plus(moment, times(part.centroid, part.area));
  }
  EXPECT_NEAR(area, whole.area, 1e-13 * whole.area);
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(moment[d] / area, whole.centroid[d], 1e-12);
}

TEST(Regions, SeveralRegionsAreOneChoice) {
  const TrimmedModel model = make_box_model();
  RegionChoice choice;
  choice.names = {"u+", "w-"};
  EXPECT_NEAR(choose_region(model, choice, "test").report.area, 2 * 1.6 + 3.5 * 2, 1e-12);
  choice.numbers = {5};
  EXPECT_NEAR(choose_region(model, choice, "test").report.area, 2 * 1.6 + 2 * 3.5 * 2, 1e-12);
}

TEST(Regions, EmptyChoicesAreRefusedWithWhatThereIs) {
  const TrimmedModel model = make_box_model();
  const auto message = [&](const RegionChoice& choice) -> std::string {
    try {
      choose_region(model, choice, "support 'base'");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  RegionChoice choice;
  choice.names = {"u*"};
  EXPECT_NE(message(choice).find("support 'base': there is no region 'u*'"), std::string::npos) << message(choice);
  EXPECT_NE(message(choice).find("4 'w-' (area 7)"), std::string::npos) << message(choice);
  choice = {};
  choice.numbers = {6};
  EXPECT_NE(message(choice).find("no region number 6"), std::string::npos);
  choice = {};
  choice.box = Box3{{0, 0, 0}, {1, 1, 0.5}};
  EXPECT_NE(message(choice).find("no part of the surface"), std::string::npos);
}

TEST(Locate, PointsOfThePartHaveASpanAndOthersAreRefused) {
  const TrimmedModel model = make_box_model(); // 1.25 … 4.75, 1.5 … 3.5, 1 … 2.6
  EXPECT_NEAR(winding_number(model.surface.mesh, {2, 2, 2}), 1, 1e-12);
  EXPECT_NEAR(winding_number(model.surface.mesh, {1.1, 2, 2}), 0, 1e-12);
  const LocatedPoint inside = locate(model, {2.3, 2.2, 1.7}, "probe 'a'");
  EXPECT_EQ(model.cells.span[static_cast<std::size_t>(inside.cell)], model.grid.span_number({2, 2, 1}));
  const LocatedPoint corner = locate(model, {4.75, 3.5, 2.6}, "probe 'b'");
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(corner.position[d], (Point3{4.75, 3.5, 2.6}[d]), 1e-12);
  // in an active span, but not in the solid
  try {
    locate(model, {1.1, 2, 2}, "probe 'c'");
    ADD_FAILURE() << "a point outside was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("probe 'c': the position (1.1, 2, 2) lies outside the part, 0.15 from"),
              std::string::npos)
        << error.what();
  }
}
