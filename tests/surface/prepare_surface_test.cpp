// Judging and mending surfaces: small shapes with known volumes.
#include "preprocessor/surface/prepare_surface.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/surface/surface_topology.hpp"
#include "tests/surface/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace iga::prep {
namespace {

using test::as_read;
using test::box_facets;
using test::moved;
using test::operator+;
using test::Soup;
using test::turned;

const Soup cube = box_facets({0, 0, 0}, {1, 1, 1});

SurfaceOptions repairing() {
  SurfaceOptions options;
  options.repair = true;
  return options;
}

double volume(const PreparedSurface& surface) {
  return volume_moments(surface.mesh).volume;
}

PreparedSurface prepare(const Soup& soup, const SurfaceOptions& options = {}) {
  PreparedSurface out = prepare_surface(as_read(soup), options);
  EXPECT_TRUE(is_closed_chain(make_edge_table(out.mesh.triangles)));
  EXPECT_EQ(out.mesh.region.size(), out.mesh.triangles.size());
  return out;
}

std::string refusal(const Soup& soup, const SurfaceOptions& options = {}) {
  try {
    prepare_surface(as_read(soup), options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

bool mentions(const std::vector<std::string>& texts, const std::string& words) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& t) { return t.find(words) != std::string::npos; });
}

#define EXPECT_REFUSED(soup, words) EXPECT_NE(refusal(soup).find(words), std::string::npos) << refusal(soup)

TEST(PrepareSurface, LeavesACleanPartAlone) {
  const PreparedSurface out = prepare(cube);
  EXPECT_EQ(out.mesh.vertices.size(), 8U);
  EXPECT_EQ(out.mesh.triangles.size(), 12U);
  EXPECT_EQ(out.bodies, 1);
  EXPECT_EQ(out.cavities, 0);
  EXPECT_FALSE(out.shape_changed);
  EXPECT_TRUE(out.findings.empty());
  EXPECT_DOUBLE_EQ(volume(out), 1);
}

// Some exporters leave facets at the origin; a part of 64 there was "no volume" beside a box of two million.
TEST(PrepareSurface, FacetsWithoutSizeDoNotCountForTheSizeOfThePart) {
  const Point3 origin{}, along{0, 0, 5};
  const Soup far = moved(cube, 64, {1e6, 2e6, 0}) + Soup{{{origin, origin, origin}}, {{origin, along, along}}};
  const PreparedSurface out = prepare(far);
  EXPECT_DOUBLE_EQ(volume(out), 262144);
  EXPECT_EQ(out.mesh.vertices.size(), 8U);
  EXPECT_TRUE(mentions(out.findings, "2 facets with coinciding vertices dropped"));
}

TEST(PrepareSurface, JoinsVerticesOnlyAlongOpenEdges) {
  // A plate much thinner than the welding distance stays when it is closed …
  const Soup plate = box_facets({0, 0, 0}, {1, 1, 3e-8});
  EXPECT_NEAR(volume(prepare(plate)) / 3e-8, 1, 1e-12);
  // … while rounding differences along an edge close.
  Soup cracked = cube;
  cracked[0][0][0] += 3e-8;
  const PreparedSurface out = prepare(cracked);
  EXPECT_EQ(out.mesh.vertices.size(), 8U);
  EXPECT_TRUE(mentions(out.findings, "joined with a neighbour"));
  EXPECT_FALSE(out.shape_changed);
}

// One side of a box meshed finer than its neighbours, which know nothing of the new vertices.
TEST(PrepareSurface, SplitsNeighboursAtVerticesOnTheirEdges) {
  constexpr int n = 7;
  test::Soup soup;
  for (const auto& t : test::box_facets({0, 0, 0}, {1, 1, 1}))
    if (!(t[0][2] == 1 && t[1][2] == 1 && t[2][2] == 1)) soup.push_back(t);
  const auto p = [](int i, int j) { return Point3{i / double{n}, j / double{n}, 1}; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      soup.push_back({p(i, j), p(i + 1, j), p(i + 1, j + 1)});
      soup.push_back({p(i, j), p(i + 1, j + 1), p(i, j + 1)});
    }
  const PreparedSurface out = prepare_surface(test::as_read(soup), {});
  EXPECT_FALSE(out.shape_changed);
  EXPECT_NEAR(volume_moments(out.mesh).volume, 1, 1e-14);
  EXPECT_EQ(out.mesh.triangles.size(), soup.size() + 4 * (n - 1));
}

TEST(PrepareSurface, TurnsFlippedFacetsAndInsideOutParts) {
  Soup flipped = cube;
  std::swap(flipped[5][0], flipped[5][1]);
  const PreparedSurface one = prepare(flipped);
  EXPECT_DOUBLE_EQ(volume(one), 1);
  EXPECT_TRUE(mentions(one.findings, "1 flipped facet turned"));
  const PreparedSurface all = prepare(turned(cube));
  EXPECT_DOUBLE_EQ(volume(all), 1);
  EXPECT_TRUE(mentions(all.findings, "inside out"));
}

TEST(PrepareSurface, DropsDuplicatesAndCollapsedFacets) {
  Soup soup = cube;
  soup.push_back(cube[3]);
  soup.push_back({cube[2][1], cube[2][2], cube[2][0]});
  soup.push_back({cube[0][0], cube[0][0], cube[0][1]});
  const PreparedSurface out = prepare(soup);
  EXPECT_EQ(out.mesh.triangles.size(), 12U);
  EXPECT_TRUE(mentions(out.findings, "2 duplicate facets dropped"));
  EXPECT_TRUE(mentions(out.findings, "1 facet with coinciding vertices dropped"));
  EXPECT_EQ(prepare(cube + cube).mesh.triangles.size(), 12U) << "the same body twice";
  Soup back = cube;
  back.push_back(turned({cube[7]})[0]);
  EXPECT_DOUBLE_EQ(volume(prepare(back)), 1) << "a facet given again with its back: the fitting one stays";
}

TEST(PrepareSurface, CancelsWallsBetweenTouchingBodies) {
  // Facets 10 and 11 of the left box lie on 8 and 9 of the right one; mirrored so that the diagonals agree.
  Soup right = cube;
  for (auto& t : right)
    for (Point3& x : t) x[0] = 2 - x[0];
  const PreparedSurface out = prepare(cube + turned(right));
  EXPECT_EQ(out.mesh.triangles.size(), 20U);
  EXPECT_DOUBLE_EQ(volume(out), 2);
  EXPECT_TRUE(mentions(out.findings, "opposite pairs"));
}

TEST(PrepareSurface, AcceptsBodiesThatTouch) {
  const PreparedSurface edge = prepare(cube + moved(cube, 1, {1, 1, 0}));
  EXPECT_EQ(edge.bodies, 2);
  EXPECT_DOUBLE_EQ(volume(edge), 2);
  EXPECT_TRUE(mentions(edge.findings, "more than two facets"));
  const PreparedSurface point = prepare(cube + moved(cube, 1, {1, 1, 1}));
  EXPECT_EQ(point.bodies, 2);
  // Face on face with other facets, once exactly and once with the rounding of single precision.
  EXPECT_EQ(prepare(cube + box_facets({0.2, 0.3, 1}, {0.8, 0.7, 2})).bodies, 2);
  EXPECT_EQ(prepare(cube + box_facets({0.2, 0.3, 1 - 1e-8}, {0.8, 0.7, 2})).bodies, 2);
}

TEST(PrepareSurface, TellsCavitiesFromBodiesInsideBodies) {
  const Soup inner = box_facets({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75});
  const PreparedSurface hollow = prepare(cube + turned(inner));
  EXPECT_EQ(hollow.bodies, 1);
  EXPECT_EQ(hollow.cavities, 1);
  EXPECT_DOUBLE_EQ(volume(hollow), 0.875);
  EXPECT_DOUBLE_EQ(volume(prepare(turned(cube) + inner)), 0.875) << "inside out as a whole";
  EXPECT_DOUBLE_EQ(volume(prepare(turned(cube) + turned(inner))), 0.875) << "only the outer shell inside out";
  const Soup innermost = box_facets({0.375, 0.375, 0.375}, {0.625, 0.625, 0.625});
  const PreparedSurface onion = prepare(cube + turned(inner) + turned(innermost));
  EXPECT_EQ(onion.bodies, 2) << "a body in a cavity is a body whichever way it faced";
  EXPECT_NEAR(volume(onion), 0.875 + 1.0 / 64, 1e-14);

  EXPECT_REFUSED(cube + inner, "inside another body");
  EXPECT_REFUSED(cube + inner, "--repair");
  const PreparedSurface united = prepare(cube + inner, repairing());
  EXPECT_DOUBLE_EQ(volume(united), 1);
  EXPECT_TRUE(united.shape_changed);
}

TEST(PrepareSurface, BelievesStoredNormalsOfACavity) {
  ReadMesh input = as_read(cube + box_facets({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}));
  for (std::size_t t = 0; t < 24; ++t) {
    const Point3 a = area_vector(input.mesh, t);
    input.facet_normals[t] = times(a, t < 12 ? 1 : -1);
  }
  const PreparedSurface out = prepare_surface(std::move(input), {});
  EXPECT_EQ(out.cavities, 1);
  EXPECT_DOUBLE_EQ(volume(out), 0.875);
}

TEST(PrepareSurface, UnitesOverlappingBodies) {
  const Soup two = cube + box_facets({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75});
  EXPECT_REFUSED(two, "bodies overlap");
  EXPECT_REFUSED(two, "--repair");
  const PreparedSurface out = prepare(two, repairing());
  EXPECT_EQ(out.bodies, 1);
  EXPECT_NEAR(volume(out), 1.125, 1e-14);
  EXPECT_TRUE(out.shape_changed);
}

TEST(PrepareSurface, KeepsRegionsThroughAUnion) {
  ReadMesh input = as_read(cube + box_facets({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75}));
  input.mesh.region_names = {"block", "peg"};
  for (std::size_t t = 12; t < 24; ++t) input.mesh.region[t] = 1;
  const PreparedSurface out = prepare_surface(std::move(input), repairing());
  double area[2] = {0, 0};
  for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t)
    area[out.mesh.region[t]] += 0.5 * norm(area_vector(out.mesh, t));
  EXPECT_NEAR(area[0], 6 - 0.25, 1e-13);
  EXPECT_NEAR(area[1], 0.25 + 4 * 0.5 * 0.5, 1e-13);
}

