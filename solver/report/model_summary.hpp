// The numbers that describe a model at a glance.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga::solve {

/// A function below this mass fraction is light: explicit dynamics treats it apart (it would shrink the time step).
constexpr double light_below = 0.05;

struct RegionSummary {
  std::string name;
  std::int64_t triangles = 0;
  double area = 0; ///< length²
};

struct ModelSummary {
  std::int64_t interior = 0, trimmed = 0, exterior = 0; ///< spans by state
  CellCounts cells;
  std::int64_t points = 0, interior_points = 0, surface_points = 0;
  std::int64_t light_functions = 0;
  double lightest = 1; ///< smallest mass fraction
  double volume = 0;   ///< Σ weights, length³
  Point3 centroid{};   ///< length
  double area = 0;     ///< Σ surface weights, length²
  std::vector<RegionSummary> regions;
};

/// @pre check(model) found nothing
ModelSummary summarise(const TrimmedModel& model);

} // namespace iga::solve
