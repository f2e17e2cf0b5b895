// check() accepts sound models and names what is wrong with others.
#include "format/model/trimmed_model.hpp"

#include "tests/support/synthetic_model.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <limits>

namespace iga {
namespace {

using test::make_box_model;

std::string all_of(const std::vector<std::string>& problems) {
  std::string text;
  for (const auto& problem : problems) text += problem + "\n";
  return text;
}

TEST(ModelCheck, AcceptsSoundModels) {
  for (const double angle : {0.0, 0.3, 2.0})
    for (const std::array<int, 3> degree : {std::array{1, 1, 1}, {2, 2, 2}, {4, 3, 1}}) {
      test::BoxCase box;
      box.rotation = test::some_rotation(angle);
      box.degree = degree;
      EXPECT_EQ(all_of(check(make_box_model(box))), "");
    }
}

TEST(ModelCheck, DoesNotDependOnSizeOrPlace) {
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double shift : {0.0, 1e4}) {
      test::BoxCase box;
      box.rotation = test::some_rotation(0.3);
      for (std::size_t d = 0; d < 3; ++d)
        for (Point3* x : {&box.A, &box.B, &box.lower, &box.upper}) (*x)[d] = scale * ((*x)[d] + 6 * shift);
      EXPECT_EQ(all_of(check(make_box_model(box))), "") << "scale " << scale << ", shift " << shift;
    }
}

TEST(ModelCheck, SpellsOutOnlyTheFirstOfAKind) {
  TrimmedModel m = make_box_model();
  for (double& w : m.points.weights) w = -w;
  const auto text = all_of(check(m, 2));
  EXPECT_NE(text.find("quadrature/weights: 646 more of this kind"), std::string::npos) << text;
}

TrimmedModel with_places() {
  TrimmedModel m = make_box_model();
  test::add_places(m);
  return m;
}

TEST(ModelCheck, AcceptsCurvesAndMarkers) {
  EXPECT_EQ(all_of(check(with_places())), "");
}

struct Fault {
  const char* name;
  std::function<void(TrimmedModel&)> make;
  const char* words;
};

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const Fault faults[]{
    {"NoGrid", [](auto& m) { m.grid = {}; }, "no spans"},
    {"ShortState", [](auto& m) { m.state.pop_back(); }, "spans/state has"},
    {"ShortOffsets", [](auto& m) { m.points.offsets.pop_back(); }, "quadrature/offsets has"},
    {"LongParameters", [](auto& m) { m.points.parameters.push_back(1); }, "quadrature/parameters has"},
    {"ShortFraction", [](auto& m) { m.cells.volume_fraction.pop_back(); }, "cells/volume_fraction has"},
    {"ShortMass", [](auto& m) { m.functions.mass_fraction.pop_back(); }, "functions/mass_fraction has"},
    {"ShortNormals", [](auto& m) { m.surface.quadrature.normals.pop_back(); }, "surface/quadrature/normals has"},
    {"ShortRegion", [](auto& m) { m.surface.mesh.region.pop_back(); }, "surface/region has"},
    {"UnknownState", [](auto& m) { m.state[static_cast<std::size_t>(m.cells.span[0])] = 3; }, "state 3"},
    {"ActiveThatIsExterior", [](auto& m) { m.state[static_cast<std::size_t>(m.cells.span[3])] = 0; }, "cells/span"},
    {"UnsortedActive", [](auto& m) { std::swap(m.cells.span[0], m.cells.span[1]); }, "cells/span"},
    {"ExteriorThatIsActive", [](auto& m) { m.state[0] = 2; }, "cells/span"},
    {"InteriorCalledTrimmedNeedsItsVolume", [](auto& m) { m.cells.volume_fraction[0] *= 0.5; },
     "volume of a trimmed cell"},
    {"FractionAboveOne", [](auto& m) { m.cells.volume_fraction[0] = 1.1; }, "fraction 1.1"},
    {"FractionNaN", [](auto& m) { m.cells.volume_fraction[0] = nan; }, "fraction nan"},
    {"FallingOffsets", [](auto& m) { m.points.offsets[1] = 1000; }, "falls"},
    {"SpanWithoutPoints", [](auto& m) { m.points.offsets[1] = 0; }, "owns no point"},
    {"PointOutsideItsSpan", [](auto& m) { m.points.parameters[1] += 1; }, "outside its span"},
    {"PointNaN", [](auto& m) { m.points.parameters[5] = nan; }, "outside its span"},
    {"NegativeWeight", [](auto& m) { m.points.weights[2] *= -1; }, "expected a positive number"},
    {"WeightInfinite", [](auto& m) { m.points.weights[2] = 1 / 0.0; }, "expected a positive number"},
    {"WeightOff", [](auto& m) { m.points.weights[2] *= 1 + 1e-6; }, "volume of a trimmed cell"},
    {"VolumeOff", [](auto& m) { m.quadrature.part_volume *= 1 + 1e-8; }, "all weights sum to"},
    {"ResidualAboveTolerance", [](auto& m) { m.points.residual[0] = 1e-9; }, "residual 1e-09"},
    {"ResidualNotTheLargest", [](auto& m) { m.quadrature.max_residual = 1e-11; }, "max_residual"},
    {"UnknownRule", [](auto& m) { m.quadrature.interior_rule = "simpson"; }, "interior_rule is 'simpson'"},
    {"MissingFunction", [](auto& m) { m.functions.number.pop_back(), m.functions.mass_fraction.pop_back(); },
     "names function 119, expected 0 to 118"},
    {"ExtraFunction", [](auto& m) { m.functions.number.push_back(335), m.functions.mass_fraction.push_back(1); },
     "belongs to no cell"},
    {"MassFractionZero", [](auto& m) { m.functions.mass_fraction[0] = 0; }, "mass fraction 0"},
    {"MassFractionAboveOne", [](auto& m) { m.functions.mass_fraction[0] = 1.01; }, "mass fraction 1.01"},
    {"MassFractionOff", [](auto& m) { m.functions.mass_fraction[60] *= 1.001; }, "Σ mass fraction"},
    {"VertexOfNoCell", [](auto& m) { m.surface.vertex_cell[0] = static_cast<std::int64_t>(m.num_cells()); },
     "belongs to cell"},
    {"VertexCellNegative", [](auto& m) { m.surface.vertex_cell[0] = -5; }, "belongs to cell"},
    {"VertexOutsideItsSpan", [](auto& m) { m.surface.vertex_parameters[0] -= 0.5; }, "surface/vertex_parameters"},
    {"VertexNaN", [](auto& m) { m.surface.mesh.vertices[0][0] = nan; }, "vertex 0 is not finite"},
    {"TriangleOutOfRange", [](auto& m) { m.surface.mesh.triangles[1][2] = 8; }, "names vertex 8"},
    {"RegionOutOfRange", [](auto& m) { m.surface.mesh.region[1] = 6; }, "names region 6"},
    {"SurfacePointOutside", [](auto& m) { m.surface.quadrature.parameters[0] += 2; }, "outside its span"},
    {"SurfaceWeightZero", [](auto& m) { m.surface.quadrature.weights[0] = 0; }, "weight 0"},
    {"NormalTooLong",
     [](auto& m) {
       for (double& n : m.surface.quadrature.normals) n *= 1.1;
     },
     "expected 1"},
    {"SurfaceTriangleOutOfRange", [](auto& m) { m.surface.quadrature.triangle[0] = 12; }, "names triangle 12"},
    {"AreaOff", [](auto& m) { m.surface.quadrature.weights[0] *= 1 + 1e-5; }, "expected its area"},
    {"RegionsSwapped", [](auto& m) { m.surface.mesh.region[0] = 2; }, "expected its area"},
    {"NormalsInward",
     [](auto& m) {
       for (double& n : m.surface.quadrature.normals) n = -n;
     },
     "∮ x·n dA / 3"},
    {"CurveNameTwice", [](auto& m) { m.curves.names[1] = m.curves.names[0]; }, "'edge 1' stands there twice"},
    {"CurveWithoutName", [](auto& m) { m.curves.names[1].clear(); }, "name 1 is empty"},
    {"CurveOfOnePoint", [](auto& m) { m.curves.offsets[1] = 6; }, "'rim größe' has 1 points, expected two"},
    {"CurveOffsetsShort", [](auto& m) { m.curves.offsets.pop_back(); }, "2 offsets for 2 names"},
    {"CurvePointsShort", [](auto& m) { m.curves.points.pop_back(); }, "the last offset is 7"},
    {"CurveWithoutLength", [](auto& m) { m.curves.points[1] = m.curves.points[2] = m.curves.points[0]; },
     "'edge 1' has no length"},
    {"CurveNaN", [](auto& m) { m.curves.points[3][1] = nan; }, "curves: point 3 is"},
    {"MarkerNaN", [](auto& m) { m.markers.positions[0][2] = nan; }, "markers: point 0 is"},
    {"MarkerWithoutPosition", [](auto& m) { m.markers.positions.pop_back(); }, "1 positions for 2 names"},
    {"OffItsTriangle", [](auto& m) { m.surface.quadrature.triangle[0] = 3; }, "off its triangle"},
};

class ModelCheckFaults : public testing::TestWithParam<Fault> {};

TEST_P(ModelCheckFaults, IsNamed) {
  TrimmedModel m = with_places();
  GetParam().make(m);
  const auto text = all_of(check(m));
  EXPECT_NE(text.find(GetParam().words), std::string::npos) << "found: " << text;
}

INSTANTIATE_TEST_SUITE_P(All, ModelCheckFaults, testing::ValuesIn(faults),
                         [](const auto& fault) { return fault.param.name; });

TEST(ModelCheck, InteriorSpansMayOwnNoPointUnderGeneralisedRules) {
  // Two interior spans in a row: the first one's points stand for the volume of both.
  TrimmedModel m = make_box_model();
  m.quadrature.interior_rule = "ggq";
  std::size_t interior = 0;
  while (m.state[static_cast<std::size_t>(m.cells.span[interior])] != 1) ++interior;
  ASSERT_EQ(m.state[static_cast<std::size_t>(m.cells.span[interior + 1])], 1);
  const auto first = static_cast<std::size_t>(m.points.offsets[interior]),
             last = static_cast<std::size_t>(m.points.offsets[interior + 1]);
  for (std::size_t q = first; q < last; ++q) m.points.weights[q] *= 2;
  const auto end = static_cast<std::size_t>(m.points.offsets[interior + 2]);
  const auto at = [](auto& v, std::size_t i) { return v.begin() + static_cast<std::ptrdiff_t>(i); };
  m.points.weights.erase(at(m.points.weights, last), at(m.points.weights, end));
  m.points.parameters.erase(at(m.points.parameters, 3 * last), at(m.points.parameters, 3 * end));
  for (std::size_t a = interior + 2; a < m.points.offsets.size(); ++a)
    m.points.offsets[a] -= static_cast<std::int64_t>(end - last);
  EXPECT_EQ(all_of(check(m)), "");
  m.quadrature.interior_rule = "gauss";
  EXPECT_NE(all_of(check(m)).find("interior cell"), std::string::npos);
}

TEST(ModelCheck, SurfaceIntegralsAreNotJudgedWhereALeakWasAccepted) {
  TrimmedModel m = make_box_model();
  m.surface.quadrature.weights[0] *= 2;
  EXPECT_NE(all_of(check(m)), "");
  m.surface.accepted_leak = 0.01;
  EXPECT_EQ(all_of(check(m)), "");
}

} // namespace
} // namespace iga
