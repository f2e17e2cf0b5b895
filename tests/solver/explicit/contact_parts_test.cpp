// The parts contact is made of: surfaces, shapes, rigid bodies, curves, searches.
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/closest_point.hpp"
#include "solver/explicit/contact/tool_mesh.hpp"
#include "tests/solver/explicit/contact_scene.hpp"
#include "tests/support/temp_folder.hpp"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr LightTreatment extended{LightFunctions::Linear, 0.05};

Point3 random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> in(-size, size);
  const double x = in(random), y = in(random);
  return {x, y, in(random)};
}

} // namespace

TEST(ContactSurface, VerticesFollowLinearFieldsAndHandBackForceAndMoment) {
  const auto body = make_body(placed_box({1, 2, 3}, {4, 3, 2}, {4, 3, 2}, 2, 0.3), isotropic(1, 0.3, 1), extended);
  ASSERT_TRUE(body->space.is_extended());
  const ContactSurface surface = make_contact_surface(body->space, "box", 2.0, 0.7);
  const auto nodes = body->space.node_points();
  Eigen::Matrix3d G;
  G << 1, 2, 3, -1, 0.5, 2, 0.3, -0.7, 1.1;
  const Eigen::MatrixXd moved = surface.S * (nodes * G.transpose());
  for (std::size_t v = 0; v < surface.mesh.vertices.size(); ++v) {
    const Eigen::Vector3d x(surface.mesh.vertices[v].data());
    EXPECT_LT((moved.row(static_cast<Eigen::Index>(v)).transpose() - G * x).norm(), 1e-11);
  }
  for (const Triangle& t : surface.mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Point3 edge = minus(surface.mesh.vertices[static_cast<std::size_t>(t[i])],
                                surface.mesh.vertices[static_cast<std::size_t>(t[(i + 1) % 3])]);
      EXPECT_LE(norm(edge), 0.7 * (1 + 1e-12));
    }
  const Eigen::Vector3d f(1, -2, 3), x(surface.mesh.vertices[7].data());
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = force;
  for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
    const Eigen::Vector3d share = surface.S.coeff(7, i) * f, at = nodes.row(i);
    force += share;
    moment += at.cross(share);
  }
  EXPECT_LT((force - f).norm(), 1e-12);
  EXPECT_LT((moment - x.cross(f)).norm(), 1e-11);
  EXPECT_NEAR(surface_area(surface.mesh), surface_area(body->model.surface.mesh), 1e-11);
}

TEST(TimeCurve, ValuesIntegralsAndRefusals) {
  const TimeCurve line({0, 1, 3}, {0, 2, -2}, TimeCurve::Between::Linear, "curve");
  EXPECT_DOUBLE_EQ(line.value(2), 0);
  EXPECT_DOUBLE_EQ(line.value(-1), 0);
  EXPECT_DOUBLE_EQ(line.value(9), -2);
  const TimeCurve smooth({0, 1, 3}, {0, 2, -2}, TimeCurve::Between::Smooth, "curve");
  EXPECT_DOUBLE_EQ(smooth.value(0.5), 1);
  for (const TimeCurve* curve : {&line, &smooth}) {
    double sum = 0;
    const double step = 1e-3;
    for (int i = 0; i < 3500; ++i) sum += step * curve->value((i + 0.5) * step);
    EXPECT_NEAR(curve->integral(3.5), sum, 1e-6);
    EXPECT_NEAR((smooth.value(1e-4) - smooth.value(0)) / 1e-4, 0, 1e-3);
  }
  EXPECT_DOUBLE_EQ(TimeCurve(3).integral(2), 6);
  EXPECT_THROW(TimeCurve({0, 0}, {1, 2}, TimeCurve::Between::Linear, "c"), InputError);
  EXPECT_THROW(TimeCurve({0, 1}, {1}, TimeCurve::Between::Linear, "c"), InputError);
}

