// Contact forces at given positions: resultants, stability, friction, baselines, what is and is not seen.
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "tests/solver/explicit/contact_scene.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

const ElasticMaterial soft = isotropic(100, 0.2, 1e-2);
constexpr LightTreatment extended{LightFunctions::Linear, 0.05};

RigidBody floor_at(double z) {
  return {"floor", PlaneShape{{0, 0, 1}}, {0, 0, z}, FixedMotion{}};
}

void shift(ElasticBody& body, const Eigen::Vector3d& by) {
  for (Eigen::Index i = 0; i < body.masses.size(); ++i) body.u.segment<3>(3 * i) += by;
}

/// A step in which all bodies move rigidly; forces at its end.
void move_rigidly(Scene& scene, std::size_t body, const Eigen::Vector3d& by) {
  scene.times.dt_last = scene.times.dt;
  for (auto& b : scene.bodies) b->v.setZero();
  scene.bodies[body]->set_velocity(by / scene.times.dt);
  shift(*scene.bodies[body], by);
  scene.evaluate();
}

Eigen::VectorXd all_forces(Scene& scene) {
  scene.evaluate();
  Eigen::VectorXd f;
  for (const auto& body : scene.bodies) {
    Eigen::VectorXd longer(f.size() + body->f.size());
    longer << f, body->f;
    f = longer;
  }
  return f;
}

/// dt² λ_max of M⁻¹ K_c, with K_c by differences of the contact forces (springs kept as they are).
double contact_eigenvalue(Scene& scene) {
  constexpr double step = 1e-7;
  Eigen::Index n = 0;
  for (const auto& body : scene.bodies) n += body->u.size();
  Eigen::MatrixXd K(n, n);
  Eigen::VectorXd masses(n);
  Eigen::Index column = 0;
  for (auto& body : scene.bodies)
    for (Eigen::Index i = 0; i < body->u.size(); ++i, ++column) {
      const double u = body->u[i];
      body->u[i] = u + step;
      const Eigen::VectorXd up = all_forces(scene);
      body->u[i] = u - step;
      const Eigen::VectorXd low = all_forces(scene);
      body->u[i] = u;
      K.col(column) = (low - up) / (2 * step);
      masses[column] = body->masses[i / 3];
    }
  const Eigen::VectorXd root = masses.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd A = root.asDiagonal() * (0.5 * (K + K.transpose())) * root.asDiagonal();
  return scene.times.dt * scene.times.dt * Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues().maxCoeff();
}

} // namespace

TEST(ContactForce, PlanePushesBackWithTheMassOverTheStepSquared) {
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {6, 6, 3}, {6, 6, 3}, 2), soft));
  ContactPair settings = pair_of(deformable(0), rigid(0));
  settings.stiffness = 0.5;
  Scene scene(std::move(bodies), {floor_at(-1e-3)}, {settings});
  scene.evaluate();
  move_rigidly(scene, 0, {0, 0, -0.002});
  const PairForce& pair = scene.pair();
  // k = stiffness · ρ · h/2 / dt² on each unit of area, but for nodes at the edges that bear less.
  const double full = 0.5 * soft.density * 0.5 / (scene.times.dt * scene.times.dt) * 36 * 1e-3;
  EXPECT_LE(pair.force[2], full * (1 + 1e-9));
  EXPECT_GE(pair.force[2], 0.85 * full);
  EXPECT_NEAR(pair.largest_depth, 1e-3, 1e-12);
  EXPECT_NEAR(pair.area, 36, 1e-9);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < scene.bodies[0]->masses.size(); ++i) sum += scene.bodies[0]->f.segment<3>(3 * i);
  EXPECT_NEAR(sum[2], pair.force[2], 1e-12 * full);
  EXPECT_NEAR(scene.contact.rigid()[0].force()[2], -pair.force[2], 1e-12 * full);
}

