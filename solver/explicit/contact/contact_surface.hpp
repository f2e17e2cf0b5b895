// The embedded surface of a body made ready for contact: fine triangles whose vertices move with the spline.
#pragma once

#include "solver/explicit/motion/contact_body.hpp"
#include "solver/space/solution_space.hpp"

#include <vector>

namespace iga::solve {

/// @param longest  no edge is longer, length; 0: half the smallest side of a span
/// @throws InputError where the triangles would be too many
ContactSurface make_contact_surface(const SolutionSpace& space, const std::string& body, double density,
                                    double longest = 0);

/// Sparse rows as plain arrays: what the loops of a step read.
struct SparseRows {
  std::vector<std::int32_t> first;  ///< (rows + 1)
  std::vector<std::int32_t> column; ///< ascending within a row
  std::vector<double> value;
  std::size_t rows() const { return first.size() - 1; }
};
SparseRows rows_of(const Eigen::SparseMatrix<double, Eigen::RowMajor>& S);
SparseRows transpose(const SparseRows& S, std::size_t columns);

} // namespace iga::solve
