// The impact sample on given models of the cube 0 … 100 mm: what contact costs, how deep it lets sink, what it
// balances.
#include "format/io/trimmed_model_io.hpp"
#include "solver/explicit/contact/contact_model.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "tests/bench/impact_foam.hpp"

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <tbb/global_control.h>

namespace iga::bench {

namespace {

using namespace solve;

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Contact with a clock.
class TimedContact : public PenaltySource {
 public:
  explicit TimedContact(ContactModel& contact) : contact_(&contact) {}
  double largest_step() const override { return contact_->largest_step(); }
  PenaltyEnergy add_forces(const StepTimes& times, std::span<const BodyState> bodies) override {
    const double begin = cpu_seconds();
    const PenaltyEnergy energy = contact_->add_forces(times, bodies);
    seconds += cpu_seconds() - begin;
    return energy;
  }
  void advance(const StepTimes& times) override { contact_->advance(times); }
  double kinetic_energy() const override { return contact_->kinetic_energy(); }
  double external_work() const override { return contact_->external_work(); }

  double seconds = 0;

 private:
  ContactModel* contact_;
};

ContactSide body() {
  return {ContactSide::Kind::Deformable, 0, {}};
}
ContactSide tool(std::size_t number) {
  return {ContactSide::Kind::Rigid, number, {}};
}

struct Options {
  double end = 8, triangles = 4;
  bool self = true;
  int threads = 1;
  double stiffness = 0, damping = -1, safety = 0, step = 0; // 0, -1: the defaults
};

void run(const char* path, const Options& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(options.threads));
  const TrimmedModel model = io::read_model(path);
  BodySettings settings;
  settings.light = {LightFunctions::Linear, 0.01}; // as igasolve
  ExplicitBody cube(model, settings, bench::impact_foam());
  RigidBody ball{"ball", SphereShape{35}, {50, 50, 136}, {}};
  FreeMotion motion;
  motion.mass = 1;
  for (std::size_t d = 0; d < 3; ++d) motion.inertia[d][d] = 490;
  motion.velocity = {0, 0, -8};
  ball.motion = motion;
  std::vector<ContactPair> pairs(options.self ? 3 : 2);
  const char* names[]{"ball", "plate", "self"};
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    pairs[p].name = names[p];
    pairs[p].first = body();
    pairs[p].second = p < 2 ? tool(p) : body();
    pairs[p].friction = {0.2, 0.2, 0};
    if (options.stiffness > 0) pairs[p].stiffness = options.stiffness;
    if (options.damping >= 0) pairs[p].damping = options.damping;
  }
  ContactOptions contact_options;
  if (options.step > 0) contact_options.step = options.step;
  std::vector<ContactSurface> surfaces{make_contact_surface(cube.space(), "cube", 6e-8, options.triangles)};
  surfaces[0].wave_speed = cube.forces().reference_wave_speed();
  const std::size_t vertices = surfaces[0].mesh.vertices.size();
  ContactModel contact(std::move(surfaces), {ball, {"plate", PlaneShape{}, {50, 50, 0}, {}}}, pairs, contact_options);
  TimedContact timed(contact);
  IntegratorSettings run;
  run.end_time = options.end;
  if (options.safety > 0) run.safety = options.safety;

  Integrator integrator({&cube}, run);
  integrator.add(timed);
  const double h = model.grid.span_size()[0];
  fmt::print("{}: {} points, {} nodes, {} vertices\n", path, model.points.weights.size(), cube.space().num_nodes(),
             vertices);
  const double cpu = cpu_seconds(), wall = wall_seconds();
  double depth[3]{}, peak = 0, mean = 0, error = 0, early = 0, next = 0.5, impulse = 0, smallest = 1;
  double friction = 0;
  bool monotone = true;
  integrator.start();
  const double started = cpu_seconds() - cpu;
  while (!integrator.finished()) {
    integrator.step();
    const ContactReport& report = contact.report();
    for (std::size_t p = 0; p < report.pairs.size(); ++p) depth[p] = std::max(depth[p], report.pairs[p].largest_depth);
    const double force = -report.pairs[0].force[2]; // on the sphere, upward
    peak = std::max(peak, force);
    impulse += force * integrator.dt();
    if (integrator.time() > 0.45 && integrator.time() < 0.55) mean += force * integrator.dt() / 0.1;
    early = mean;
    error = std::max(error, integrator.energy_error());
    smallest = std::min(smallest, report.least_scale);
    monotone = monotone && integrator.energy().friction >= friction;
    friction = integrator.energy().friction;
    if (integrator.time() >= next) {
      next += 0.5;
      fmt::print("  t {:.2f} force {:.4f} depth {:.3f} {:.3f} {:.3f} touches {} {} {} looks {} candidates {} "
                 "scale {:.3f} dt {:.2e} z {:.3f} contact {:.2f} of {:.2f} s\n",
                 integrator.time(), force, report.pairs[0].largest_depth, report.pairs[1].largest_depth,
                 report.pairs.size() > 2 ? report.pairs[2].largest_depth : 0, report.pairs[0].touches,
                 report.pairs[1].touches, report.pairs.size() > 2 ? report.pairs[2].touches : 0, report.looks,
                 report.candidates, report.least_scale, integrator.dt(), contact.rigid()[0].pose().centre[2],
                 timed.seconds, cpu_seconds() - cpu);
    }
  }
  const double total = cpu_seconds() - cpu - started;
  fmt::print("  steps {}, {:.2f} s CPU ({:.2f} s wall, {:.2f} s before the first step), contact {:.1f} %, looks {}\n",
             integrator.steps(), total, wall_seconds() - wall - started, started, 100 * timed.seconds / total,
             contact.report().looks);
  fmt::print(
      "  force at 0.5 {:.4f}, peak {:.4f} kN, impulse {:.4f}; depth / h: ball {:.4f}, plate {:.4f}, self {:.4f}; "
      "least scale {:.3f}; energy error {:.2e}, friction monotone {}; last velocity {:.6f}\n",
      early, peak, impulse, depth[0] / h, depth[1] / h, depth[2] / h, smallest, error, monotone,
      contact.rigid()[0].momentum()[2]);
}

} // namespace

} // namespace iga::bench

// impact_bench MODEL [END [THREADS [TRIANGLES [SELF [STIFFNESS [DAMPING [SAFETY [STEP]]]]]]]]
int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "impact_bench MODEL [END [THREADS [TRIANGLES [SELF [STIFFNESS [DAMPING [SAFETY [STEP]]]]]]]]\n");
    return 2;
  }
  iga::bench::Options options;
  if (argc > 2) options.end = std::atof(argv[2]);
  if (argc > 3) options.threads = std::atoi(argv[3]);
  if (argc > 4) options.triangles = std::atof(argv[4]);
  if (argc > 5) options.self = std::atoi(argv[5]) != 0;
  if (argc > 6) options.stiffness = std::atof(argv[6]);
  if (argc > 7) options.damping = std::atof(argv[7]);
  if (argc > 8) options.safety = std::atof(argv[8]);
  if (argc > 9) options.step = std::atof(argv[9]);
  iga::bench::run(argv[1], options);
  return 0;
}
