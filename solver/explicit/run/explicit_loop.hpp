// The loop over the steps of a run, with all that happens between them: outputs, restart files, stop conditions,
// signals, progress.
#pragma once

#include "format/io/progress.hpp"
#include "solver/explicit/run/run_outputs.hpp"
#include "solver/explicit/run/run_restart.hpp"
#include "solver/explicit/run/run_watch.hpp"
#include "solver/explicit/run/series_recorder.hpp"

namespace iga::solve {

class ExplicitLoop {
 public:
  struct Parts {
    ExplicitScene& scene;
    SeriesRecorder& recorder;
    RunOutputs& outputs;
    io::Progress& progress;
    std::vector<InputFile> inputs; ///< for restart files
    RunWatch::Warn warn;           ///< called at once, with each warning of the run
  };
  explicit ExplicitLoop(Parts parts)
      : parts_(std::move(parts)), watch_([this](const std::string& text) { warn_now(text); }) {}
  ExplicitLoop(const ExplicitLoop&) = delete;
  ExplicitLoop& operator=(const ExplicitLoop&) = delete;

  /// The state at the start: first row, first fields. @pre scene.start()
  void begin();
  /// Goes on where a restart file was written: the next outputs are the first ones beyond the time of the scene, by the
  /// intervals of the run file as it is now. @pre scene.load()
  void resume();
  /// Until the end, a stop condition or a signal. @returns the signal's number, 0 for none
  /// @throws NumericalError of the integrator, after the rows so far were written
  int run();

  const StopCondition* stopped_by() const { return stop_; }
  /// All of the run, with how bad it became.
  std::vector<std::string> warnings() const;
  /// Largest relative error of all bodies: MomentumBalance.
  double momentum_error() const { return largest_error(&MomentumBalance::relative_linear_error); }
  double angular_momentum_error() const { return largest_error(&MomentumBalance::relative_angular_error); }

 private:
  bool is_due(std::int64_t number, double interval) const;
  std::int64_t next_number(double interval) const;
  void follow_up();
  void write_restart_file() const;
  std::string state_text() const;
  void warn_now(const std::string& text) const;
  double largest_error(double (MomentumBalance::*error)() const) const;

  Parts parts_;
  std::int64_t next_row_ = 1, next_field_ = 1, next_restart_ = 1;
  const StopCondition* stop_ = nullptr;
  std::vector<std::string> warnings_;
  RunWatch watch_;
};

} // namespace iga::solve
