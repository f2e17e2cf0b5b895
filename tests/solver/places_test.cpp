// Which cell a place belongs to where two plates lie on the two sides of a gap: the surface of a plate moves with that
// plate, also where what lies beyond a grid plane is a sliver that has no cell; a place in the gap belongs to neither.
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/output/surface_output.hpp"
#include "solver/space/locate.hpp"
#include "solver/space/surface_region.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/trimmed_part.hpp"

#include <gtest/gtest.h>

namespace iga::solve {
namespace {

using namespace iga::test;

// Plates over 7.3 × 6.6 in spans of 1: the lower one between 0 and `top`, the upper one from there plus the gap to 5.2.
TriangleMesh plates(double top, double gap) {
  return join({box({0, 0, 0}, {7.3, 6.6, top}), box({0, 0, top + gap}, {7.3, 6.6, 5.2})});
}

TrimmedModel model_of(const TriangleMesh& mesh, int degree, double shift = 0) {
  PartOptions options;
  options.span_size = 1;
  options.degree = degree;
  options.shift = shift;
  return make_part(mesh, options);
}

// Body of each cell, as the regions of the surface are numbered: the one that most of the surface of its connected part
// belongs to.
std::vector<int> body_of_cells(const TrimmedModel& model) {
  const std::vector<std::int32_t> parts = connected_parts(model);
  const std::vector<std::size_t> part(parts.begin(), parts.end());
  std::vector<std::array<double, 2>> area(model.num_cells());
  const auto& surface = model.surface.quadrature;
  for (std::size_t c = 0; c < part.size(); ++c)
    for (auto q = static_cast<std::size_t>(surface.offsets[c]); q < static_cast<std::size_t>(surface.offsets[c + 1]);
         ++q)
      area[part[c]]
          [static_cast<std::size_t>(model.surface.mesh.region[static_cast<std::size_t>(surface.triangle[q])])] +=
          surface.weights[q];
  std::vector<int> body;
  for (const std::size_t p : part) body.push_back(area[p][1] > area[p][0]);
  return body;
}

class PlatesWithAGap : public testing::TestWithParam<std::tuple<int, double>> {};
INSTANTIATE_TEST_SUITE_P(DegreesAndGaps, PlatesWithAGap,
                         testing::Combine(testing::Values(1, 2, 3), testing::Values(1e-3, 1e-2, 0.05, 0.2)));

void expect_own_surface(const TrimmedModel& model) {
  for (const std::string& problem : check(model)) ADD_FAILURE() << problem;
  EXPECT_EQ(count_cells(model).components, 2);
  const auto body = body_of_cells(model);
  const auto& surface = model.surface.quadrature;
  std::size_t astray = 0;
  for (std::size_t c = 0; c < body.size(); ++c)
    for (auto q = static_cast<std::size_t>(surface.offsets[c]); q < static_cast<std::size_t>(surface.offsets[c + 1]);
         ++q)
      astray += model.surface.mesh.region[static_cast<std::size_t>(surface.triangle[q])] != body[c];
  EXPECT_EQ(astray, 0u) << "surface points of the file";

  const OutputMesh output = subdivide_surface(model, 3);
  std::size_t given_astray = 0, added_astray = 0;
  for (std::size_t t = 0; t < output.mesh.triangles.size(); ++t)
    for (const std::int32_t v : output.mesh.triangles[t]) {
      const bool is_astray =
          body[static_cast<std::size_t>(output.cell[static_cast<std::size_t>(v)])] != output.mesh.region[t];
      (static_cast<std::size_t>(v) < model.surface.mesh.vertices.size() ? given_astray : added_astray) += is_astray;
    }
  EXPECT_EQ(given_astray, 0u) << "vertices of the file";
  EXPECT_EQ(added_astray, 0u) << "vertices of the output";

  for (const std::int64_t number : {0, 1}) {
    RegionChoice choice; // cuts every triangle
    choice.numbers = {number};
    choice.box = Box3{{0.11, 0.12, 0.13}, {7.19, 6.41, 5.11}};
    const SurfaceRegion region = choose_region(model, choice, "load 'a'");
    std::size_t cut_astray = 0;
    for (const std::int64_t cell : region.cells) cut_astray += body[static_cast<std::size_t>(cell)] != number;
    EXPECT_EQ(cut_astray, 0u) << "surface cut by a box";
  }
}

TEST_P(PlatesWithAGap, SurfaceBelongsToItsOwnPlate) {
  const auto [degree, gap] = GetParam();
  // The lower plate's top, then the upper plate's bottom, this far above the grid plane at 2.
  for (const double above : {0.3, 1e-5, 1e-7, 1e-10, 0.0, -1e-10, -1e-7, -1e-5})
    for (const double top : {2 + above, 2 - gap + above}) {
      SCOPED_TRACE(testing::Message() << "top at " << top);
      expect_own_surface(model_of(plates(top, gap), degree));
    }
}

TEST_P(PlatesWithAGap, TurnedInTheGridToo) {
  const auto [degree, gap] = GetParam();
  PartOptions options;
  options.span_size = 1;
  options.degree = degree;
  options.rotation = rotation(13, 9);
  expect_own_surface(make_part(plates(2.1, gap), options));
}

// Both plates have steps in the plane of a grid face: their slivers end in it.
TEST_P(PlatesWithAGap, StepsInGridPlanes) {
  const auto [degree, gap] = GetParam();
  for (const double above : {1e-5, 1e-7, -1e-7}) {
    const double top = 2 + above, edge = 3 + above;
    const TriangleMesh lower = prism({{0, 0}, {7.3, 0}, {7.3, 1}, {edge, 1}, {edge, top}, {0, top}},
                                     {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 0, 6.6);
    const TriangleMesh upper =
        prism({{0, top + gap}, {edge + gap, top + gap}, {edge + gap, 1 + gap}, {7.3, 1 + gap}, {7.3, 5.2}, {0, 5.2}},
              {{0, 1, 5}, {1, 4, 5}, {1, 3, 4}, {1, 2, 3}}, 0, 6.6);
    SCOPED_TRACE(testing::Message() << "top at " << top);
    expect_own_surface(model_of(join({lower, upper}), degree));
  }
}

// The body that a place is found in; -1 where it is refused.
int located_body(const TrimmedModel& model, const std::vector<int>& body, const Point3& x, std::string* message) {
  try {
    const LocatedPoint at = locate(model, x, "probe 'a'");
    return body[static_cast<std::size_t>(at.cell)];
  } catch (const InputError& error) {
    *message = error.what();
    return -1;
  }
}

TEST_P(PlatesWithAGap, PlacesInTheGapAreRefusedAndThoseOnAWallAreThatWalls) {
  const auto [degree, gap] = GetParam();
  for (const double top : {2.3, 2 + 1e-7, 2 - 0.5 * gap, 2 - gap - 1e-7}) {
    SCOPED_TRACE(testing::Message() << "top at " << top);
    const TrimmedModel model = model_of(plates(top, gap), degree);
    const auto body = body_of_cells(model);
    std::string message;
    for (const Point3& at : {Point3{3.4, 2.7, 0}, Point3{3, 2, 0}, Point3{0.01, 6.6, 0}}) {
      const auto found = [&](double share) { // across the gap
        return located_body(model, body, {at[0], at[1], top + share * gap}, &message);
      };
      EXPECT_EQ(found(-0.5), 0);
      EXPECT_EQ(found(0), 0);
      EXPECT_EQ(found(0.09), 0);
      EXPECT_EQ(found(0.91), 1);
      EXPECT_EQ(found(1), 1);
      EXPECT_EQ(found(1.5), 1);
      for (const double share : {0.2, 0.5, 0.8}) {
        EXPECT_EQ(found(share), -1) << share;
        EXPECT_NE(message.find(share * gap > 0.05 && (1 - share) * gap > 0.05 ? "outside the part" : "lies in a gap"),
                  std::string::npos)
            << message;
      }
    }
  }
}

TEST(PlacesOutside, OfARoundFaceAreItsOwn) {
  // Facets of a sphere lie inside it; places on a sphere between are some hundredths of a span off.
  const TriangleMesh mesh = sphere({0, 0, 0}, 5, 3);
  const TrimmedModel model = model_of(mesh, 2, 0.3);
  int outside = 0;
  for (int k = 0; k < 200; ++k) {
    const double z = 2 * (k + 0.5) / 200 - 1, a = 2.4 * k, r = std::sqrt(1 - z * z);
    const double R = 4.97;
    const Point3 x{R * r * std::cos(a), R * r * std::sin(a), R * z};
    outside += winding_number(mesh, x) < 0.5;
    const LocatedPoint at = locate(model, x, "probe 'a'");
    EXPECT_LT(norm(minus(at.asked, at.position)), 0.05);
  }
  EXPECT_GT(outside, 100);
}

} // namespace
} // namespace iga::solve
