// Supports and loads on lines, at points, on patches and cylinders; forces and moments from a place beside their
// region.
#include "format/model/errors.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/spread_loads.hpp"
#include "solver/space/surface_patch.hpp"
#include "solver/supports/support_check.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/temp_folder.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

void expect_near(const Point3& a, const Point3& b, double tolerance) {
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(a[d], b[d], tolerance) << "xyz"[d];
}

template <class Call> std::string refusal(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
}

PlaceChoice line(std::vector<Point3> corners) {
  PlaceChoice place;
  place.line = std::move(corners);
  return place;
}
PlaceChoice at(const Point3& x) {
  PlaceChoice place;
  place.at = x;
  return place;
}

Support on(const PlaceChoice& place, const std::array<bool, 3>& fixed) {
  Support support;
  support.name = "held";
  support.place = place;
  support.fixed = fixed;
  support.method = SupportMethod::Penalty;
  return support;
}

Load with(LoadKind kind, const Point3& vector) {
  Load load;
  load.name = "load";
  load.kind = kind;
  load.vector = vector;
  return load;
}

LoadReport report_of(const SolutionSpace& space, const Load& load) {
  return assemble_loads(space, 1, std::span(&load, 1)).reports[0];
}

Point3 about(const Point3& centre, const LoadReport& report) {
  return minus(report.moment, cross(centre, report.force));
}

// A block with a bore of `facets` facets along z; region "bore". Turned by R about the origin.
TriangleMesh bored_block(int facets, double radius, const Rotation& R = identity_rotation) {
  std::vector<std::array<double, 2>> polygon{{3, 0},   {3, 3},  {0, 3},  {-3, 3}, {-3, 0},
                                             {-3, -3}, {0, -3}, {3, -3}, {3, 0}};
  std::vector<Triangle> triangles;
  const int n = 8 * facets; // inner corners follow clockwise, slit at (3, 0)
  for (int i = 0; i <= n; ++i) {
    const double t = -2 * std::numbers::pi * i / n;
    polygon.push_back({radius * std::cos(t), radius * std::sin(t)});
  }
  const auto inner = [n](int i) { return 9 + (n - i); }; // at the angle i · 360° / n
  for (int side = 0; side < 8; ++side) {
    for (int i = side * facets; i < (side + 1) * facets; ++i) triangles.push_back({side, inner(i + 1), inner(i)});
    triangles.push_back({side, side + 1, inner((side + 1) * facets)});
  }
  TriangleMesh mesh = prism(polygon, triangles, 0, 2);
  // The slit's two walls and its doubled corners go.
  const std::int32_t size = 9 + n + 1;
  std::vector<Triangle> kept;
  std::vector<std::int32_t> region;
  const auto merged = [&](std::int32_t v) {
    const std::int32_t level = v / size * size, corner = v % size;
    return level + (corner == 8 ? 0 : corner == 9 ? size - 1 : corner);
  };
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t a) { return t[a] % size; };
    const auto in_slit = [&](std::int32_t v) { return v == 0 || v == 8 || v == 9 || v == size - 1; };
    const bool on_sides = t[0] / size != t[1] / size || t[1] / size != t[2] / size;
    if (on_sides && in_slit(corner(0)) && in_slit(corner(1)) && in_slit(corner(2))) continue;
    kept.push_back({merged(t[0]), merged(t[1]), merged(t[2])});
    region.push_back(on_sides && corner(0) >= 9 && corner(1) >= 9 && corner(2) >= 9 ? 1 : 0);
  }
  mesh.triangles = std::move(kept);
  mesh.region = std::move(region);
  mesh.region_names = {"block", "bore"};
  return transformed(mesh, R, {});
}

RegionChoice named(const std::string& name) {
  RegionChoice choice;
  choice.names = {name};
  return choice;
}

void write_stl(const std::filesystem::path& file, const std::vector<std::array<Point3, 3>>& facets) {
  std::ofstream out(file);
  out << "solid patch\n";
  for (const auto& facet : facets) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const Point3& x : facet) out << fmt::format("vertex {} {} {}\n", x[0], x[1], x[2]);
    out << "endloop\nendfacet\n";
  }
  out << "endsolid patch\n";
}

