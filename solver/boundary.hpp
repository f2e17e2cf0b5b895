// Supports and loads on the embedded surface: regions, weak Dirichlet conditions, tractions.
#pragma once

#include "solver/linear_solver.hpp"
#include "solver/material.hpp"

#include <optional>
#include <string>

namespace iga::solve {

enum class SupportMethod { Nitsche, Penalty, Lagrange };

/// Which surface points a condition holds on: all given tests must be met.
struct RegionChoice {
  std::optional<std::string> name;    ///< region name in the file
  std::optional<std::int64_t> number; ///< region number in the file
  std::optional<Box3> box;            ///< position within a box (part's frame)
  struct Plane {
    Point3 point{}, normal{};
    double tolerance = 0; ///< length
  };
  std::optional<Plane> plane; ///< position on a plane
  struct Direction {
    Point3 direction{};
    double angle = 0; ///< degrees between the outward normal and the direction
  };
  std::optional<Direction> normal;
};

/// Prescribed displacement components on a region, in the frame whose columns are `frame` (default: the part's axes).
struct Support {
  std::string name;
  RegionChoice region;
  std::array<bool, 3> fixed{true, true, true};
  Point3 value{};                   ///< length, in `frame`; constant part
  std::array<Point3, 3> gradient{}; ///< u_D = value + gradient (x - origin): rows in `frame`, for linear fields
  Rotation frame = identity_rotation;
  SupportMethod method = SupportMethod::Nitsche;
  double penalty_factor = 1e3; ///< C in beta = C E / h, for the penalty method
};

/// What a region turned out to be, for the report.
struct RegionReport {
  std::string name;
  std::int64_t points = 0;
  double area = 0;   ///< length²
  Point3 centroid{}; ///< length, the part's frame
};

/// What supports add to a system beyond the stiffness matrix itself.
struct SupportTerms {
  Eigen::VectorXd load;         ///< (num_unknowns): right-hand side from prescribed values
  ConstraintMatrix constraints; ///< Lagrange multipliers: C u = values; no rows where none is asked for
  Eigen::VectorXd values;       ///< (constraints)
  std::vector<RegionReport> regions;
};

/// Adds the supports' stiffness to K (same sparsity: all terms are local to a span) and returns the rest.
/// @throws InputError for a region without area, naming it
SupportTerms apply_supports(const SolutionSpace& space, const ElasticMaterial& material,
                            std::span<const Support> supports, StiffnessMatrix& K);

} // namespace iga::solve
