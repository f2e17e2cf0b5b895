// Statics of a model file by deal.II: how another code builds on the interchange file. HDF5 and deal.II alone, no code
// of this project. Each cell becomes a Bézier element: Bernstein polynomials on the unit cube, an extraction operator
// that makes its unknowns' shape functions of them, and a Quadrature<3> of its own. Matrix and factors are distributed
// (PETSc).
//   mpirun -n 2 dealii_statics bracket.prm        the keys, with their meaning: dealii_statics --help
#include <deal.II/base/mpi.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/petsc_solver.h>
#include <deal.II/lac/petsc_sparse_matrix.h>
#include <deal.II/lac/petsc_vector.h>
#include <deal.II/lac/sparsity_tools.h>

#include "results_file.hpp"

using namespace sample;

namespace {

/// A cell's stiffness and loads, those of its part of the surface included.
void integrate(const Model& model, const Run& run, std::size_t cell, Element& e, FullMatrix<double>& K,
               Vector<double>& f) {
  const std::size_t n = e.unknowns.size();
  const double mu = run.E / (2 * (1 + run.nu)), lame = run.E * run.nu / ((1 + run.nu) * (1 - 2 * run.nu));
  K.reinit(3 * n, 3 * n);
  f.reinit(3 * n);
  const Quadrature<3> volume = e.exact_quadrature(cell), surface = e.quadrature(model.surface, cell);
  for (unsigned q = 0; q < volume.size(); ++q) {
    e.evaluate(volume.point(q));
    for (std::size_t a = 0; a < n; ++a)
      for (int i = 0; i < 3; ++i) {
        f(3 * a + i) += volume.weight(q) * run.density * run.acceleration[i] * e.N[a];
        for (std::size_t b = 0; b < n; ++b) {
          for (int j = 0; j < 3; ++j)
            K(3 * a + i, 3 * b + j) +=
                volume.weight(q) * (lame * e.dN[a][i] * e.dN[b][j] + mu * e.dN[a][j] * e.dN[b][i]);
          K(3 * a + i, 3 * b + i) += volume.weight(q) * mu * (e.dN[a] * e.dN[b]);
        }
      }
  }
  for (unsigned q = 0; q < surface.size(); ++q) {
    const int region = model.region[model.triangle[model.surface.offsets[cell] + q]];
    if (region != run.region[0] && region != run.region[1]) continue;
    e.evaluate(surface.point(q));
    for (std::size_t a = 0; a < n; ++a)
      for (int i = 0; i < 3; ++i) {
        if (region == run.region[1]) f(3 * a + i) += surface.weight(q) * run.force[i] / run.area[1] * e.N[a];
        for (std::size_t b = 0; region == run.region[0] && b < n; ++b)
          K(3 * a + i, 3 * b + i) += surface.weight(q) * run.beta * e.N[a] * e.N[b];
      }
  }
}

/// Every rank assembles a run of cells and owns a run of unknowns. Returns all coefficients, and the work of the loads.
std::pair<Vector<double>, double> solve(const Model& model, const Run& run, std::vector<Element>& elements) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const std::size_t rank = Utilities::MPI::this_mpi_process(comm), ranks = Utilities::MPI::n_mpi_processes(comm);
  const auto part = [&](std::size_t n) { return std::pair(n * rank / ranks, n * (rank + 1) / ranks); };
  const types::global_dof_index size = 3 * model.num_unknowns;
  const auto [first_node, end_node] = part(model.num_unknowns);
  const auto [first, end] = part(elements.size());
  IndexSet owned(size), touched(size);
  owned.add_range(3 * first_node, 3 * end_node);
  std::vector<std::vector<types::global_dof_index>> dofs(elements.size());
  for (std::size_t c = first; c < end; ++c) {
    for (const auto unknown : elements[c].unknowns)
      for (int d = 0; d < 3; ++d) dofs[c].push_back(3 * unknown + d);
    touched.add_indices(dofs[c].begin(), dofs[c].end());
  }
  touched.add_indices(owned);
  DynamicSparsityPattern pattern(size, size, touched);
  for (std::size_t c = first; c < end; ++c)
    for (const auto row : dofs[c]) pattern.add_entries(row, dofs[c].begin(), dofs[c].end(), true);
  SparsityTools::distribute_sparsity_pattern(pattern, owned, comm, touched);

  PETScWrappers::MPI::SparseMatrix K;
  K.reinit(owned, owned, pattern, comm);
  PETScWrappers::MPI::Vector f(owned, comm), u(owned, comm);
  FullMatrix<double> cell_K;
  Vector<double> cell_f;
  for (std::size_t c = first; c < end; ++c) {
    integrate(model, run, c, elements[c], cell_K, cell_f);
    K.add(dofs[c], cell_K);
    f.add(dofs[c], cell_f);
  }
  K.compress(VectorOperation::add);
  f.compress(VectorOperation::add);
  SolverControl control;
  PETScWrappers::SparseDirectMUMPS solver(control, comm);
  solver.set_symmetric_mode(true);
  solver.solve(K, u, f);
  return {Vector<double>(u), (u * f) / 2};
}

} // namespace

int main(int argc, char** argv) {
  Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  const bool first = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  try {
    ParameterHandler prm;
    declare(prm);
    if (argc != 2 || std::string(argv[1]) == "--help") {
      if (first) std::cout << "usage: dealii_statics SETTINGS.prm, with these keys:\n\n";
      if (first) prm.print_parameters(std::cout, ParameterHandler::Text);
      return argc == 2 ? 0 : 2;
    }
    prm.parse_input(argv[1]);
    if (first) std::cout.precision(12);
    const h5::File file(prm.get("Model file"), false);
    const Model model(file);
    const Run run(prm, model);
    std::vector<std::vector<Polynomials::Polynomial<double>>> by_direction;
    for (const int p : model.degree) {
      auto& polynomials = by_direction.emplace_back();
      for (const auto& b : generate_complete_bernstein_basis<double>(p)) polynomials.push_back(b);
    }
    const AnisotropicPolynomials<3> bernstein(by_direction);
    std::vector<Element> elements;
    for (std::size_t cell = 0; cell < model.span.size(); ++cell) elements.emplace_back(model, cell, bernstein);
    const auto [u, work] = solve(model, run, elements);
    if (first) write_results(prm, file, model, run, elements, u, work);
  } catch (const std::exception& error) {
    if (first) std::cerr << "dealii_statics: " << error.what() << "\n";
    return 2; // bad input is seen by every rank alike
  }
}
