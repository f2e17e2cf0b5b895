#include "solver/response/harmonic.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

constexpr double two_pi = 2 * std::numbers::pi;
// Below it a resonance has no width to speak of: its answer is infinite, and no frequency beside it tells more than
// another.
constexpr double least_ratio = 1e-7;

// Factors of all excitations at a frequency: e^(i phase) · spectrum · unit.
VectorXcd factors(const ResponseSystem& system, double frequency) {
  VectorXcd all(static_cast<Index>(system.excitations.size()));
  for (std::size_t k = 0; k < system.excitations.size(); ++k) {
    const Excitation& e = system.excitations[k];
    const double amplitude = e.variation.spectrum ? e.variation.spectrum->linear(frequency) : e.is_base ? 0 : 1;
    all[static_cast<Index>(k)] = std::polar(1.0, e.variation.phase * std::numbers::pi / 180) * (amplitude * e.unit);
  }
  return all;
}

void need_spectra(const ResponseSystem& system, double from, double to) {
  for (const Excitation& e : system.excitations) {
    const auto& spectrum = e.variation.spectrum;
    if (e.is_base && !spectrum)
      throw InputError(
          fmt::format("{}: missing; give spectrum = … in [base], the acceleration's amplitude as a number, "
                      "[[frequency, amplitude], …] or a file",
                      e.variation.where));
    if (spectrum && !spectrum->is_constant() && (from < spectrum->x.front() || to > spectrum->x.back()))
      throw InputError(fmt::format("{}: the spectrum holds {:.6g} … {:.6g}, but the run goes from {:.6g} to {:.6g}; "
                                   "extend it, or change from and to in [harmonic]",
                                   spectrum->where, spectrum->x.front(), spectrum->x.back(), from, to));
  }
}

std::vector<double> spread(double from, double to, int points) {
  std::vector<double> all;
  const bool logarithmic = from > 0 && to >= 10 * from;
  for (int k = 0; k < points; ++k) {
    const double share = static_cast<double>(k) / (points - 1);
    all.push_back(logarithmic ? from * std::pow(to / from, share) : from + share * (to - from));
  }
  all.back() = to;
  return all;
}

} // namespace

MatrixXcd modal_response(const ModalBasis& basis, const ModalDamping& damping, double frequency,
                         const MatrixXcd& modal_loads) {
  const double omega = two_pi * frequency;
  MatrixXcd q(modal_loads.rows(), modal_loads.cols());
  for (Index j = 0; j < q.rows(); ++j) {
    const std::complex<double> stiffness(basis.lambda[j] - omega * omega,
                                         basis.lambda[j] * damping.structural + omega * damping.c[j]);
    q.row(j) = modal_loads.row(j) / stiffness;
  }
  return q;
}