TEST(PrepareSurface, FindsOverlapsWhoseFacetsOnlyTouch) {
  // A peg stuck into a block, with its facets split at the block's face: no facet crosses another in its interior.
  Soup lower = box_facets({0.25, 0.25, 0.5}, {0.75, 0.75, 1}), upper = box_facets({0.25, 0.25, 1}, {0.75, 0.75, 1.5});
  lower.erase(lower.begin() + 2, lower.begin() + 4);
  upper.erase(upper.begin(), upper.begin() + 2);
  EXPECT_REFUSED(cube + lower + upper, "bodies overlap");
  EXPECT_NEAR(volume(prepare(cube + lower + upper, repairing())), 1.125, 1e-14);
}

TEST(PrepareSurface, RemovesSelfIntersections) {
  // The middle of a cube's top is pulled through its bottom: a pyramid-shaped pit that ends as a hole of side 1/3.
  Soup pierced = cube;
  pierced.erase(pierced.begin() + 2, pierced.begin() + 4);
  const std::array<Point3, 4> top{{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  for (std::size_t i = 0; i < 4; ++i) pierced.push_back({top[i], top[(i + 1) % 4], {0.5, 0.5, -0.5}});
  EXPECT_TRUE(mentions(prepare(pierced).warnings, "crosses itself"));
  const PreparedSurface out = prepare(pierced, repairing());
  EXPECT_TRUE(mentions(out.findings, "self-intersections removed"));
  EXPECT_NEAR(volume(out), 1 - (std::pow(1.5, 3) - std::pow(0.5, 3)) / 6.75, 1e-13);
}

TEST(PrepareSurface, FillsHolesWhenAllowed) {
  Soup open = cube;
  open.erase(open.begin() + 4, open.begin() + 6);
  EXPECT_REFUSED(open, "the surface is open: 4 edges");
  EXPECT_REFUSED(open, "first one near");
  EXPECT_REFUSED(open, "--repair");
  const PreparedSurface out = prepare(open, repairing());
  EXPECT_DOUBLE_EQ(volume(out), 1);
  EXPECT_EQ(out.mesh.region_names.back(), "repaired");
  EXPECT_EQ(std::count(out.mesh.region.begin(), out.mesh.region.end(), 1), 2);
}

TEST(PrepareSurface, ClosesWideCracks) {
  Soup cracked = cube;
  for (std::size_t t = 0; t < cracked.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t d = 0; d < 3; ++d)
        cracked[t][i][d] += 2e-3 * std::sin(7.0 * static_cast<double>(9 * t + 3 * i + d));
  EXPECT_REFUSED(cracked, "--repair");
  const PreparedSurface out = prepare(cracked, repairing());
  EXPECT_EQ(out.mesh.vertices.size(), 8U);
  EXPECT_NEAR(volume(out), 1, 0.01);
}

TEST(PrepareSurface, LetsOpenSurfacesThroughOnlyWhenAsked) {
  Soup open = cube;
  open.pop_back();
  SurfaceOptions options;
  options.accept_leaks = true;
  const PreparedSurface out = prepare_surface(as_read(open), options);
  EXPECT_TRUE(mentions(out.warnings, "accepted as asked"));
}

TEST(PrepareSurface, RefusesSurfacesThatEncloseNothing) {
  EXPECT_REFUSED((Soup{cube[0]} + turned({cube[0]})), "cancel in pairs");
  Soup flat = moved(cube, 1, {0, 0, 0});
  for (auto& t : flat)
    for (Point3& x : t) x[2] = 0.3 * x[0];
  EXPECT_NE(refusal(flat), "accepted");
  EXPECT_REFUSED(moved(cube, 0, {1, 2, 3}), "no extent");
  const Soup soup{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0.2, 0.1, 0.5}, {0.9, 0.4, 0.3}, {0.3, 0.8, 0.7}}}};
  EXPECT_NE(refusal(soup, repairing()).find("--wrap"), std::string::npos);
}

