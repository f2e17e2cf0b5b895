// What a surface encloses at least once: overlapping bodies, surfaces that cross themselves, shared faces, free sheets.
#include "preprocessor/surface/prepare_surface.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/surface/surface_topology.hpp"
#include "tests/surface/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace iga::prep {
namespace {

using test::as_read;
using test::box_facets;
using test::moved;
using test::operator+;
using test::Soup;
using test::turned;

const Soup cube = box_facets({0, 0, 0}, {1, 1, 1});

PreparedSurface repaired(const Soup& soup) {
  SurfaceOptions options;
  options.repair = true;
  PreparedSurface out = prepare_surface(as_read(soup), options);
  EXPECT_TRUE(is_closed_chain(make_edge_table(out.mesh.triangles)));
  return out;
}

double volume(const PreparedSurface& surface) {
  return volume_moments(surface.mesh).volume;
}

bool mentions(const std::vector<std::string>& texts, const std::string& words) {
  return std::any_of(texts.begin(), texts.end(),
                     [&](const std::string& t) { return t.find(words) != std::string::npos; });
}

std::string refusal(const Soup& soup, const SurfaceOptions& options) {
  try {
    prepare_surface(as_read(soup), options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

// The prism over a closed polygon, counterclockwise where it turns left. The caps are fans about `hub`: where the
// polygon crosses itself, so do they.
Soup prism(const std::vector<std::array<double, 2>>& polygon, const std::array<double, 2>& hub, double height) {
  Soup out;
  const auto at = [](const std::array<double, 2>& p, double z) { return Point3{p[0], p[1], z}; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    out.push_back({at(a, 0), at(b, 0), at(b, height)});
    out.push_back({at(a, 0), at(b, height), at(a, height)});
    out.push_back({at(hub, height), at(a, height), at(b, height)});
    out.push_back({at(hub, 0), at(b, 0), at(a, 0)});
  }
  return out;
}

TEST(SurfaceUnion, KeepsWhatASelfCrossingShellEnclosesAtLeastOnce) {
  // A five-pointed star drawn in one stroke: its middle is enclosed twice.
  const std::vector<std::array<double, 2>> pentagram{{0, 3},
                                                     {-1.7633557568774194, -2.4270509831248424},
                                                     {2.853169548885461, 0.9270509831248424},
                                                     {-2.853169548885461, 0.9270509831248424},
                                                     {1.7633557568774194, -2.4270509831248424}};
  const PreparedSurface out = repaired(prism(pentagram, {0, 0}, 2));
  // The outline has ten corners, by turns at the radius 3 and at the inner one: ten triangles about the centre.
  const double pi = std::numbers::pi, inner = 3 * std::cos(2 * pi / 5) / std::cos(pi / 5);
  EXPECT_NEAR(volume(out), 2 * 10 * 0.5 * 3 * inner * std::sin(pi / 5), 1e-12);
  EXPECT_EQ(out.bodies, 1);
}

TEST(SurfaceUnion, OpensAPocketWhoseTopLiesInTheFace) {
  const Soup part = box_facets({0, 0, 0}, {20, 20, 20}) + turned(box_facets({5, 5, 10}, {15, 15, 20}));
  EXPECT_NE(refusal(part, {}).find("--repair"), std::string::npos);
  EXPECT_EQ(refusal(part, {}).find("0 pairs of facets"), std::string::npos);
  const PreparedSurface out = repaired(part);
  EXPECT_NEAR(volume(out), 7000, 1e-10);
  EXPECT_EQ(out.bodies, 1);
  EXPECT_EQ(out.cavities, 0);
}

TEST(SurfaceUnion, FillsACavityWithABodyThatCrossesTheWall) {
  // A hollow box, and a bar from the middle of the hollow to the outside.
  const Soup part = box_facets({0, 0, 0}, {4, 4, 4}) + turned(box_facets({1, 1, 1}, {3, 3, 3})) +
                    box_facets({1.5, 1.5, 2}, {2.5, 2.5, 5});
  const PreparedSurface out = repaired(part);
  EXPECT_NEAR(volume(out), 64 - 8 + 1 + 1, 1e-12);
}

TEST(SurfaceUnion, AddsACoplanarOverlapOnce) {
  // Two boxes that share four face planes; then three, given in any order.
  EXPECT_NEAR(volume(repaired(cube + box_facets({0.5, 0, 0}, {1.5, 1, 1}))), 1.5, 1e-14);
  EXPECT_NEAR(volume(repaired(box_facets({0.25, 0, 0}, {1.25, 1, 1}) + box_facets({0.5, 0, 0}, {1.5, 1, 1}) + cube)),
              1.5, 1e-14);
}

TEST(SurfaceUnion, UnitesTheStrutsOfALattice) {
  const std::vector<test::Strut> struts = test::body_centred_lattice(2);
  const PreparedSurface out = repaired(test::facets_of(struts));
  EXPECT_EQ(out.bodies, 1);
  // Independent: the share of points that lie in some strut, by a sequence of low discrepancy (Roberts' R3).
  constexpr int n = 40000;
  constexpr double low = -1.5, width = 23;
  std::int64_t inside = 0;
  for (int i = 0; i < n; ++i) {
    Point3 x{};
    for (std::size_t d = 0; d < 3; ++d)
      x[d] = low + width * std::fmod(i * std::pow(1 / 1.2207440846057596, d + 1), 1.0);
    inside += std::any_of(struts.begin(), struts.end(), [&](const test::Strut& s) { return s.contains(x); });
  }
  const double sampled = static_cast<double>(inside) / n * width * width * width;
  EXPECT_NEAR(volume(out), sampled, 0.01 * sampled);
  EXPECT_NEAR(volume(out), 1259, 1);
}

TEST(SurfaceUnion, DropsFinsWallsAndStraySheets) {
  const Soup fin{{{{0, 0, 1}, {1, 1, 1}, {0.5, 0.5, 2}}}}; // stands on the diagonal of the cube's top
  const PreparedSurface without_fin = repaired(cube + fin);
  EXPECT_DOUBLE_EQ(volume(without_fin), 1);
  EXPECT_TRUE(mentions(without_fin.findings, "dropped"));

  // Two boxes with one wall between them.
  Soup right = cube;
  for (auto& t : right)
    for (Point3& x : t) x[0] = 2 - x[0];
  Soup walled = cube + turned(right);
  walled.erase(walled.begin() + 22, walled.end());
  const PreparedSurface without_wall = repaired(walled);
  EXPECT_DOUBLE_EQ(volume(without_wall), 2);

  const Soup sheet{{{{3, 0, 0}, {4, 0, 0}, {4, 1, 0.5}}}, {{{3, 0, 0}, {4, 1, 0.5}, {3, 1, 0}}}};
  const PreparedSurface beside = repaired(cube + sheet);
  EXPECT_DOUBLE_EQ(volume(beside), 1);
  EXPECT_TRUE(mentions(beside.findings, "1 sheet"));
  // A box without its lid is a body with a hole, not a sheet.
  Soup open = moved(cube, 1, {3, 0, 0});
  open.erase(open.begin() + 2, open.begin() + 4);
  EXPECT_DOUBLE_EQ(volume(repaired(cube + open)), 2);
}

TEST(SurfaceUnion, NeverAdvisesWhatWasJustTried) {
  const Soup sheets{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0.2, 0.1, 0.5}, {0.9, 0.4, 0.3}, {0.3, 0.8, 0.7}}}};
  SurfaceOptions options;
  options.repair = true;
  EXPECT_EQ(refusal(sheets, options).find("--repair closes"), std::string::npos);
  options.wrap = true;
  options.wrap_alpha = 0.2;
  EXPECT_EQ(refusal(sheets, options).find("; --wrap"), std::string::npos);
}

// Wrapping keeps a stray sheet as a fin and rounds the body: it is advised only where a repair has failed.
TEST(SurfaceUnion, AdvisesRepairsBeforeWrapping) {
  const Soup stray = cube + Soup{{{{2, 0, 0}, {3, 0, 0}, {2, 1, 0}}}};
  EXPECT_NE(refusal(stray, {}).find("--repair"), std::string::npos);
  EXPECT_EQ(refusal(stray, {}).find("--wrap"), std::string::npos);
  EXPECT_DOUBLE_EQ(volume(repaired(stray)), 1);
  EXPECT_EQ(refusal(cube + moved(cube, 1, {0.5, 0.5, 0.5}), {}).find("--wrap"), std::string::npos);
  // What no option mends is answered with none.
  const std::string line = refusal({{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}}}, {});
  EXPECT_NE(line.find("lie on a line"), std::string::npos) << line;
  EXPECT_EQ(line.find("--"), std::string::npos) << line;
}

