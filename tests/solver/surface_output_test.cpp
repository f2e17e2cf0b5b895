// The surface for output has no cracks and no long edges; fields on it are those of the spline.
#include "solver/output/surface_output.hpp"

#include "format/model/errors.hpp"
#include "format/model/span_state.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/surface_cells.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/synthetic_results.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <tbb/global_control.h>

namespace iga::solve {
namespace {

test::BoxCase box_case(int degree, bool rotated) {
  test::BoxCase box;
  box.B = {9, 10, 4}; // spans of 1.5 × 2 × 1
  box.lower = {1.75, 2, 1};
  box.upper = {7, 8.25, 2.6};
  box.degree = {degree, degree, degree};
  if (rotated) box.rotation = test::some_rotation(0.4);
  return box;
}

class OutputSurface : public testing::TestWithParam<bool> {
 protected:
  TrimmedModel model_ = test::make_box_model(box_case(2, GetParam()));
  double longest_edge(const OutputMesh& out) const {
    double longest = 0;
    for (const Triangle& t : out.mesh.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const Point3 a = model_.grid.to_parameter(out.mesh.vertices[static_cast<std::size_t>(t[i])]),
                     b = model_.grid.to_parameter(out.mesh.vertices[static_cast<std::size_t>(t[(i + 1) % 3])]);
        Point3 e = minus(b, a);
        for (std::size_t d = 0; d < 3; ++d) e[d] /= model_.grid.span_size()[d];
        longest = std::max(longest, norm(e));
      }
    return longest;
  }
};

TEST_P(OutputSurface, HasNoLongEdgeAndNoCrack) {
  std::size_t before = 0;
  for (const int subdivide : {1, 2, 5}) {
    const OutputMesh out = subdivide_surface(model_, subdivide);
    EXPECT_LE(longest_edge(out), (1 + 1e-12) / subdivide);
    EXPECT_GT(out.mesh.triangles.size(), before);
    before = out.mesh.triangles.size();
    std::map<std::pair<std::int32_t, std::int32_t>, int> directed;
    for (const Triangle& t : out.mesh.triangles)
      for (std::size_t i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
    for (const auto& [edge, count] : directed) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ((directed.count({edge.second, edge.first})), 1u);
    }
    const auto found = volume_moments(out.mesh), given = volume_moments(model_.surface.mesh);
    EXPECT_NEAR(found.volume, given.volume, 1e-12 * given.volume);
    EXPECT_NEAR(surface_area(out.mesh), surface_area(model_.surface.mesh), 1e-12 * surface_area(model_.surface.mesh));
  }
}

TEST_P(OutputSurface, KeepsVerticesAndRegions) {
  const auto& given = model_.surface.mesh;
  const OutputMesh out = subdivide_surface(model_, 3);
  EXPECT_TRUE(std::equal(given.vertices.begin(), given.vertices.end(), out.mesh.vertices.begin()));
  EXPECT_TRUE(std::equal(model_.surface.vertex_cell.begin(), model_.surface.vertex_cell.end(), out.cell.begin()));
  EXPECT_EQ(out.mesh.region_names, given.region_names);
  const auto areas = [](const TriangleMesh& mesh) {
    std::vector<double> area(mesh.region_names.size(), 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle& c = mesh.triangles[t];
      area[static_cast<std::size_t>(mesh.region[t])] +=
          0.5 *
          norm(twice_area(mesh.vertices[static_cast<std::size_t>(c[0])], mesh.vertices[static_cast<std::size_t>(c[1])],
                          mesh.vertices[static_cast<std::size_t>(c[2])]));
    }
    return area;
  };
  const auto found = areas(out.mesh), expected = areas(given);
  for (std::size_t r = 0; r < expected.size(); ++r) EXPECT_NEAR(found[r], expected[r], 1e-12 * expected[r]);
}

TEST_P(OutputSurface, EveryVertexLiesInAnActiveSpan) {
  const OutputMesh out = subdivide_surface(model_, 4);
  ASSERT_EQ(out.span.size(), out.mesh.vertices.size());
  ASSERT_EQ(out.parameters.size(), 3 * out.mesh.vertices.size());
  for (std::size_t v = 0; v < out.span.size(); ++v) {
    EXPECT_NE(model_.state[static_cast<std::size_t>(out.span[v])], static_cast<std::uint8_t>(SpanState::Exterior));
    const Box3 box = model_.grid.span_box(model_.grid.span_index(out.span[v]));
    const Point3 u{out.parameters[3 * v], out.parameters[3 * v + 1], out.parameters[3 * v + 2]};
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_GE(u[d], box.lower[d]);
      EXPECT_LE(u[d], box.upper[d]);
    }
    EXPECT_LT(norm(minus(model_.grid.to_position(u), out.mesh.vertices[v])), 1e-12);
  }
}

TEST_P(OutputSurface, IsTheSameForAnyNumberOfThreads) {
  const OutputMesh many = subdivide_surface(model_, 4);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const OutputMesh single = subdivide_surface(model_, 4);
  EXPECT_EQ(many.mesh.vertices, single.mesh.vertices);
  EXPECT_EQ(many.mesh.triangles, single.mesh.triangles);
  EXPECT_EQ(many.span, single.span);
  EXPECT_EQ(many.parameters, single.parameters);
}

INSTANTIATE_TEST_SUITE_P(AlignedAndRotated, OutputSurface, testing::Bool());

TEST(OutputSurfaceRefusals, SubdivideBelowOne) {
  const TrimmedModel model = test::make_box_model();
  EXPECT_THROW(subdivide_surface(model, 0), InputError);
  EXPECT_THROW(subdivide_surface(model, 1'000'000), InputError);
}

TEST(SurfaceCellsOf, PlacesInGridPlanesAreThoseOfTheMaterial) {
  const TrimmedModel model =
      test::make_box_model({{0, 0, 0}, {6, 5, 4}, {6, 5, 4}, {2, 2, 2}, identity_rotation, {2, 1, 1}, {4, 3, 2}});
  const SurfaceCells surface(model);
  const auto find = [&](const Point3& u, const Point3& outward) { // on the nearest triangle that looks that way
    const TriangleMesh& mesh = model.surface.mesh;
    std::size_t nearest = mesh.triangles.size();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto corner = [&](std::size_t a) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][a])]; };
      if (dot(twice_area(corner(0), corner(1), corner(2)), outward) <= 0) continue;
      if (nearest == mesh.triangles.size() || distance_to_triangle(mesh, t, u) < distance_to_triangle(mesh, nearest, u))
        nearest = t;
    }
    return surface.find(nearest, u);
  };
  const auto span_of = [&](const Point3& u, const Point3& outward) {
    return model.grid.span_index(model.cells.span[static_cast<std::size_t>(find(u, outward).cell)]);
  };
  EXPECT_EQ(span_of({4, 1.5, 1.5}, {1, 0, 0}), (Index3{3, 1, 1}));
  EXPECT_EQ(span_of({2, 1.5, 1.5}, {-1, 0, 0}), (Index3{2, 1, 1}));
  EXPECT_EQ(span_of({3, 1, 1.5}, {0, -1, 0}), (Index3{2, 1, 1})); // the lower number
  EXPECT_EQ(span_of({3.2, 2.5, 2}, {0, 0, 1}), (Index3{3, 2, 1}));
  const auto beyond = find({4.25, 1.5, 3}, {1, 0, 0});
  EXPECT_DOUBLE_EQ(beyond.distance, std::hypot(0.25, 1));
  EXPECT_EQ(beyond.parameter, (Point3{4, 1.5, 2}));
  const auto far = find({5.5, 4.5, 3.5}, {1, 0, 0});
  EXPECT_EQ(model.cells.span[static_cast<std::size_t>(far.cell)], model.grid.span_number({3, 2, 1}));
}

