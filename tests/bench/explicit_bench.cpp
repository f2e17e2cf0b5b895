// explicit_bench: point updates per second of the explicit kernel, by law, kind of span and degree; fraction of the
// core's f64 peak; gain of a second thread. CPU time, so that other work on the machine disturbs little; best of
// several runs. Arguments: spans along an edge (default 24; 0: none of these), seconds per measurement (default 0.2),
// model files of igaprep: points and whole steps per second with the rules that they hold.
#include "format/io/trimmed_model_io.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "tests/bench/impact_foam.hpp"
#include "tests/support/synthetic_model.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>

namespace iga::bench {

namespace {

using namespace iga::solve;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Independent multiply-adds in registers: the most that this build reaches on one core, flop/s.
double measure_peak() {
  constexpr int chains = 12;
  double best = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    Pack x[chains];
    for (int k = 0; k < chains; ++k) x[k] = pack(1.0 + k);
    constexpr int steps = 2'000'000;
    const double start = cpu_seconds();
    const Pack a = pack(0.999999), b = pack(1e-6);
    for (int i = 0; i < steps; ++i)
      for (int k = 0; k < chains; ++k) x[k] = x[k] * a + b;
    const double seconds = cpu_seconds() - start;
    double sum = 0;
    for (const Pack& chain : x) sum += chain[0];
    if (sum > 0) best = std::max(best, 2.0 * pack_size * chains * steps / seconds); // sum is needed, so is the loop
  }
  return best;
}

/// n³ interior spans; or a plate of n² spans that are all trimmed.
TrimmedModel make_model(bool trimmed, int p, std::int64_t n) {
  const auto size = static_cast<double>(n + 2 * p);
  const double low = p, high = size - p;
  if (!trimmed)
    return test::make_box_model({{0, 0, 0},
                                 {size, size, size},
                                 {n + 2 * p, n + 2 * p, n + 2 * p},
                                 {p, p, p},
                                 identity_rotation,
                                 {low, low, low},
                                 {high, high, high}});
  const double depth = 2 * p + 2;
  return test::make_box_model({{0, 0, 0},
                               {size, size, depth},
                               {n + 2 * p, n + 2 * p, 2 * p + 2},
                               {p, p, p},
                               identity_rotation,
                               {low, low, p + 0.1},
                               {high, high, p + 1.9}});
}

struct Rate {
  double by_cpu = 0, by_wall = 0; // points per second
  double cores = 0;               // CPU time over wall time of the best run by the wall clock
};

Rate measure(InternalForces& forces, const std::vector<double>& u, int threads, double seconds) {
  std::vector<double> f(u.size()), back(u);
  for (double& x : back) x = -x;
  Rate best;
  // An arena of its own: a limit on all of TBB, once set to one thread, would keep later runs from getting more.
  tbb::task_arena arena(threads);
  arena.execute([&] {
    for (int repeat = 0; repeat < 5; ++repeat) {
      const double cpu = cpu_seconds(), wall = wall_seconds();
      double points = 0;
      while (wall_seconds() - wall < seconds / 5) {
        // There and back, so that laws with history yield in every step.
        forces.evaluate(u.data(), 1e-3, f.data());
        forces.evaluate(back.data(), 1e-3, f.data());
        points += 2 * static_cast<double>(forces.plan().num_points);
      }
      const double cpu_used = cpu_seconds() - cpu, wall_used = wall_seconds() - wall;
      best.by_cpu = std::max(best.by_cpu, points / cpu_used);
      if (points / wall_used > best.by_wall) {
        best.by_wall = points / wall_used;
        best.cores = cpu_used / wall_used;
      }
    }
  });
  return best;
}

// One part of a user: how its points are worked on, what they and whole steps cost on one core, and the time that the
// limit of the time step takes. Units of the model do not matter.
void run_model(const char* path, double seconds) {
  const TrimmedModel model = io::read_model(path);
  const Point3 h = model.grid.span_size();
  for (const auto& [name, law] : {std::pair<const char*, Law>{"neo-Hookean", neo_hookean(1, 0.3, 1)},
                                  std::pair<const char*, Law>{"foam", bench::impact_foam()}}) {
    ExplicitBody body(model, {.name = "part", .light = {LightFunctions::Linear, 0.01}}, law);
    const SpanPlan& plan = body.forces().plan();
    const auto points = static_cast<double>(plan.num_points);
    std::vector<double> u(3 * model.functions.number.size());
    for (std::size_t k = 0; k < u.size(); ++k) u[k] = 0.01 * h[0] * std::sin(1.3 * static_cast<double>(k));
    const Rate one = measure(body.forces(), u, 1, seconds);
    const double before = cpu_seconds();
    const StartStep limit = body.start_step();
    const double start = cpu_seconds() - before;
    body.set_velocity([&](const Point3& x) {
      const double size = 1e-3 * h[0] / limit.dt;
      return Point3{size * std::sin(x[1] / h[1]), size * std::sin(x[2] / h[2]), size * std::sin(x[0] / h[0])};
    });
    Integrator integrator({&body}, {.end_time = 1e30});
    integrator.start({limit});
    double best = 0;
    tbb::task_arena(1).execute([&] {
      for (int repeat = 0; repeat < 5; ++repeat) {
        const double cpu = cpu_seconds();
        double steps = 0;
        for (; cpu_seconds() - cpu < seconds / 5; ++steps) integrator.step();
        best = std::max(best, steps / (cpu_seconds() - cpu));
      }
    });
    const auto share = [&](std::int64_t part) { return 100 * static_cast<double>(part) / points; };
    fmt::print(
        "{} {}: {:.0f} points ({:.0f} % in tensors, {:.0f} % lane by lane, {:.0f} % in single spans; {:.0f} % of "
        "the lanes used), {} functions; {:.1f} M points/s, {:.0f} B/point; {:.0f} steps/s of {:.0f} forces/s; "
        "limit of the step ({} products) {:.2f} s\n",
        path, name, points, share(plan.num_tensor_points), share(plan.num_lane_points),
        share(plan.num_points - plan.num_tensor_points - plan.num_lane_points),
        100 * points / static_cast<double>(lanes) / static_cast<double>(plan.num_point_blocks()),
        model.functions.number.size(), 1e-6 * one.by_cpu, static_cast<double>(body.forces().memory()) / points, best,
        one.by_cpu / points, limit.products, start);
  }
}

void run(std::int64_t n, double seconds) {
  const double peak = measure_peak();
  fmt::print("f64 peak of a core with this build: {:.0f} GFLOP/s\n", 1e-9 * peak);
  fmt::print("{:<9} {:>2} {:<12} {:>9} {:>10} {:>10} {:>12} {:>8} {:>11} {:>9}\n", "spans", "p", "law", "points",
             "M points/s", "flop/point", "of peak", "B/point", "2 threads", "cores");
  for (const bool trimmed : {false, true})
    for (const int p : {2, 3}) {
      const TrimmedModel model = make_model(trimmed, p, trimmed ? 3 * n : n);
      const SolutionSpace space(model, {});
      std::vector<double> u(3 * model.functions.number.size());
      for (std::size_t k = 0; k < u.size(); ++k) u[k] = 0.01 * std::sin(1.3 * static_cast<double>(k));
      const std::pair<const char*, Law> laws[]{{"elastic", LinearElastic(isotropic(1, 0.3, 1))},
                                               {"neo-Hookean", neo_hookean(1, 0.3, 1)},
                                               {"foam", bench::impact_foam()}};
      for (const auto& [name, law] : laws) {
        const auto forces = make_internal_forces(space, law);
        const auto points = static_cast<double>(forces->plan().num_points);
        const double flops = contraction_flops(forces->plan()) / points;
        const Rate one = measure(*forces, u, 1, seconds), two = measure(*forces, u, 2, seconds);
        fmt::print("{:<9} {:>2} {:<12} {:>9.0f} {:>10.1f} {:>10.0f} {:>10.0f} % {:>8.0f} {:>9.2f} × {:>6.2f}\n",
                   trimmed ? "trimmed" : "interior", p, name, points, 1e-6 * one.by_cpu, flops,
                   100 * flops * one.by_cpu / peak, static_cast<double>(forces->memory()) / points,
                   two.by_wall / one.by_wall, two.cores);
      }
    }
  fmt::print(
      "flop/point and the share of the peak leave the law's own operations out; 2 threads: gain by the wall clock, "
      "and the cores they got while it was measured (below 2 on a busy machine)\n");
}

} // namespace

} // namespace iga::bench

int main(int argc, char** argv) {
  const long long n = argc > 1 ? std::atoll(argv[1]) : 24;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 0.2;
  if (n > 0) iga::bench::run(n, seconds);
  try {
    for (int k = 3; k < argc; ++k) iga::bench::run_model(argv[k], seconds);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
