// Rigid bodies: a shape, and a motion that is none, prescribed, or free.
#pragma once

#include "format/model/triangle_mesh.hpp"
#include "solver/explicit/motion/contact_body.hpp"
#include "solver/explicit/motion/time_curve.hpp"

#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <variant>

namespace iga::solve {

/// Shapes in the body's own frame, centre at the origin. Solid where the normal points away from.
struct PlaneShape {
  Point3 normal{0, 0, 1}; ///< outward, unit: the half space below is solid
};
struct SphereShape {
  double radius = 1; ///< length
};
struct CylinderShape {
  Point3 axis{0, 0, 1}; ///< unit
  double radius = 1, half_length = 1;
};
struct MeshShape {
  TriangleMesh mesh; ///< closed, outward; equal vertices merged
};
using RigidShape = std::variant<PlaneShape, SphereShape, CylinderShape, MeshShape>;

/// A box as a mesh: its edges and corners take part in contact.
MeshShape box_shape(const Point3& half_size);

struct ShapeDistance {
  double gap = 0;  ///< signed, positive outside, length
  Point3 normal{}; ///< outward unit normal of the nearest point of the shape
};
/// @pre not a mesh
ShapeDistance distance_to_shape(const RigidShape& shape, const Point3& x);
/// Radius of the smallest ball about the centre that holds the shape; infinite for a plane.
double bounding_radius(const RigidShape& shape);

struct FixedMotion {};
/// Translation per axis and rotation about one axis through the centre; curves of displacement (length, radians) or of
/// velocity (integrated from the curve's first time).
struct PrescribedMotion {
  std::array<std::optional<TimeCurve>, 3> translation;
  std::optional<TimeCurve> rotation;
  Point3 axis{0, 0, 1}; ///< unit
  bool curves_are_velocities = false;
};
struct FreeMotion {
  double mass = 1;
  std::array<std::array<double, 3>, 3> inertia{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}; ///< about the centre, mass · length²
  Point3 velocity{}, angular_velocity{};                                           ///< at the start
  Point3 acceleration{};                                                           ///< gravity, length/time²
  std::array<bool, 3> guided{};                                                    ///< no translation along x, y, z
  bool rotates = true;
};
using RigidMotion = std::variant<FixedMotion, PrescribedMotion, FreeMotion>;

struct RigidBody {
  std::string name;
  RigidShape shape;
  Point3 centre{}; ///< at the start: centre of mass of a free body
  RigidMotion motion = FixedMotion{};
};

struct Pose {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity(); ///< from the body's frame to space
};

/// A rigid body in time. Positions at t_n and t_{n-1}, velocities at t_{n-1/2}.
class RigidState {
 public:
  /// @throws InputError for sizes, masses or inertias that no body has, naming the body
  explicit RigidState(RigidBody body);

  const RigidBody& body() const { return body_; }
  const Pose& pose() const { return now_; }
  const Pose& pose_before() const { return last_; } ///< at the t_n that the last advance began with
  bool is_free() const { return std::holds_alternative<FreeMotion>(body_.motion); }
  bool is_fixed() const { return std::holds_alternative<FixedMotion>(body_.motion); }
  double mass() const; ///< infinite unless free
  /// √(smallest inertia / mass), length; infinite where it cannot rotate.
  double radius_of_gyration() const;

  Point3 to_space(const Point3& local) const;
  Point3 to_body(const Point3& x) const;
  Point3 turned(const Point3& direction) const; ///< from the body's frame to space
  /// Of the material point that is at x now, over the last step: (x_n - x_{n-1}) / dt_last; at the start its velocity.
  Point3 velocity_at(const Point3& x, const StepTimes& times) const;

  /// Resultants at t_n of all that acts from outside, moment about the centre. They begin at zero in each step.
  void clear_force();
  void add_force(const Point3& force, const Point3& x);
  void add_resultant(const Point3& force, const Point3& moment);
  Point3 force() const { return {force_[0], force_[1], force_[2]}; }
  Point3 moment() const { return {moment_[0], moment_[1], moment_[2]}; }

  /// Of the forces at t_{n-1} and t_n on the way between (trapezoidal).
  double work_of_forces() const;

  /// From t_n to t_{n+1} with the force added; the first step of a run has dt_last = 0.
  void advance(const StepTimes& times);

  double kinetic_energy() const; ///< at the last t_n passed: mean of the half steps around it; 0 unless free
  /// Work of the drive on a prescribed body, of gravity on a free one, up to the last t_n passed.
  double external_work() const { return external_work_; }
  Point3 momentum() const;         ///< at t_{n-1/2}; 0 unless free
  Point3 angular_momentum() const; ///< about the origin, at t_{n-1/2} with the centre at t_n

  /// All that changes, for a restart. (state_size)
  static constexpr std::size_t state_size = 2 * 7 + 6 * 3 + 2;
  std::vector<double> save() const;
  void restore(std::span<const double> values);

 private:
  Pose prescribed(double t) const;
  void advance_free(const FreeMotion& motion, const StepTimes& times);
  Eigen::Vector3d spin(const Eigen::Quaterniond& turn, const Eigen::Vector3d& angular_momentum) const;
  double energy_of(const Eigen::Vector3d& v, const Eigen::Vector3d& spin_momentum,
                   const Eigen::Quaterniond& turn) const;

  RigidBody body_;
  Pose now_, last_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();         ///< at t_{n-1/2}
  Eigen::Vector3d angular_momentum_ = Eigen::Vector3d::Zero(); ///< about the centre, in space, at t_{n-1/2}
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero(), moment_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_force_ = Eigen::Vector3d::Zero(), last_moment_ = Eigen::Vector3d::Zero();
  double kinetic_ = 0, external_work_ = 0;
};

} // namespace iga::solve
