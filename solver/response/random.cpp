#include "solver/response/random.hpp"

#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/response/harmonic.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double two_pi = 2 * std::numbers::pi;
constexpr double least_ratio = 1e-7; // a resonance narrower than this is none that anybody has measured

// Gauss–Legendre on [-1, 1]: abscissae above 0 and their weights (Abramowitz & Stegun 1964, table 25.4).
constexpr std::array<std::pair<double, double>, 5> gauss{{{0.148874338981631211, 0.295524224714752870},
                                                          {0.433395394129247191, 0.269266719309996355},
                                                          {0.679409568299024406, 0.219086362515982044},
                                                          {0.865063366688984511, 0.149451349150580593},
                                                          {0.973906528517171720, 0.066671344308688138}}};

std::vector<const NumberCurve*> densities(const ResponseSettings& settings) {
  std::vector<const NumberCurve*> all;
  if (settings.base && settings.base->acceleration.psd) all.push_back(&*settings.base->acceleration.psd);
  for (const Variation& load : settings.loads)
    if (load.psd) all.push_back(&*load.psd);
  return all;
}

std::vector<double> pieces(const ResponseSystem& system, double from, double to) {
  std::vector<double> ends{from, to};
  const auto add = [&](double f) {
    if (f > from && f < to) ends.push_back(f);
  };
  for (double f = to / 2; f > std::max(from, to * 1e-12); f /= 2) add(f);
  for (const Excitation& e : system.excitations)
    if (e.variation.psd)
      for (const double f : e.variation.psd->x) add(f);
  const ModalBasis& basis = system.basis;
  for (Index j = basis.rigid; j < basis.size(); ++j) {
    const double f = basis.omega(j) / two_pi, half = damping_ratio(system.damping, basis, j) * f;
    add(f);
    for (double way = half; way < f; way *= 2)
      for (const double at : {f - way, f + way}) add(at);
    for (double at = 2 * f; at < to; at *= 2) add(at);
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

// Absolute accelerations of all probes, relative displacements and modal amplitudes of one excitation's unit.
struct Answer {
  VectorXcd modal, acceleration;
};

Answer answer(const ResponseSystem& system, std::size_t k, double frequency) {
  const MatrixXcd load = system.modal_loads.col(static_cast<Index>(k)) * system.excitations[k].unit;
  Answer a;
  a.modal = modal_response(system.basis, system.damping, frequency, load).col(0);
  const double omega = two_pi * frequency;
  a.acceleration = -omega * omega * (system.observed.displacement * a.modal);
  if (system.excitations[k].is_base) a.acceleration += system.base_vector() * system.excitations[k].unit;
  return a;
}

void need_damping(const ResponseSystem& system, double from, double to) {
  const ModalBasis& basis = system.basis;
  for (Index j = basis.rigid; j < basis.modes(); ++j) {
    const double f = basis.omega(j) / two_pi;
    if (f >= from && f <= to && damping_ratio(system.damping, basis, j) < least_ratio)
      throw InputError(
          fmt::format("[damping]: the mode at {:.6g} has a damping ratio of {:.2g}: its answer to a random "
                      "excitation is infinite or nearly so; give one above {:g}",
                      f, damping_ratio(system.damping, basis, j), least_ratio));
  }
  if (basis.rigid > 0 && from == 0)
    throw InputError("[random]: the part is not held: its answer to frequencies from 0 on is infinite; give from = …");
}

void integrate(const ResponseSystem& system, RandomResponse& response) {
  const Index size = system.basis.size(), rows = system.observed.displacement.rows();
  response.covariance = response.rates = MatrixXd::Zero(size, size);
  response.acceleration = response.jerk = VectorXd::Zero(rows);
  const std::vector<double> ends = pieces(system, response.from, response.to);
  MatrixXd columns(size, 4 * gauss.size()), rates(size, 4 * gauss.size());
  for (std::size_t k = 0; k < system.excitations.size(); ++k) {
    const Excitation& e = system.excitations[k];
    if (!e.variation.psd) continue;
    for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
      const double middle = (ends[piece] + ends[piece + 1]) / 2, half = (ends[piece + 1] - ends[piece]) / 2;
      Index column = 0;
      for (const auto& [abscissa, weight] : gauss)
        for (const double f : {middle - half * abscissa, middle + half * abscissa}) {
          const double part = half * weight * e.variation.psd->log_log(f), omega = two_pi * f;
          const Answer a = answer(system, k, f);
          columns.col(column) = std::sqrt(part) * a.modal.real();
          columns.col(column + 1) = std::sqrt(part) * a.modal.imag();
          rates.middleCols(column, 2) = omega * columns.middleCols(column, 2);
          column += 2;
          response.acceleration += part * a.acceleration.cwiseAbs2();
          response.jerk += part * omega * omega * a.acceleration.cwiseAbs2();
          if (e.is_base) response.base.back() += part * e.unit * e.unit;
        }
      response.covariance += columns * columns.transpose();
      response.rates += rates * rates.transpose();
    }
  }
}

void spectra(const ResponseSystem& system, RandomResponse& response) {
  const auto count = static_cast<Index>(response.frequencies.size());
  response.acceleration_psd = response.displacement_psd = MatrixXd::Zero(system.observed.displacement.rows(), count);
  response.stress_psd = MatrixXd::Zero(system.observed.stress.rows(), count);
  response.base_psd = VectorXd::Zero(count);
  for (Index n = 0; n < count; ++n)
    for (std::size_t k = 0; k < system.excitations.size(); ++k) {
      const Excitation& e = system.excitations[k];
      if (!e.variation.psd) continue;
      const double frequency = response.frequencies[static_cast<std::size_t>(n)];
      const double density = e.variation.psd->log_log(frequency);
      const Answer a = answer(system, k, frequency);
      response.acceleration_psd.col(n) += density * a.acceleration.cwiseAbs2();
      response.displacement_psd.col(n) += density * (system.observed.displacement * a.modal).cwiseAbs2();
      response.stress_psd.col(n) += density * (system.observed.stress * a.modal).cwiseAbs2();
      if (e.is_base) response.base_psd[n] += density * e.unit * e.unit;
    }
}

} // namespace

