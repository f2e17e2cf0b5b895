// igasolve eigen and timestep: modes or the largest eigenfrequency, as report and results file.
#include "format/io/run_tool.hpp"
#include "solver/analysis/eigen_analysis.hpp"
#include "solver/analysis/timestep_analysis.hpp"
#include "solver/mechanics/largest_eigenvalue.hpp"
#include "solver/report/analysis_report.hpp"
#include "solver/report/preload_report.hpp"

#include <numbers>

namespace iga::solve {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

const char* name_of(ModeKind kind) {
  return kind == ModeKind::Rigid ? "rigid" : kind == ModeKind::Mechanism ? "mechanism" : "elastic";
}

// Cycles per time; what rounding leaves of a rigid motion is no frequency.
double frequency(const ModeSet& modes, Eigen::Index m) {
  return modes.kind[static_cast<std::size_t>(m)] == ModeKind::Rigid
             ? 0
             : std::sqrt(std::max(modes.lambda[m], 0.0)) / two_pi;
}

// Where an estimate ends: a frequency that may be off by half tells nothing.
constexpr double largest_error = 0.5;

// Relative error of a frequency.
double frequency_error(const EigenOutcome& outcome, Eigen::Index m) {
  const bool is_elastic = outcome.modes.kind[static_cast<std::size_t>(m)] == ModeKind::Elastic;
  return is_elastic ? std::min(0.5 * (*outcome.lambda_error)[m] / outcome.modes.lambda[m], largest_error) : 0;
}

double corrected_frequency(const EigenOutcome& outcome, Eigen::Index m) {
  return frequency(outcome.modes, m) * (1 - frequency_error(outcome, m));
}

void add_participation(const Participation& p, EigenResult& eigen) {
  for (Eigen::Index m = 0; m < p.factors.rows(); ++m)
    for (Eigen::Index d = 0; d < 3; ++d) {
      eigen.participation.push_back(p.factors(m, d));
      eigen.rotation_participation.push_back(p.factors(m, 3 + d));
    }
  eigen.centre_of_mass = p.centre;
  eigen.total_mass = p.total.head<3>().mean();
  eigen.total_inertia = {p.total[3], p.total[4], p.total[5]};
}

Results mode_results(const AnalysisRun& run, const EigenOutcome& outcome) {
  const BodySystem& system = outcome.system;
  const ModeSet& modes = outcome.modes;
  Results results = results_head(run, "eigen", system);
  EigenResult eigen;
  eigen.mass = solve::name_of(run.settings.mass);
  if (outcome.preload) eigen.preload = outcome.preload->names;
  if (modes.sturm && modes.sturm->shift > 0) eigen.complete_below = std::sqrt(modes.sturm->shift) / two_pi;
  add_participation(outcome.participation, eigen);
  std::vector<double> steps;
  for (Eigen::Index m = 0; m < modes.lambda.size(); ++m) {
    eigen.frequencies.push_back(frequency(modes, m));
    eigen.omega_squared.push_back(modes.lambda[m]);
    eigen.residuals.push_back(modes.residual[m]);
    const ModeKind kind = modes.kind[static_cast<std::size_t>(m)];
    eigen.kind.push_back(kind == ModeKind::Rigid       ? EigenResult::Rigid
                         : kind == ModeKind::Mechanism ? EigenResult::Mechanism
                                                       : EigenResult::Elastic);
    if (system.size() == 1) {
      const Eigen::VectorXd all = system[0].space->expand(modes.vectors.col(m));
      eigen.modes.insert(eigen.modes.end(), all.data(), all.data() + all.size());
    }
    steps.push_back(static_cast<double>(m + 1));
  }
  results.eigen = std::move(eigen);
  add_fields(run, system, modes.vectors, steps, Fields::VonMises, results);
  return results;
}

io::JsonObject json_of(const SturmCount& count) {
  return io::JsonObject()
      .add("below_frequency", std::sqrt(std::max(count.shift, 0.0)) / two_pi)
      .add("expected", count.expected)
      .add("found", count.found);
}

// Shares of mass and moments of inertia that the modes move, and in brackets their sums from the first mode on.
void add_participation(TextReport& report, const EigenOutcome& outcome) {
  const Participation& p = outcome.participation;
  const Eigen::MatrixXd masses = p.effective_masses(), sums = p.summed_shares();
  report.row(
      "\neffective masses in % of the total (in brackets: summed up from the first mode), moments of inertia about "
      "the centre of mass ({:.6g})",
      fmt::join(p.centre, ", "));
  report.row("{:>6}  {:>12}{:>16}{:>16}{:>16}{:>16}{:>16}{:>16}", "mode", "frequency", "x", "y", "z", "about x",
             "about y", "about z");
  for (Eigen::Index m = 0; m < masses.rows(); ++m) {
    std::string cells;
    for (Eigen::Index d = 0; d < 6; ++d)
      cells +=
          fmt::format("{:>7.3f} ({:>6.2f})", p.total[d] > 0 ? 100 * masses(m, d) / p.total[d] : 0, 100 * sums(m, d));
    report.row("{:>6}  {:>12.6g}{}", m + 1, frequency(outcome.modes, m), cells);
  }
  std::string totals;
  for (Eigen::Index d = 0; d < 6; ++d) totals += fmt::format("{:>16.6g}", p.total[d]);
  report.row("{:>6}  {:>12}{}", "total", "", totals);
  const Eigen::Index last = sums.rows() - 1;
  report.row("these modes hold {:.3g}, {:.3g}, {:.3g} % of the mass along x, y, z; modes above them hold the rest{}",
             100 * sums(last, 0), 100 * sums(last, 1), 100 * sums(last, 2),
             outcome.regions.empty() ? "" : " (beside supports it hardly moves)");
}

io::JsonObject json_of(const Participation& p) {
  const auto rows = [](const Eigen::MatrixXd& table) {
    std::vector<std::vector<double>> all;
    for (Eigen::Index m = 0; m < table.rows(); ++m) {
      const Eigen::VectorXd row = table.row(m);
      all.emplace_back(row.data(), row.data() + row.size());
    }
    return all;
  };
  return io::JsonObject()
      .add("centre_of_mass", p.centre)
      .add("total", std::vector<double>(p.total.begin(), p.total.end()))
      .add("factors", rows(p.factors))
      .add("effective_masses", rows(p.effective_masses()))
      .add("summed_shares", rows(p.summed_shares()));
}

std::string modes_text(const AnalysisRun& run, const EigenOutcome& outcome) {
  const ModeSet& modes = outcome.modes;
  TextReport report;
  add_models(report, run, outcome.system);
  add_regions(report, outcome.regions);
  add_ties(report, outcome.ties);
  add_attached(report, outcome.attached);
  if (outcome.preload) {
    report.line("prestress", "modes about the state under the loads: (K + K_G) phi = omega^2 M phi");
    add_preload(report, "preload", run, outcome.system, *outcome.preload);
  } else if (const StaticSettings& s = run.settings.statics; !s.loads.empty() || !s.bolts.empty() || s.temperature) {
    report.line("loads",
                "of the run file: not in these modes; [eigen] prestress = true gives those of the loaded part");
  }
  report.line("mass", "{:.8g} ({}); {} {}", outcome.mass, solve::name_of(run.settings.mass), outcome.bodies,
              outcome.bodies == 1 ? "body" : "separate bodies");
  report.line("modes", "{} rigid, {} elastic{}", modes.rigid, modes.elastic,
              modes.mechanisms ? fmt::format(", {} mechanisms (no stiffness, no rigid motion)", modes.mechanisms) : "");
  if (!outcome.preload) report.line("solver", "{}", solve::text_of(outcome.solver));
  if (modes.sturm)
    report.line("complete", "{} modes of this model lie below {:.6g} by a Sturm count, {} were found",
                modes.sturm->expected, std::sqrt(std::max(modes.sturm->shift, 0.0)) / two_pi, modes.sturm->found);
  else if (modes.searched_again)
    report.line("complete", "a second search found no other mode of this model (no proof; --sturm gives one)");
  else if (outcome.solver.multigrid)
    report.line("complete",
                "no count was made, residuals are shown; --solver direct --sturm proves that no mode is missing");
  report.row("");
  const bool errors = outcome.lambda_error.has_value();
  report.row("{:>6}  {:>16}  {:<9}  {:>8}{}", "mode", "frequency", "kind", "residual",
             errors ? "     error         corrected" : "");
  for (Eigen::Index m = 0; m < modes.lambda.size(); ++m) {
    const ModeKind kind = modes.kind[static_cast<std::size_t>(m)];
    report.row(
        "{:>6}  {:>16.9g}  {:<9}  {:>8.1e}{}", m + 1, frequency(modes, m), name_of(kind), modes.residual[m],
        errors && kind == ModeKind::Elastic
            ? fmt::format("  {:>6.2g} %  {:>16.9g}", 100 * frequency_error(outcome, m), corrected_frequency(outcome, m))
            : "");
  }
  if (errors)
    report.row(
        "\nerror: estimated share by which the frequency of this grid lies too high, from what the mode leaves of the "
        "equations; corrected: less that.\n       Not in it: facets instead of the exact part, the material, the "
        "supports. At sharp re-entrant edges the error is two to four times larger.");
  add_participation(report, outcome);
  report.row("");
  add_end(report, run);
  return report.text();
}

std::string modes_json(const AnalysisRun& run, const EigenOutcome& outcome) {
  const ModeSet& modes = outcome.modes;
  std::vector<double> frequencies, residuals, omega_squared;
  for (Eigen::Index m = 0; m < modes.lambda.size(); ++m) {
    frequencies.push_back(frequency(modes, m));
    residuals.push_back(modes.residual[m]);
    omega_squared.push_back(modes.lambda[m]);
  }
  io::JsonObject report, factor;
  add_models(report, run, outcome.system);
  report.add("mass_type", solve::name_of(run.settings.mass)).add("mass", outcome.mass).add("bodies", outcome.bodies);
  report.add("supports", json_of(outcome.regions)).add("constraints", outcome.constraints);
  if (!outcome.ties.empty()) report.add("ties", json_of(outcome.ties));
  add_attached(report, outcome.attached);
  if (outcome.preload) report.add("preload", json_of(run, outcome.system, *outcome.preload));
  report.add("prestress", outcome.preload.has_value());
  report.add("rigid_modes", modes.rigid).add("mechanisms", modes.mechanisms).add("elastic_modes", modes.elastic);
  report.add("frequencies", frequencies).add("omega_squared", omega_squared).add("residuals", residuals);
  if (modes.sturm) report.add("sturm", json_of(*modes.sturm));
  if (outcome.lambda_error) {
    std::vector<double> errors, corrected;
    for (Eigen::Index m = 0; m < modes.lambda.size(); ++m) {
      errors.push_back(frequency_error(outcome, m));
      corrected.push_back(corrected_frequency(outcome, m));
    }
    report.add("error_estimate", errors).add("corrected_frequencies", corrected);
  }
  report.add("participation", json_of(outcome.participation));
  factor.add("nonzeros", modes.factor.nonzeros).add("flops", modes.factor.flops).add("bytes", modes.factor.bytes);
  report.add("factor", factor).add("solves", modes.solves).add("solver", json_of(outcome.solver));
  add_end(report, run);
  return report.text();
}

std::string largest_text(const AnalysisRun& run, const EigenOutcome& outcome) {
  TextReport report;
  add_models(report, run, outcome.system);
  add_regions(report, outcome.regions);
  add_ties(report, outcome.ties);
  add_attached(report, outcome.attached);
  report.line("mass", "{:.8g} ({})", outcome.mass, solve::name_of(run.settings.mass));
  report.line("omega_max", "{:.9g} rad/time (residual {:.1e}), frequency {:.9g}", outcome.omega_max,
              outcome.omega_max_residual, outcome.omega_max / two_pi);
  report.line("dt_crit", "{:.9g} = 2 / omega_max", 2 / outcome.omega_max);
  if (outcome.element)
    report.line("bound", "{:.9g} rad/time from the spans alone (set by span {}{})", outcome.element->omega,
                outcome.element->span, of_body(outcome.system, outcome.element->body));
  add_end(report, run);
  return report.text();
}

std::string largest_json(const AnalysisRun& run, const EigenOutcome& outcome) {
  io::JsonObject report;
  add_models(report, run, outcome.system);
  report.add("mass_type", solve::name_of(run.settings.mass)).add("mass", outcome.mass);
  report.add("supports", json_of(outcome.regions));
  if (!outcome.ties.empty()) report.add("ties", json_of(outcome.ties));
  add_attached(report, outcome.attached);
  report.add("omega_max", outcome.omega_max).add("residual", outcome.omega_max_residual);
  report.add("omega_max_bound", omega_safety * outcome.omega_max).add("dt_crit", 2 / outcome.omega_max);
  if (outcome.element) report.add("omega_spans", outcome.element->omega).add("bound_span", outcome.element->span);
  add_end(report, run);
  return report.text();
}

std::string timestep_text(const AnalysisRun& run, const TimestepOutcome& t) {
  TextReport report;
  add_models(report, run, t.system);
  add_regions(report, t.regions);
  add_ties(report, t.ties);
  add_attached(report, t.attached);
  report.line("mass", "{:.8g} ({})", t.mass, solve::name_of(run.settings.mass));
  report.line("omega_max", "{:.6g} rad/time by Lanczos to 1e-3 ({} products)", t.omega_max, t.products);
  report.line("dt_crit", "{:.6g} = 2 / omega_max", t.dt_crit);
  report.line("dt_safe", "{:.6g} with 1 % on omega_max; explicit runs take 0.9 of it", t.dt_safe);
  if (t.element)
    report.line("dt_spans", "{:.6g} from the spans alone (a bound; set by span {}{})", t.dt_element, t.element->span,
                of_body(t.system, t.element->body));
  add_end(report, run);
  return report.text();
}

std::string timestep_json(const AnalysisRun& run, const TimestepOutcome& t) {
  io::JsonObject report;
  add_models(report, run, t.system);
  report.add("mass_type", solve::name_of(run.settings.mass)).add("mass", t.mass).add("supports", json_of(t.regions));
  if (!t.ties.empty()) report.add("ties", json_of(t.ties));
  add_attached(report, t.attached);
  report.add("omega_max", t.omega_max).add("omega_max_bound", t.omega_max_bound);
  report.add("dt_crit", t.dt_crit).add("dt_safe", t.dt_safe).add("products", t.products);
  if (t.element)
    report.add("omega_spans", t.element->omega).add("dt_spans", t.dt_element).add("bound_span", t.element->span);
  add_end(report, run);
  return report.text();
}

void take(AnalysisRun& run, const Timings& timings, const std::vector<std::string>& warnings) {
  run.timings.insert(run.timings.end(), timings.begin(), timings.end());
  warn(run, warnings);
}

} // namespace

int eigen_command(AnalysisRun& run) {
  const EigenOutcome outcome = analyse_modes(run.settings, run.settings.eigen, run.models);
  take(run, outcome.timings, outcome.warnings);
  warn_of_joined_bodies(run, outcome.system);
  if (!run.settings.output.empty() && !run.settings.eigen.largest) {
    Results results = mode_results(run, outcome);
    write_outputs(run, results);
  }
  const bool json = run.command.style == ReportStyle::Json;
  if (run.settings.eigen.largest)
    print_report(run, json ? largest_json(run, outcome) : largest_text(run, outcome));
  else
    print_report(run, json ? modes_json(run, outcome) : modes_text(run, outcome));
  return io::exit_done;
}

int timestep_command(AnalysisRun& run) {
  const TimestepOutcome outcome = analyse_timestep(run.settings, run.models);
  take(run, outcome.timings, outcome.warnings);
  warn_of_joined_bodies(run, outcome.system);
  print_report(run, run.command.style == ReportStyle::Json ? timestep_json(run, outcome) : timestep_text(run, outcome));
  return io::exit_done;
}

} // namespace iga::solve
