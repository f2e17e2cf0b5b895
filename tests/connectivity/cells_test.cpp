// Pieces, links, copies and cells on solids whose connectivity is known.
#include "format/model/span_state.hpp"
#include "preprocessor/connectivity/cells.hpp"
#include "preprocessor/fit/span_part.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "tests/embed/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <set>
#include <tbb/global_control.h>

namespace iga::prep {
namespace {

using namespace iga::test;

struct Split {
  Trimming whole, trimming;
  CellTable cells;
  CellCounts counts;
};

// Copies alone, unless asked for: what happens at the ends of gaps has tests of its own.
Split split(const SplineGrid& grid, const TriangleMesh& mesh, bool split_gap_ends = false) {
  Split out;
  TrimOptions options;
  options.split_gap_ends = split_gap_ends;
  out.whole = trim(grid, mesh, options);
  out.trimming = out.whole;
  out.cells = split_into_cells(grid, options, out.trimming);
  TrimmedModel model;
  place_cells(Trimming(out.trimming), CellTable(out.cells), model);
  out.counts = count_cells(model);
  return out;
}

std::vector<double> moments_of(const SplineGrid& grid, const Trimming& trimming, std::size_t touched) {
  const std::array<int, 3> degree{2, 2, 2};
  const FarMoments far(grid, trimming, degree);
  LocalSurface surface;
  gather_local_surface(grid, trimming, touched, surface);
  std::vector<double> in_box(27);
  span_moments(surface, far.find(touched), degree, in_box.data());
  // Monomials of the span's own coordinates say the same about parts with different boxes: degree 1 will do.
  std::vector<double> out;
  const double V = surface.box_volume();
  const auto mean = [&](std::size_t d, double first) {
    const double size = surface.box.upper[d] - surface.box.lower[d];
    return V * (surface.box.lower[d] * in_box[0] + size * (0.5 * (in_box[0] + first)));
  };
  out.push_back(V * in_box[0]);
  out.push_back(mean(0, in_box[1]));
  out.push_back(mean(1, in_box[3]));
  out.push_back(mean(2, in_box[9]));
  return out;
}

// Every span's cells add up to it, in volume and first moments.
void expect_same_moments(const SplineGrid& grid, const Split& s) {
  double worst = 0;
  for (std::size_t c = 0; c < s.trimming.active.size();) {
    const std::int64_t span = s.trimming.active[c];
    std::size_t end = c;
    while (end < s.trimming.active.size() && s.trimming.active[end] == span) ++end;
    if (end - c > 1) {
      std::vector<double> sum(4, 0.0);
      for (; c < end; ++c) {
        const auto m = moments_of(grid, s.trimming, static_cast<std::size_t>(s.trimming.touched[c]));
        EXPECT_NEAR(m[0], s.trimming.fraction[c], 1e-12);
        for (std::size_t k = 0; k < 4; ++k) sum[k] += m[k];
      }
      const auto at = std::lower_bound(s.whole.pieces.spans.begin(), s.whole.pieces.spans.end(), span);
      const auto whole = moments_of(grid, s.whole, static_cast<std::size_t>(at - s.whole.pieces.spans.begin()));
      for (std::size_t k = 0; k < 4; ++k) worst = std::max(worst, std::abs(sum[k] - whole[k]));
    }
    c = end;
  }
  EXPECT_LE(worst, 1e-12);
}

// Copies of a function belong to cells that links inside the support join, and to no others.
void expect_connected_copies(const SplineGrid& grid, const Split& s) {
  const auto p = grid.degree();
  const auto local = static_cast<std::size_t>((p[0] + 1) * (p[1] + 1) * (p[2] + 1));
  for (std::size_t c = 0; c < s.trimming.active.size(); ++c) {
    const Index3 ijk = grid.span_index(s.trimming.active[c]);
    std::size_t f = c * local;
    for (int w = 0; w <= p[2]; ++w)
      for (int v = 0; v <= p[1]; ++v)
        for (int u = 0; u <= p[0]; ++u, ++f)
          ASSERT_EQ(s.cells.function[static_cast<std::size_t>(s.cells.functions[f])],
                    grid.function_number({ijk[0] + u, ijk[1] + v, ijk[2] + w}));
  }
  for (const PieceLink& link : s.trimming.links) { // what both see of a function is the same copy
    std::set<std::int32_t> low(
        s.cells.functions.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(link.low) * local),
        s.cells.functions.begin() + static_cast<std::ptrdiff_t>((static_cast<std::size_t>(link.low) + 1) * local));
    std::size_t shared = 0;
    for (std::size_t f = 0; f < local; ++f)
      shared += low.count(s.cells.functions[static_cast<std::size_t>(link.high) * local + f]);
    ASSERT_EQ(shared, local / static_cast<std::size_t>(p[link.axis] + 1) * static_cast<std::size_t>(p[link.axis]));
  }
}

void expect_sound(const SplineGrid& grid, const Split& s) {
  EXPECT_EQ(s.cells.unclear_spans, 0);
  expect_same_moments(grid, s);
  expect_connected_copies(grid, s);
}

TriangleMesh two_blocks(double gap) {
  return join({box({0, 0, 0}, {20, 20, 14.37}), box({0, 0, 14.37 + gap}, {20, 20, 30})});
}

TEST(Cells, TwoBlocksOfAnyGapAreTwoBodies) {
  for (const double gap : {1.0, 1e-3, 1e-8}) {
    for (int degree = 1; degree <= 4; ++degree) {
      const TriangleMesh mesh = transformed(two_blocks(gap), rotation(13, 9), {1.234, 2.345, 3.456});
      const SplineGrid grid = grid_around(mesh, 5, degree, 0.37);
      const Split s = split(grid, mesh);
      EXPECT_EQ(s.counts.components, 2) << gap << " p" << degree;
      EXPECT_GT(s.counts.split_spans, 0);
      EXPECT_GT(s.counts.copied_functions, 0);
      expect_sound(grid, s);
    }
  }
}

TEST(Cells, GapBetweenGridPlanesOfAlignedBlocks) {
  for (const double height : {5.0, 10.0, 9.99999, 10.00001, 12.5}) {
    const TriangleMesh mesh = join({box({0, 0, 0}, {20, 20, height}), box({0, 0, height + 1e-4}, {20, 20, 25})});
    const SplineGrid grid = grid_around(mesh, 5, 2);
    const Split s = split(grid, mesh);
    EXPECT_EQ(s.counts.components, 2) << height;
    expect_same_moments(grid, s);
    expect_connected_copies(grid, s);
  }
}

TEST(Cells, ConvexBodyHasOneCellPerSpanAndNoCopies) {
  const TriangleMesh mesh = sphere({0.1, 0.2, 0.3}, 10, 3);
  const SplineGrid grid = grid_around(mesh, 3, 2, 0.31);
  const Split s = split(grid, mesh);
  EXPECT_EQ(s.counts.components, 1);
  EXPECT_EQ(s.counts.split_spans, 0);
  EXPECT_EQ(s.counts.copied_functions, 0);
  EXPECT_EQ(s.trimming.active, s.whole.active);
  EXPECT_EQ(s.trimming.pieces.offsets, s.whole.pieces.offsets);
  expect_connected_copies(grid, s);
}

TEST(Cells, BoxOnAPlateInAGridPlaneIsOneBody) {
  // The box's foot lies inside the plate's top, in a grid plane: no trace is common to both spans.
  TriangleMesh mesh = prism({{0, 0}, {30, 0}, {30, 10}, {22, 10}, {22, 20}, {8, 20}, {8, 10}, {0, 10}},
                            {{0, 1, 4}, {1, 2, 3}, {1, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 7}}, 0, 30);
  const SplineGrid grid = grid_around(mesh, 10, 2);
  const Split s = split(grid, mesh);
  EXPECT_EQ(s.counts.components, 1);
  EXPECT_EQ(s.cells.unclear_spans, 0);
  expect_connected_copies(grid, s);
}

TEST(Cells, ShellInsideASpan) {
  const SplineGrid grid({0, 0, 0}, {30, 30, 30}, {3, 3, 3}, {2, 2, 2}, identity_rotation);
  const TriangleMesh ball = sphere({15, 15, 15}, 2, 2), hole = flipped(sphere({15, 15, 15}, 4, 2));
  const TriangleMesh block = box({2, 2, 2}, {28, 28, 28});
  const Split cavity = split(grid, join({block, hole}));
  EXPECT_EQ(cavity.counts.components, 1);
  EXPECT_EQ(cavity.counts.split_spans, 0);
  EXPECT_EQ(cavity.cells.unclear_spans, 0);
  const Split loose = split(grid, join({block, hole, ball}));
  EXPECT_EQ(loose.counts.components, 2);
  EXPECT_EQ(loose.counts.split_spans, 1);
  EXPECT_EQ(loose.cells.unclear_spans, 0);
  expect_same_moments(grid, loose);
}

TEST(Cells, ForkOfAnyGap) {
  for (const char* name : {"fork_gap_2.5.stl", "fork_gap_0.5.stl", "fork_gap_0.02.stl"}) {
    const auto file = shared_part(std::string("fork/") + name);
    if (file.empty()) GTEST_SKIP() << "the shared parts are not there; set IGA_SHARED_DIR";
    const TriangleMesh mesh = read_stl(file);
    for (const double size : {10.0, 5.0, 2.5, 1.6}) {
      const SplineGrid grid = grid_around(mesh, size, 2);
      const Split s = split(grid, mesh);
      EXPECT_EQ(s.counts.components, 1);
      EXPECT_GT(s.counts.copied_functions, 0);
      expect_sound(grid, s);
    }
  }
}

TEST(Cells, OfSharedPartsAddUpToTheirSpans) {
  if (shared_part("valid").empty()) GTEST_SKIP() << "the shared parts are not there; set IGA_SHARED_DIR";
  int parts = 0;
  for (const auto& entry : std::filesystem::directory_iterator(shared_part("valid"))) {
    const std::string name = entry.path().filename().string();
    const TriangleMesh mesh = read_stl(entry.path(), weld_of(name));
    if (mesh.triangles.empty()) continue;
    SCOPED_TRACE(name);
    for (const int degree : {1, 2, 3}) {
      const SplineGrid grid = grid_with(mesh, 11, degree);
      const Split s = split(grid, mesh);
      if (s.whole.worst_leak > 1e-9) continue; // not closed
      expect_sound(grid, s);
    }
    ++parts;
  }
  EXPECT_GT(parts, 20);
}

TEST(Cells, ThinWallsWithThinGaps) {
  // Sheets of a thousandth of a span, a hundredth apart, turned: every span holds several.
  std::vector<TriangleMesh> sheets;
  for (int k = 0; k < 5; ++k) sheets.push_back(box({0, 0, 0.055 * k}, {20, 20, 0.055 * k + 0.005}));
  const TriangleMesh mesh = transformed(join(sheets), rotation(21, 33), {0.1, 0.2, 0.3});
  for (int degree = 1; degree <= 4; ++degree) {
    const SplineGrid grid = grid_around(mesh, 5, degree, 0.21);
    const Split s = split(grid, mesh);
    EXPECT_EQ(s.counts.components, 5);
    expect_sound(grid, s);
  }
}

TEST(Cells, SlitThatEndsInsideIsOneBody) {
  const TriangleMesh mesh = prism({{0, 0}, {9, 0}, {9, 20}, {9.5, 20}, {9.5, 0}, {20, 0}, {20, 40}, {0, 40}},
                                  {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 4, 5}, {3, 5, 6}}, 0, 10);
  const SplineGrid grid = grid_around(mesh, 4, 2, 0.3);
  const Split s = split(grid, mesh);
  EXPECT_EQ(s.counts.components, 1);
  EXPECT_GT(s.counts.copied_functions, 0);
  expect_sound(grid, s);
}

