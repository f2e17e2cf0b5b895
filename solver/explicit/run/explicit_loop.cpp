#include "solver/explicit/run/explicit_loop.hpp"

#include "format/io/interrupt.hpp"
#include "format/model/errors.hpp"
#include "format/model/version.hpp"

#include <cmath>
#include <cstdio>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr double rounding = 1e-9; // of an interval: times that should be equal

} // namespace

bool ExplicitLoop::is_due(std::int64_t number, double interval) const {
  return interval > 0 && parts_.scene.integrator().time() >= (static_cast<double>(number) - rounding) * interval;
}

// Number of the first output that is not due yet.
std::int64_t ExplicitLoop::next_number(double interval) const {
  if (!(interval > 0)) return 1;
  auto number = static_cast<std::int64_t>(std::floor(parts_.scene.integrator().time() / interval + rounding)) + 1;
  // The quotient may be rounded to the other side than the product of is_due.
  while (is_due(number, interval)) ++number;
  while (number > 1 && !is_due(number - 1, interval)) --number;
  return number;
}

void ExplicitLoop::begin() {
  parts_.recorder.add_step(0);
  parts_.recorder.record();
  parts_.outputs.begin();
  parts_.outputs.add_fields();
  parts_.outputs.publish(parts_.recorder.series());
  parts_.outputs.wait(); // lists of files that an earlier run has left are replaced before the first step
  parts_.scene.integrator().clock().lap(Phase::Output);
}

void ExplicitLoop::resume() {
  const OutputRun& out = parts_.scene.run().out;
  next_row_ = next_number(out.interval);
  next_field_ = next_number(out.field_interval);
  next_restart_ = next_number(out.restart_interval);
}

int ExplicitLoop::run() {
  Integrator& integrator = parts_.scene.integrator();
  const double end = parts_.scene.run().time.end_time;
  constexpr double parts_of_run = 1e6; // progress is counted in whole numbers
  const auto show = [&](bool now) {
    parts_.progress.update(
        static_cast<std::int64_t>(parts_of_run * integrator.time() / end), static_cast<std::int64_t>(parts_of_run),
        [this] { return state_text(); }, now);
  };
  parts_.progress.start("stepping");
  try {
    while (!integrator.finished() && !stop_) {
      const double dt_last = integrator.dt();
      integrator.step();
      parts_.recorder.add_step(dt_last);
      follow_up();
      watch_.look(parts_.scene);
      show(integrator.finished() || stop_);
      integrator.clock().lap(Phase::Output);
      if (const int signal = io::pending_signal(); signal != 0) {
        parts_.outputs.publish(parts_.recorder.series());
        if (!integrator.finished() && !stop_) write_restart_file();
        parts_.outputs.wait();
        parts_.progress.finish();
        return signal;
      }
    }
  } catch (const NumericalError& error) {
    parts_.outputs.publish(parts_.recorder.series());
    parts_.outputs.wait();
    parts_.progress.finish();
    throw NumericalError(fmt::format("{}; {} holds what was found until t = {:.6g}", error.what(),
                                     parts_.outputs.path().string(), parts_.recorder.series().time.back()));
  }
  parts_.outputs.wait();
  parts_.progress.finish();
  return 0;
}

void ExplicitLoop::follow_up() {
  const Integrator& integrator = parts_.scene.integrator();
  const ExplicitRun& run = parts_.scene.run();
  const bool last = integrator.finished();
  if (last || is_due(next_row_, run.out.interval)) {
    parts_.recorder.record();
    next_row_ = next_number(run.out.interval);
    stop_ = parts_.recorder.stop();
    if (warnings_.empty() && run.energy_warning > 0 && integrator.energy_error() > run.energy_warning) {
      warnings_.push_back(
          fmt::format("t = {:.6g}: the energy balance is off by {:.3g} of the largest energy, more than {:g}",
                      integrator.time(), integrator.energy_error(), run.energy_warning));
      warn_now(warnings_.back());
    }
    parts_.outputs.publish_if_cheap(parts_.recorder.series());
  }
  if (last || stop_ || is_due(next_field_, run.out.field_interval)) {
    parts_.outputs.add_fields();
    next_field_ = next_number(run.out.field_interval);
    parts_.outputs.publish(parts_.recorder.series());
  }
  if (!last && !stop_ && is_due(next_restart_, run.out.restart_interval)) {
    next_restart_ = next_number(run.out.restart_interval);
    parts_.outputs.publish(parts_.recorder.series());
    write_restart_file();
  }
}

void ExplicitLoop::write_restart_file() const {
  parts_.outputs.wait();
  RestartState restart;
  restart.version = program_version();
  restart.inputs = parts_.inputs;
  restart.settings = settings_to_keep(parts_.scene.run());
  restart.limits = parts_.scene.limits();
  restart.state = parts_.scene.integrator().save();
  restart.sums = parts_.recorder.sums();
  restart.rows = static_cast<std::int64_t>(parts_.recorder.num_rows());
  restart.fields = static_cast<std::int64_t>(parts_.outputs.num_fields());
  write_restart(restart_path(parts_.outputs.path()), restart);
}

std::string ExplicitLoop::state_text() const {
  const Integrator& integrator = parts_.scene.integrator();
  const EnergyBalance& e = integrator.energy();
  return fmt::format(
      "step {}, t = {:.5g}, dt = {:.3g}, internal {:.4g}, kinetic {:.4g}, contact {:.3g}, energy error {:.1e}",
      integrator.steps(), integrator.time(), integrator.dt(), e.internal, e.kinetic, e.contact,
      integrator.energy_error());
}

double ExplicitLoop::largest_error(double (MomentumBalance::*error)() const) const {
  double largest = 0;
  for (std::size_t b = 0; b < parts_.scene.num_bodies(); ++b)
    largest = std::max(largest, (parts_.scene.integrator().momentum(b).*error)());
  return largest;
}

std::vector<std::string> ExplicitLoop::warnings() const {
  std::vector<std::string> all = warnings_;
  for (std::string& warning : watch_.warnings()) all.push_back(std::move(warning));
  return all;
}

void ExplicitLoop::warn_now(const std::string& text) const {
  if (!parts_.warn) return;
  parts_.progress.finish();
  parts_.warn(text);
  parts_.progress.start("stepping");
}

} // namespace iga::solve