TEST(ContactForce, StaysWithinTheBudgetOfStability) {
  struct Case {
    const char* name;
    double cut, longest, stiffness, damping;
    LightTreatment light;
    bool two_bodies;
    double rigid_mass; ///< 0: a fixed floor
  };
  const Case cases[]{
      {"aligned", 1, 0.5, 0.5, 0, {}, false, 0},
      {"fine surface", 1, 0.2, 10, 0, {}, false, 0},
      {"trimmed, extended", 0.3, 0.4, 10, 0, extended, false, 0},
      {"trimmed", 0.3, 0.5, 10, 0, {}, false, 0},
      {"two bodies", 0.6, 0.4, 10, 0, extended, true, 0},
      {"light tool", 1, 0.5, 10, 0, {}, false, 0.002},
  };
  for (const Case& c : cases) {
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({0, 0, 0}, {2, 2, 2}, {2, 2, 2}, 2, c.cut), soft, c.light));
    ContactPair pair = pair_of(deformable(0), c.two_bodies ? deformable(1) : rigid(0));
    pair.stiffness = c.stiffness;
    pair.damping = c.damping;
    pair.edges = false;
    // The upper faces are the trimmed ones: what they touch lies above.
    const double top = bodies[0]->model.surface.mesh.vertices[7][2];
    std::vector<RigidBody> rigid{{"roof", PlaneShape{{0, 0, -1}}, {1, 1, top - 1e-3}, FixedMotion{}}};
    if (c.two_bodies)
      bodies.push_back(make_body(placed_box({0.2, 0.3, top - 1e-3}, {2, 2, 2}, {2, 2, 2}, 2, 0.8), soft, extended));
    if (c.rigid_mass > 0) {
      FreeMotion motion;
      motion.mass = c.rigid_mass;
      for (std::size_t d = 0; d < 3; ++d) motion.inertia[d][d] = c.rigid_mass;
      rigid[0].motion = motion;
    }
    Scene scene(std::move(bodies), std::move(rigid), {pair}, c.longest);
    for (auto& body : scene.bodies) shift(*body, {0, 0, body == scene.bodies[0] ? -2e-3 : 0});
    scene.evaluate(); // nothing touches yet: no baseline
    move_rigidly(scene, 0, {0, 0, 2e-3});
    ASSERT_GT(scene.pair().touches, 8) << c.name;
    for (auto& body : scene.bodies) body->v.setZero();
    const double eigenvalue = contact_eigenvalue(scene);
    EXPECT_LE(eigenvalue, scene.times.budget * (1 + 1e-4)) << c.name;
    double used = eigenvalue;
    if (c.rigid_mass > 0) { // the tool's own row
      scene.evaluate();
      const PairForce& force = scene.pair();
      used = force.normal_force / force.largest_depth * scene.times.dt * scene.times.dt / c.rigid_mass;
      EXPECT_LE(eigenvalue + used, scene.times.budget);
    }
    EXPECT_GE(used, 0.1 * scene.times.budget) << c.name;
    std::printf("[          ] %-18s dt^2 lambda = %.3f of %.3f, least scale %.3f\n", c.name, eigenvalue,
                scene.times.budget, scene.contact.report().least_scale);
    for (const auto& body : scene.bodies)
      for (Eigen::Index i = 0; i < body->masses.size(); ++i)
        EXPECT_LE(body->penalty[i] * scene.times.dt * scene.times.dt,
                  scene.times.budget * body->masses[i] * (1 + 1e-9));
  }
}

TEST(ContactForce, InitialOverlapIsTheBaselineAndFallsAsItOpens) {
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {2, 2, 2}, {2, 2, 2}, 2), soft));
  Scene scene(std::move(bodies), {floor_at(0.1)}, {pair_of(deformable(0), rigid(0))});
  scene.evaluate();
  EXPECT_NEAR(scene.contact.report().initial_depth, 0.1, 1e-12);
  EXPECT_EQ(scene.pair().normal_force, 0);
  move_rigidly(scene, 0, {0, 0, -0.01});
  EXPECT_NEAR(scene.pair().largest_depth, 0.01, 1e-12);
  const double force = scene.pair().normal_force;
  EXPECT_GT(force, 0);
  move_rigidly(scene, 0, {0, 0, 0.05}); // opens: 0.06 are left and forgotten
  EXPECT_EQ(scene.pair().normal_force, 0);
  move_rigidly(scene, 0, {0, 0, -0.01});
  EXPECT_NEAR(scene.pair().normal_force, force, 1e-9 * force);
  ElasticBodies deep;
  deep.push_back(make_body(placed_box({0, 0, 0}, {2, 2, 2}, {2, 2, 2}, 2), soft));
  Scene overlapping(std::move(deep), {floor_at(0.7)}, {pair_of(deformable(0), rigid(0))});
  EXPECT_THROW(overlapping.evaluate(), InputError);
}

