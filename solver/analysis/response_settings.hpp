// [base], [damping], [response], [harmonic], [random], [transient] of a run file, and how its loads vary.
#pragma once

#include "format/model/types.hpp"
#include "solver/base/number_curve.hpp"

namespace iga::solve {

/// How a load, or the acceleration of the base, varies: factors of what the run file gives as its value.
struct Variation {
  std::string where;                   ///< opens messages
  std::optional<NumberCurve> spectrum; ///< amplitude over frequency; harmonic
  double phase = 0;                    ///< degrees, ahead of the others; harmonic
  std::optional<NumberCurve> psd;      ///< one-sided power spectral density over frequency, 1/frequency; random
  std::optional<NumberCurve> history;  ///< over time; transient
  bool given() const { return spectrum || phase != 0 || psd || history; }
};

/// All supports move together.
struct BaseMotion {
  Point3 direction{};            ///< unit vector, the run's frame
  bool in_g = false;             ///< accelerations are multiples of standard gravity
  std::optional<double> gravity; ///< length/time² of one g, where the run says it
  Variation acceleration;        ///< length/time², or g
};

struct DampingSettings {
  bool given = false;
  double ratio = 0;                 ///< of critical damping, all modes
  std::vector<double> mode_ratios;  ///< by elastic mode; the last one for all others
  std::optional<NumberCurve> table; ///< ratio over frequency, straight lines, end values outside
  double alpha = 0, beta = 0;       ///< Rayleigh: C = α M + β K; 1/time, time
  double structural = 0;            ///< loss factor η: K (1 + i η)
  std::string where;
};

struct HarmonicSettings {
  std::optional<double> from, to; ///< cycles/time
  int points = 200;               ///< spread over the range, beside those at the resonances
  std::vector<double> frequencies, fields;
};

struct RandomSettings {
  std::optional<double> from, to; ///< cycles/time; default: where the spectra are given
  int points = 200;               ///< of the spectra of the answers
};

struct TransientSettings {
  double end = 0, step = 0; ///< time; step of the output, 0: a thousandth of the end
  std::vector<double> fields;
};

/// What the three response analyses are asked for.
struct ResponseSettings {
  bool choose_modes = true; ///< the run does not say how many modes it takes
  bool residual_vectors = true;
  DampingSettings damping;
  std::optional<BaseMotion> base;
  std::vector<Variation> loads; ///< by load of the run
  HarmonicSettings harmonic;
  RandomSettings random;
  TransientSettings transient;
};

/// @throws InputError with file and line for values that make no sense
ResponseSettings read_response_settings(io::SettingsTable& root);
/// For SettingsTable::expect_only.
std::vector<io::TableKeys> response_keys();

} // namespace iga::solve
