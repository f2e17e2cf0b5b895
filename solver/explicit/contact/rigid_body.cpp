#include "solver/explicit/contact/rigid_body.hpp"

#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace iga::solve {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double inf = std::numeric_limits<double>::infinity();

Vector3d vec(const Point3& x) {
  return {x[0], x[1], x[2]};
}
Point3 point(const Vector3d& x) {
  return {x[0], x[1], x[2]};
}

Matrix3d matrix(const std::array<std::array<double, 3>, 3>& rows) {
  Matrix3d m;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) m(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return m;
}

Quaterniond turn_by(const Vector3d& angles) {
  const double angle = angles.norm();
  return angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, angles / angle)) : Quaterniond::Identity();
}

void require_unit(const std::string& name, const char* what, const Point3& v) {
  if (!(std::abs(vec(v).norm() - 1) < 1e-9))
    throw InputError(
        fmt::format("rigid body '{}': the {} ({}, {}, {}) is no unit vector", name, what, v[0], v[1], v[2]));
}

void require_positive(const std::string& name, const char* what, double x) {
  if (!(x > 0) || !std::isfinite(x))
    throw InputError(fmt::format("rigid body '{}': the {} is {}, expected a number above 0", name, what, x));
}

void check(const RigidBody& b) {
  if (const auto* plane = std::get_if<PlaneShape>(&b.shape)) require_unit(b.name, "normal", plane->normal);
  if (const auto* sphere = std::get_if<SphereShape>(&b.shape)) require_positive(b.name, "radius", sphere->radius);
  if (const auto* c = std::get_if<CylinderShape>(&b.shape)) {
    require_unit(b.name, "axis", c->axis);
    require_positive(b.name, "radius", c->radius);
    require_positive(b.name, "half length", c->half_length);
  }
  if (const auto* m = std::get_if<MeshShape>(&b.shape); m && m->mesh.triangles.empty())
    throw InputError(fmt::format("rigid body '{}': its surface has no triangles", b.name));
  if (const auto* p = std::get_if<PrescribedMotion>(&b.motion); p && p->rotation)
    require_unit(b.name, "axis of rotation", p->axis);
  if (const auto* f = std::get_if<FreeMotion>(&b.motion)) {
    require_positive(b.name, "mass", f->mass);
    if (!f->rotates) return;
    const Matrix3d I = matrix(f->inertia);
    const Vector3d e = symmetric_eigenvalues_3(0.5 * (I + I.transpose()));
    if (!((I - I.transpose()).norm() <= 1e-9 * I.norm()) || !(e[0] > 0) || !(e[2] <= (e[0] + e[1]) * (1 + 1e-9)))
      throw InputError(fmt::format("rigid body '{}': principal inertias {:.6g}, {:.6g}, {:.6g} belong to no body; give "
                                   "a symmetric tensor, each at most the sum of the others",
                                   b.name, e[0], e[1], e[2]));
  }
}

} // namespace

RigidState::RigidState(RigidBody body) : body_(std::move(body)) {
  check(body_);
  now_.centre = vec(body_.centre);
  if (std::holds_alternative<PrescribedMotion>(body_.motion)) now_ = prescribed(0);
  if (const auto* free = std::get_if<FreeMotion>(&body_.motion)) {
    velocity_ = vec(free->velocity);
    for (int d = 0; d < 3; ++d)
      if (free->guided[static_cast<std::size_t>(d)]) velocity_[d] = 0;
    if (free->rotates) angular_momentum_ = matrix(free->inertia) * vec(free->angular_velocity);
    kinetic_ = energy_of(velocity_, angular_momentum_, now_.turn);
  }
  last_ = now_;
}

double RigidState::mass() const {
  const auto* free = std::get_if<FreeMotion>(&body_.motion);
  return free ? free->mass : inf;
}

double RigidState::radius_of_gyration() const {
  const auto* free = std::get_if<FreeMotion>(&body_.motion);
  if (!free || !free->rotates) return inf;
  return std::sqrt(symmetric_eigenvalues_3(matrix(free->inertia))[0] / free->mass);
}

Point3 RigidState::to_space(const Point3& local) const {
  return point(now_.centre + now_.turn * vec(local));
}
Point3 RigidState::to_body(const Point3& x) const {
  return point(now_.turn.conjugate() * (vec(x) - now_.centre));
}
Point3 RigidState::turned(const Point3& direction) const {
  return point(now_.turn * vec(direction));
}

Point3 RigidState::velocity_at(const Point3& x, const StepTimes& times) const {
  const Vector3d r = vec(x) - now_.centre;
  if (times.dt_last > 0) {
    const Vector3d before = last_.centre + last_.turn * (now_.turn.conjugate() * r);
    return point((vec(x) - before) / times.dt_last);
  }
  if (is_free()) return point(velocity_ + spin(now_.turn, angular_momentum_).cross(r));
  if (const auto* p = std::get_if<PrescribedMotion>(&body_.motion); p && times.dt > 0) {
    const Pose next = prescribed(times.time + times.dt);
    return point((next.centre + next.turn * (now_.turn.conjugate() * r) - vec(x)) / times.dt);
  }
  return {};
}

void RigidState::clear_force() {
  force_.setZero();
  moment_.setZero();
}