const Point3 box_lower{1.25, 1.5, 1}, box_upper{4.75, 3.5, 2.6}; // of make_box_model()

} // namespace

TEST(Places, LinesAreCutAtSpanFacesAndKeepTheirLength) {
  const TrimmedModel model = make_box_model();
  const SurfaceRegion edge = choose_places(model, line({box_lower, {4.75, 1.5, 1}, {4.75, 3.5, 1}}), "test");
  EXPECT_EQ(edge.report.extent, Extent::Line);
  EXPECT_NEAR(edge.report.length, 5.5, 1e-14);
  EXPECT_EQ(edge.report.area, 0);
  expect_near(edge.report.centroid, {(3.5 * 3 + 2 * 4.75) / 5.5, (3.5 * 1.5 + 2 * 2.5) / 5.5, 1}, 1e-14);
  double first = 0, cubed = 0; // 3 Gauss points a piece: exact to degree 5
  for (std::size_t q = 0; q < edge.weights.size(); ++q) {
    const double x = edge.parameters[3 * q];
    first += edge.weights[q] * x;
    cubed += edge.weights[q] * x * x * x * x * x;
    const Box3 span = model.grid.span_box(
        model.grid.span_index(model.cells.span[static_cast<std::size_t>(edge.cells[static_cast<std::size_t>(
            std::upper_bound(edge.offsets.begin(), edge.offsets.end(), static_cast<std::int64_t>(q)) -
            edge.offsets.begin() - 1)])]));
    EXPECT_GE(x, span.lower[0]);
    EXPECT_LE(x, span.upper[0]);
  }
  EXPECT_NEAR(first, 3.5 * 3 + 2 * 4.75, 1e-13);
  EXPECT_NEAR(cubed, (std::pow(4.75, 6) - std::pow(1.25, 6)) / 6 + 2 * std::pow(4.75, 5), 1e-9);
}

TEST(Places, AreFoundByName) {
  TrimmedModel model = make_box_model();
  model.curves = {{"edge 1", "edge 2"}, {0, 2, 4}, {box_lower, {4.75, 1.5, 1}, {1.25, 3.5, 1}, {4.75, 3.5, 1}}};
  model.markers = {{"vertex 1"}, {box_upper}};
  PlaceChoice both, corner;
  both.curves = {"edge 1", "edge 2"};
  EXPECT_NEAR(choose_places(model, both, "test").report.length, 7, 1e-14);
  corner.marker = "vertex 1";
  const SurfaceRegion found = choose_places(model, corner, "test");
  EXPECT_EQ(found.report.extent, Extent::Point);
  ASSERT_EQ(found.report.places.size(), 1u);
  expect_near(found.report.places[0], box_upper, 1e-14);

  both.curves = {"edge 3"};
  expect_words(refusal([&] { choose_places(model, both, "support 'a'"); }),
               {"support 'a': there is no curve 'edge 3'", "did you mean 'edge 1'", "edge 1, edge 2"});
  both.curves = {"edge 1", "edge 1"};
  expect_words(refusal([&] { choose_places(model, both, "support 'a'"); }), {"'edge 1' is named twice"});
  corner.marker = "vertex 7";
  expect_words(refusal([&] { choose_places(model, corner, "load 'b'"); }), {"load 'b': there is no marker 'vertex 7'"});
  expect_words(refusal([&] { choose_places(make_box_model(), both, "x"); }), {"the model has none", "coordinates"});
  expect_words(refusal([&] { choose_places(model, line({box_lower, {0, 0, 0}}), "x"); }), {"outside the part"});
  expect_words(refusal([&] { choose_places(model, line({box_lower, box_lower}), "x"); }), {"no length"});
}

TEST(Places, ForcesHaveTheirResultants) {
  const TrimmedModel model = make_box_model();
  const SolutionSpace space(model, usual());
  const Point3 F{3, -1, 2};
  Load load = with(LoadKind::Line, F);
  load.place = line({box_lower, {4.75, 1.5, 1}});
  const LoadReport along = report_of(space, load);
  expect_near(along.force, F, 1e-13);
  expect_near(along.moment, cross({3, 1.5, 1}, F), 1e-12); // evenly: about its middle none
  load = with(LoadKind::Point, F);
  load.place.at = box_upper;
  const LoadReport corner = report_of(space, load);
  expect_near(corner.force, F, 1e-15);
  expect_near(corner.moment, cross(box_upper, F), 1e-13);
  const auto warnings = region_warnings(std::vector{along, corner});
  ASSERT_EQ(warnings.size(), 2u);
  expect_words(warnings[0], {"load 'load' acts along a line", "two spans (2)"});
  expect_words(warnings[1], {"at a point"});
}

