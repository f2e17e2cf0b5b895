// Statics at large displacement: f_int(u) + supports = λ · loads, followed from λ = 0 to 1 by Newton's method.
#pragma once

#include "solver/nonlinear/finite_body.hpp"
#include "solver/nonlinear/follower_pressure.hpp"
#include "solver/nonlinear/nonlinear_run.hpp"

#include <functional>
#include <memory>

namespace iga::solve {

/// One converged step.
struct StepReport {
  double factor = 0;             ///< λ
  int iterations = 0;            ///< of Newton's method, those of steps that were cut included
  int cuts = 0;                  ///< halvings on the way from the step before
  double residual = 0;           ///< ‖f_int - f_ext‖ relative to the forces
  std::vector<double> residuals; ///< the same after each iteration of the last increment
  bool definite = true;  ///< was the last tangent positive definite? Where it is not, equilibrium may be unstable.
  bool symmetric = true; ///< false: the tangent is not, and its definiteness was not looked at
  PointsReport points;
  std::vector<ToolContactReport> contacts;
};

/// The state of a converged step: all that a run needs to go on bit for bit.
struct StaticState {
  double factor = 0, increment = 0; ///< λ reached; size of the next step
  double work = 0;                  ///< of the internal forces so far, force · length
  double external = 0;              ///< of loads and supports
  Eigen::VectorXd u;                ///< (num_unknowns)
  PointHistory points;
  std::vector<double> contacts; ///< ToolContact::save of one after the other
};

/// What holds the part, at a converged step.
struct SupportForce {
  std::string name;
  Point3 force{}, moment{}; ///< on the part; about the origin, at the undeformed places
  double gap = 0;           ///< root mean square of u - u_D over the surface, length; 0 for lines and points
};

class NonlinearStatics {
 public:
  /// The space must outlive the analysis.
  /// @throws InputError for regions without area, probes outside the part, rigid motions that no support resists
  NonlinearStatics(const NonlinearRun& run, const SolutionSpace& space);

  /// From the last converged step to the load factor `target`, in smaller steps where Newton's method needs them.
  /// @param show  called in each iteration with what happens; may be empty
  /// @throws NumericalError where the smallest step does not converge; the last converged state is kept
  /// @throws io::Interrupted where a signal arrived, likewise
  StepReport advance(double target, const std::function<void(const std::string&)>& show = {});

  double factor() const { return state_.factor; }
  const Eigen::VectorXd& displacement() const { return state_.u; }
  /// Work of the internal forces so far (trapezoidal rule over the steps), force · length.
  double internal_work() const { return state_.work; }
  /// Of loads, supports and tools, likewise. What is not in the internal work is stored in or lost by contact.
  double external_work() const;
  double contact_energy() const;  ///< in the springs of contact, force · length
  double friction_energy() const; ///< dissipated so far
  const std::vector<ToolContact>& contacts() const { return contacts_; }
  const std::vector<ToolContactReport>& contact_reports() const {
    return contact_reports_;
  } ///< of the last converged step
  const FiniteBody& body() const { return *body_; }
  const std::vector<LoadReport>& loads() const { return load_reports_; }
  const std::vector<RegionReport>& regions() const { return supports_.regions; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  std::vector<SupportForce> support_forces() const;
  std::vector<Point3> probe_displacements() const;
  /// Σ of all loads at λ and u, on the part.
  Point3 load_force() const;

  StaticState save() const;
  void load(const StaticState& state);

  /// r = λ loads - f_int(u) - supports, and the size of the forces in it. Of the state that was kept last.
  struct Residual {
    Eigen::VectorXd r;
    double size = 0;     ///< of the forces that balance each other
    double rounding = 0; ///< what rounding leaves of r
    PointsReport points;
    Eigen::VectorXd internal, external; ///< external: loads and supports
  };
  Residual residual(const Eigen::VectorXd& u, double factor) const;
  /// -∂r/∂u.
  void tangent(const Eigen::VectorXd& u, double factor, Tangent& A) const;
  Tangent make_tangent() const;

 private:
  void add_loads(const NonlinearRun& run);
  void add_supports(const NonlinearRun& run);
  void add_contacts(const NonlinearRun& run);
  void need_held(const NonlinearRun& run) const;
  /// Newton's method at a fixed λ; false where it does not converge.
  /// @param search  along each step, else steps are whole as long as no point is crushed
  bool equilibrate(double factor, bool search, Eigen::VectorXd& u, StepReport& report,
                   const std::function<void(const std::string&)>& show);
  Eigen::VectorXd solve(const Eigen::VectorXd& r, StepReport& report) const;

  const SolutionSpace* space_;
  NewtonSettings settings_;
  ElasticMaterial small_strain_;
  std::shared_ptr<const Connectivity> connectivity_;
  std::unique_ptr<FiniteBody> body_;
  double stress_rounding_ = 0; ///< what rounding of F leaves of the residual, force
  StiffnessMatrix holding_;    ///< of the supports
  SupportTerms supports_;
  Eigen::VectorXd dead_; ///< loads that keep direction and place
  std::vector<FollowerPressure> pressures_;
  std::vector<ToolContact> contacts_;
  std::vector<ToolContactReport> contact_reports_;
  std::vector<LoadReport> load_reports_;
  std::vector<Probe> probes_;
  std::vector<LocatedPoint> places_;
  std::vector<std::string> warnings_;
  StaticState state_;
  mutable Tangent tangent_;
};

} // namespace iga::solve
