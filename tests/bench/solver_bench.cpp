#include "tests/bench/measurements.hpp"

#include "solver/mechanics/assemble.hpp"

#include <memory>

namespace iga::bench {

namespace {

struct Problem {
  explicit Problem(TrimmedModel made) : model(std::move(made)), space(model, {solve::LightFunctions::DegreeP, 1e-3}) {}
  TrimmedModel model;
  solve::SolutionSpace space;
  std::shared_ptr<const solve::Connectivity> connectivity = std::make_shared<const solve::Connectivity>(space);
};

} // namespace

void measure_solver(BenchCase& part, int degree) {
  const auto name = [&](const char* kernel) {
    return std::string(kernel) + "/" + part.name() + "/p" + std::to_string(degree);
  };
  const auto prepare = [&part, degree] { return std::make_shared<Problem>(part.model(degree)); };
  const solve::ElasticMaterial material = solve::isotropic(210, 0.3, 7.8e-6);
  measure(name("solver_pattern"), "pairs", [prepare]() -> Work {
    const auto problem = prepare();
    return [problem] { return solve::Connectivity(problem->space).pattern.num_pairs(); };
  });
  measure(name("solver_stiffness"), "points", [prepare, material]() -> Work {
    const auto problem = prepare();
    return [problem, material] {
      benchmark::DoNotOptimize(
          solve::assemble_stiffness(problem->space, problem->connectivity, material).values().data());
      return static_cast<std::int64_t>(problem->model.points.weights.size());
    };
  });
  measure(name("solver_mass"), "points", [prepare]() -> Work {
    const auto problem = prepare();
    return [problem] {
      benchmark::DoNotOptimize(solve::assemble_mass(problem->space, problem->connectivity, 1).values().data());
      return static_cast<std::int64_t>(problem->model.points.weights.size());
    };
  });
  measure(name("solver_product"), "entries", [prepare, material]() -> Work {
    const auto problem = prepare();
    const auto K = std::make_shared<solve::StiffnessMatrix>(
        solve::assemble_stiffness(problem->space, problem->connectivity, material));
    const auto x = std::make_shared<Eigen::VectorXd>(Eigen::VectorXd::Ones(K->size()));
    return [problem, K, x] {
      benchmark::DoNotOptimize((*K * *x).norm());
      return static_cast<std::int64_t>(K->values().size());
    };
  });
}

} // namespace iga::bench
