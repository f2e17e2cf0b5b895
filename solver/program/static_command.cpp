// igasolve static: displacements, stresses and reactions, as report and results file.
#include "format/io/run_tool.hpp"
#include "format/model/errors.hpp"
#include "solver/analysis/advice.hpp"
#include "solver/analysis/prepared_system.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/report/static_report.hpp"
#include "solver/report/stress_report.hpp"

#include <algorithm>
#include <fmt/ranges.h>

namespace iga::solve {

namespace {

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

void append(SurfaceResult& all, const SurfaceResult& more) {
  append(all.steps, more.steps);
  append(all.fields.displacement, more.fields.displacement);
  append(all.fields.strain, more.fields.strain);
  append(all.fields.stress, more.fields.stress);
  append(all.fields.von_mises, more.fields.von_mises);
  append(all.fields.von_mises_error, more.fields.von_mises_error);
  append(all.fields.safety_factor, more.fields.safety_factor);
}

CaseResult case_result(const StaticSolution& solution) {
  CaseResult one{solution.case_name,
                 solution.factors,
                 solution.result.displacement,
                 {},
                 solution.result.strain_energy,
                 solution.largest_displacement.value,
                 solution.largest_von_mises.value};
  for (const SupportResult& support : solution.result.supports) one.support_force.push_back(support.force);
  return one;
}

// Step by step, each case with the stresses of its own initial strains.
void add_case(Results one, Results& all) {
  if (!all.surface && all.parts.empty()) {
    all.active_functions = std::move(one.active_functions);
    all.surface = std::move(one.surface);
    all.parts = std::move(one.parts);
    return;
  }
  if (all.surface) append(*all.surface, *one.surface);
  for (std::size_t b = 0; b < all.parts.size(); ++b) {
    append(all.parts[b].coefficients, one.parts[b].coefficients);
    append(all.parts[b].surface, one.parts[b].surface);
  }
}

// Of all cases, with their fields for the results where these are written.
std::vector<StressReport> recover_cases(const AnalysisRun& run, std::vector<StaticSolution>& solutions,
                                        Results* results) {
  std::vector<StressReport> all;
  for (std::size_t c = 0; c < solutions.size(); ++c) {
    Results one;
    if (results)
      add_fields(run, solutions[c].system, solutions[c].unknowns, {static_cast<double>(c + 1)}, Fields::All, one);
    all.push_back(recover_stress(run, solutions[c], results ? &one : nullptr));
    if (results) add_case(std::move(one), *results);
  }
  return all;
}

// What the solutions hold moves into the results.
void add_solutions(std::vector<StaticSolution>& solutions, Results& results) {
  std::vector<CaseResult> cases;
  if (!solutions[0].case_name.empty())
    for (const StaticSolution& solution : solutions) cases.push_back(case_result(solution));
  if (solutions.size() == 1) // of the only step
    for (std::size_t b = 0; b < results.parts.size(); ++b)
      results.parts[b].point_stress = std::move(solutions[0].bodies[b].points.stress);
  results.statics = std::move(solutions[0].result);
  results.statics->cases = std::move(cases);
}

// Of recovered stress at the surface.
std::size_t case_of_largest(std::span<const StressReport> stress) {
  const auto smaller = [](const StressReport& a, const StressReport& b) {
    return a.largest.von_mises < b.largest.von_mises;
  };
  return static_cast<std::size_t>(std::max_element(stress.begin(), stress.end(), smaller) - stress.begin());
}

std::string json_report(const AnalysisRun& run, const BodySystem& system, std::span<const StaticSolution> solutions,
                        std::span<const StressReport> stress) {
  io::JsonObject report;
  add_models(report, run, system);
  if (solutions[0].case_name.empty()) {
    report.add("statics", static_json(solutions[0], system));
    report.add("stress", stress_json(stress[0], solutions[0], system));
  } else {
    std::vector<io::JsonObject> cases;
    for (std::size_t c = 0; c < solutions.size(); ++c) {
      cases.push_back(static_json(solutions[c], system));
      cases.back().add("stress", stress_json(stress[c], solutions[c], system));
    }
    const CaseEnvelope envelope = envelope_of(solutions);
    report.add("cases", cases);
    const std::size_t surface = case_of_largest(stress);
    report.add("envelope", io::JsonObject()
                               .add("largest_surface_von_mises", stress[surface].largest.von_mises)
                               .add("largest_surface_von_mises_case", solutions[surface].case_name)
                               .add("largest_displacement", solutions[envelope.displacement].largest_displacement.value)
                               .add("largest_displacement_case", solutions[envelope.displacement].case_name)
                               .add("largest_von_mises", solutions[envelope.von_mises].largest_von_mises.value)
                               .add("largest_von_mises_case", solutions[envelope.von_mises].case_name));
  }
  add_end(report, run);
  return report.text();
}

std::string text_report(const AnalysisRun& run, const BodySystem& system, std::span<const StaticSolution> solutions,
                        std::span<const StressReport> stress) {
  TextReport head, end;
  add_models(head, run, system);
  add_end(end, run);
  const auto one = [&](std::size_t c) {
    return static_text(solutions[c], system) + stress_text(stress[c], solutions[c], system);
  };
  if (solutions[0].case_name.empty()) return head.text() + one(0) + end.text();
  std::string cases;
  for (std::size_t c = 0; c < solutions.size(); ++c)
    cases += fmt::format("case '{}'\n{}", solutions[c].case_name, one(c));
  const std::size_t surface = case_of_largest(stress);
  const PeakStress& peak = stress[surface].largest;
  return head.text() + cases + envelope_text(solutions, system) +
         fmt::format("  largest von Mises stress of the surface {:.6g} in case '{}' at ({:.6g}){}\n", peak.von_mises,
                     solutions[surface].case_name, fmt::join(peak.at, ", "), of_body(system, peak.body)) +
         end.text();
}

} // namespace

int static_command(AnalysisRun& run) {
  const BodySystem system = make_system(run.settings, run.models);
  warn(run, space_warnings(system));
  warn_of_joined_bodies(run, system);
  std::vector<StaticSolution> solutions;
  try {
    solutions = run_static_cases(run.settings, run.settings.statics, system);
  } catch (const NumericalError& error) {
    throw NumericalError(fmt::format("{}; {}", error.what(), numerical_advice(run.settings, run.models)));
  }
  for (const StaticSolution& solution : solutions) warn(run, solution.warnings);
  run.timings.insert(run.timings.end(), solutions[0].timings.begin(), solutions[0].timings.end());
  const bool writes = !run.settings.output.empty();
  Results results;
  if (writes) results = results_head(run, "static", system);
  Stopwatch watch(run.timings);
  const std::vector<StressReport> stress = recover_cases(run, solutions, writes ? &results : nullptr);
  watch.stage("stress");
  const std::string report = run.command.style == ReportStyle::Json ? json_report(run, system, solutions, stress)
                                                                    : text_report(run, system, solutions, stress);
  if (writes) {
    add_solutions(solutions, results);
    for (std::size_t c = 0; c < solutions.size(); ++c) {
      std::vector<ResultTable> tables = line_tables(stress[c], solutions[c].case_name);
      std::move(tables.begin(), tables.end(), std::back_inserter(results.tables));
    }
    write_outputs(run, results);
  }
  print_report(run, report);
  return io::exit_done;
}

} // namespace iga::solve