std::vector<double> response_frequencies(const ModalBasis& basis, const ModalDamping& damping, double from, double to,
                                         int points, const std::vector<double>& more) {
  std::vector<double> all = more;
  if (to > from) {
    const std::vector<double> even = spread(from, to, points);
    all.insert(all.end(), even.begin(), even.end());
  }
  for (Index j = basis.rigid; j < basis.modes(); ++j) {
    const double f = basis.omega(j) / two_pi, half = damping_ratio(damping, basis, j) * f;
    if (half < least_ratio * f) continue;
    for (int degrees = -80; degrees <= 80; degrees += 10) {
      const double at = f + half * std::tan(degrees * std::numbers::pi / 180);
      if (at >= from && at <= to) all.push_back(at);
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<std::string> undamped_resonances(const ResponseSystem& system, const HarmonicResponse& response) {
  std::vector<std::string> warnings;
  for (Index j = system.basis.rigid; j < system.basis.modes(); ++j) {
    const double f = system.basis.omega(j) / two_pi;
    if (f >= response.frequencies.front() && f <= response.frequencies.back() &&
        damping_ratio(system.damping, system.basis, j) < least_ratio)
      warnings.push_back(fmt::format("the mode at {:.6g} has no damping: at its resonance the answer is infinite, and "
                                     "largest values beside it mean nothing",
                                     f));
  }
  return warnings;
}

std::pair<double, double> harmonic_range(const ResponseSettings& settings) {
  const HarmonicSettings& h = settings.harmonic;
  std::optional<double> from = h.from, to = h.to;
  const auto widen = [](std::optional<double>& a, double value, bool up) {
    a = !a ? value : up ? std::max(*a, value) : std::min(*a, value);
  };
  if (!from && !to) {
    std::vector<const NumberCurve*> spectra;
    if (settings.base && settings.base->acceleration.spectrum)
      spectra.push_back(&*settings.base->acceleration.spectrum);
    for (const Variation& load : settings.loads)
      if (load.spectrum) spectra.push_back(&*load.spectrum);
    for (const NumberCurve* spectrum : spectra)
      if (!spectrum->is_constant()) {
        widen(from, spectrum->x.front(), false);
        widen(to, spectrum->x.back(), true);
      }
    for (const auto* list : {&h.frequencies, &h.fields})
      for (const double f : *list) {
        widen(from, f, false);
        widen(to, f, true);
      }
  }
  if (!from || !to)
    throw InputError(
        "[harmonic]: no range of frequencies; give from and to, frequencies = […], or a table as spectrum");
  return {*from, *to};
}

HarmonicResponse harmonic_response(const ResponseSystem& system, const ResponseSettings& settings) {
  const auto [from, to] = harmonic_range(settings);
  HarmonicResponse response;
  response.frequencies = response_frequencies(system.basis, system.damping, from, to, settings.harmonic.points,
                                              settings.harmonic.frequencies);
  response.fields = settings.harmonic.fields;
  response.frequencies.insert(response.frequencies.end(), response.fields.begin(), response.fields.end());
  std::sort(response.frequencies.begin(), response.frequencies.end());
  response.frequencies.erase(std::unique(response.frequencies.begin(), response.frequencies.end()),
                             response.frequencies.end());
  need_spectra(system, response.frequencies.front(), response.frequencies.back());
  if (response.frequencies.front() == 0 && (system.basis.rigid > 0 || system.base_direction))
    throw InputError(fmt::format("[harmonic]: frequency 0: {}; begin above 0",
                                 system.base_direction ? "a base that accelerates for ever has no amplitude"
                                                       : "the part is not held and moves away"));
  const auto count = static_cast<Index>(response.frequencies.size());
  response.modal.resize(system.basis.size(), count);
  response.base = VectorXcd::Zero(count);
  const auto at = [&](double frequency) {
    const MatrixXcd load = system.modal_loads * factors(system, frequency);
    return VectorXcd(modal_response(system.basis, system.damping, frequency, load).col(0));
  };
  double largest = -1, peak = 0;
  for (Index k = 0; k < count; ++k) {
    const double frequency = response.frequencies[static_cast<std::size_t>(k)];
    response.modal.col(k) = at(frequency);
    if (!response.modal.col(k).allFinite())
      throw InputError(
          fmt::format("[harmonic]: at {:.9g} the answer is infinite: an undamped resonance; give damping", frequency));
    if (system.base_direction) response.base[k] = factors(system, frequency)[system.modal_loads.cols() - 1];
    const double energy = system.basis.lambda.dot(response.modal.col(k).cwiseAbs2());
    if (energy > largest) {
      largest = energy;
      peak = frequency;
    }
  }
  if (response.fields.empty()) response.fields = {peak};
  std::sort(response.fields.begin(), response.fields.end());
  response.field_modal.resize(system.basis.size(), static_cast<Index>(response.fields.size()));
  for (std::size_t k = 0; k < response.fields.size(); ++k)
    response.field_modal.col(static_cast<Index>(k)) = at(response.fields[k]);
  return response;
}

} // namespace iga::solve
