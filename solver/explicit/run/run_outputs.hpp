// Files that a run leaves while it goes on. At any time, kill -9 included, each of them is whole: a file appears under
// a temporary name and is renamed, fields come as new files, and the results file that lists them is replaced last.
// Files are written beside the steps, in this order.
#pragma once

#include "format/model/results.hpp"
#include "solver/explicit/run/background_work.hpp"
#include "solver/explicit/run/run_scene.hpp"
#include "solver/explicit/run/series_fields.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>

namespace iga::solve {

class RunOutputs {
 public:
  /// @param results  out.h5; beside it come out_fields/, out_vtp/ and out.pvd
  /// @param head     header and bodies; the rest is filled in here
  RunOutputs(const ExplicitScene& scene, std::filesystem::path results, Results head);

  /// A new run: meshes are written, fields of an earlier run removed. @throws InputError with the system's reason
  void begin();
  /// A run that goes on: the first `steps` fields are kept. @throws InputError where they are missing
  void resume(const FieldIndex& fields, std::size_t steps);
  /// Fields of the present state, for viewers too; listed with the next publish. This and the others throw what
  /// writing a file before has thrown.
  void add_fields();
  /// Replaces the results file.
  void publish(const TimeSeries& series);
  /// The same where that costs no more than a twentieth of the time since the last one: long series are written less
  /// often than they grow.
  void publish_if_cheap(const TimeSeries& series);
  /// Until all is written. HDF5 serves one thread at a time: before other files are read or written with it.
  void wait() { work_.wait(); }

  std::size_t num_fields() const { return results_.fields->times.size(); }
  const std::filesystem::path& path() const { return path_; }
  ResultsHeader& header() { return results_.header; }

 private:
  using Clock = std::chrono::steady_clock;
  std::string field_file(std::size_t step) const;
  std::string viewer_file(std::size_t step, std::size_t part) const;
  struct FieldStep; ///< what the files of one step hold
  void write_viewer(const FieldStep& written) const;
  void write_index(const FieldIndex& steps) const;
  void remove_fields_after(std::size_t steps) const;

  const ExplicitScene& scene_;
  std::filesystem::path path_, folder_;
  Results results_;
  std::vector<FieldSampler> samplers_;
  std::vector<TriangleMesh> rigid_; ///< in their own frames
  Clock::time_point published_ = Clock::now();
  std::atomic<Clock::duration> cost_{}; ///< of writing the results file
  BackgroundWork work_;                 ///< last: it ends before what it writes
};

} // namespace iga::solve