TEST(RigidShape, NormalsAreGradientsOfTheDistance) {
  std::mt19937 random(5);
  const RigidShape shapes[]{PlaneShape{{0.6, 0, 0.8}}, SphereShape{2}, CylinderShape{{0, 0.6, 0.8}, 1.2, 0.9}};
  for (const RigidShape& shape : shapes)
    for (int k = 0; k < 200; ++k) {
      const Point3 x = random_point(random, 3);
      const ShapeDistance here = distance_to_shape(shape, x);
      EXPECT_NEAR(norm(here.normal), 1, 1e-12);
      for (std::size_t d = 0; d < 3; ++d) {
        Point3 up = x, low = x;
        up[d] += 1e-6;
        low[d] -= 1e-6;
        EXPECT_NEAR((distance_to_shape(shape, up).gap - distance_to_shape(shape, low).gap) / 2e-6, here.normal[d],
                    2e-5);
      }
    }
  EXPECT_NEAR(distance_to_shape(CylinderShape{{0, 0, 1}, 1, 2}, {4, 0, 6}).gap, 5, 1e-12);
  const MeshShape box = box_shape({1, 2, 3});
  EXPECT_NEAR(volume_moments(box.mesh).volume, 48, 1e-12);
}

TEST(ClosestPoint, IsNoFartherThanAnyPointOfTheTriangle) {
  std::mt19937 random(7);
  for (int k = 0; k < 300; ++k) {
    const Point3 a = random_point(random, 1), b = random_point(random, 1), c = random_point(random, 1);
    const Point3 x = random_point(random, 2);
    const ClosestOnTriangle on = closest_on_triangle(x, a, b, c);
    double nearest = 1e9;
    for (int i = 0; i <= 40; ++i)
      for (int j = 0; i + j <= 40; ++j) {
        const double s = i / 40.0, t = j / 40.0;
        const Point3 p = plus(times(a, 1 - s - t), plus(times(b, s), times(c, t)));
        nearest = std::min(nearest, norm(minus(x, p)));
      }
    EXPECT_LE(std::sqrt(on.distance2), nearest + 1e-12);
    EXPECT_GE(std::sqrt(on.distance2), nearest - 0.1);
    TriangleMesh mesh{{a, b, c}, {{0, 1, 2}}, {0}, {"t"}};
    EXPECT_NEAR(std::sqrt(on.distance2), distance_to_triangle(mesh, 0, x), 1e-12);
  }
}

TEST(Bvh, FollowsASegmentAndFindsTheNearestPastFewItems) {
  // Small cells of an oblique sheet, as the triangles of a turned face.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(0, 1);
  std::vector<Box3> boxes;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      const Point3 x{0.01 * i, 0.01 * j, 0.005 * (i + j)};
      boxes.push_back({x, plus(x, {0.01, 0.01, 0.01})});
    }
  const Bvh tree(boxes);
  std::size_t visits = 0, looks = 0;
  for (int k = 0; k < 50; ++k) {
    const Point3 a{anywhere(random), anywhere(random), anywhere(random)}, b{anywhere(random), anywhere(random), 1};
    std::vector<std::uint8_t> visited(boxes.size(), 0);
    tree.each_on_segment(a, b, [&](std::int32_t i) { visited[static_cast<std::size_t>(i)] = 1; });
    visits += static_cast<std::size_t>(std::count(visited.begin(), visited.end(), 1));
    for (int s = 0; s <= 100; ++s) { // points of the segment lie in visited boxes alone
      const Point3 x = plus(times(a, 1 - 0.01 * s), times(b, 0.01 * s));
      for (std::size_t i = 0; i < boxes.size(); ++i)
        ASSERT_TRUE(visited[i] || !overlap({x, x}, boxes[i])) << k << " " << s << " " << i;
    }
    double least = std::numeric_limits<double>::infinity();
    const auto distance2 = [&](std::size_t i) {
      const Point3 d = minus(a, boxes[i].lower);
      return dot(d, d);
    };
    for (std::size_t i = 0; i < boxes.size(); ++i) least = std::min(least, distance2(i));
    EXPECT_EQ(tree.least_distance2(a, [&](std::int32_t i) { return ++looks, distance2(static_cast<std::size_t>(i)); }),
              least);
  }
  EXPECT_LT(visits, 50u * 100u); // of 10 000 each
  EXPECT_LT(looks, 50u * 300u);
  EXPECT_EQ(Bvh().least_distance2({0, 0, 0}, [](std::int32_t) { return 0.0; }),
            std::numeric_limits<double>::infinity());
}

