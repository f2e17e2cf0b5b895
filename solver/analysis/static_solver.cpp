#include "solver/analysis/static_solver.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/stage_progress.hpp"
#include "solver/multigrid/multigrid_solver.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

std::unique_ptr<LinearSolver> factorised(const BoundSystem& bound, const InertiaRelief* relief,
                                         io::Progress* progress) {
  SystemMatrix system;
  system.announce = show_factorisation(progress);
  system.stiffness = &bound.K;
  if (relief) {
    system.mass = &relief->mass();
    system.shift = -relief->sigma();
  }
  if (bound.constraints.rows() == 0 && holds_without_low_rank(system)) return factorise_positive_definite(system);
  system.constraints = &bound.constraints;
  return factorise_indefinite(system);
}

// Multigrid; where nobody asked for it by name and it fails, the direct solver from then on.
class IterativeSolver final : public LinearSolver {
 public:
  IterativeSolver(const BodySystem& system, const BoundSystem& bound, bool may_give_up, io::Progress* progress,
                  SolverReport& report)
      : bound_(bound), may_give_up_(may_give_up), progress_(progress), report_(report) {
    try {
      show_stage(progress, "coarse grids");
      multigrid_ = std::make_unique<MultigridSolver>(ShiftedStiffness{&bound.K}, system, progress, MultigridSettings{},
                                                     held_cells(bound));
      report.level_nodes = multigrid_->multigrid().level_nodes();
    } catch (const InputError& error) {
      give_up(error);
    } catch (const NumericalError& error) {
      give_up(error);
    }
  }

  using LinearSolver::solve;
  void solve(const double* b, double* x, int columns) const override {
    if (multigrid_) try {
        multigrid_->solve(b, x, columns);
        report_.steps = multigrid_->steps();
        return;
      } catch (const NumericalError& error) {
        give_up(error);
      }
    direct_->solve(b, x, columns);
  }
  std::int64_t size() const override { return bound_.K.size(); }
  FactorCost cost() const override { return multigrid_ ? multigrid_->cost() : direct_->cost(); }

 private:
  // Called while an error is handled.
  template <class Error> void give_up(const Error& error) const {
    if (!may_give_up_) throw;
    multigrid_.reset();
    report_.multigrid = false;
    report_.reason = fmt::format("multigrid was tried: {}", error.what());
    direct_ = factorised(bound_, nullptr, progress_);
  }

  const BoundSystem& bound_;
  bool may_give_up_;
  io::Progress* progress_;
  SolverReport& report_;
  mutable std::unique_ptr<MultigridSolver> multigrid_;
  mutable std::unique_ptr<LinearSolver> direct_;
};

std::string obstacle_of(const BoundSystem& bound, const InertiaRelief* relief, bool rigid_regions) {
  if (bound.constraints.rows() > 0)
    return "supports by Lagrange multipliers make the system indefinite, which the multigrid solver cannot treat";
  if (relief) return "the multigrid solver knows no inertia relief";
  if (rigid_regions) return "the multigrid solver knows no loads that keep their region rigid (spread = \"rigid\")";
  return "";
}

} // namespace

std::string doubt_about(const BodySystem& system) {
  for (const SystemBody& body : system) {
    const auto p = body.space->model().grid.degree();
    if (*std::max_element(p.begin(), p.end()) > 2)
      return "at degree 3 and 4 multigrid converges on some parts only; solver = \"multigrid\" tries";
  }
  return "";
}

std::vector<std::vector<std::int64_t>> held_cells(const BoundSystem& bound) {
  std::vector<std::vector<std::int64_t>> held(bound.of_body.size());
  const auto take = [&](std::size_t body, const SurfaceRegion& region) {
    held[body].insert(held[body].end(), region.cells.begin(), region.cells.end());
  };
  for (std::size_t b = 0; b < held.size(); ++b)
    for (const PreparedSupport& support : bound.of_body[b].prepared) take(b, support.region);
  for (const PreparedSpring& spring : bound.springs)
    if (spring.is_grounded()) take(spring.body, spring.region);
  for (const PreparedTie& tie : bound.ties)
    for (std::size_t side = 0; side < 2; ++side) take(tie.surface.body[side], tie.side[side].region);
  return held;
}

std::unique_ptr<LinearSolver> static_solver(const RunSettings& run, const BodySystem& system, const BoundSystem& bound,
                                            const InertiaRelief* relief, bool rigid_regions, SolverReport& report) {
  std::string obstacle = obstacle_of(bound, relief, rigid_regions);
  if (obstacle.empty() && run.solver == SolverKind::Auto) obstacle = doubt_about(system);
  report = choose_solver(run.solver, bound.K.pattern(), obstacle);
  if (!report.multigrid) return factorised(bound, relief, run.progress);
  return std::make_unique<IterativeSolver>(system, bound, run.solver == SolverKind::Auto, run.progress, report);
}

} // namespace iga::solve