TEST(SurfaceUnion, ShowsItsProgress) {
  std::vector<std::int64_t> done;
  SurfaceOptions options;
  options.repair = true;
  options.progress = [&](std::int64_t now, std::int64_t total) {
    EXPECT_LE(now, total);
    done.push_back(now);
  };
  prepare_surface(as_read(cube + moved(cube, 1, {0.5, 0.5, 0.5}) + moved(cube, 1, {-0.3, 0.4, 0.2})), options);
  EXPECT_GT(done.size(), 10U);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  EXPECT_LT(done.front(), 100);
  EXPECT_GT(done.back(), 900);
}

// Boxes in boxes, each outwards: walls inside the outermost one go, however many there are.
TEST(SurfaceUnion, DropsSeveralNestedInnerWalls) {
  Soup nested = moved(cube, 10, {0, 0, 0});
  for (const double wall : {1.0, 2.0, 3.0, 4.0}) nested = nested + moved(cube, 10 - 2 * wall, {wall, wall, wall});
  const PreparedSurface one = repaired(nested);
  EXPECT_DOUBLE_EQ(volume(one), 1000);
  EXPECT_EQ(one.bodies, 1);
  EXPECT_EQ(one.cavities, 0);
  // A cavity within the outermost one, with a body that holds another body in it.
  const Soup hollow = moved(cube, 10, {0, 0, 0}) + turned(moved(cube, 8, {1, 1, 1})) + moved(cube, 4, {3, 3, 3}) +
                      moved(cube, 2, {4, 4, 4});
  const PreparedSurface two = repaired(hollow);
  EXPECT_NEAR(volume(two), 1000 - 512 + 64, 1e-9);
  EXPECT_EQ(two.bodies, 2);
  EXPECT_EQ(two.cavities, 1);
}

