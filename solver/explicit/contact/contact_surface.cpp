#include "solver/explicit/contact/contact_surface.hpp"

#include "solver/explicit/contact/coarsen_surface.hpp"
#include "solver/output/surface_output.hpp"

#include <algorithm>
#include <numeric>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

/// Vertices that each cell owns, cell by cell.
struct Owned {
  std::vector<std::size_t> vertex, first;
};

Owned group_by_cell(const OutputMesh& output, std::size_t num_cells) {
  Owned owned;
  owned.vertex.resize(output.cell.size());
  std::iota(owned.vertex.begin(), owned.vertex.end(), std::size_t{0});
  std::stable_sort(owned.vertex.begin(), owned.vertex.end(),
                   [&](std::size_t a, std::size_t b) { return output.cell[a] < output.cell[b]; });
  owned.first.assign(num_cells + 1, 0);
  for (const std::int64_t cell : output.cell) ++owned.first[static_cast<std::size_t>(cell) + 1];
  std::partial_sum(owned.first.begin(), owned.first.end(), owned.first.begin());
  return owned;
}

/// The vertices that stay, in the place of all.
void keep(CoarseSurface& coarse, OutputMesh& output) {
  for (std::size_t k = 0; k < coarse.vertex.size(); ++k) { // ascending: what is read is not yet written
    const auto v = static_cast<std::size_t>(coarse.vertex[k]);
    std::copy_n(&output.parameters[3 * v], 3, &output.parameters[3 * k]);
    output.cell[k] = output.cell[v];
    output.span[k] = output.span[v];
  }
  output.parameters.resize(3 * coarse.vertex.size());
  output.cell.resize(coarse.vertex.size());
  output.span.resize(coarse.vertex.size());
  output.mesh = std::move(coarse.mesh);
}

} // namespace

ContactSurface make_contact_surface(const SolutionSpace& space, const std::string& body, double density, double longest,
                                    double shortest, MergedEdges* merged) {
  const TrimmedModel& model = space.model();
  const Point3 h = model.grid.span_size();
  ContactSurface surface;
  surface.body = body;
  surface.density = density;
  surface.span_size = std::min({h[0], h[1], h[2]});
  if (!(longest > 0)) longest = 0.5 * surface.span_size;
  OutputMesh output = refine_surface(model, longest);
  if (shortest > 0) {
    CoarseSurface coarse =
        coarsen(output.mesh, {std::min(shortest, longest), longest, merge_deviation * surface.span_size});
    if (merged) *merged = {output.mesh.vertices.size(), coarse.deviation};
    keep(coarse, output);
  }
  const Owned owned = group_by_cell(output, model.num_cells());
  std::vector<std::vector<Eigen::Triplet<double>>> rows(model.num_cells());
  tbb::parallel_for(std::size_t{0}, model.num_cells(), [&](std::size_t a) {
    const std::size_t n = owned.first[a + 1] - owned.first[a];
    if (n == 0) return;
    std::vector<double> parameters;
    for (std::size_t k = 0; k < n; ++k) {
      const double* u = &output.parameters[3 * owned.vertex[owned.first[a] + k]];
      parameters.insert(parameters.end(), u, u + 3);
    }
    SpanShapes shapes;
    const auto cell = static_cast<std::int64_t>(a);
    evaluate(space, cell, parameters, Shapes::Values, shapes);
    const auto nodes = space.nodes(cell);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double N = shapes.values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i));
        if (N != 0) rows[a].emplace_back(static_cast<int>(owned.vertex[owned.first[a] + k]), nodes[i], N);
      }
  });
  std::vector<Eigen::Triplet<double>> all;
  for (const auto& part : rows) all.insert(all.end(), part.begin(), part.end());
  surface.mesh = std::move(output.mesh);
  surface.S.resize(static_cast<Eigen::Index>(surface.mesh.vertices.size()), space.num_nodes());
  surface.S.setFromTriplets(all.begin(), all.end());
  return surface;
}

SparseRows rows_of(const Eigen::SparseMatrix<double, Eigen::RowMajor>& S) {
  SparseRows rows;
  rows.first.reserve(static_cast<std::size_t>(S.rows()) + 1);
  rows.first.push_back(0);
  for (Eigen::Index r = 0; r < S.rows(); ++r) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(S, r); entry; ++entry) {
      rows.column.push_back(static_cast<std::int32_t>(entry.col()));
      rows.value.push_back(entry.value());
    }
    rows.first.push_back(static_cast<std::int32_t>(rows.column.size()));
  }
  return rows;
}

SparseRows transpose(const SparseRows& S, std::size_t columns) {
  SparseRows T;
  T.first.assign(columns + 1, 0);
  for (const std::int32_t c : S.column) ++T.first[static_cast<std::size_t>(c) + 1];
  std::partial_sum(T.first.begin(), T.first.end(), T.first.begin());
  T.column.resize(S.column.size());
  T.value.resize(S.value.size());
  std::vector<std::int32_t> next(T.first.begin(), T.first.end() - 1);
  for (std::size_t r = 0; r < S.rows(); ++r)
    for (auto e = static_cast<std::size_t>(S.first[r]); e < static_cast<std::size_t>(S.first[r + 1]); ++e) {
      const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(S.column[e])]++);
      T.column[at] = static_cast<std::int32_t>(r);
      T.value[at] = S.value[e];
    }
  return T;
}

} // namespace iga::solve
