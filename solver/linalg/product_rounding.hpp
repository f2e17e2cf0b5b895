// How much of a product with a stiffness matrix is rounding.
#pragma once

#include "solver/linalg/symmetric_matrix.hpp"

#include <Eigen/Core>

namespace iga::solve {

/// A bound of ‖fl(K x) - K x‖: each entry of K is at most √(K_ii K_jj), and as wrong as one in the last place.
/// @param diagonal  of K (size)
double product_rounding(const NodePattern& pattern, const Eigen::VectorXd& diagonal,
                        const Eigen::Ref<const Eigen::VectorXd>& x);

} // namespace iga::solve