TEST(Cells, PiecesThatSeeTheSameFunctionsAreOne) {
  // A flat cavity that is only just longer than a span: what it parts is connected in every support around it.
  const TriangleMesh mesh = join({box({1, 1, 1}, {59, 59, 59}), flipped(box({28, 12, 33}, {42, 47, 34}))});
  const SplineGrid grid({0, 0, 0}, {60, 60, 60}, {6, 6, 6}, {2, 2, 2});
  const Split s = split(grid, mesh);
  EXPECT_GT(s.cells.pieces, static_cast<std::int64_t>(s.trimming.active.size()));
  EXPECT_EQ(s.counts.split_spans, 0);
  EXPECT_EQ(s.counts.copied_functions, 0);
  EXPECT_EQ(s.trimming.touched_fraction, s.whole.touched_fraction);
  EXPECT_EQ(s.trimming.pieces.vertices, s.whole.pieces.vertices);
  expect_connected_copies(grid, s);
}

// A tube of `around` × `across` quadrilaterals, closed on itself: about z.
TriangleMesh torus(double major, double minor, std::int32_t around, std::int32_t across) {
  TriangleMesh m;
  for (std::int32_t i = 0; i < around; ++i)
    for (std::int32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = major + minor * std::cos(b);
      m.vertices.push_back({r * std::cos(a), r * std::sin(a), minor * std::sin(b)});
    }
  const auto at = [&](std::int32_t i, std::int32_t j) { return i % around * across + j % across; };
  for (std::int32_t i = 0; i < around; ++i)
    for (std::int32_t j = 0; j < across; ++j) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"ring"};
  return m;
}