TEST(Bvh, FindsWhatBruteForceFindsAfterRefittingToo) {
  std::mt19937 random(3);
  std::vector<Box3> boxes(500);
  const auto scatter = [&] {
    for (Box3& box : boxes) {
      const Point3 x = random_point(random, 10);
      box = {x, plus(x, {0.5, 0.7, 0.3})};
    }
  };
  scatter();
  Bvh tree(boxes);
  for (int round = 0; round < 2; ++round) {
    for (int k = 0; k < 50; ++k) {
      const Point3 x = random_point(random, 10);
      const Box3 query{x, plus(x, {1, 2, 1})};
      std::vector<std::int32_t> found, expected;
      tree.each_overlap(query, [&](std::int32_t i) { found.push_back(i); });
      for (std::size_t i = 0; i < boxes.size(); ++i)
        if (overlap(boxes[i], query)) expected.push_back(static_cast<std::int32_t>(i));
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
    }
    scatter();
    tree.refit(boxes);
  }
}

TEST(ContactMesh, KnowsNeighboursSharpEdgesAndThickness) {
  const ContactMesh box = make_contact_mesh(box_shape({1, 2, 3}).mesh, 5);
  EXPECT_EQ(box.sharp_edges.size(), 12u);
  double area = 0;
  for (const double a : box.vertex_area) area += a;
  EXPECT_NEAR(area, 88, 1e-12);
  for (std::size_t f = 0; f < box.triangles.size(); ++f) {
    for (const std::int32_t n : box.neighbour[f]) EXPECT_GE(n, 0);
    const double expected = std::abs(box.face_normal[f][0]) > 0.5 ? 2 : std::abs(box.face_normal[f][1]) > 0.5 ? 4 : 5;
    EXPECT_NEAR(box.thickness[f], expected, 1e-12);
  }
  TriangleMesh soup; // every facet with corners of its own, as an STL has them
  soup.region_names = {"box"};
  for (const Triangle& t : box.triangles) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    for (const std::int32_t v : t) soup.vertices.push_back(box.vertices[static_cast<std::size_t>(v)]);
    soup.triangles.push_back({first, first + 1, first + 2});
    soup.region.push_back(0);
  }
  EXPECT_EQ(merge_equal_vertices(soup).vertices.size(), 8u);
}

TEST(RigidState, FreeRotationKeepsMomentumAndEnergy) {
  RigidBody body{"top", SphereShape{1}, {1, 2, 3}, {}};
  FreeMotion motion;
  motion.mass = 3;
  motion.inertia = {{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}};
  motion.velocity = {1, 0, -1};
  motion.angular_velocity = {0.1, 2, 0.1}; // about the unstable axis
  body.motion = motion;
  RigidState state(body);
  StepTimes times{0, 0, 2e-3, 0.76};
  state.advance(times);
  const double energy = state.kinetic_energy();
  const Point3 before = state.angular_momentum();
  for (int k = 0; k < 5000; ++k) {
    times = {times.time + times.dt, times.dt, times.dt, 0.76};
    state.advance(times);
  }
  EXPECT_NEAR(state.kinetic_energy(), energy, 1e-5 * energy);
  const Point3 after = state.angular_momentum();
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(after[d], before[d], 1e-9);
  EXPECT_NEAR(state.pose().centre[0], 1 + 5001 * 2e-3, 1e-9);
  RigidState copy(body);
  copy.restore(state.save());
  EXPECT_EQ(copy.save(), state.save());
}