// Held at three corners as a statically determinate body, pulled: uniaxial stress, and the corners carry nothing.
TEST(Places, PointsHoldABodyWithoutStress) {
  const TrimmedModel model = make_box_model();
  const SolutionSpace space(model, usual());
  const RunSettings run = run_with({on(at(box_lower), {true, true, true}), on(at({4.75, 1.5, 1}), {false, true, true}),
                                    on(at({1.25, 3.5, 1}), {false, false, true})});
  StaticSettings settings;
  for (const char* face : {"u-", "u+"}) {
    settings.loads.push_back(with(LoadKind::Traction, {face[1] == '+' ? 2.0 : -2.0, 0, 0}));
    settings.loads.back().region.names = {face};
  }
  const StaticSolution s = run_static(run, settings, space);
  for (const double stress : s.result.points.von_mises) EXPECT_NEAR(stress, 2, 1e-9);
  for (const Reaction& reaction : s.reactions) expect_near(reaction.force, {}, 1e-10);
  EXPECT_EQ(s.warnings.size(), 3u);
  EXPECT_LT(energy_defect(s.result), 1e-9);
}

// A linear field prescribed on lines alone, which hold every rigid motion: no force, no stress of a rigid one.
TEST(Places, LinesPrescribeRigidMotions) {
  const TrimmedModel model = make_box_model();
  const SolutionSpace space(model, usual());
  Support held = on(line({box_lower, {4.75, 1.5, 1}, {4.75, 3.5, 1}}), {true, true, true});
  held.value = {1e-3, 2e-3, -1e-3};
  held.gradient = {{{0, -3e-3, 2e-3}, {3e-3, 0, -1e-3}, {-2e-3, 1e-3, 0}}};
  StaticSettings settings;
  settings.probes = {{"far corner", {1.25, 3.5, 2.6}}};
  const StaticSolution s = run_static(run_with({held}), settings, space);
  const Point3 u{s.result.probes.fields.displacement[0], s.result.probes.fields.displacement[1],
                 s.result.probes.fields.displacement[2]};
  for (std::size_t d = 0; d < 3; ++d)
    EXPECT_NEAR(u[d], held.value[d] + dot(held.gradient[d], Point3{1.25, 3.5, 2.6}), 1e-12);
  for (const double stress : s.result.points.von_mises) EXPECT_NEAR(stress, 0, 1e-9);
}

TEST(Places, FreeMotionsAboutALineAreNamed) {
  const TrimmedModel model = make_box_model();
  const SolutionSpace space(model, usual());
  const std::string text = refusal([&] {
    run_static(run_with({on(line({box_lower, {4.75, 1.5, 1}}), {true, true, true})}), {}, space);
  });
  expect_words(text, {"rotation about the axis (1, 0, 0) through"});
  EXPECT_EQ(text.find("translation"), std::string::npos) << text;
}

TEST(Cylinders, AreFittedWhateverTheirFacetsAndTheirAxis) {
  for (const int facets : {1, 3, 12}) // times eight around
    for (const Rotation& R : {identity_rotation, rotation(20, 50)}) {
      const TriangleMesh mesh = bored_block(facets, 1.2, R);
      ASSERT_NEAR(volume_moments(mesh).volume,
                  72 - 2 * 4 * facets * 1.44 * std::sin(2 * std::numbers::pi / (8 * facets)), 1e-9);
      const TrimmedModel model = make_part(mesh, {2, 1.0});
      const Cylinder bore = fit_cylinder(model, choose_region(model, named("bore"), "test"), "test");
      EXPECT_NEAR(bore.radius, 1.2, 1e-9);
      EXPECT_LT(bore.deviation, 1e-9);
      EXPECT_TRUE(bore.is_bore);
      EXPECT_NEAR(std::abs(dot(bore.axis, Point3{R[0][2], R[1][2], R[2][2]})), 1, 1e-12);
      expect_near(bore.point, {R[0][2], R[1][2], R[2][2]}, 1e-9); // the middle of the bore
      expect_words(bore.text(), {"bore of radius 1.2 about the axis"});
    }
}

