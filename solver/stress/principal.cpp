#include "solver/stress/principal.hpp"

#include "solver/base/dense_algebra.hpp"

namespace iga::solve {

Eigen::Vector3d principal_stresses(const Voigt& stress) {
  Eigen::Matrix3d tensor;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) tensor(a, b) = stress[voigt_place[a][b]];
  return symmetric_eigenvalues_3(tensor).reverse();
}

} // namespace iga::solve