TEST(Cells, ChainOfLooseRings) {
  std::vector<TriangleMesh> rings;
  for (int k = 0; k < 4; ++k) {
    TriangleMesh ring = torus(10, 2, 48, 16);
    if (k % 2)
      for (Point3& v : ring.vertices) v = {v[0], v[2], -v[1]};
    rings.push_back(transformed(ring, identity_rotation, {14.0 * k, 0, 0}));
  }
  const TriangleMesh chain = transformed(join(rings), rotation(17, 29), {0.3, 0.4, 0.5});
  for (const double size : {9.0, 4.0, 1.5})
    for (int degree = 1; degree <= 3; ++degree) {
      const SplineGrid grid = grid_around(chain, size, degree, 0.4);
      const Split s = split(grid, chain);
      EXPECT_EQ(s.counts.components, 4) << size << " p" << degree;
      expect_sound(grid, s);
    }
}

// Prism of a regular polygon, or the ring between two of them.
TriangleMesh ring_prism(double inner, double outer, double z0, double z1, std::int32_t n) {
  TriangleMesh m;
  for (const double r : {inner, outer})
    for (const double z : {z0, z1})
      for (std::int32_t i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n;
        m.vertices.push_back({r * std::cos(a), r * std::sin(a), z});
      }
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t k = (i + 1) % n;
    quad(2 * n + i, 2 * n + k, 3 * n + k, 3 * n + i); // outside
    quad(k, i, n + i, n + k);                         // bore
    quad(n + i, 3 * n + i, 3 * n + k, n + k);         // top
    quad(i, k, 2 * n + k, 2 * n + i);                 // bottom
  }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"ring"};
  return m;
}

