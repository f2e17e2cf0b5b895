#include "solver/linalg/product_rounding.hpp"

#include <cmath>
#include <limits>

namespace iga::solve {

using Eigen::Index;
using Eigen::VectorXd;

double product_rounding(const NodePattern& pattern, const VectorXd& diagonal, const Eigen::Ref<const VectorXd>& x) {
  const VectorXd root = diagonal.cwiseMax(0).cwiseSqrt(), size = root.cwiseProduct(x.cwiseAbs());
  VectorXd node(pattern.num_nodes()), sums = VectorXd::Zero(pattern.num_nodes());
  for (Index i = 0; i < node.size(); ++i) node[i] = size.segment<3>(3 * i).sum();
  for (Index j = 0; j < node.size(); ++j)
    for (auto k = static_cast<std::size_t>(pattern.offsets[static_cast<std::size_t>(j)]);
         k < static_cast<std::size_t>(pattern.offsets[static_cast<std::size_t>(j) + 1]); ++k) {
      const Index i = pattern.rows[k];
      sums[i] += node[j];
      if (i != j) sums[j] += node[i];
    }
  double total = 0;
  for (Index i = 0; i < root.size(); ++i) total += std::pow(root[i] * sums[i / 3], 2);
  return 4 * std::numeric_limits<double>::epsilon() * std::sqrt(total);
}

} // namespace iga::solve
