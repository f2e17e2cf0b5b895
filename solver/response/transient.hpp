// Transients by modal superposition: loads and base accelerations over time, from rest.
#pragma once

#include "solver/response/response_system.hpp"

namespace iga::solve {

/// Exact at every output for histories of straight lines: there is no time step but that of the output.
struct TransientResponse {
  std::vector<double> times;    ///< (n), from 0
  Eigen::MatrixXd modal;        ///< (size × n): of the motion relative to the base
  Eigen::MatrixXd velocity;     ///< (size × n)
  Eigen::MatrixXd acceleration; ///< (size × n)
  Eigen::Matrix3Xd base;        ///< (3 × n): displacement, velocity, acceleration of the base along its direction
  std::vector<double> fields;   ///< times of whole fields
  Eigen::MatrixXd field_modal;  ///< (size × fields)
};

/// @throws InputError for structural damping, which has no meaning in time, and for loads without a history
TransientResponse transient_response(const ResponseSystem& system, const ResponseSettings& settings);

} // namespace iga::solve
