// What is known of the traction on a body's surface: nothing pulls at free surface, loads bring their own, supports
// leave open what they hold.
#pragma once

#include "solver/mechanics/loads.hpp"
#include "solver/supports/boundary.hpp"

#include <Eigen/Core>

namespace iga::solve {

/// What acts on the surface of one body.
struct SurfaceConditions {
  std::vector<Load> loads;             ///< those on surface; others are passed over
  std::vector<Support> supports;       ///< those on surface; others are passed over
  std::vector<std::int64_t> unknown{}; ///< triangles of which nothing is known: tied ones
};

/// Pieces of surface, cell by cell: P (σ n - t) = 0 at the middle of each.
struct KnownTractions {
  std::vector<std::int64_t> offsets;      ///< (num_cells + 1); cell c owns pieces [c] … [c + 1) - 1
  std::vector<Point3> parameters;         ///< (n); knot space
  std::vector<double> areas;              ///< (n); length²
  std::vector<Point3> normals;            ///< (n); mean outward normal, of length 1 where the piece is flat
  std::vector<Eigen::Matrix3d> known;     ///< (n); P: projection on the directions in which the traction is known
  std::vector<Eigen::Vector3d> tractions; ///< (n); P t, force/length²
  std::vector<Point3> centres; ///< (num_cells); knot space: middle of the cell's surface, of its span where it has none
};

/// Surface points that lie close together on facets of about one direction make one piece.
/// @throws InputError as choose_region
KnownTractions known_tractions(const SolutionSpace& space, const SurfaceConditions& conditions);

} // namespace iga::solve