TEST(Cells, HingeWithPlay) {
  // A pin of radius 5 (a thick tube) in an eye with 0.2 of play: one gap runs around inside of every span it meets.
  const TriangleMesh hinge = transformed(join({ring_prism(1, 5, -12, 12, 40), ring_prism(5.2, 9, -8, 8, 40)}),
                                         rotation(11, 23), {0.1, 0.2, 0.3});
  for (const double size : {6.0, 3.0})
    for (int degree = 1; degree <= 4; ++degree) {
      const SplineGrid grid = grid_around(hinge, size, degree, 0.3);
      const Split s = split(grid, hinge);
      EXPECT_EQ(s.counts.components, 2) << size << " p" << degree;
      expect_sound(grid, s);
    }
}

TEST(Cells, BoreWithinAFaceIsNoGap) {
  // A bore much thinner than the spans: its traces are loops inside of faces.
  const TriangleMesh tube = ring_prism(0.5, 12, -10, 10, 24);
  for (const double shift : {0.0, 0.31}) {
    const SplineGrid grid = grid_around(tube, 6, 2, shift);
    const Split s = split(grid, tube);
    EXPECT_EQ(s.counts.components, 1);
    EXPECT_EQ(s.cells.unclear_spans, 0);
    EXPECT_EQ(s.counts.copied_functions, 0);
    expect_connected_copies(grid, s);
  }
}

