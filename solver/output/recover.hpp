// Fields of a static solution at quadrature points and probes, and the energy stored.
#pragma once

#include "format/model/results.hpp"
#include "solver/mechanics/material.hpp"
#include "solver/space/locate.hpp"
#include "solver/space/solution_space.hpp"

namespace iga::solve {

/// Fields (one step) at points grouped by cell: the volume's or the surface's quadrature points.
/// @param[in] u           (num_unknowns)
/// @param[in] offsets     (num_cells + 1); cell a owns points [a] … [a + 1) - 1
/// @param[in] parameters  (n × 3), row-major
FieldSamples recover_fields(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                            std::span<const std::int64_t> offsets, const std::vector<double>& parameters);

/// ½ ∫ σ : ε dV from the fields at the volume's quadrature points (force · length).
double strain_energy(const TrimmedModel& model, const FieldSamples& fields);

/// -½ ∫ σ : ε₀ dV of the material's initial strain ε₀ (force · length): with it, ½ ∫ σ : ε is the energy that is
/// stored, ½ ∫ σ : (ε - ε₀).
double initial_strain_work(const TrimmedModel& model, const ElasticMaterial& material, const FieldSamples& fields);

struct Probe {
  std::string name;
  Point3 position{};     ///< length, the part's frame
  std::string body = {}; ///< that it lies in; empty: the only one that holds the position
};

/// Cells of probes, found before anything is computed. @throws InputError naming a probe outside the part or in a gap
std::vector<LocatedPoint> locate_probes(const TrimmedModel& model, std::span<const Probe> probes);
/// Fields at the located probes, in their order.
ProbeResult recover_probes(const SolutionSpace& space, const ElasticMaterial& material, const Eigen::VectorXd& u,
                           std::span<const Probe> probes, std::span<const LocatedPoint> located);

} // namespace iga::solve
