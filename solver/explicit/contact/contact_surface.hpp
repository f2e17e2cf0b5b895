// The embedded surface of a body made ready for contact: fine triangles whose vertices move with the spline.
#pragma once

#include "solver/explicit/motion/contact_body.hpp"
#include "solver/space/solution_space.hpp"

#include <vector>

namespace iga::solve {

/// What merging of short edges has done.
struct MergedEdges {
  std::size_t vertices_before = 0;
  double deviation = 0; ///< largest distance of a merged vertex from the triangles that stay, length
};

/// @param longest   no edge is longer, length; 0: half the smallest side of a span
/// @param shortest  edges below this are merged (coarsen_surface.hpp) where the surface moves by no more than
///                  `merge_deviation` spans and no edge gets longer than allowed, length; 0: none
/// @param merged    is told what became of them
/// @throws InputError where the triangles would be too many
ContactSurface make_contact_surface(const SolutionSpace& space, const std::string& body, double density,
                                    double longest = 0, double shortest = 0, MergedEdges* merged = nullptr);
constexpr double merge_deviation = 0.02; ///< in spans

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