// A sheet of `across` × `along` square tiles with a hole each: a regular polygon of eight corners, its radius by tile.
// Rings of quadrilaterals lie between the holes and the tiles' edges.
template <class Radius>
TriangleMesh perforated_sheet(int across, int along, double tile, double thickness, Radius radius) {
  TriangleMesh m;
  std::map<std::array<long, 3>, std::int32_t>
      numbers; // of vertices, by rounded place: tiles share those of their edges
  const auto vertex = [&](double x, double y, double z) {
    const auto [at, is_new] = numbers.try_emplace({std::lround(1e6 * x), std::lround(1e6 * y), std::lround(1e6 * z)},
                                                  static_cast<std::int32_t>(m.vertices.size()));
    if (is_new) m.vertices.push_back({x, y, z});
    return at->second;
  };
  const auto quad = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < along; ++j) {
      std::array<std::array<std::int32_t, 8>, 2> hole, edge; // bottom, top
      for (std::size_t n = 0; n < 8; ++n) {
        const double a = std::numbers::pi * static_cast<double>(n) / 4, c = std::cos(a), s = std::sin(a);
        const double x = tile * (i + 0.5), y = tile * (j + 0.5), r = radius(i, j),
                     R = 0.5 * tile / std::max(std::abs(c), std::abs(s));
        for (std::size_t side = 0; side < 2; ++side) {
          const double z = side == 0 ? 0 : thickness;
          hole[side][n] = vertex(x + r * c, y + r * s, z);
          edge[side][n] = vertex(x + R * c, y + R * s, z);
        }
      }
      for (std::size_t n = 0; n < 8; ++n) {
        const std::size_t k = (n + 1) % 8;
        quad(hole[1][n], edge[1][n], edge[1][k], hole[1][k]);
        quad(hole[0][k], edge[0][k], edge[0][n], hole[0][n]);
        quad(hole[0][n], hole[1][n], hole[1][k], hole[0][k]);
        const bool rim = (i == across - 1 && (n == 7 || n == 0)) || (j == along - 1 && (n == 1 || n == 2)) ||
                         (i == 0 && (n == 3 || n == 4)) || (j == 0 && (n == 5 || n == 6));
        if (rim) quad(edge[0][n], edge[0][k], edge[1][k], edge[1][n]);
      }
    }
  m.region.assign(m.triangles.size(), 0);
  m.region_names = {"sheet"};
  return m;
}

TEST(Cells, PerforatedSheetThinnerThanASpan) {
  // Holes much smaller than a span in one half, about as large as a span in the other.
  const TriangleMesh sheet = transformed(perforated_sheet(8, 6, 6, 1.5, [](int i, int) { return i < 4 ? 0.4 : 2.6; }),
                                         rotation(13, 9), {0.1, 0.2, 0.3});
  for (const double size : {8.0, 5.0, 2.7})
    for (int degree = 1; degree <= 4; ++degree) {
      const SplineGrid grid = grid_around(sheet, size, degree, 0.37);
      const Split s = split(grid, sheet);
      EXPECT_EQ(s.counts.components, 1) << size << " p" << degree;
      expect_sound(grid, s);
      if (degree == 1) {
        EXPECT_GT(s.counts.copied_functions, 0) << size;
      }
    }
}

// Block of 20 × 40 × 10 with a slit of 0.05 from its edge to its middle; turned, so that nothing lies in a grid plane.
TriangleMesh slit_block(double length = 20, double turn = 13) {
  const double l = length;
  return transformed(prism({{0, 0}, {9, 0}, {9, l}, {9.05, l}, {9.05, 0}, {20, 0}, {20, 40}, {0, 40}},
                           {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 4, 5}, {3, 5, 6}}, 0, 10),
                     rotation(turn, 0.7 * turn), {});
}

