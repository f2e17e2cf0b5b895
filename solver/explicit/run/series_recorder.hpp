// The time series of a run: one row per output, sums that grow with every step.
#pragma once

#include "format/model/time_series.hpp"
#include "solver/explicit/run/run_scene.hpp"

namespace iga::solve {

class SeriesRecorder {
 public:
  /// @throws InputError for a stop condition on a series that does not exist, with the nearest one
  explicit SeriesRecorder(const ExplicitScene& scene);

  /// After every evaluation of forces, the first one included: impulses. @param dt_last  of the step before; 0 at first
  void add_step(double dt_last);
  /// Appends a row of the present state.
  void record();
  /// The first stop condition that the last row meets; null for none.
  const StopCondition* stop() const;

  const TimeSeries& series() const { return series_; }
  std::size_t num_rows() const { return series_.time.size(); }
  /// Takes over rows of a run that goes on, the first `rows` of them, and its sums.
  /// @throws InputError where they are not those of this run or too few
  void resume(TimeSeries rows, std::size_t count, const std::vector<double>& sums);
  /// Sums that grow with every step, for a restart.
  const std::vector<double>& sums() const { return impulses_; }

 private:
  struct Watch {
    std::size_t condition = 0, column = 0, component = 0;
  };
  void record_contacts();
  void record_bodies();
  void record_rigid();

  const ExplicitScene* scene_;
  TimeSeries series_;
  std::vector<double> impulses_; ///< 3 per contact
  std::vector<Watch> watches_;
};

} // namespace iga::solve