TEST(ContactForce, FrictionIsASpringUpToCoulombsLimit) {
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {2, 2, 2}, {2, 2, 2}, 2), soft));
  Scene scene(std::move(bodies), {floor_at(-1e-3)}, {pair_of(deformable(0), rigid(0), 0.3)});
  scene.evaluate();
  move_rigidly(scene, 0, {0, 0, -0.002});
  const double normal = scene.pair().force[2];
  const double stick = 0.3 * 1e-3; // way at which k x = mu k g
  move_rigidly(scene, 0, {0.5 * stick, 0, 0});
  EXPECT_NEAR(scene.pair().force[0], -0.15 * normal, 1e-9 * normal);
  EXPECT_EQ(scene.energies.friction, 0);
  move_rigidly(scene, 0, {-0.5 * stick, 0, 0}); // and back: nothing is lost
  EXPECT_NEAR(scene.pair().force[0], 0, 1e-9 * normal);
  move_rigidly(scene, 0, {0, 5 * stick, 0});
  EXPECT_NEAR(scene.pair().force[1], -0.3 * normal, 1e-9 * normal);
  EXPECT_NEAR(scene.energies.friction, 0.3 * normal * 4 * stick * 0.5, 0.3 * normal * 4 * stick * 0.01);
  const double before = scene.energies.friction;
  move_rigidly(scene, 0, {0, 3 * stick, 0});
  EXPECT_NEAR(scene.energies.friction - before, 0.3 * normal * 3 * stick, 1e-6 * normal);
  EXPECT_NEAR(scene.pair().force[2], normal, 1e-9 * normal);
}

TEST(ContactForce, HistoryFollowsAVertexFromFaceToFaceAndThroughARestart) {
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {6, 6, 1}, {6, 6, 2}, 2), soft));
  bodies.push_back(make_body(placed_box({1, 2, 1.001}, {2, 2, 1}, {2, 2, 2}, 2), soft));
  Scene scene(std::move(bodies), {}, {pair_of(deformable(1), deformable(0), 0.4)});
  scene.evaluate();
  move_rigidly(scene, 1, {0, 0, -0.004});
  const double normal = scene.pair().normal_force;
  double friction = 0;
  for (int k = 0; k < 40; ++k) { // slides over many faces
    move_rigidly(scene, 1, {0.05, 0.013, 0});
    EXPECT_GE(scene.energies.friction, friction);
    friction = scene.energies.friction;
    EXPECT_NEAR(scene.pair().friction_force, 0.4 * scene.pair().normal_force, 1e-6 * normal);
    EXPECT_NEAR(scene.pair().normal_force, normal, 0.15 * normal);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& body : scene.bodies)
      for (Eigen::Index i = 0; i < body->masses.size(); ++i) sum += body->f.segment<3>(3 * i);
    EXPECT_LT(sum.norm(), 1e-12 * normal);
  }
  const std::vector<SavedArray> saved = scene.contact.save();
  scene.evaluate();
  const Eigen::VectorXd expected = scene.bodies[1]->f;
  scene.contact.load(saved);
  scene.evaluate();
  EXPECT_EQ(scene.bodies[1]->f, expected);
}

TEST(ContactForce, WhatIsNoContactIsLeftAlone) {
  // A thin plate: its own far side is no contact, even when the plate is squeezed to a tenth.
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 0}, {4, 4, 2}, {4, 4, 4}, 2), soft));
  Scene scene(std::move(bodies), {}, {pair_of(deformable(0), deformable(0))});
  const auto points = scene.bodies[0]->space.node_points();
  scene.evaluate();
  for (int k = 1; k <= 30; ++k) {
    scene.times.dt_last = scene.times.dt;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const double dz = -0.03 * points(i, 2);
      scene.bodies[0]->u[3 * i + 2] += dz;
      scene.bodies[0]->v[3 * i + 2] = dz / scene.times.dt;
    }
    scene.evaluate();
    ASSERT_EQ(scene.pair().normal_force, 0) << k;
  }
}