TEST(GapEnds, OnlyWhereAGapEndsAndOnlyFromDegreeTwo) {
  for (const int degree : {1, 2, 3, 4}) {
    SCOPED_TRACE(degree);
    const TriangleMesh slit = slit_block();
    const Split s = split(grid_around(slit, 4, degree, 0.3), slit, true);
    EXPECT_EQ(s.counts.components, 1);
    EXPECT_EQ(s.counts.gap_end_cells > 0, degree > 1);
    // Blocks apart have a gap that ends nowhere, a convex body has none, a notch of less than a span is too shallow.
    for (const TriangleMesh& mesh : {join({box({0, 0, 0}, {20, 20, 14.37}), box({0, 0, 14.38}, {20, 20, 30})}),
                                     sphere({0, 0, 0}, 10, 3), slit_block(3, 0)}) {
      const Split none = split(grid_around(mesh, 4, degree, 0.3), mesh, true);
      EXPECT_EQ(none.counts.gap_end_cells, 0);
      EXPECT_TRUE(none.cells.unknowns.rows.empty());
      EXPECT_TRUE(none.trimming.gap_end.empty());
      EXPECT_EQ(none.cells.functions, split(grid_around(mesh, 4, degree, 0.3), mesh).cells.functions);
    }
  }
}

TEST(GapEnds, UnknownsAddUpToOneAndToPlaces) {
  for (const std::array<int, 3>& degree : {std::array<int, 3>{2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {2, 3, 1}}) {
    const TriangleMesh mesh = slit_block();
    const SplineGrid around = grid_around(mesh, 4, 2, 0.3);
    const SplineGrid grid(around.A(), around.B(), around.spans(), degree);
    const Split s = split(grid, mesh, true);
    const Unknowns& u = s.cells.unknowns.rows;
    ASSERT_FALSE(u.function.empty());
    ASSERT_EQ(u.offsets.size(), s.cells.function.size() + 1);
    EXPECT_TRUE(std::is_sorted(s.cells.function.begin(), s.cells.function.end()));
    for (std::size_t f = 0; f < s.cells.function.size(); ++f) {
      double sum = 0, size = 0;
      Point3 place{};
      for (auto t = static_cast<std::size_t>(u.offsets[f]); t < static_cast<std::size_t>(u.offsets[f + 1]); ++t) {
        sum += u.weights[t];
        size += std::abs(u.weights[t]);
        for (std::size_t d = 0; d < 3; ++d)
          place[d] += u.weights[t] * u.parameters[3 * static_cast<std::size_t>(u.terms[t]) + d];
      }
      EXPECT_NEAR(sum, 1, 1e-13 * size);
      const Index3 i = grid.function_index(s.cells.function[f]);
      for (std::size_t d = 0; d < 3; ++d)
        EXPECT_NEAR(place[d], grid.knots(static_cast<int>(d)).greville(i[d]), 1e-11 * size);
    }
    for (const double full : s.cells.unknowns.full) EXPECT_GT(full, 0);
  }
}

TEST(Cells, DoNotDependOnTheNumberOfThreads) {
  const std::array<TriangleMesh, 2> meshes{transformed(two_blocks(0.01), rotation(13, 9), {1, 2, 3}), slit_block()};
  for (const TriangleMesh& mesh : meshes) {
    const SplineGrid grid = grid_around(mesh, 2, 2, 0.37);
    const Split many = split(grid, mesh, true);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Split single = split(grid, mesh, true);
    EXPECT_EQ(many.cells.functions, single.cells.functions);
    EXPECT_EQ(many.cells.function, single.cells.function);
    EXPECT_EQ(many.cells.unknowns.rows.terms, single.cells.unknowns.rows.terms);
    EXPECT_EQ(many.cells.unknowns.rows.weights, single.cells.unknowns.rows.weights);
    EXPECT_EQ(many.cells.unknowns.full, single.cells.unknowns.full);
    EXPECT_EQ(many.trimming.fraction, single.trimming.fraction);
    EXPECT_EQ(many.trimming.pieces.vertices, single.trimming.pieces.vertices);
  }
}

} // namespace
} // namespace iga::prep
