// Responses as tables for the results file: what probes and supports see, over frequency or time.
#pragma once

#include "format/model/results.hpp"
#include "solver/response/harmonic.hpp"
#include "solver/response/random.hpp"
#include "solver/response/transient.hpp"

namespace iga::solve {

/// Complex amplitudes over frequency: size and phase (degrees ahead of a factor without phase), the von Mises stress at
/// its largest over a cycle. With a base: `relative` to it; displacement, velocity and acceleration are absolute.
std::vector<ResultTable> tables_of(const ResponseSystem& system, const HarmonicResponse& response);
/// Root mean squares (1 sigma), apparent frequencies and spectra. With a base: `relative` to it, accelerations
/// absolute.
std::vector<ResultTable> tables_of(const ResponseSystem& system, const RandomResponse& response);
/// Histories.
std::vector<ResultTable> tables_of(const ResponseSystem& system, const TransientResponse& response);

/// A probe's answers as one row of numbers for reports: the largest size of each over frequency or time and where it
/// is.
struct Peak {
  double value = 0, at = 0;
};
struct ProbePeaks {
  std::string probe;
  Peak relative, acceleration,
      von_mises; ///< sizes of vectors: over a cycle, over time; displacement relative to the base
};
std::vector<ProbePeaks> peaks_of(const ResponseSystem& system, const HarmonicResponse& response);
std::vector<ProbePeaks> peaks_of(const ResponseSystem& system, const TransientResponse& response);

/// Root mean squares at a probe.
struct ProbeRms {
  std::string probe;
  Eigen::Vector3d relative, acceleration;                     ///< length, length/time²
  Eigen::Vector3d relative_frequency, acceleration_frequency; ///< apparent, cycles/time
  Voigt stress, stress_frequency;
  double von_mises = 0;
};
std::vector<ProbeRms> rms_of(const ResponseSystem& system, const RandomResponse& response);

} // namespace iga::solve