TEST(SurfaceWrap, RefusesFacetsOnALineOrPoint) {
  SurfaceOptions options;
  options.wrap = true;
  const Soup line{{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}}}, diagonal{{{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}}};
  for (const Soup& soup : {line, diagonal, moved(line, 0, {1, 2, 3})})
    for (bool repair : {false, true}) {
      options.repair = repair;
      EXPECT_NE(refusal(soup, options).find("export the part again"), std::string::npos) << refusal(soup, options);
    }
}

TEST(SurfaceWrap, WrapsAtAnyLengthThatCanBeIntegratedAndRefusesOthers) {
  SurfaceOptions options;
  options.wrap = true;
  Soup open = cube;
  open.pop_back();
  for (double scale : {1e-29, 1e-12, 1.0, 1e12, 1e29}) {
    options.wrap_alpha = 2 * scale;
    options.wrap_offset = 0.02 * scale;
    const double v = volume(prepare_surface(as_read(moved(open, scale, {})), options));
    EXPECT_GT(v / (scale * scale * scale), 1) << scale;
    EXPECT_LT(v / (scale * scale * scale), 1.5) << scale;
  }
  options.wrap_alpha.reset();
  options.wrap_offset.reset();
  for (double scale : {1e-160, 1e-300, 1e100, 1e160})
    EXPECT_NE(refusal(moved(open, scale, {}), options).find("--scale"), std::string::npos) << scale;
}

// Random small surfaces: closed bodies in any position, needles, duplicated and turned facets, soups. Each is prepared
// plainly, with repairs and with wrapping; it ends with a closed surface or a refusal.
Soup random_soup(std::mt19937& random) {
  std::uniform_real_distribution<double> real(0, 1);
  std::uniform_int_distribution<int> small(0, 3), kind(0, 7);
  const auto grid_point = [&] { return Point3{0.5 * small(random), 0.5 * small(random), 0.5 * small(random)}; };
  const auto any_point = [&] { return Point3{real(random), real(random), real(random)}; };
  Soup out;
  const int parts = 1 + small(random);
  for (int p = 0; p < parts; ++p) switch (kind(random)) {
    case 0:
      out = out + moved(cube, 0.5 + 0.5 * small(random), grid_point());
      break;
    case 1:
      out = out + moved(turned(cube), 0.5 + 0.5 * small(random), grid_point());
      break;
    case 2:
      out = out + test::Strut{any_point(), plus(any_point(), {0, 0, 1}), 0.3}.facets();
      break;
    case 3:
      for (int i = 0; i < 6; ++i) out.push_back({grid_point(), grid_point(), grid_point()});
      break;
    case 4:
      for (int i = 0; i < 6; ++i) out.push_back({any_point(), any_point(), any_point()});
      break;
    case 5: { // needle
      const Point3 a = any_point(), b = any_point();
      out.push_back({a, b, plus(times(plus(a, b), 0.5), times(any_point(), 1e-14))});
      break;
    }
    case 6:
      if (!out.empty()) out.push_back(out[static_cast<std::size_t>(small(random)) % out.size()]);
      break;
    default:
      if (!out.empty()) out.erase(out.begin() + small(random) % static_cast<int>(out.size()));
    }
  if (out.empty()) out = cube;
  return out;
}

TEST(SurfaceAttack, RandomSurfacesEndClosedOrRefused) {
  constexpr int tries = 40;
  std::mt19937 random(11);
  std::uniform_int_distribution<int> exponent(-3, 3);
  int accepted = 0, refused = 0;
  for (int i = 0; i < tries; ++i) {
    const double scale = std::pow(10.0, 9.5 * exponent(random));
    const Soup soup = moved(random_soup(random), scale, {});
    for (int mode = 0; mode < (i % 10 == 0 ? 3 : 2); ++mode) {
      SurfaceOptions options;
      options.repair = mode == 1;
      options.wrap = mode == 2;
      options.wrap_alpha = 0.3 * scale;
      try {
        const PreparedSurface out = prepare_surface(as_read(soup), options);
        EXPECT_TRUE(is_closed_chain(make_edge_table(out.mesh.triangles))) << "try " << i << ", mode " << mode;
        EXPECT_GT(volume(out), 0) << "try " << i << ", mode " << mode;
        ++accepted;
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  RecordProperty("accepted", accepted);
  RecordProperty("refused", refused);
  EXPECT_GT(accepted, tries / 2);
}

} // namespace
} // namespace iga::prep