TEST(RigidState, FallsAndFollowsItsTable) {
  RigidBody body{"stone", SphereShape{1}, {0, 0, 0}, {}};
  FreeMotion motion;
  motion.acceleration = {0, 0, -10};
  body.motion = motion;
  RigidState stone(body);
  PrescribedMotion drive;
  drive.translation[0] = TimeCurve({0, 1}, {0, 2}, TimeCurve::Between::Linear, "drive");
  drive.rotation = TimeCurve(3);
  drive.curves_are_velocities = true;
  RigidState driven({"press", SphereShape{1}, {0, 0, 5}, drive});
  StepTimes times{0, 0, 0.01, 0.76};
  for (int k = 0; k < 100; ++k) {
    stone.clear_force();
    driven.clear_force();
    stone.advance(times);
    driven.add_force({-1, 0, 0}, {0, 0, 5});
    driven.advance(times);
    times = {times.time + times.dt, times.dt, times.dt, 0.76};
  }
  EXPECT_NEAR(stone.pose().centre[2], -5, 1e-9); // leapfrog is exact for parabolas
  EXPECT_NEAR(stone.kinetic_energy() - stone.external_work(), 0, 0.01);
  EXPECT_NEAR(driven.pose().centre[0], 1, 1e-12);
  const Point3 v = driven.velocity_at(driven.to_space({1, 0, 0}), times);
  EXPECT_NEAR(norm(minus(v, {2, 0, 0})), 3, 0.02);
  EXPECT_NEAR(driven.external_work(), 0.99 * 0.99, 1e-2); // drags 1 against the force over the way passed
  EXPECT_THROW(RigidState({"bad", SphereShape{-1}, {}, FixedMotion{}}), InputError);
  motion.inertia = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 5}}};
  EXPECT_THROW(RigidState({"bad", SphereShape{1}, {}, motion}), InputError);
}

TEST(ToolMesh, ASolidBoxFromAnStlHasItsMassAndInertia) {
  const TempFolder folder;
  const auto write = [&](const char* name, bool turned, std::size_t leave_out) {
    const MeshShape box = box_shape({1, 2, 3});
    std::ofstream out(folder.path() / name);
    out << "solid box\n";
    for (std::size_t f = leave_out; f < box.mesh.triangles.size(); ++f) {
      Triangle t = box.mesh.triangles[f];
      if (turned) std::swap(t[0], t[1]);
      out << "facet normal 0 0 0\nouter loop\n";
      for (const std::int32_t v : t) {
        const Point3 x = plus(box.mesh.vertices[static_cast<std::size_t>(v)], {5, 6, 7});
        out << "vertex " << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
      }
      out << "endloop\nendfacet\n";
    }
    out << "endsolid\n";
    return folder.path() / name;
  };
  const ToolMesh tool = read_tool(write("box.stl", false, 0), 2);
  EXPECT_NEAR(norm(minus(tool.centre, {10, 12, 14})), 0, 1e-12);
  EXPECT_EQ(tool.shape.mesh.vertices.size(), 8u);
  const FreeMotion motion = solid_tool(tool, 0.5);
  EXPECT_NEAR(motion.mass, 0.5 * 48 * 8, 1e-10);
  EXPECT_NEAR(motion.inertia[0][0], motion.mass / 12 * (64 + 144), 1e-9);
  EXPECT_NEAR(motion.inertia[2][2], motion.mass / 12 * (16 + 64), 1e-9);
  EXPECT_NEAR(motion.inertia[0][1], 0, 1e-9);
  EXPECT_THROW(read_tool(write("turned.stl", true, 0)), InputError);
  EXPECT_THROW(read_tool(write("open.stl", false, 1)), InputError);
  EXPECT_THROW(read_tool(folder.path() / "missing.stl"), InputError);
}
