#include "solver/report/response_report.hpp"

#include <cmath>
#include <numbers>

namespace iga::solve {

namespace {

constexpr double two_pi = 2 * std::numbers::pi;

std::string damping_text(const DampingSettings& d) {
  if (d.table) return "ratio by frequency";
  if (!d.mode_ratios.empty()) return "ratio by mode";
  if (d.alpha > 0 || d.beta > 0) return fmt::format("Rayleigh, C = {:g} M + {:g} K", d.alpha, d.beta);
  if (d.structural > 0) return fmt::format("structural, loss factor {:g}", d.structural);
  return fmt::format("ratio {:g} of all modes", d.ratio);
}

std::vector<double> values(const auto& vector) {
  return {vector.data(), vector.data() + vector.size()};
}

const char* moving(const ResponseSystem& system) {
  return system.base_direction ? "displacement relative to the base" : "displacement";
}

const char* acceleration(const ResponseSystem& system) {
  return system.base_direction ? "absolute acceleration" : "acceleration";
}

} // namespace

void warn_of_range(AnalysisRun& run, const ResponseSystem& system, double highest) {
  std::vector<std::string> warnings;
  const ModalBasis& basis = system.basis;
  if (highest > basis.highest_frequency())
    warnings.push_back(fmt::format("the modes reach up to {:.6g}, the excitation up to {:.6g}: modes in between are "
                                   "missing from the answer; take more (modes_below in [eigen])",
                                   basis.highest_frequency(), highest));
  if (basis.rigid > 0 && system.base_direction)
    warnings.push_back(fmt::format(
        "the supports leave {} rigid motions free: along these the base does not move the part", basis.rigid));
  warn(run, warnings);
}

void add_response(TextReport& report, const AnalysisRun& run, const ResponseSystem& system) {
  add_models(report, run, system.system);
  add_regions(report, system.regions);
  add_ties(report, system.ties);
  add_attached(report, system.attached);
  report.line("mass", "{:.8g} ({})", system.mass, name_of(run.settings.mass));
  const ModalBasis& basis = system.basis;
  report.line("modes", "{}{} elastic{}{}", basis.rigid > 0 ? fmt::format("{} rigid, ", basis.rigid) : "", basis.elastic,
              basis.elastic > 0
                  ? fmt::format(", {:.6g} … {:.6g}", basis.omega(basis.rigid) / two_pi, basis.highest_frequency())
                  : "",
              system.sturm ? "; none below is missing (Sturm count)" : "");
  std::string residual;
  for (Eigen::Index j = basis.modes(); j < basis.size(); ++j)
    residual += fmt::format("{}{:.6g}", residual.empty() ? "" : ", ", basis.omega(j) / two_pi);
  report.line("residual", "{}",
              basis.residual > 0 ? fmt::format("{} vector(s) for what modes above leave, pseudo-frequencies {}",
                                               basis.residual, residual)
              : run.settings.response.residual_vectors ? "no vectors needed: the modes hold the static answer"
                                                       : "no vectors: modes above are left out, statics too");
  report.line("damping", "{}", damping_text(run.settings.response.damping));
  for (std::size_t k = 0; k < system.excitations.size(); ++k) {
    const double share = system.load_shares[static_cast<Eigen::Index>(k)];
    report.line("excitation", "{}{}", system.excitations[k].name,
                run.settings.response.residual_vectors
                    ? fmt::format(": the modes hold {:.4g} % of its static strain energy, residual vectors the rest",
                                  100 * share)
                    : "");
  }
  if (system.base_direction)
    report.line("base", "along ({:.4g}); effective mass of the modes {:.4g} % of the total",
                fmt::join(*system.base_direction, ", "), 100 * system.base_mass_share);
}

void add_response(io::JsonObject& report, const AnalysisRun& run, const ResponseSystem& system) {
  add_models(report, run, system.system);
  report.add("supports", json_of(system.regions)).add("mass", system.mass);
  if (!system.ties.empty()) report.add("ties", json_of(system.ties));
  add_attached(report, system.attached);
  const ModalBasis& basis = system.basis;
  std::vector<double> frequencies, ratios;
  for (Eigen::Index j = 0; j < basis.size(); ++j) {
    frequencies.push_back(basis.omega(j) / two_pi);
    ratios.push_back(damping_ratio(system.damping, basis, j));
  }
  report.add("rigid_modes", basis.rigid).add("elastic_modes", basis.elastic).add("residual_vectors", basis.residual);
  report.add("frequencies", frequencies).add("damping_ratios", ratios);
  std::vector<io::JsonObject> excitations;
  for (std::size_t k = 0; k < system.excitations.size(); ++k)
    excitations.push_back(io::JsonObject()
                              .add("name", system.excitations[k].name)
                              .add("modes_share_of_static_energy", system.load_shares[static_cast<Eigen::Index>(k)]));
  report.add("excitations", excitations);
  if (system.base_direction) report.add("base_effective_mass_share", system.base_mass_share);
}

void add_peaks(TextReport& report, const ResponseSystem& system, const std::vector<ProbePeaks>& peaks,
               const char* where) {
  for (const ProbePeaks& p : peaks)
    report.line("probe", "'{}': largest {} {:.6g} {} {:.6g}\n{} {:.6g} {} {:.6g}\nvon Mises stress {:.6g} {} {:.6g}",
                p.probe, moving(system), p.relative.value, where, p.relative.at, acceleration(system),
                p.acceleration.value, where, p.acceleration.at, p.von_mises.value, where, p.von_mises.at);
}

std::vector<io::JsonObject> json_of(const ResponseSystem&, const std::vector<ProbePeaks>& peaks, const char* where) {
  std::vector<io::JsonObject> list;
  for (const ProbePeaks& p : peaks) {
    const auto peak = [&](const Peak& one) { return io::JsonObject().add("value", one.value).add(where, one.at); };
    list.push_back(io::JsonObject()
                       .add("name", p.probe)
                       .add("relative", peak(p.relative))
                       .add("acceleration", peak(p.acceleration))
                       .add("von_mises", peak(p.von_mises)));
  }
  return list;
}

void add_rms(TextReport& report, const ResponseSystem& system, const std::vector<ProbeRms>& rms) {
  for (const ProbeRms& p : rms) {
    report.line(
        "probe",
        "'{}': 1 sigma (three times as much: 3 sigma), apparent frequency\n{} {:.6g}, {:.6g}\n{} {:.6g}, {:.6g}",
        p.probe, moving(system), fmt::join(values(p.relative), "  "), fmt::join(values(p.relative_frequency), "  "),
        acceleration(system), fmt::join(values(p.acceleration), "  "),
        fmt::join(values(p.acceleration_frequency), "  "));
    report.line("", "stress xx yy zz xy yz zx {:.6g}\nvon Mises stress {:.6g} (3 sigma {:.6g})",
                fmt::join(values(p.stress), "  "), p.von_mises, 3 * p.von_mises);
  }
}

std::vector<io::JsonObject> json_of(const ResponseSystem&, const std::vector<ProbeRms>& rms) {
  std::vector<io::JsonObject> list;
  for (const ProbeRms& p : rms)
    list.push_back(io::JsonObject()
                       .add("name", p.probe)
                       .add("relative", values(p.relative))
                       .add("relative_frequency", values(p.relative_frequency))
                       .add("acceleration", values(p.acceleration))
                       .add("acceleration_frequency", values(p.acceleration_frequency))
                       .add("stress", values(p.stress))
                       .add("stress_frequency", values(p.stress_frequency))
                       .add("von_mises", p.von_mises));
  return list;
}

} // namespace iga::solve