TEST(ContactForce, CrossedEdgesPushEachOtherApart) {
  // Two bars lie across each other edge on edge: no vertex of one is within the other's faces' reach.
  BoxCase bar = placed_box({-3, -0.5, -0.5}, {6, 1, 1}, {6, 2, 2}, 2);
  BoxCase other = placed_box({-0.5, -3, -0.5}, {1, 6, 1}, {2, 6, 2}, 2);
  ElasticBodies bodies;
  bodies.push_back(make_body(bar, soft));
  bodies.push_back(make_body(other, soft));
  Scene scene(std::move(bodies), {}, {pair_of(deformable(0), deformable(1))}, 0.8);
  const auto turn = [&](std::size_t b, const Eigen::Vector3d& axis, double lift) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(M_PI / 4, axis).toRotationMatrix();
    const auto points = scene.bodies[b]->space.node_points();
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const Eigen::Vector3d x = points.row(i);
      scene.bodies[b]->u.segment<3>(3 * i) = R * x - x + Eigen::Vector3d(0, 0, lift);
    }
  };
  turn(0, Eigen::Vector3d::UnitX(), 0);
  turn(1, Eigen::Vector3d::UnitY(), std::sqrt(2.0) + 0.01);
  shift(*scene.bodies[1], {0.03, 0.02, 0});
  scene.evaluate();
  EXPECT_EQ(scene.pair().touches, 0);
  move_rigidly(scene, 1, {0, 0, -0.03});
  ASSERT_GT(scene.pair().touches, 0);
  EXPECT_LT(scene.pair().force[2], 0); // the lower bar is pushed down
  EXPECT_NEAR(scene.pair().largest_depth, 0.02, 1e-9);
}

TEST(ContactForce, FastApproachIsSeenAndRefusedBeforeItCouldPass) {
  ElasticBodies bodies;
  bodies.push_back(make_body(placed_box({0, 0, 5}, {2, 2, 2}, {2, 2, 2}, 2), soft));
  Scene scene(std::move(bodies), {floor_at(0)}, {pair_of(deformable(0), rigid(0))});
  scene.evaluate();
  EXPECT_EQ(scene.contact.report().candidates, 0);
  std::int64_t looks = scene.contact.report().looks;
  double height = 5;
  while (height > -0.05) { // 0.11 a step: never deeper than one step when first seen
    const double before = height;
    move_rigidly(scene, 0, {0, 0, -0.11});
    height -= 0.11;
    if (height < 0) {
      EXPECT_GT(scene.pair().normal_force, 0) << before;
    }
  }
  EXPECT_LT(scene.contact.report().looks - looks, 20);
  EXPECT_THROW(move_rigidly(scene, 0, {0, 0, -0.6}), NumericalError);
}

TEST(ContactForce, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    ElasticBodies bodies;
    bodies.push_back(make_body(placed_box({0, 0, 0}, {3, 3, 3}, {4, 4, 4}, 2, 0.3), soft, extended));
    bodies.push_back(make_body(placed_box({0.3, 0.2, 3.001}, {2, 2, 2}, {3, 3, 3}, 2), soft));
    bodies[1]->set_velocity({0.3, 0.1, -2});
    RigidBody ball{"ball", SphereShape{2}, {1.5, 1.5, 7.1}, FreeMotion{}};
    Scene scene(std::move(bodies), {floor_at(0), ball},
                {pair_of(deformable(0), deformable(1), 0.3, 0.1), pair_of(deformable(0), rigid(0), 0.2),
                 pair_of(deformable(1), rigid(1), 0.2), pair_of(deformable(0), deformable(0))});
    for (int k = 0; k < 60; ++k) scene.step();
    return std::make_pair(scene.bodies[0]->u, scene.contact.save());
  };
  const auto one = run(1), two = run(2), four = run(4);
  EXPECT_GT(one.first.norm(), 0);
  EXPECT_EQ(one.first, two.first);
  EXPECT_EQ(one.second, two.second);
  EXPECT_EQ(one.second, four.second);
}
