// Files that a nonlinear run leaves, step by step, as explicit runs do: at any time each of them is whole.
#pragma once

#include "solver/explicit/run/series_fields.hpp"
#include "solver/nonlinear/nonlinear_statics.hpp"

#include <filesystem>

namespace iga::solve {

class NonlinearOutputs {
 public:
  /// @param results  out.h5; beside it come out_fields/, out_vtp/ and out.pvd. Empty: nothing is written
  /// @param head     header and bodies; the rest is filled in here
  NonlinearOutputs(const NonlinearRun& run, const NonlinearStatics& statics, std::filesystem::path results,
                   Results head);

  /// A new run: the mesh is written, fields of an earlier run removed. @throws InputError with the system's reason
  void begin();
  /// A run that goes on: series and fields of `before` up to `rows` are kept. @throws InputError where they are missing
  void resume(Results before, std::size_t rows);
  /// Adds a converged step to series and fields and replaces the results file.
  void add(const StepReport& step);
  /// Replaces the results file.
  void publish();

  const TimeSeries& series() const { return *results_.time_series; }
  const std::filesystem::path& path() const { return path_; }
  ResultsHeader& header() { return results_.header; }

 private:
  void record(const StepReport& step);
  void record_contacts(TimeSeries& t) const;
  void write_fields();
  void write_index() const;

  const NonlinearRun& run_;
  const NonlinearStatics& statics_;
  std::filesystem::path path_, folder_;
  Results results_;
  FieldSampler sampler_;
};

} // namespace iga::solve
