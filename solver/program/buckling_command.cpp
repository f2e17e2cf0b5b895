// igasolve buckling: factors on the loads and the shapes that go with them, as report and results file.
#include "format/io/run_tool.hpp"
#include "solver/analysis/buckling_analysis.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/report/preload_report.hpp"

namespace iga::solve {

namespace {

// Strain of the loads at a factor from which the linear theory is doubtful, and the part rather yields.
constexpr double doubtful_strain = 0.02;

Eigen::MatrixXd all_vectors(const BucklingOutcome& outcome) {
  const Eigen::MatrixXd& positive = outcome.positive.vectors;
  if (!outcome.negative) return positive;
  const Eigen::MatrixXd& negative = outcome.negative->vectors;
  Eigen::MatrixXd all(positive.rows(), positive.cols() + negative.cols());
  if (positive.cols() > 0) all.leftCols(positive.cols()) = positive;
  if (negative.cols() > 0) all.rightCols(negative.cols()) = negative;
  return all;
}

void append(std::vector<double>& values, const Eigen::VectorXd& more) {
  values.insert(values.end(), more.data(), more.data() + more.size());
}

BucklingResult numbers_of(const BucklingOutcome& outcome) {
  BucklingResult result;
  if (outcome.positive.count) result.complete_below = outcome.positive.count->at;
  result.growing = outcome.growing.names;
  if (outcome.constant) result.constant = outcome.constant->names;
  append(result.factors, outcome.positive.factor);
  append(result.residuals, outcome.positive.residual);
  if (outcome.negative) {
    append(result.factors, outcome.negative->factor);
    append(result.residuals, outcome.negative->residual);
  }
  return result;
}

Results buckling_results(const AnalysisRun& run, const BucklingOutcome& outcome) {
  const BodySystem& system = outcome.system;
  const Eigen::MatrixXd vectors = all_vectors(outcome);
  Results results = results_head(run, "buckling", system);
  BucklingResult buckling = numbers_of(outcome);
  std::vector<double> steps;
  for (Eigen::Index m = 0; m < vectors.cols(); ++m) {
    if (system.size() == 1) {
      const Eigen::VectorXd all = system[0].space->expand(vectors.col(m));
      append(buckling.modes, all);
    }
    steps.push_back(static_cast<double>(m + 1));
  }
  results.buckling = std::move(buckling);
  add_fields(run, system, vectors, steps, Fields::VonMises, results);
  return results;
}

// Factors of one sign: what was found, how complete.
void add_sign(TextReport& report, const char* what, const BucklingOutcome& outcome, const BucklingModes& modes) {
  if (modes.factor.size() == 0)
    report.line("found", "no {} factor up to {:.4g}: there the strains of the loads themselves would reach {:g} %",
                what, outcome.limit, 100 * largest_buckling_strain);
  if (modes.count)
    report.line("complete", "{} {} factors of this model lie within {:.6g} by a Sturm count, {} were found",
                modes.count->expected, what, modes.count->at, modes.count->found);
  else if (modes.searched_again)
    report.line("complete", "a second search found no other {} factor of this model (no proof; --sturm gives one)",
                what);
}

std::string text_report(const AnalysisRun& run, const BucklingOutcome& outcome) {
  TextReport report;
  add_models(report, run, outcome.system);
  add_regions(report, outcome.regions);
  add_attached(report, outcome.attached);
  add_ties(report, outcome.ties);
  if (outcome.constraints > 0) report.line("constraints", "{} by multipliers", outcome.constraints);
  add_preload(report, "loads", run, outcome.system, outcome.growing);
  if (outcome.constant) add_preload(report, "constant", run, outcome.system, *outcome.constant);
  report.line("factor of K", "{:.3g} nonzeros, {:.3g} Gflop, {:.3g} GiB", static_cast<double>(outcome.cost.nonzeros),
              1e-9 * outcome.cost.flops, outcome.cost.bytes / (1024.0 * 1024 * 1024));
  add_sign(report, "positive", outcome, outcome.positive);
  if (outcome.negative) add_sign(report, "negative", outcome, *outcome.negative);
  const BucklingResult numbers = numbers_of(outcome);
  report.row("");
  if (!numbers.factors.empty())
    report.row("{:>6}  {:>16}  {:>8}  {:>16}", "mode", "factor", "residual", "von Mises stress");
  for (std::size_t m = 0; m < numbers.factors.size(); ++m)
    report.row("{:>6}  {:>16.9g}  {:>8.1e}  {:>16.6g}", m + 1, numbers.factors[m], numbers.residuals[m],
               std::abs(numbers.factors[m]) * outcome.growing.solution.largest_von_mises.value);
  report.row(
      "\nfactor: times {} at which the part buckles{}; negative ones: of the reversed loads.\n"
      "        Real parts are not perfectly straight and buckle earlier; on coarse grids factors come out too high: "
      "give "
      "walls that bend two spans and more.\n"
      "von Mises stress: the largest of these loads times the factor; where it is above yield the part yields before "
      "it buckles.",
      outcome.constant ? "the growing loads" : "all loads", outcome.constant ? " while the constant ones act" : "");
  report.row("");
  add_end(report, run);
  return report.text();
}

io::JsonObject json_of(const BucklingCount& count) {
  return io::JsonObject().add("within", count.at).add("expected", count.expected).add("found", count.found);
}

std::string json_report(const AnalysisRun& run, const BucklingOutcome& outcome) {
  const BucklingResult numbers = numbers_of(outcome);
  std::vector<double> stress;
  for (const double factor : numbers.factors)
    stress.push_back(std::abs(factor) * outcome.growing.solution.largest_von_mises.value);
  io::JsonObject report, factor;
  add_models(report, run, outcome.system);
  report.add("bodies", outcome.bodies)
      .add("supports", json_of(outcome.regions))
      .add("constraints", outcome.constraints);
  if (!outcome.ties.empty()) report.add("ties", json_of(outcome.ties));
  add_attached(report, outcome.attached);
  report.add("factors", numbers.factors).add("residuals", numbers.residuals).add("von_mises_at_factors", stress);
  report.add("searched_within", outcome.limit);
  if (outcome.positive.count) report.add("sturm", json_of(*outcome.positive.count));
  if (outcome.negative && outcome.negative->count) report.add("sturm_negative", json_of(*outcome.negative->count));
  report.add("growing", numbers.growing).add("constant", numbers.constant);
  report.add("preload", json_of(run, outcome.system, outcome.growing));
  if (outcome.constant) report.add("constant_preload", json_of(run, outcome.system, *outcome.constant));
  factor.add("nonzeros", outcome.cost.nonzeros).add("flops", outcome.cost.flops).add("bytes", outcome.cost.bytes);
  report.add("factor_of_K", factor);
  add_end(report, run);
  return report.text();
}

std::vector<std::string> strain_warning(const BucklingOutcome& outcome) {
  double least = 0;
  for (const BucklingModes* modes : {&outcome.positive, outcome.negative ? &*outcome.negative : nullptr})
    if (modes && modes->factor.size() > 0)
      least = least == 0 ? std::abs(modes->factor[0]) : std::min(least, std::abs(modes->factor[0]));
  const double strain = least * outcome.growing.largest_strain;
  if (!(strain > doubtful_strain)) return {};
  return {
      fmt::format("at the least factor the loads themselves strain the part by up to {:.2g} %: linear buckling holds "
                  "for slender parts, whose strains are small; this one yields, or a peak of stress buckles alone",
                  100 * strain)};
}

} // namespace

int buckling_command(AnalysisRun& run) {
  const BucklingOutcome outcome = analyse_buckling(run.settings, run.settings.buckling, run.models);
  run.timings.insert(run.timings.end(), outcome.timings.begin(), outcome.timings.end());
  warn(run, outcome.warnings);
  warn(run, strain_warning(outcome));
  warn_of_joined_bodies(run, outcome.system);
  if (!run.settings.output.empty()) {
    Results results = buckling_results(run, outcome);
    write_outputs(run, results);
  }
  print_report(run, run.command.style == ReportStyle::Json ? json_report(run, outcome) : text_report(run, outcome));
  return io::exit_done;
}

} // namespace iga::solve
