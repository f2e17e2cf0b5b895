// Displacement, strain and stress of a solution at points.
#pragma once

#include "solver/locate.hpp"
#include "solver/material.hpp"
#include "solver/solution_space.hpp"

namespace iga::solve {

/// Fields at n points, row-major. 6-vectors in the order xx yy zz xy yz zx, the part's frame.
struct PointFields {
  std::vector<double> displacement; ///< (n × 3), length
  std::vector<double> strain;       ///< (n × 6), no unit; engineering shears
  std::vector<double> stress;       ///< (n × 6), force/length²
  std::vector<double> von_mises;    ///< (n), force/length²
  std::size_t size() const { return von_mises.size(); }
};

/// Fields at points grouped by active span (the volume's or the surface's quadrature points, or a refined surface).
/// @param[in] u           (num_unknowns)
/// @param[in] offsets     (num_spans + 1); the a-th span owns points [a] … [a + 1) - 1
/// @param[in] parameters  (n × 3), row-major
PointFields recover_fields(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                           std::span<const std::int64_t> offsets, std::span<const double> parameters);

/// ½ ∫ σ : ε dV from the fields at the volume's quadrature points (force · length).
double strain_energy(const TrimmedModel& model, const PointFields& fields);

struct Probe {
  std::string name;
  Point3 position{}; ///< length, the part's frame
};

struct ProbeResult {
  std::string name;
  LocatedPoint at;
  Point3 displacement{}; ///< length
  Voigt strain = Voigt::Zero();
  Voigt stress = Voigt::Zero(); ///< force/length²
  double von_mises = 0;
};

/// Spans of probes, found before anything is computed. @throws InputError naming a probe outside the part
std::vector<ProbeResult> locate_probes(const TrimmedModel& model, std::span<const Probe> probes);
void recover_probes(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                    std::vector<ProbeResult>& probes);

} // namespace iga::solve