TEST(Cylinders, OtherFacesAreRefusedWithTheDeviation) {
  const TrimmedModel box_model = make_box_model();
  const auto fit = [](const TrimmedModel& model, const RegionChoice& choice) {
    return refusal([&] { fit_cylinder(model, choose_region(model, choice, "support 'pin'"), "support 'pin'"); });
  };
  expect_words(fit(box_model, named("u+")), {"support 'pin': the region is no cylinder", "flat"});
  expect_words(fit(box_model, {}), {"no cylinder", "normal is", "degrees"});
  const TrimmedModel ball = make_part(sphere({0, 0, 0}, 1, 3), {2, 0.5});
  expect_words(fit(ball, {}), {"no cylinder", "lies", "allowed are 1 % of the radius"});
  RegionChoice bore_and_shoulder = named("bore");
  bore_and_shoulder.names.emplace_back("block");
  expect_words(fit(make_part(bored_block(3, 1.2), {2, 1.0}), bore_and_shoulder), {"no cylinder"});
}

// A pinned bore resists everything but turning about its axis, exactly, however coarse its facets are.
TEST(Cylinders, PinnedOnesTurnFreely) {
  const TriangleMesh mesh = bored_block(2, 1.2, rotation(0, 90)); // the axis along x
  const TrimmedModel model = make_part(mesh, {2, 0.8});
  const SolutionSpace space(model, usual());
  Support pin;
  pin.name = "pin";
  pin.region = named("bore");
  pin.radial = pin.axial = true;
  expect_words(refusal([&] { run_static(run_with({pin}), {}, space); }),
               {"is free to move: rotation about the axis (1, 0, 0) through (1, 0, 0)"});
  pin.axial = false;
  expect_words(refusal([&] { run_static(run_with({pin}), {}, space); }),
               {"translation along (1, 0, 0)", "rotation about the axis (1, 0, 0)"});
  // A rigid turn about the axis costs nothing.
  for (const SupportMethod method : {SupportMethod::Nitsche, SupportMethod::Penalty}) {
    pin.axial = true;
    pin.method = method;
    const ElasticMaterial material = isotropic(210, 0.3, 1);
    StiffnessMatrix K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
    apply_supports(space, material, std::span(&pin, 1), K);
    const auto points = space.node_points();
    Eigen::VectorXd turn(space.num_unknowns()), shift = turn;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      turn.segment<3>(3 * i) = Eigen::Vector3d(0, -points(i, 2), points(i, 1));
      shift.segment<3>(3 * i) = Eigen::Vector3d(0, 1, 0);
    }
    EXPECT_LT(turn.dot(K * turn), 1e-11 * shift.dot(K * shift));
  }
}

TEST(Cylinders, PressFitsAreRadialDisplacements) {
  const TrimmedModel model = make_part(bored_block(6, 1.2), {2, 0.6});
  const SolutionSpace space(model, usual());
  Support fit, holds;
  fit.name = "press fit";
  fit.region = named("bore");
  fit.radial = fit.axial = true;
  fit.value = {0.01, 0, 0}; // the bore grows
  holds = on(at({3, 0, 1}), {false, true, false});
  const StaticSolution s = run_static(run_with({fit, holds}), {}, space);
  const FieldSamples& fields = s.surface;
  double worst = 0, mean = 0, area = 0;
  const auto& q = model.surface.quadrature;
  for (std::size_t i = 0; i < q.weights.size(); ++i) {
    if (model.surface.mesh.region[static_cast<std::size_t>(q.triangle[i])] != 1) continue;
    const Point3 x = model.grid.to_position({q.parameters[3 * i], q.parameters[3 * i + 1], q.parameters[3 * i + 2]});
    const double r = std::hypot(x[0], x[1]);
    const double u = (fields.displacement[3 * i] * x[0] + fields.displacement[3 * i + 1] * x[1]) / r;
    worst = std::max(worst, std::abs(u - 0.01));
    mean += q.weights[i] * u;
    area += q.weights[i];
  }
  EXPECT_NEAR(mean / area, 0.01, 1e-5);
  EXPECT_LT(worst, 5e-4);
  expect_near(s.reactions[0].force, {}, 1e-6); // a press fit alone pushes nowhere
}

