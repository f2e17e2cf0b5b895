// Frequency response by modal superposition.
#pragma once

#include "solver/response/response_system.hpp"

namespace iga::solve {

/// Amplitudes of e^(iωt): x(t) = Re(X e^(iωt)).
struct HarmonicResponse {
  std::vector<double> frequencies; ///< (n), cycles/time, ascending
  Eigen::MatrixXcd modal;          ///< (size × n): of the motion relative to the base
  Eigen::VectorXcd base;           ///< (n): acceleration of the base along its direction, length/time²
  std::vector<double> fields;      ///< frequencies of whole fields
  Eigen::MatrixXcd field_modal;    ///< (size × fields)
};

/// Of unit factors: q = p / (ω_j² (1 + i η) - Ω² + i Ω c_j), (size × columns of p). @param frequency cycles/time
Eigen::MatrixXcd modal_response(const ModalBasis& basis, const ModalDamping& damping, double frequency,
                                const Eigen::MatrixXcd& modal_loads);

/// Frequencies at which a response over [from, to] is to be computed: `points` spread evenly (over logarithms where the
/// range spans a factor of ten and more), and for each damped resonance in the range those at which the phase of its
/// answer turns by equal steps of 10°, so that peaks and their half-power widths are resolved whatever the damping.
std::vector<double> response_frequencies(const ModalBasis& basis, const ModalDamping& damping, double from, double to,
                                         int points, const std::vector<double>& more);

/// Warnings about resonances in the range that nothing damps.
std::vector<std::string> undamped_resonances(const ResponseSystem& system, const HarmonicResponse& response);

/// The range of a run: as it says, else that of its list of frequencies or spectra.
/// @throws InputError where none is given, or where it leaves the table of a spectrum
std::pair<double, double> harmonic_range(const ResponseSettings& settings);

/// @throws InputError for frequency 0 of parts that are not held and of a base
HarmonicResponse harmonic_response(const ResponseSystem& system, const ResponseSettings& settings);

} // namespace iga::solve
