// Random vibration: stationary Gaussian excitations of given power spectral densities, root mean squares of the answer.
#pragma once

#include "solver/response/response_system.hpp"

namespace iga::solve {

/// Excitations are independent of each other. Root mean squares are standard deviations (1 sigma): the mean is zero.
struct RandomResponse {
  double from = 0, to = 0;          ///< cycles/time: range that was integrated over
  Eigen::MatrixXd covariance;       ///< (size × size): of the modal coordinates relative to the base
  Eigen::MatrixXd rates;            ///< (size × size): of their velocities
  Eigen::VectorXd acceleration;     ///< (3 probes): mean squares of the absolute acceleration, length²/time⁴
  Eigen::VectorXd jerk;             ///< (3 probes): of its rate
  std::vector<double> base;         ///< (1 or none): mean square of the base's acceleration
  std::vector<double> frequencies;  ///< (n), of the spectra
  Eigen::MatrixXd acceleration_psd; ///< (3 probes × n): length²/time⁴ per frequency
  Eigen::MatrixXd displacement_psd; ///< (3 probes × n): relative, length² per frequency
  Eigen::MatrixXd stress_psd;       ///< (6 probes × n)
  Eigen::VectorXd base_psd;         ///< (n)
};

/// The range of a run: as it says, else that of its tables of densities.
/// @throws InputError where densities are missing, or where a constant one has no range
std::pair<double, double> random_range(const ResponseSettings& settings);

/// Integrals over the frequency by ten Gauss points on pieces that shrink towards each resonance by its half-power
/// width, end where tables have points and are no longer than twice their distance from 0: poles of the answer lie
/// three half lengths from a piece's middle or farther, so that each integral is exact to 1e-12 and better.
/// @throws InputError for modes without damping in the range
RandomResponse random_response(const ResponseSystem& system, const ResponseSettings& settings);

/// Combinations of the basis that are independent of each other and make up the covariance: columns of L, C = L Lᵀ,
/// those without energy to rounding left out. With u = V L z, z of unit variance, mean squares of any field are sums
/// over columns; of the von Mises stress too, whose square is a quadratic form (Segalman, Fulcher, Reese, Field 1998).
Eigen::MatrixXd independent_parts(const Eigen::MatrixXd& covariance, const ModalBasis& basis);

/// Mean crossings of zero upwards, per time: √(mean square of the rate / mean square) / 2π (Rice 1944); 0 where nothing
/// moves.
double apparent_frequency(double mean_square, double rate_mean_square);

} // namespace iga::solve
