// What a static run says of stress: recovered at the surface, at probes and along lines through walls.
#pragma once

#include "solver/analysis/static_analysis.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/stress/stress_lines.hpp"

namespace iga::solve {

/// The largest von Mises stress of some places.
struct PeakStress {
  double von_mises = 0;        ///< force/length²
  std::optional<double> error; ///< estimated, force/length²; none of stress that was not recovered
  Point3 at{};                 ///< length
  std::size_t body = 0;
  Eigen::Vector3d principal = Eigen::Vector3d::Zero();
  std::string face;                ///< name of the region of the surface; empty inside
  std::optional<std::string> near; ///< what takes its limit away (SingularPlaces)
};

struct LineStress {
  StressLine line;
  std::size_t body = 0;
  LinePoints points;
  RecoveredStress stress;
  LinearisedStress linear;
};

struct StressReport {
  PeakStress largest;
  std::optional<PeakStress> regular; ///< the largest that has a limit, where `largest` has none
  /// The least yield / von Mises over the bodies that have a yield strength.
  struct Safety {
    double factor = 0, yield = 0;
    PeakStress where;
  };
  std::optional<Safety> safety;
  std::vector<double> probe_errors; ///< (probes), of the von Mises stress; empty where stress is not recovered
  std::vector<LineStress> lines;
};

/// Recovers the stress of every body of one load case: at its surface, into `results` where they have fields there, at
/// the probes of the solution, and along the run's lines. With raw_stress only the largest values are looked for.
/// @throws InputError for lines that leave the part
StressReport recover_stress(const AnalysisRun& run, StaticSolution& solution, Results* results);

/// The report's lines as tables of the results file: `line_NAME`, stress along it, and `linearised_NAME`, membrane,
/// bending and peak stress at its two ends; with `CASE_` in front where there are load cases.
std::vector<ResultTable> line_tables(const StressReport& report, const std::string& case_name);

std::string stress_text(const StressReport& report, const StaticSolution& solution, const BodySystem& system);
io::JsonObject stress_json(const StressReport& report, const StaticSolution& solution, const BodySystem& system);

} // namespace iga::solve