TEST(PrepareSurface, WrapsAsTheLastResort) {
  Soup open = cube;
  open.pop_back();
  SurfaceOptions options;
  options.wrap = true;
  options.wrap_alpha = 0.1;
  EXPECT_NE(refusal(open, options).find("only a skin"), std::string::npos) << "the wrap enters through the hole";
  options.wrap_alpha = 2;
  options.wrap_offset = 0.02;
  const PreparedSurface out = prepare(open, options);
  EXPECT_TRUE(out.shape_changed);
  EXPECT_TRUE(mentions(out.findings, "wrapped"));
  EXPECT_TRUE(mentions(out.warnings, "approximated"));
  EXPECT_GT(volume(out), 1);
  EXPECT_LT(volume(out), 1.5);
  EXPECT_FALSE(prepare(cube, options).shape_changed) << "a good surface is not wrapped";
}

TEST(PrepareSurface, SplitsRegionsAtSharpEdges) {
  SurfaceOptions options;
  options.region_angle = 30;
  const PreparedSurface out = prepare(cube, options);
  ASSERT_EQ(out.mesh.region_names.size(), 6U);
  EXPECT_EQ(out.mesh.region_names.front(), "surface/1");
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(out.mesh.region[t], static_cast<std::int32_t>(t / 2));
  options.region_angle = 95;
  EXPECT_EQ(prepare(cube, options).mesh.region_names, std::vector<std::string>{"surface"});
}

