// Steady conduction of heat: -div(k grad T) = s on the cells and functions of the mechanical analyses.
#pragma once

#include "format/model/results.hpp"
#include "solver/analysis/run_settings.hpp"

namespace iga::solve {

/// What one [[heat]] turned out to be.
struct HeatReport {
  RegionReport region;    ///< no points of a source
  double temperature = 0; ///< mean over the region; of a source over the body
  double power = 0;       ///< into the body
};

struct HeatSolution {
  HeatResult result;           ///< as the results file holds it
  Eigen::VectorXd temperature; ///< (num_nodes)
  std::vector<HeatReport> boundaries;
  double balance = 0; ///< Σ powers: rounding
  double largest_power = 0;
  double residual = 0;        ///< relative
  double least = 0, most = 0; ///< temperature at the quadrature points of volume and surface
  Point3 least_at{}, most_at{};
  FactorCost cost;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, double>> timings; ///< stage, seconds
};

/// Prescribed temperatures by Nitsche's method, symmetric and consistent: polynomials of the splines' degree are exact.
/// Its parameter follows from that of elasticity (heat_analysis.cpp).
/// @throws InputError for several bodies or ties, a material without conductivity, a region without area, and a piece
/// of the body whose temperature nothing determines
HeatSolution run_heat(const RunSettings& run, const SolutionSpace& space);

/// Temperature, and flux -k grad T, at points (n); see sample_fields.
struct HeatSamples {
  std::vector<double> temperature; ///< (n)
  std::vector<double> flux;        ///< (n × 3), power/length²
};
HeatSamples sample_heat(const SolutionSpace& space, double conductivity, const Eigen::VectorXd& temperature,
                        std::span<const std::int64_t> cells, std::span<const double> parameters);

} // namespace iga::solve
