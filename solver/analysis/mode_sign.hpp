// The sign of an eigenvector, so that it does not depend on how it was found.
#pragma once

#include <Eigen/Core>

namespace iga::solve {

/// Makes the component of largest magnitude positive; among those that are equal to rounding the first one decides.
inline void orient(Eigen::Ref<Eigen::VectorXd> x) {
  Eigen::Index largest = 0;
  x.cwiseAbs().maxCoeff(&largest);
  const double top = std::abs(x[largest]) * (1 - 1e-6);
  for (Eigen::Index i = 0; i < largest; ++i)
    if (std::abs(x[i]) >= top) largest = i;
  if (x[largest] < 0) x = -x;
}

} // namespace iga::solve