TEST(Bearings, HaveTheirForceAndPressOneHalf) {
  for (const Rotation& R : {identity_rotation, rotation(20, 50)}) {
    const TrimmedModel model = make_part(bored_block(6, 1.2, R), {2, 1.0});
    const SolutionSpace space(model, usual());
    const Point3 across{R[0][0], R[1][0], R[2][0]}, axis{R[0][2], R[1][2], R[2][2]};
    Load load = with(LoadKind::Bearing, times(across, 5.0));
    load.region = named("bore");
    const LoadReport report = report_of(space, load);
    expect_near(report.force, times(across, 5.0), 1e-12);
    expect_near(about(axis, report), {}, 1e-3); // through the middle of the bore, to the facets
    expect_words(report.region.note, {"bore of radius 1.2"});

    const SurfaceRegion region = choose_region(model, named("bore"), "test");
    const Cylinder bore = fit_cylinder(model, region, "test");
    const TractionField field = bearing_pressure(model, region, bore, times(across, 5.0), "test");
    double largest = 0;
    for (std::size_t q = 0; q < region.weights.size(); ++q) {
      const Point3 x = model.grid.to_position(
          {region.parameters[3 * q], region.parameters[3 * q + 1], region.parameters[3 * q + 2]});
      const Point3 t = field(x, region.normals[q]), e = bore.radial(x);
      const double pressure = dot(t, e), cosine = dot(e, across);
      EXPECT_GE(pressure, -1e-15);
      EXPECT_NEAR(norm(minus(t, times(e, pressure))), 0, 1e-12);
      // p cos φ with p = 2 F / (π r length)
      EXPECT_NEAR(pressure, 2 * 5.0 / (std::numbers::pi * 1.2 * 2) * std::max(cosine, 0.0), 0.05);
      largest = std::max(largest, pressure);
    }
    EXPECT_NEAR(largest, 2 * 5.0 / (std::numbers::pi * 1.2 * 2), 0.05);

    load.vector = plus(times(across, 5.0), times(axis, 1.0));
    expect_words(refusal([&] { report_of(space, load); }), {"load 'load'", "acts along the axis", "across"});
    load.vector = plus(times(across, 5.0), times(axis, 0.01)); // typed with two digits
    expect_near(report_of(space, load).force, load.vector, 1e-12);
    load.vector = {};
    expect_words(refusal([&] { report_of(space, load); }), {"the force is zero"});
  }
  // Half a bore, pulled away from.
  const TrimmedModel model = make_part(bored_block(6, 1.2), {2, 1.0});
  const SolutionSpace space(model, usual());
  Load load = with(LoadKind::Bearing, {-1, 0, 0});
  load.region = named("bore");
  load.region.box = Box3{{0, -3, 0}, {3, 3, 2}};
  expect_words(refusal([&] { report_of(space, load); }), {"presses, the region holds", "direction of the force"});
  load.vector = {1, 0.2, 0};
  expect_near(report_of(space, load).force, load.vector, 1e-12);
}

