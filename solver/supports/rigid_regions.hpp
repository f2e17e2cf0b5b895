// Regions that move as rigid bodies: what a flange, a shaft, a motor or a test machine's jaw does to its surface.
#pragma once

#include "solver/linalg/linear_solver.hpp"
#include "solver/mechanics/body_system.hpp"
#include "solver/mechanics/loads.hpp"

namespace iga::solve {

/// Motion of a rigid region: the place where its load acts moves by `displacement`, the region turns by `rotation`
/// (along the axis, radians).
struct RegionMotion {
  Point3 at{}, displacement{}, rotation{};
};

/// The part of the displacement u on a region that is no rigid motion, u - P u with P the projection in L²(region), is
/// held down by a penalty: ½ β ∫ |u - P u|² dA = ½ uᵀ (β M - U Uᵀ) u. β M fits the pattern of K; U Uᵀ (rank six a
/// region) would fill it, so the system is solved with K + β M and corrected (Sherman, Morrison & Woodbury 1950).
class RigidRegions {
 public:
  RigidRegions() = default; ///< of no region
  /// Adds β M of regions of the system's bodies to K. The system must outlive the object.
  struct Held {
    std::size_t body = 0;
    SurfaceRegion region;
  };
  RigidRegions(const BodySystem& system, std::vector<Held> held, StiffnessMatrix& K);
  /// Adds β M of the loads that keep their region rigid to K. The system must outlive the object.
  /// @param bodies  by load: those that it acts on; one where it acts on a region
  /// @throws InputError for a region without area, naming the load
  RigidRegions(const BodySystem& system, std::span<const Load> loads, std::span<const std::vector<std::size_t>> bodies,
               StiffnessMatrix& K);

  /// Adds -U Uᵀ to K as a part of low rank: then K is whole, and nothing is to be corrected.
  void complete(StiffnessMatrix& K) const;
  bool empty() const { return regions_.empty(); }
  /// @param solver  made with K + β M (and constraints)
  void prepare(const LinearSolver& solver);
  /// The corrected solution. @param b  unknowns, then constraints
  Eigen::VectorXd solve(const LinearSolver& solver, const Eigen::VectorXd& b) const;
  /// U Uᵀ u, which (K + β M) u has too much. (num_unknowns)
  Eigen::VectorXd correction(const Eigen::Ref<const Eigen::VectorXd>& u) const { return U_ * (U_.transpose() * u); }
  /// Penalty energy of all regions, force · length.
  double energy(const Eigen::VectorXd& u) const;
  /// Motions of the regions, and the loads that they belong to.
  std::vector<std::pair<std::size_t, RegionMotion>> motions(const Eigen::VectorXd& u) const;

 private:
  struct Region {
    std::size_t load = 0, body = 0;
    SurfaceRegion region;
    Point3 at{};
    double beta = 0;
    Eigen::Matrix<double, 6, 6> basis; ///< columns: orthonormal motions, velocity at the centroid and angular velocity
  };
  void take(std::size_t load, std::size_t body, SurfaceRegion region, const std::optional<Point3>& at);
  void add_regions(StiffnessMatrix& K);
  void add_region(const Region& r, StiffnessMatrix& K);
  Eigen::Matrix<double, 6, 1> motion_of(std::size_t r, const Eigen::VectorXd& u) const;

  const BodySystem* system_ = nullptr;
  std::vector<Region> regions_;
  Eigen::MatrixXd U_;                 ///< (num_unknowns × 6 regions)
  Eigen::MatrixXd solved_, capacity_; ///< Z = (K + β M)⁻¹ U with rows for constraints; (I - Uᵀ Z)⁻¹
};

} // namespace iga::solve