// (unknowns × 2): coefficients of two linear fields.
Eigen::MatrixXd linear_fields(const SolutionSpace& space) {
  Eigen::MatrixXd unknowns(space.num_unknowns(), 2);
  const auto points = space.node_points();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (int step = 0; step < 2; ++step) {
      const Point3 u = test::LinearField(step).at({points(i, 0), points(i, 1), points(i, 2)});
      for (Eigen::Index d = 0; d < 3; ++d) unknowns(3 * i + d, step) = u[static_cast<std::size_t>(d)];
    }
  return unknowns;
}

Voigt strain_of(const test::LinearField& field) {
  const auto& G = field.G;
  Voigt strain;
  strain << G[0][0], G[1][1], G[2][2], G[0][1] + G[1][0], G[1][2] + G[2][1], G[0][2] + G[2][0];
  return strain;
}

class SampledFields : public testing::TestWithParam<std::tuple<int, LightFunctions>> {};

TEST_P(SampledFields, OfALinearDisplacementAreExact) {
  const auto [degree, remedy] = GetParam();
  const TrimmedModel model = test::make_box_model(box_case(degree, true));
  const SolutionSpace space(model, {remedy, remedy == LightFunctions::None ? 0 : 0.2});
  if (remedy != LightFunctions::None) {
    EXPECT_GT(space.num_light(), 0);
  }
  const ElasticMaterial material = isotropic(50, 0.3, 1);
  const SurfaceResult result =
      sample_surface(space, material, subdivide_surface(model, 2), linear_fields(space), {1, 2}, Fields::All);
  const auto& x = result.output.mesh.vertices;
  ASSERT_EQ(result.fields.displacement.size(), 2 * 3 * x.size());
  ASSERT_EQ(result.fields.stress.size(), 2 * 6 * x.size());
  ASSERT_EQ(result.fields.von_mises.size(), 2 * x.size());
  for (int step = 0; step < 2; ++step) {
    const test::LinearField field(step);
    const Voigt strain = strain_of(field), stress = material.C * strain;
    for (std::size_t v = 0; v < x.size(); ++v) {
      const std::size_t at = static_cast<std::size_t>(step) * x.size() + v;
      const Point3 u = field.at(x[v]);
      for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(result.fields.displacement[3 * at + d], u[d], 1e-14);
      for (std::size_t c = 0; c < 6; ++c) {
        EXPECT_NEAR(result.fields.strain[6 * at + c], strain[static_cast<Eigen::Index>(c)], 1e-14);
        EXPECT_NEAR(result.fields.stress[6 * at + c], stress[static_cast<Eigen::Index>(c)], 1e-12);
      }
      EXPECT_NEAR(result.fields.von_mises[at], von_mises(stress), 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(DegreesAndTreatments, SampledFields,
                         testing::Combine(testing::Values(1, 2, 3),
                                          testing::Values(LightFunctions::None, LightFunctions::Linear)));

TEST(SampledFieldsOfManyPoints, AreTheSameForAnyNumberOfThreadsAndInAnyOrder) {
  const TrimmedModel model = test::make_box_model(box_case(2, true));
  const SolutionSpace space(model, {});
  const ElasticMaterial material = isotropic(50, 0.3, 1);
  const Eigen::MatrixXd unknowns = Eigen::MatrixXd::Random(space.num_unknowns(), 3);
  const OutputMesh out = subdivide_surface(model, 8);
  const auto many = sample_surface(space, material, out, unknowns, {1, 2, 3}, Fields::VonMises);
  EXPECT_TRUE(many.fields.stress.empty());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = sample_surface(space, material, out, unknowns, {1, 2, 3}, Fields::VonMises);
  EXPECT_EQ(many.fields.displacement, single.fields.displacement);
  EXPECT_EQ(many.fields.von_mises, single.fields.von_mises);
}

} // namespace
} // namespace iga::solve