std::pair<double, double> random_range(const ResponseSettings& settings) {
  const auto all = densities(settings);
  if (all.empty())
    throw InputError("[random]: no power spectral density; give psd = … in [base] or in a [[load]]: a number, "
                     "[[frequency, density], …] or a file");
  std::optional<double> from = settings.random.from, to = settings.random.to;
  for (const NumberCurve* psd : all) {
    if (psd->is_constant()) continue;
    if (!settings.random.from) from = from ? std::min(*from, psd->x.front()) : psd->x.front();
    if (!settings.random.to) to = to ? std::max(*to, psd->x.back()) : psd->x.back();
  }
  if (!from || !to || !(*from < *to))
    throw InputError(fmt::format("{}: the density has no range of frequencies; give from and to in [random], or rows "
                                 "[[frequency, density], …]",
                                 all.front()->where));
  return {*from, *to};
}

RandomResponse random_response(const ResponseSystem& system, const ResponseSettings& settings) {
  RandomResponse response;
  std::tie(response.from, response.to) = random_range(settings);
  for (const Excitation& e : system.excitations)
    if (!e.variation.psd)
      throw InputError(
          fmt::format("{}: {} has no psd; a random vibration knows no other excitation: give one, or leave it "
                      "out",
                      e.variation.where, e.name));
  need_damping(system, response.from, response.to);
  if (system.base_direction) response.base = {0};
  integrate(system, response);
  response.frequencies =
      response_frequencies(system.basis, system.damping, response.from, response.to, settings.random.points, {});
  if (response.frequencies.front() == 0 && system.basis.rigid > 0)
    response.frequencies.erase(response.frequencies.begin());
  spectra(system, response);
  return response;
}

MatrixXd independent_parts(const MatrixXd& covariance, const ModalBasis& basis) {
  // In units of energy: what a stiff vector has in stress would be rounding of a soft one's displacement.
  const double stiffest = basis.lambda.maxCoeff();
  const VectorXd root = basis.lambda.unaryExpr([&](double l) { return std::sqrt(l > 0 ? l : stiffest); });
  const MatrixXd energy = root.asDiagonal() * covariance * root.asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (energy + energy.transpose()));
  const double largest = eigen.values.size() > 0 ? eigen.values[eigen.values.size() - 1] : 0;
  const Index kept = (eigen.values.array() > 1e-15 * largest).count();
  return root.cwiseInverse().asDiagonal() * eigen.vectors.rightCols(kept) *
         eigen.values.tail(kept).cwiseSqrt().asDiagonal();
}

double apparent_frequency(double mean_square, double rate_mean_square) {
  return mean_square > 0 ? std::sqrt(rate_mean_square / mean_square) / two_pi : 0;
}

} // namespace iga::solve