TEST(RemoteLoads, HaveTheirForceAndMoment) {
  const TrimmedModel model = make_box_model();
  const SolutionSpace space(model, usual());
  Load load = with(LoadKind::Remote, {1, 2, -3});
  load.region.names = {"u+", "v-"};
  load.moment = {0.5, -0.25, 2};
  load.remote = Point3{10, -4, 7};
  LoadReport report = report_of(space, load);
  expect_near(report.force, load.vector, 1e-12);
  expect_near(about(*load.remote, report), load.moment, 1e-11);
  load.vector = {}; // a moment alone, wherever it acts
  report = report_of(space, load);
  expect_near(report.force, {}, 1e-12);
  expect_near(report.moment, load.moment, 1e-12);
  load.remote.reset();
  load.frame = {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
  load.vector = {1, 0, 0}; // along y
  report = report_of(space, load);
  expect_near(report.force, {0, 1, 0}, 1e-12);
  expect_near(about(report.region.centroid, report), {0.25, 0.5, 2}, 1e-12);
}

// A bar clamped at one end whose other end stays plane and rigid, pulled, bent and twisted.
TEST(RemoteLoads, RigidRegionsMoveAsOne) {
  BoxCase bar;
  bar.A = {0, 0, 0};
  bar.B = {12, 6, 6};
  bar.spans = {12, 6, 6};
  bar.lower = {2.3, 2.2, 2.1};
  bar.upper = {9.6, 3.8, 3.7};
  const TrimmedModel model = make_box_model(bar);
  const SolutionSpace space(model, usual());
  Support clamp;
  clamp.name = "clamp";
  clamp.region = named("u-");
  for (const SupportMethod method : {SupportMethod::Nitsche, SupportMethod::Lagrange}) {
    clamp.method = method;
    StaticSettings settings;
    Load load = with(LoadKind::Remote, {0.2, 0.05, -0.1});
    load.region = named("u+");
    load.moment = {0.03, 0, 0};
    load.remote = Point3{11, 3, 4};
    const StaticSolution soft = run_static(run_with({clamp}), {{load}, {}}, space);
    EXPECT_TRUE(soft.motions.empty());
    load.rigid = true;
    settings.loads = {load};
    const StaticSolution s = run_static(run_with({clamp}), settings, space);
    ASSERT_EQ(s.motions.size(), 1u);
    const RegionMotion& motion = s.motions[0].second;
    expect_near(motion.at, *load.remote, 0);
    // Work of force and moment on the motion of their place.
    const double work = 0.5 * (dot(load.vector, motion.displacement) + dot(load.moment, motion.rotation));
    EXPECT_NEAR(s.result.external_work / work, 1, 1e-9);
    EXPECT_LT(work, soft.result.external_work); // stiffer than the end that deforms
    EXPECT_GT(work, 0.9 * soft.result.external_work);
    EXPECT_LT(energy_defect(s.result), 1e-8);
    EXPECT_LT(s.residual, 1e-9);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(s.force_balance[d], 0, 1e-9);
    for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(s.moment_balance[d], 0, 1e-8);
    const auto& q = model.surface.quadrature;
    double off = 0, largest = 0;
    for (std::size_t i = 0; i < q.weights.size(); ++i) {
      if (q.normals[3 * i] < 0.5) continue;
      const Point3 x = model.grid.to_position({q.parameters[3 * i], q.parameters[3 * i + 1], q.parameters[3 * i + 2]});
      const Point3 u{s.surface.displacement[3 * i], s.surface.displacement[3 * i + 1],
                     s.surface.displacement[3 * i + 2]};
      const Point3 rigid = plus(motion.displacement, cross(motion.rotation, minus(x, motion.at)));
      off = std::max(off, norm(minus(u, rigid)));
      largest = std::max(largest, norm(u));
    }
    EXPECT_LT(off, 1e-3 * largest);
    // Timoshenko and Saint-Venant for what the end does: stretch F L / (E A), twist M L / (G c a⁴) with c = 0.1406.
    const double L = 7.3, a = 1.6, E = 210, G = E / 2.6;
    const Point3 arm = minus(*load.remote, Point3{9.6, 3, 2.9});
    const Point3 moment = plus(load.moment, cross(arm, load.vector));
    EXPECT_NEAR(motion.rotation[0], moment[0] * L / (G * 0.1406 * a * a * a * a), 0.06 * std::abs(motion.rotation[0]));
    const double bend = moment[2] * L + load.vector[1] * L * L / 2; // ∫ M_z along the bar
    EXPECT_NEAR(motion.rotation[2], bend / (E * a * a * a * a / 12), 0.03 * std::abs(motion.rotation[2]));
  }
}

TEST(Patches, ChooseThePartThatTheyCover) {
  const TempFolder folder;
  const TrimmedModel model = make_box_model(); // the upper face at z = 2.6 has two triangles
  std::vector<std::array<Point3, 3>> disc;
  const int n = 24;
  for (int i = 0; i < n; ++i) {
    const auto rim = [&](int k) {
      const double t = 2 * std::numbers::pi * k / n;
      return Point3{3 + 0.6 * std::cos(t), 2.4 + 0.6 * std::sin(t), 2.6};
    };
    disc.push_back({Point3{3, 2.4, 2.6}, rim(i), rim((i + 1) % n)});
  }
  const double area = 0.5 * n * 0.36 * std::sin(2 * std::numbers::pi / n);
  const auto chosen = [&](const std::vector<std::array<Point3, 3>>& facets, std::optional<double> tolerance = {}) {
    write_stl(folder / "patch.stl", facets);
    RegionChoice choice;
    choice.patch = RegionChoice::Patch{folder / "patch.stl", tolerance};
    return choose_region(model, choice, "support 'heads'");
  };
  const SurfaceRegion found = chosen(disc);
  EXPECT_NEAR(found.report.area, area, 1e-6); // written with the digits of a float
  expect_near(found.report.centroid, {3, 2.4, 2.6}, 1e-6);
  for (const Point3& normal : found.normals) expect_near(normal, {0, 0, 1}, 1e-12);
  expect_words(found.report.note, {"patch", "100.0 % of it found", "chosen from the facets"});

  auto turned = disc; // facets the other way round, and all of it twice: the same surface once
  for (auto& facet : turned) std::swap(facet[1], facet[2]);
  turned.insert(turned.end(), disc.begin(), disc.end());
  EXPECT_NEAR(chosen(turned).report.area, area, 1e-6);

  auto beyond = disc; // over the edge: only what lies on the part
  for (auto& facet : beyond)
    for (Point3& x : facet) x[1] += 3.5 - 2.4;
  const RegionReport half = chosen(beyond).report;
  EXPECT_NEAR(half.area, area / 2, 1e-3);
  const auto warnings = region_warnings(half, "support 'heads'");
  ASSERT_EQ(warnings.size(), 1u);
  expect_words(warnings[0], {"support 'heads': only 50 % of the patch", "tolerance"});
  EXPECT_TRUE(region_warnings(found.report, "support 'heads'").empty());

  auto lifted = disc;
  for (auto& facet : lifted)
    for (Point3& x : facet) x[2] += 0.1;
  expect_words(refusal([&] { chosen(lifted); }),
               {"support 'heads': no part of the surface", "as near as 0.1 to", "its tolerance is"});
  EXPECT_NEAR(chosen(lifted, 0.15).report.area, area, 1e-6);
  EXPECT_NEAR(chosen(disc, 0.15).report.area, area, 1e-6); // the tolerance makes no rim wider

  std::ofstream(folder / "patch.stl") << "no patch";
  RegionChoice choice;
  choice.patch = RegionChoice::Patch{folder / "patch.stl", std::nullopt};
  expect_words(refusal([&] { choose_region(model, choice, "x"); }), {"patch.stl"});
  choice.patch->file = folder / "missing.stl";
  expect_words(refusal([&] { choose_region(model, choice, "x"); }), {"missing.stl"});
}

// A bore drawn anew with other facets: all of it is found, with a tolerance from the facets.
TEST(Patches, FitRoundFacesWithOtherFacets) {
  const TempFolder folder;
  const TrimmedModel model = make_part(bored_block(4, 1.2), {2, 1.0});
  const int n = 20;
  std::vector<std::array<Point3, 3>> tube;
  for (int i = 0; i < n; ++i) {
    const auto rim = [&](int k, double z) {
      const double t = 0.05 + 2 * std::numbers::pi * k / n;
      return Point3{1.2 * std::cos(t), 1.2 * std::sin(t), z};
    };
    tube.push_back({rim(i, 0), rim(i + 1, 0), rim(i, 2)});
    tube.push_back({rim(i + 1, 0), rim(i + 1, 2), rim(i, 2)});
  }
  write_stl(folder / "tube.stl", tube);
  RegionChoice choice;
  choice.patch = RegionChoice::Patch{folder / "tube.stl", std::nullopt};
  const SurfaceRegion found = choose_region(model, choice, "test");
  const double bore = choose_region(model, named("bore"), "test").report.area;
  EXPECT_NEAR(found.report.area, bore, 1e-6 * bore);
  EXPECT_NEAR(fit_cylinder(model, found, "test").radius, 1.2, 1e-6);
}
