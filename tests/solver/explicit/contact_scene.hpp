// Elastic bodies under contact, in time: small strain, lumped mass, central differences. What contact does to them can
// be judged apart from the large-deformation kernel.
#pragma once

#include "solver/explicit/contact/contact_model.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"
#include "tests/solver/eigen_support.hpp"

#include <memory>

namespace iga::test {

struct ElasticBody {
  ElasticBody(TrimmedModel made, const solve::ElasticMaterial& made_of, const solve::LightTreatment& treatment = {})
      : model(std::move(made)), material(made_of), space(model, treatment),
        connectivity(std::make_shared<const solve::Connectivity>(space)),
        K(solve::assemble_stiffness(space, connectivity, material)),
        masses(solve::spare_masses(space, material.density).masses), u(Eigen::VectorXd::Zero(K.size())), v(u), f(u),
        penalty(Eigen::VectorXd::Zero(masses.size())) {}

  double largest_omega() const { return solve::largest_eigenvalue(K, solve::MassOperator::lumped(masses), 1e-4).omega; }
  Eigen::VectorXd acceleration(const Eigen::VectorXd& force) const {
    Eigen::VectorXd a(force.size());
    for (Eigen::Index i = 0; i < masses.size(); ++i) a.segment<3>(3 * i) = force.segment<3>(3 * i) / masses[i];
    return a;
  }
  void set_velocity(const Eigen::Vector3d& velocity) {
    for (Eigen::Index i = 0; i < masses.size(); ++i) v.segment<3>(3 * i) = velocity;
  }
  Eigen::Vector3d momentum() const {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < masses.size(); ++i) p += masses[i] * v.segment<3>(3 * i);
    return p;
  }
  /// With Greville points: exact for the linear part of the motion.
  Eigen::Vector3d angular_momentum() const {
    const auto points = space.node_points();
    Eigen::Vector3d L = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < masses.size(); ++i) {
      const Eigen::Vector3d x = points.row(i).transpose() + u.segment<3>(3 * i), p = masses[i] * v.segment<3>(3 * i);
      L += x.cross(p);
    }
    return L;
  }
  double weighted(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < masses.size(); ++i) sum += masses[i] * a.segment<3>(3 * i).dot(b.segment<3>(3 * i));
    return sum;
  }
  solve::BodyState state() { return {&u, &v, &masses, 1, &f, &penalty}; }

  TrimmedModel model;
  solve::ElasticMaterial material;
  solve::SolutionSpace space;
  std::shared_ptr<const solve::Connectivity> connectivity;
  solve::StiffnessMatrix K;
  Eigen::VectorXd masses, u, v, f, penalty;
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
};

using ElasticBodies = std::vector<std::unique_ptr<ElasticBody>>;

struct Energies {
  double kinetic = 0, internal = 0, contact = 0, friction = 0, damping = 0, external = 0;
  double balance() const { return kinetic + internal + contact + friction + damping - external; }
};

class Scene {
 public:
  Scene(ElasticBodies made, std::vector<solve::RigidBody> rigid, std::vector<solve::ContactPair> pairs,
        double longest = 0, double safety = 0.9)
      : bodies(std::move(made)), contact(surfaces(longest), std::move(rigid), std::move(pairs)) {
    double omega = 0;
    for (const auto& body : bodies) omega = std::max(omega, body->largest_omega());
    const double x = 2 * safety;
    times.dt = x / omega;
    times.budget = times.lasting = 4 - x * x;
  }

  std::vector<solve::BodyState> states() {
    std::vector<solve::BodyState> all;
    for (const auto& body : bodies) all.push_back(body->state());
    return all;
  }

  /// Contact forces at the current positions into the bodies' f.
  void evaluate() {
    for (const auto& body : bodies) {
      body->f.setZero();
      body->penalty.setZero();
    }
    auto all = states();
    contact.add_forces(times, all);
    const auto& e = contact.report().energy;
    energies.contact += e.stored;
    energies.friction += e.friction;
    energies.damping += e.damping;
  }

  /// Energies are those at the time before the step.
  void step() {
    evaluate();
    const double middle = 0.5 * (times.dt_last + times.dt);
    energies.kinetic = energies.internal = 0;
    double gravity = 0;
    for (const auto& body : bodies) {
      const Eigen::VectorXd Ku = body->K * body->u;
      const Eigen::VectorXd before = body->v;
      Eigen::VectorXd a = body->acceleration(body->f - Ku);
      for (Eigen::Index i = 0; i < body->masses.size(); ++i) a.segment<3>(3 * i) += body->gravity;
      body->v += middle * a;
      energies.kinetic += 0.5 * body->weighted(before, times.dt_last > 0 ? body->v : before);
      energies.internal += 0.5 * body->u.dot(Ku);
      for (Eigen::Index i = 0; i < body->masses.size(); ++i)
        gravity += body->masses[i] * body->gravity.dot(body->u.segment<3>(3 * i));
      body->u += times.dt * body->v;
    }
    contact.advance(times);
    energies.external = gravity;
    for (const auto& body : contact.rigid()) {
      energies.kinetic += body.kinetic_energy();
      energies.external += body.external_work();
    }
    times.time += times.dt;
    times.dt_last = times.dt;
  }

  const solve::PairForce& pair(std::size_t p = 0) const { return contact.report().pairs[p]; }

 private:
  std::vector<solve::ContactSurface> surfaces(double longest) {
    std::vector<solve::ContactSurface> all;
    for (const auto& body : bodies)
      all.push_back(solve::make_contact_surface(body->space, "body", body->material.density, longest));
    return all;
  }

 public:
  ElasticBodies bodies;
  solve::ContactModel contact;
  solve::StepTimes times;
  Energies energies;
};

inline solve::ContactSide deformable(std::size_t number) {
  return {solve::ContactSide::Kind::Deformable, number, {}};
}
inline solve::ContactSide rigid(std::size_t number) {
  return {solve::ContactSide::Kind::Rigid, number, {}};
}
inline solve::ContactPair pair_of(solve::ContactSide first, solve::ContactSide second, double friction = 0,
                                  double damping = 0) {
  solve::ContactPair pair;
  pair.name = "pair";
  pair.first = std::move(first);
  pair.second = std::move(second);
  pair.friction = {friction, friction, 0};
  pair.damping = damping;
  return pair;
}

/// A box of about the given size and place; its lower faces lie on knots to the last bit, the upper ones where cut = 1.
inline BoxCase placed_box(const Point3& lower, const Point3& size, const Index3& spans, int degree, double cut = 1) {
  BoxCase box = box_in_grid(size, spans, degree, cut);
  for (std::size_t d = 0; d < 3; ++d) {
    box.A[d] += lower[d];
    box.B[d] += lower[d];
  }
  const SplineGrid grid(box.A, box.B, box.spans, box.degree);
  for (std::size_t d = 0; d < 3; ++d) {
    const KnotVector& knots = grid.knots(static_cast<int>(d));
    const std::int64_t last = degree + spans[d] - 1;
    box.lower[d] = knots.lower(degree);
    box.upper[d] = cut == 1 ? knots.upper(last) : knots.lower(last) + cut * (knots.upper(last) - knots.lower(last));
  }
  return box;
}

inline std::unique_ptr<ElasticBody> make_body(const BoxCase& box, const solve::ElasticMaterial& material,
                                              const solve::LightTreatment& treatment = {}) {
  return std::make_unique<ElasticBody>(make_box_model(box), material, treatment);
}

} // namespace iga::test