class AnySize : public ::testing::TestWithParam<std::pair<double, double>> {};

TEST_P(AnySize, JudgesAndMendsAlike) {
  const auto [factor, shift] = GetParam();
  const Point3 by{shift * factor, -shift * factor, 0.5 * shift * factor};
  const double unit = factor * factor * factor;
  const double rounding = 1e-14 + 1e-13 * shift;
  Soup cracked = cube, open = cube;
  cracked[0][0][0] += 1e-7;
  open.erase(open.begin());
  EXPECT_NEAR(volume(prepare(moved(cracked, factor, by))) / unit, 1, 1e-6);
  EXPECT_NEAR(volume(prepare(moved(open, factor, by), repairing())) / unit, 1, rounding);
  const Soup two = cube + box_facets({0.5, 0.25, 0.25}, {1.5, 0.75, 0.75});
  EXPECT_REFUSED(moved(two, factor, by), "bodies overlap");
  EXPECT_NEAR(volume(prepare(moved(two, factor, by), repairing())) / unit, 1.125, rounding);
  EXPECT_EQ(prepare(moved(cube + box_facets({0.2, 0.3, 1}, {0.8, 0.7, 2}), factor, by)).bodies, 2);
}

INSTANTIATE_TEST_SUITE_P(PrepareSurface, AnySize,
                         ::testing::Values(std::pair{1.0, 0.0}, std::pair{1e-6, 0.0}, std::pair{1e6, 0.0},
                                           std::pair{1.0, 1e4}, std::pair{1e-3, 1e4}));

} // namespace
} // namespace iga::prep
