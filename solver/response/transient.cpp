#include "solver/response/transient.hpp"

#include "format/model/errors.hpp"
#include "solver/response/oscillator.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void need_histories(const ResponseSystem& system, const ResponseSettings& settings) {
  if (!(settings.transient.end > 0))
    throw InputError("[transient]: end is missing; give the time at which the run ends");
  if (settings.damping.structural > 0)
    throw InputError(fmt::format("{}: structural damping belongs to harmonic motion; in a transient give ratio, modes, "
                                 "table or rayleigh (ratio = η / 2 damps resonances alike)",
                                 settings.damping.where));
  for (const Excitation& e : system.excitations)
    if (!e.variation.history)
      throw InputError(
          fmt::format("{}: {} has no history; give history = [[time, factor], …] or a file, or history = 1 "
                      "for what is there from time 0 on",
                      e.variation.where, e.name));
}

std::vector<double> output_times(const TransientSettings& settings) {
  std::vector<double> times;
  const auto count = static_cast<std::int64_t>(std::ceil(settings.end / settings.step - 1e-9));
  for (std::int64_t k = 0; k < count; ++k) times.push_back(static_cast<double>(k) * settings.step);
  times.push_back(settings.end);
  return times;
}

// All in [0, end], ascending.
std::vector<double> joined(std::vector<double> times, const std::vector<double>& more, double end) {
  for (const double t : more)
    if (t > 0 && t < end) times.push_back(t);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

// Factors of all excitations at a time.
VectorXd factors(const ResponseSystem& system, double time) {
  VectorXd all(static_cast<Index>(system.excitations.size()));
  for (std::size_t k = 0; k < system.excitations.size(); ++k)
    all[static_cast<Index>(k)] = system.excitations[k].unit * system.excitations[k].variation.history->linear(time);
  return all;
}

// The steps of all oscillators over one length of time; made again when the length changes.
class Steps {
 public:
  Steps(const ModalBasis& basis, const ModalDamping& damping) : basis_(basis), damping_(damping) {}
  const std::vector<OscillatorStep>& over(double h) {
    // Times of a regular output differ in rounding.
    if (!steps_.empty() && std::abs(h - length_) <= 1e-12 * length_) return steps_;
    length_ = h;
    steps_.clear();
    for (Index j = 0; j < basis_.size(); ++j) steps_.emplace_back(basis_.lambda[j], damping_.c[j], h);
    return steps_;
  }

 private:
  const ModalBasis& basis_;
  const ModalDamping& damping_;
  double length_ = 0;
  std::vector<OscillatorStep> steps_;
};

} // namespace

TransientResponse transient_response(const ResponseSystem& system, const ResponseSettings& settings) {
  need_histories(system, settings);
  const ModalBasis& basis = system.basis;
  TransientResponse response;
  response.times = joined(output_times(settings.transient), settings.transient.fields, settings.transient.end);
  std::vector<double> times = response.times;
  for (const Excitation& e : system.excitations) times = joined(times, e.variation.history->x, settings.transient.end);

  const auto count = static_cast<Index>(response.times.size());
  response.modal = response.velocity = response.acceleration = MatrixXd::Zero(basis.size(), count);
  response.base = Eigen::Matrix3Xd::Zero(3, count);
  std::vector<std::array<double, 2>> state(static_cast<std::size_t>(basis.size()), {0, 0});
  Steps steps(basis, system.damping);
  VectorXd start = factors(system, 0), p_start = system.modal_loads * start;
  Eigen::Vector3d base = Eigen::Vector3d::Zero();
  const Index base_column = system.modal_loads.cols() - 1;
  double largest = -1, peak = 0;
  Index output = 0;
  for (std::size_t n = 0; n < times.size(); ++n) {
    if (n > 0) {
      const double h = times[n] - times[n - 1];
      const VectorXd end = factors(system, times[n]), p_end = system.modal_loads * end;
      const auto& step = steps.over(h);
      for (Index j = 0; j < basis.size(); ++j) {
        const auto k = static_cast<std::size_t>(j);
        state[k] = step[k].advance(state[k], p_start[j], p_end[j]);
      }
      if (system.base_direction) {
        const double a0 = start[base_column], a1 = end[base_column];
        base[0] += h * (base[1] + h * (a0 / 3 + a1 / 6));
        base[1] += h * (a0 + a1) / 2;
      }
      start = end;
      p_start = p_end;
    }
    if (times[n] != response.times[static_cast<std::size_t>(output)]) continue;
    for (Index j = 0; j < basis.size(); ++j) {
      const auto& [q, v] = state[static_cast<std::size_t>(j)];
      response.modal(j, output) = q;
      response.velocity(j, output) = v;
      response.acceleration(j, output) = p_start[j] - system.damping.c[j] * v - basis.lambda[j] * q;
    }
    if (system.base_direction) base[2] = start[base_column];
    response.base.col(output) = base;
    const double energy = basis.lambda.dot(response.modal.col(output).cwiseAbs2());
    if (energy > largest) {
      largest = energy;
      peak = times[n];
    }
    if (++output == count) break;
  }
  response.fields = settings.transient.fields;
  if (response.fields.empty()) response.fields = {peak};
  std::sort(response.fields.begin(), response.fields.end());
  response.fields.erase(std::unique(response.fields.begin(), response.fields.end()), response.fields.end());
  response.field_modal.resize(basis.size(), static_cast<Index>(response.fields.size()));
  for (std::size_t k = 0; k < response.fields.size(); ++k) {
    const auto at = std::lower_bound(response.times.begin(), response.times.end(), response.fields[k]);
    response.field_modal.col(static_cast<Index>(k)) =
        response.modal.col(static_cast<Index>(at - response.times.begin()));
  }
  return response;
}

} // namespace iga::solve
