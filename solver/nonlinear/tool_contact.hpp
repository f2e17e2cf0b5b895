// Contact of the part with a rigid tool in statics: penalty at the quadrature points of the part's surface.
#pragma once

#include "solver/nonlinear/finite_body.hpp"
#include "solver/nonlinear/tool_shape.hpp"
#include "solver/space/surface_region.hpp"

namespace iga::solve {

/// One of [[contacts]].
struct ToolContactSettings {
  std::string name, where;          ///< `where` opens messages: file and line
  std::size_t tool = 0;             ///< number of the rigid body
  std::vector<std::string> regions; ///< of the part's surface, by name; empty: all
  double friction = 0;              ///< Coulomb's coefficient
  bool rough = false;               ///< what touches sticks
  double stiffness = 100;           ///< of the penalty, in E / h
  bool swapped = false;             ///< the first-named side is the tool
};

struct ToolContactReport {
  Point3 force{}, moment{};                       ///< on the part; the moment about the tool's centre
  double normal_force = 0, friction_force = 0;    ///< Σ of the sizes
  double area = 0;                                ///< that touches, undeformed, length²
  double depth = 0;                               ///< largest penetration, length
  Point3 deepest{};                               ///< where that is
  std::int64_t points = 0, sliding = 0;           ///< that touch, and those of them at the limit of friction
  double stored = 0, dissipated = 0, by_tool = 0; ///< energies: in springs; since the state kept last; work of the tool
};

/// Where the load factor has a fixed or driven body.
Pose pose_of(const RigidBody& body, double factor);

/// Per undeformed area, with the tool's distance g and outward normal n at x = X + u:
///   traction = p n + t,   p = -ε min(g, 0),   t = the return of B (Q t_old - ε_t v) to |t| ≤ μ p,   B = I - n nᵀ,
/// v the motion of the point beside the tool since the state kept last, Q the turn of the tool since. Points that were
/// apart in that state have no friction until the next one.
class ToolContact {
 public:
  /// @param modulus  E / h, force/length³
  /// @throws InputError for regions without area, a part that lies in the tool by more than half a span
  ToolContact(const SolutionSpace& space, const ToolContactSettings& settings, const RigidBody& tool, double modulus);

  const ToolContactSettings& settings() const { return settings_; }
  double span_size() const { return span_size_; } ///< smallest side, length
  /// May its stiffness be unsymmetric?
  bool is_symmetric() const;
  Pose pose(double factor) const { return pose_of(mover_, factor); }

  /// f += forces on the part at u, with the tool where the load factor has it.
  ToolContactReport add_forces(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& f) const;
  /// A -= ∂(forces)/∂u.
  void subtract_stiffness(const Eigen::VectorXd& u, double factor, Tangent& A) const;
  /// The depth, or the way since the last one, that no step may reach, is half a span; else points
  /// may have come out on the far side. Empty, or why the step is too large.
  std::string too_far(const Eigen::VectorXd& u, double factor) const;
  /// A converged step. @returns its forces, and what was dissipated and done by the tool since the last one
  ToolContactReport keep(const Eigen::VectorXd& u, double factor);
  /// What touches in the state kept last, for the check of rigid motions.
  SurfaceRegion touching() const;

  /// Of the state kept last: (points × 7) flag, friction, traction; then dissipated energy and the tool's work so far.
  std::vector<double> save() const;
  /// @throws InputError for another length
  void load(const std::vector<double>& saved, const Eigen::VectorXd& u, double factor);
  double dissipated() const { return dissipated_; }
  double tool_work() const { return tool_work_; }

 private:
  struct Cell {
    std::int64_t cell = 0;
    std::size_t first = 0;  ///< point
    Eigen::MatrixXd values; ///< (points × nodes)
    Eigen::Matrix3Xd X;     ///< (3 × points)
    std::vector<double> weights;
    Eigen::Vector3d centre;   ///< of X
    double radius = 0;        ///< of X about it
    double amplification = 1; ///< max Σ |N_i|
    double lacking = 0;       ///< max |1 - Σ N_i|: not zero where light functions are removed
  };
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
  };
  struct Memory {
    bool touches = false;
    Eigen::Vector3d friction = Eigen::Vector3d::Zero(), traction = Eigen::Vector3d::Zero(); ///< force/length²
  };
  struct Motion; ///< poses of the state kept last and now
  struct Touch;
  Motion motion(double factor) const;
  Eigen::Matrix3Xd positions(const Cell& cell, const Eigen::VectorXd& u) const;
  /// Holds all points of the cell at u.
  Ball ball(const Cell& cell, const Eigen::VectorXd& u) const;
  /// Does no point of the cell touch, now or in the state kept last? Then it takes no part, at the cost of one
  /// distance: that of the ball, for over a way d a distance changes by d at most.
  bool apart(const Cell& cell, const Motion& motion, const Eigen::VectorXd& u) const;
  /// Are all points further from the tool than the way they go beside it?
  bool stays_away(const Cell& cell, const Motion& motion, const Eigen::VectorXd& u) const;
  Touch touch(const Motion& motion, const Eigen::Vector3d& x, const Eigen::Vector3d& x_old, const Memory& old) const;
  Eigen::Matrix3d stiffness(const Motion& motion, const Touch& touch) const;

  const SolutionSpace* space_;
  ToolContactSettings settings_;
  SurfaceRegion region_;
  double span_size_;
  ToolShape shape_;
  RigidBody mover_; ///< the tool without its shape
  double normal_stiffness_ = 0, tangential_stiffness_ = 0, closed_ = 0;
  std::vector<Cell> cells_;
  std::vector<Memory> memory_; ///< by point
  Eigen::VectorXd u_old_;
  Pose pose_old_;
  double dissipated_ = 0, tool_work_ = 0;
};

} // namespace iga::solve
