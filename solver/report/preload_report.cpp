#include "solver/report/preload_report.hpp"

#include "solver/report/static_report.hpp"

namespace iga::solve {

void add_preload(TextReport& report, const char* what, const AnalysisRun& run, const BodySystem& system,
                 const Preload& preload) {
  const StaticSolution& s = preload.solution;
  for (const LoadResult& load : s.result.loads)
    report.line(what, "{} ({}): resultant ({:.6g})", load.name, load.kind, fmt::join(load.force, ", "));
  for (const BoltReport& bolt : s.bolts) report.line(what, "bolt {}: tension {:.6g}", bolt.name, bolt.force);
  for (const TemperatureReport& t : s.temperatures)
    report.line(what, "temperature {} ({}): {:.6g} … {:.6g}, reference {:.6g}", t.body, t.source, t.least, t.most,
                t.reference);
  const auto largest = [&](const char* name, const LargestValue& value) {
    return fmt::format("largest {} {:.6g} at ({:.4g}){}", name, value.value, fmt::join(value.at, ", "),
                       of_body(system, value.body));
  };
  report.line(what, "{}, {}", largest("displacement", s.largest_displacement),
              largest("von Mises stress", s.largest_von_mises));
  report.lines(what, preload_notes(run.settings, preload));
}

io::JsonObject json_of(const AnalysisRun& run, const BodySystem& system, const Preload& preload) {
  io::JsonObject json = static_json(preload.solution, system);
  json.add("largest_strain", preload.largest_strain).add("notes", preload_notes(run.settings, preload));
  return json;
}

} // namespace iga::solve