void RigidState::add_force(const Point3& force, const Point3& x) {
  force_ += vec(force);
  moment_ += (vec(x) - now_.centre).cross(vec(force));
}

void RigidState::add_resultant(const Point3& force, const Point3& moment) {
  force_ += vec(force);
  moment_ += vec(moment);
}

Pose RigidState::prescribed(double t) const {
  const auto& motion = std::get<PrescribedMotion>(body_.motion);
  const auto amount = [&](const TimeCurve& curve) {
    return motion.curves_are_velocities ? curve.integral(t) : curve.value(t);
  };
  Pose pose;
  pose.centre = vec(body_.centre);
  for (int d = 0; d < 3; ++d)
    if (const auto& curve = motion.translation[static_cast<std::size_t>(d)]) pose.centre[d] += amount(*curve);
  if (motion.rotation) pose.turn = Quaterniond(Eigen::AngleAxisd(amount(*motion.rotation), vec(motion.axis)));
  return pose;
}

Vector3d RigidState::spin(const Quaterniond& turn, const Vector3d& L) const {
  const auto* free = std::get_if<FreeMotion>(&body_.motion);
  if (!free || !free->rotates) return Vector3d::Zero();
  return turn * matrix(free->inertia).ldlt().solve(turn.conjugate() * L);
}

double RigidState::energy_of(const Vector3d& v, const Vector3d& L, const Quaterniond& turn) const {
  return 0.5 * mass() * v.squaredNorm() + 0.5 * L.dot(spin(turn, L));
}

double RigidState::work_of_forces() const {
  const Eigen::AngleAxisd turned(now_.turn * last_.turn.conjugate());
  return 0.5 * (force_ + last_force_).dot(now_.centre - last_.centre) +
         0.5 * (moment_ + last_moment_).dot(turned.angle() * turned.axis());
}

void RigidState::advance(const StepTimes& times) {
  const auto* free = std::get_if<FreeMotion>(&body_.motion);
  if (!free) external_work_ -= work_of_forces(); // the drive balances what acts from outside
  last_force_ = force_;
  last_moment_ = moment_;
  if (free) {
    advance_free(*free, times);
    return;
  }
  last_ = now_;
  if (std::holds_alternative<PrescribedMotion>(body_.motion)) now_ = prescribed(times.time + times.dt);
}

void RigidState::advance_free(const FreeMotion& motion, const StepTimes& times) {
  // Leapfrog; the rotation by the explicit midpoint rule with the angular momentum of the half step, which is exact.
  const double middle = 0.5 * (times.dt_last + times.dt);
  const Vector3d before = velocity_, L_before = angular_momentum_, g = vec(motion.acceleration);
  velocity_ += middle * (force_ / motion.mass + g);
  for (int d = 0; d < 3; ++d)
    if (motion.guided[static_cast<std::size_t>(d)]) velocity_[d] = 0;
  if (motion.rotates) angular_momentum_ += middle * moment_;
  // Velocities at t_n by the share of the step around it that lies before.
  const double share = times.dt_last + times.dt > 0 ? times.dt_last / (times.dt_last + times.dt) : 0;
  const Vector3d v = before + share * (velocity_ - before), L = L_before + share * (angular_momentum_ - L_before);
  kinetic_ = energy_of(v, L, now_.turn);
  external_work_ += motion.mass * g.dot(now_.centre - last_.centre);
  last_ = now_;
  now_.centre += times.dt * velocity_;
  if (motion.rotates) {
    const Quaterniond half = turn_by(0.5 * times.dt * spin(now_.turn, angular_momentum_)) * now_.turn;
    now_.turn = (turn_by(times.dt * spin(half, angular_momentum_)) * now_.turn).normalized();
  }
}

double RigidState::kinetic_energy() const {
  return kinetic_;
}

Point3 RigidState::momentum() const {
  return is_free() ? point(mass() * velocity_) : Point3{};
}
Point3 RigidState::angular_momentum() const {
  return is_free() ? point(angular_momentum_ + mass() * now_.centre.cross(velocity_)) : Point3{};
}

std::vector<double> RigidState::save() const {
  std::vector<double> values;
  const auto add = [&](const auto& v) { values.insert(values.end(), v.data(), v.data() + v.size()); };
  for (const Pose* pose : {&now_, &last_}) {
    add(pose->centre);
    add(pose->turn.coeffs());
  }
  for (const Vector3d* v : {&velocity_, &angular_momentum_, &force_, &moment_, &last_force_, &last_moment_}) add(*v);
  values.push_back(kinetic_);
  values.push_back(external_work_);
  return values;
}

void RigidState::restore(std::span<const double> values) {
  std::size_t next = 0;
  const auto take = [&](auto& v) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(next), v.size(), v.data());
    next += static_cast<std::size_t>(v.size());
  };
  for (Pose* pose : {&now_, &last_}) {
    take(pose->centre);
    take(pose->turn.coeffs());
  }
  for (Vector3d* v : {&velocity_, &angular_momentum_, &force_, &moment_, &last_force_, &last_moment_}) take(*v);
  kinetic_ = values[next];
  external_work_ = values[next + 1];
}

} // namespace iga::solve
