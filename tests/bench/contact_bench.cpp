#include "tests/bench/measurements.hpp"

#include "solver/explicit/contact/contact_model.hpp"
#include "solver/mechanics/assemble.hpp"
#include "tests/support/synthetic_model.hpp"

#include <cmath>
#include <memory>

namespace iga::bench {

namespace {

using namespace solve;

/// A cube of side 100 on the floor at z = 0, or on another one's top, in a grid that is not aligned with it.
struct Cube {
  explicit Cube(double z)
      : model(test::make_box_model({{-9, -9, z - 9},
                                    {107, 107, z + 107},
                                    {29, 29, 29},
                                    {2, 2, 2},
                                    identity_rotation,
                                    {0, 0, z},
                                    {100, 100, z + 100}})),
        space(model, {LightFunctions::Linear, 0.05}), masses(lumped_mass(space, 6e-8)),
        u(Eigen::VectorXd::Zero(space.num_unknowns())), v(u), f(u), penalty(Eigen::VectorXd::Zero(masses.size())) {}
  BodyState state() { return {&u, &v, &masses, 1, &f, &penalty}; }
  void move_to(double z, double dt) {
    for (Eigen::Index i = 2; i < u.size(); i += 3) {
      v[i] = (z - u[i]) / dt;
      u[i] = z;
    }
  }
  TrimmedModel model;
  SolutionSpace space;
  Eigen::VectorXd masses, u, v, f, penalty;
};

enum class Partner { Shapes, Self, OtherCube };

struct Problem {
  explicit Problem(Partner partner) {
    cubes.push_back(std::make_unique<Cube>(0));
    if (partner == Partner::OtherCube) cubes.push_back(std::make_unique<Cube>(100));
    std::vector<ContactSurface> surfaces;
    for (const auto& cube : cubes) surfaces.push_back(make_contact_surface(cube->space, "cube", 6e-8, 4));
    for (const ContactSurface& surface : surfaces) vertices += static_cast<std::int64_t>(surface.mesh.vertices.size());
    const auto body = [](std::size_t k) { return ContactSide{ContactSide::Kind::Deformable, k, {}}; };
    const auto tool = [](std::size_t k) { return ContactSide{ContactSide::Kind::Rigid, k, {}}; };
    std::vector<RigidBody> rigid{{"ball", SphereShape{35}, {50, 50, 134.5}, {}}, {"floor", PlaneShape{}, {}, {}}};
    std::vector<ContactPair> pairs;
    if (partner != Partner::OtherCube) {
      pairs.push_back({"ball", body(0), tool(0), {0.2, 0.2, 0}});
      pairs.push_back({"floor", body(0), tool(1), {0.2, 0.2, 0}});
    }
    if (partner == Partner::Self) pairs.push_back({"self", body(0), body(0), {0.2, 0.2, 0}});
    if (partner == Partner::OtherCube) pairs.push_back({"cubes", body(0), body(1), {0.2, 0.2, 0}});
    contact = std::make_unique<ContactModel>(std::move(surfaces), std::move(rigid), std::move(pairs));
  }
  std::int64_t step() {
    constexpr double dt = 4e-3;
    cubes[0]->move_to(0.5 * std::sin(0.06 * static_cast<double>(steps)), dt);
    std::vector<BodyState> states;
    for (const auto& cube : cubes) {
      cube->penalty.setZero();
      states.push_back(cube->state());
    }
    const StepTimes times{dt * static_cast<double>(steps), steps > 0 ? dt : 0, dt, 0.76};
    contact->add_forces(times, states);
    contact->advance(times);
    ++steps;
    return vertices;
  }
  std::vector<std::unique_ptr<Cube>> cubes;
  std::unique_ptr<ContactModel> contact;
  std::int64_t vertices = 0, steps = 0;
};

} // namespace

void measure_contact() {
  const std::pair<const char*, Partner> cases[]{{"contact_sphere_and_floor", Partner::Shapes},
                                                {"contact_with_self", Partner::Self},
                                                {"contact_of_two_cubes", Partner::OtherCube}};
  for (const auto& [name, partner] : cases)
    measure(name, "vertices", [partner = partner]() -> Work {
      const auto problem = std::make_shared<Problem>(partner);
      return [problem] { return problem->step(); };
    });
}

} // namespace iga::bench
