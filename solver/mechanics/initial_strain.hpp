// Strains without stress: thermal expansion, sums and multiples of such fields.
#pragma once

#include "solver/mechanics/material.hpp"
#include "solver/space/solution_space.hpp"

namespace iga::solve {

/// A temperature in a body.
class TemperatureField {
 public:
  virtual ~TemperatureField() = default;
  /// At points of a cell of the body's model: (n). Safe to call from several threads.
  /// @param parameters  (n × 3), row-major, knot space
  virtual Eigen::VectorXd at(std::int64_t cell, std::span<const double> parameters) const = 0;
};

/// α (T - reference) along every axis.
std::shared_ptr<const StrainField> thermal_strain(std::shared_ptr<const TemperatureField> temperature, double reference,
                                                  double expansion);

/// One share of a sum.
struct StrainShare {
  double factor = 0;
  std::shared_ptr<const StrainField> field; ///< null: nothing
};
/// Σ factor · field; null where nothing is left.
std::shared_ptr<const StrainField> sum_of(std::vector<StrainShare> shares);

/// f = ∫ Bᵀ C ε₀ dV by the points that the stiffness has, so that the strain of a field that the functions hold needs
/// no stress to the last digit. Zero without an initial strain. (num_unknowns)
Eigen::VectorXd initial_strain_load(const SolutionSpace& space, const ElasticMaterial& material);

} // namespace iga::solve
