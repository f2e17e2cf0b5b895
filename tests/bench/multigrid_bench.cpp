// multigrid_bench: steps and seconds of the multigrid solver on model files of igaprep.
#include "format/io/trimmed_model_io.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/multigrid/multigrid_solver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <random>

namespace {

using namespace iga;
using namespace iga::solve;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void measure(const char* file, int sweeps) {
  const TrimmedModel model = io::read_model(file);
  const SolutionSpace space(model, {LightFunctions::DegreeP, 1e-3});
  const BodySystem system(space, isotropic(210, 0.3, 7.8e-6));
  double start = cpu_seconds();
  const auto lap = [&](const char* what) {
    fmt::print("  {:<14} {:6.2f} s\n", what, cpu_seconds() - start);
    start = cpu_seconds();
  };
  const auto connectivity = system.connectivity({});
  const StiffnessMatrix K = assemble_stiffness(system, connectivity);
  const MassOperator M = make_mass(MassType::Consistent, system, connectivity);
  lap("assembly");
  const ShiftedStiffness A{&K, &M, -1e-3 * lambda_scale(system)};
  const MultigridSolver solver(A, system, nullptr, {.sweeps = sweeps});
  lap("hierarchy");
  fmt::print("{}: {} unknowns, levels {}, {:.0f} MB\n", file, K.size(), solver.multigrid().level_nodes(),
             1e-6 * solver.cost().bytes);
  std::mt19937_64 random(1);
  Eigen::VectorXd b(K.size());
  for (double& x : b) x = std::uniform_real_distribution(-1.0, 1.0)(random);
  solver.solve(b);
  fmt::print("  sweeps {}: {} steps\n", sweeps, solver.steps());
  lap("solution");
}

} // namespace

int main(int argc, char** argv) {
  for (int k = 2; k < argc; ++k) measure(argv[k], std::atoi(argv[1]));
}
