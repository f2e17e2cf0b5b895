// Prescribed motion of a surface region by springs: β ∫ (u - u_D) · N_i dA with β from the mass that a step can move.
#pragma once

#include "solver/explicit/motion/force_source.hpp"
#include "solver/explicit/motion/time_curve.hpp"
#include "solver/space/solution_space.hpp"
#include "solver/space/surface_region.hpp"

#include <optional>

namespace iga::solve {

struct DrivenRegion {
  std::string name;
  RegionChoice region;
  /// Components in the part's frame; one without a curve is free.
  std::array<std::optional<TimeCurve>, 3> motion;
  bool curves_are_velocities = false; ///< integrated from the curves' first times; otherwise displacements, length
  /// β = stiffness · ρ (h/2) / dt², lowered where the budget of stability asks for it.
  double stiffness = 0.5;
  double damping = 0.05; ///< share of critical damping of that mass on that spring
  /// Of the budget of stability of each node: what it may take. Below 1 the rest is left to contact on the same nodes,
  /// as those of a wall thinner than a span, counted when stability has shrunk.
  double budget_share = 1;
};

/// One driven region of one body. Sources are asked in the order they were added to the integrator: supports before
/// contact have their share of the budget first.
class RegionDrive : public PenaltySource {
 public:
  /// @param space  of the body-th body; must outlive the drive
  /// @throws InputError for a region without area or a drive that drives nothing, naming it
  RegionDrive(const SolutionSpace& space, std::size_t body, double density, DrivenRegion region);

  PenaltyEnergy add_forces(const StepTimes& times, std::span<const BodyState> bodies) override;
  double external_work() const override { return external_work_; }
  std::vector<SavedArray> save() const override;
  void load(std::span<const SavedArray> arrays) override;

  const RegionReport& region() const { return region_.report; }
  Point3 force() const { return force_; }               ///< on the body at the last evaluation
  double largest_miss() const { return largest_miss_; } ///< largest |u - u_D| of a driven component, length

 private:
  struct Patch { ///< points of one span
    std::int64_t span = 0;
    Eigen::MatrixXd values;               ///< (points × nodes)
    std::vector<double> weights, density; ///< area; β at stiffness 1
  };
  double target(std::size_t component, double t) const;
  void share_budget(const BodyState& state, const StepTimes& times);

  const SolutionSpace* space_;
  std::size_t body_;
  double density_;
  DrivenRegion settings_;
  SurfaceRegion region_;
  std::vector<Patch> patches_;
  Eigen::VectorXd sums_; ///< (num_nodes) β |N_i| Σ |N_j| dA with damping
  double reference_dt_ = 0;
  Point3 force_{}, last_force_{};
  double external_work_ = 0, stored_ = 0, largest_miss_ = 0;
};

} // namespace iga::solve
