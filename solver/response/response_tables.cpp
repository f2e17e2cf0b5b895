#include "solver/response/response_tables.hpp"

#include "solver/response/stress_forms.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double two_pi = 2 * std::numbers::pi;
const std::vector<std::string> xyz{"_x", "_y", "_z"}, voigt{"_xx", "_yy", "_zz", "_xy", "_yz", "_zx"};
constexpr const char* hertz = "1/time";
constexpr const char* stress_unit = "force/length^2";
constexpr const char* acceleration_unit = "length/time^2";

/// A table filled column by column.
class Columns {
 public:
  Columns(std::string name, std::string description) {
    table_.name = std::move(name);
    table_.description = std::move(description);
  }
  void add(const std::string& title, const std::string& unit, const Eigen::Ref<const VectorXd>& values) {
    table_.columns.push_back(title);
    table_.units.push_back(unit);
    columns_.emplace_back(values);
  }
  void add(const std::string& title, const std::string& unit, const std::vector<double>& values) {
    add(title, unit, Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size())));
  }
  /// A column for each row of `values` (components × rows of the table).
  void add_rows(const std::string& title, const std::vector<std::string>& suffixes, const std::string& unit,
                const Eigen::Ref<const MatrixXd>& values) {
    for (std::size_t d = 0; d < suffixes.size(); ++d)
      add(title + suffixes[d], unit, values.row(static_cast<Index>(d)).transpose());
  }
  /// Size and phase of each.
  void add_amplitudes(const std::string& title, const std::vector<std::string>& suffixes, const std::string& unit,
                      const Eigen::Ref<const MatrixXcd>& values) {
    add_rows(title, suffixes, unit, values.cwiseAbs());
    for (std::size_t d = 0; d < suffixes.size(); ++d)
      add(title + suffixes[d] + "_phase", "degree",
          values.row(static_cast<Index>(d)).cwiseArg().transpose() * (180 / std::numbers::pi));
  }
  ResultTable table() && {
    const Index rows = columns_.empty() ? 0 : columns_[0].size();
    for (Index row = 0; row < rows; ++row)
      for (const VectorXd& column : columns_) table_.values.push_back(column[row]);
    return std::move(table_);
  }

 private:
  ResultTable table_;
  std::vector<VectorXd> columns_;
};

// "probe tip": no slash, and each once.
class TableNames {
 public:
  std::string operator()(const char* kind, std::string name) {
    std::replace(name.begin(), name.end(), '/', '_');
    std::string whole = fmt::format("{}_{}", kind, name);
    for (int number = 2; std::find(taken_.begin(), taken_.end(), whole) != taken_.end(); ++number)
      whole = fmt::format("{}_{}_{}", kind, name, number);
    taken_.push_back(whole);
    return whole;
  }

 private:
  std::vector<std::string> taken_;
};

ResultTable modes_table(const ResponseSystem& system) {
  const ModalBasis& basis = system.basis;
  Columns columns("modes", "vectors of the superposition: rigid modes, elastic modes, residual vectors (pseudo-modes)");
  VectorXd number(basis.size()), frequency(basis.size()), ratio(basis.size()), residual(basis.size());
  for (Index j = 0; j < basis.size(); ++j) {
    number[j] = static_cast<double>(j + 1);
    frequency[j] = basis.omega(j) / two_pi;
    ratio[j] = damping_ratio(system.damping, basis, j);
    residual[j] = j >= basis.modes() ? 1 : 0;
  }
  columns.add("vector", "1", number);
  columns.add("frequency", hertz, frequency);
  columns.add("damping_ratio", "1", ratio);
  columns.add("is_residual", "1", residual);
  for (std::size_t k = 0; k < system.excitations.size(); ++k)
    columns.add(fmt::format("modal force of {}", system.excitations[k].name), "mass^(1/2)*length/time^2",
                system.modal_loads.col(static_cast<Index>(k)));
  return std::move(columns).table();
}

std::string force_text(const Observed::Holder& holder) {
  return fmt::format("force of {} '{}' on the part, moment about the centroid of its region", holder.kind, holder.name);
}

const char* moving_name(const ResponseSystem& system) {
  return system.base_direction ? "relative" : "displacement";
}

// Largest length over a cycle of each column's vector (3 × n).
VectorXd cycle_lengths(const Eigen::Ref<const MatrixXcd>& vectors) {
  VectorXd lengths(vectors.cols());
  for (Index k = 0; k < vectors.cols(); ++k) {
    const Eigen::Vector3d a = vectors.col(k).real(), b = vectors.col(k).imag();
    lengths[k] = cycle_maximum(a.squaredNorm(), b.squaredNorm(), a.dot(b));
  }
  return lengths;
}

VectorXd von_mises_of(const Eigen::Ref<const MatrixXcd>& stress) {
  VectorXd largest(stress.cols());
  for (Index k = 0; k < stress.cols(); ++k)
    largest[k] = von_mises_over_cycle(stress.col(k).real(), stress.col(k).imag());
  return largest;
}

VectorXd von_mises_of(const Eigen::Ref<const MatrixXd>& stress) {
  VectorXd size(stress.cols());
  for (Index k = 0; k < stress.cols(); ++k) size[k] = von_mises(stress.col(k));
  return size;
}

Peak peak_of(const VectorXd& values, const std::vector<double>& at) {
  Index where = 0;
  const double value = values.maxCoeff(&where);
  return {value, at[static_cast<std::size_t>(where)]};
}

/// Amplitudes at all probes.
struct HarmonicMotion {
  MatrixXcd relative, displacement, velocity, acceleration; ///< (3 probes × n)
  MatrixXcd stress;                                         ///< (6 probes × n)
};

HarmonicMotion motion_of(const ResponseSystem& system, const HarmonicResponse& response) {
  HarmonicMotion m;
  m.relative = system.observed.displacement * response.modal;
  m.stress = system.observed.stress * response.modal;
  m.displacement = m.relative;
  m.velocity = m.acceleration = MatrixXcd::Zero(m.relative.rows(), m.relative.cols());
  const VectorXd base = system.base_vector();
  for (Index k = 0; k < m.relative.cols(); ++k) {
    const double omega = two_pi * response.frequencies[static_cast<std::size_t>(k)];
    if (system.base_direction) m.displacement.col(k) -= base * (response.base[k] / (omega * omega));
    m.velocity.col(k) = std::complex<double>(0, omega) * m.displacement.col(k);
    // The base's part as it is given: the displacement's has lost digits at low frequencies.
    m.acceleration.col(k) = -omega * omega * m.relative.col(k) + base * response.base[k];
  }
  return m;
}

} // namespace

std::vector<ResultTable> tables_of(const ResponseSystem& system, const HarmonicResponse& response) {
  std::vector<ResultTable> tables;
  TableNames names;
  const Observed& seen = system.observed;
  const HarmonicMotion m = motion_of(system, response);
  for (std::size_t k = 0; k < seen.probes.size(); ++k) {
    const auto p = static_cast<Index>(k);
    Columns columns(
        names("probe", seen.probes[k]),
        fmt::format("amplitudes and phases at probe '{}'; von Mises stress: the largest over a cycle", seen.probes[k]));
    columns.add("frequency", hertz, response.frequencies);
    if (system.base_direction) columns.add_amplitudes("relative", xyz, "length", m.relative.middleRows(3 * p, 3));
    columns.add_amplitudes("displacement", xyz, "length", m.displacement.middleRows(3 * p, 3));
    columns.add_amplitudes("velocity", xyz, "length/time", m.velocity.middleRows(3 * p, 3));
    columns.add_amplitudes("acceleration", xyz, acceleration_unit, m.acceleration.middleRows(3 * p, 3));
    if (system.base_direction) {
      const Eigen::Vector3d d = system.base_vector().segment<3>(3 * p);
      const VectorXd along = (d.transpose() * m.acceleration.middleRows(3 * p, 3)).cwiseAbs().transpose();
      columns.add("transmissibility", "1", along.cwiseQuotient(response.base.cwiseAbs()).unaryExpr([](double t) {
        return std::isfinite(t) ? t : 0.0; // where the base rests
      }));
    }
    columns.add_amplitudes("stress", voigt, stress_unit, m.stress.middleRows(6 * p, 6));
    columns.add("von_mises", stress_unit, von_mises_of(m.stress.middleRows(6 * p, 6)));
    tables.push_back(std::move(columns).table());
  }
  const MatrixXcd reactions = seen.reaction * response.modal;
  for (std::size_t s = 0; s < seen.holders.size(); ++s) {
    const Index at = 6 * static_cast<Index>(s);
    Columns columns(names(seen.holders[s].kind, seen.holders[s].name), force_text(seen.holders[s]));
    columns.add("frequency", hertz, response.frequencies);
    columns.add_amplitudes("force", xyz, "force", reactions.middleRows(at, 3));
    columns.add_amplitudes("moment", xyz, "force*length", reactions.middleRows(at + 3, 3));
    tables.push_back(std::move(columns).table());
  }
  tables.push_back(modes_table(system));
  Columns fields("fields",
                 "steps of the fields on the surface: at phase 0 and a quarter of a cycle later; the motion is "
                 "step 1 cos + step 2 sin of the phase; von Mises stress: the largest over a cycle");
  VectorXd step(2 * static_cast<Index>(response.fields.size())), frequency(step.size()), phase(step.size());
  for (Index k = 0; k < step.size(); ++k) {
    step[k] = static_cast<double>(k + 1);
    frequency[k] = response.fields[static_cast<std::size_t>(k / 2)];
    phase[k] = k % 2 == 0 ? 0 : 90;
  }
  fields.add("step", "1", step);
  fields.add("frequency", hertz, frequency);
  fields.add("phase", "degree", phase);
  tables.push_back(std::move(fields).table());
  return tables;
}

std::vector<ProbePeaks> peaks_of(const ResponseSystem& system, const HarmonicResponse& response) {
  const HarmonicMotion m = motion_of(system, response);
  std::vector<ProbePeaks> peaks;
  for (std::size_t k = 0; k < system.observed.probes.size(); ++k) {
    const auto p = static_cast<Index>(k);
    peaks.push_back({system.observed.probes[k],
                     peak_of(cycle_lengths(m.relative.middleRows(3 * p, 3)), response.frequencies),
                     peak_of(cycle_lengths(m.acceleration.middleRows(3 * p, 3)), response.frequencies),
                     peak_of(von_mises_of(m.stress.middleRows(6 * p, 6)), response.frequencies)});
  }
  return peaks;
}

std::vector<ProbeRms> rms_of(const ResponseSystem& system, const RandomResponse& response) {
  const Observed& seen = system.observed;
  const MatrixXd parts = independent_parts(response.covariance, system.basis);
  const auto squares = [](const Eigen::Ref<const MatrixXd>& rows, const MatrixXd& covariance) {
    return VectorXd((rows * covariance).cwiseProduct(rows).rowwise().sum().cwiseMax(0));
  };
  const auto frequencies = [](const VectorXd& values, const VectorXd& rates) {
    VectorXd all(values.size());
    for (Index d = 0; d < all.size(); ++d) all[d] = apparent_frequency(values[d], rates[d]);
    return all;
  };
  std::vector<ProbeRms> all;
  for (std::size_t k = 0; k < seen.probes.size(); ++k) {
    const auto p = static_cast<Index>(k);
    const auto U = seen.displacement.middleRows(3 * p, 3);
    const auto S = seen.stress.middleRows(6 * p, 6);
    const VectorXd u = squares(U, response.covariance), v = squares(U, response.rates),
                   s = squares(S, response.covariance), r = squares(S, response.rates);
    ProbeRms rms;
    rms.probe = seen.probes[k];
    rms.relative = u.cwiseSqrt();
    rms.relative_frequency = frequencies(u, v);
    rms.acceleration = response.acceleration.segment<3>(3 * p).cwiseSqrt();
    rms.acceleration_frequency = frequencies(response.acceleration.segment<3>(3 * p), response.jerk.segment<3>(3 * p));
    rms.stress = s.cwiseSqrt();
    rms.stress_frequency = frequencies(s, r);
    rms.von_mises = von_mises_of(MatrixXd(S * parts)).norm();
    all.push_back(std::move(rms));
  }
  return all;
}

std::vector<ResultTable> tables_of(const ResponseSystem& system, const RandomResponse& response) {
  std::vector<ResultTable> tables;
  TableNames names;
  const Observed& seen = system.observed;
  const std::string moving = moving_name(system);
  for (const ProbeRms& rms : rms_of(system, response)) {
    Columns columns(names("rms", rms.probe),
                    fmt::format("root mean squares (1 sigma) at probe '{}' and apparent frequencies", rms.probe));
    columns.add_rows(moving, xyz, "length", rms.relative);
    columns.add_rows(moving + "_frequency", xyz, hertz, rms.relative_frequency);
    columns.add_rows("acceleration", xyz, acceleration_unit, rms.acceleration);
    columns.add_rows("acceleration_frequency", xyz, hertz, rms.acceleration_frequency);
    columns.add_rows("stress", voigt, stress_unit, rms.stress);
    columns.add_rows("stress_frequency", voigt, hertz, rms.stress_frequency);
    columns.add("von_mises", stress_unit, std::vector<double>{rms.von_mises});
    tables.push_back(std::move(columns).table());
  }
  const VectorXd squares =
      (seen.reaction * response.covariance).cwiseProduct(seen.reaction).rowwise().sum().cwiseMax(0);
  for (std::size_t s = 0; s < seen.holders.size(); ++s) {
    const Index at = 6 * static_cast<Index>(s);
    const auto& [kind, name] = seen.holders[s];
    Columns columns(
        names(fmt::format("rms_{}", kind).c_str(), name),
        fmt::format("root mean squares (1 sigma) of the force of {} '{}', moment about its centroid", kind, name));
    columns.add_rows("force", xyz, "force", squares.segment(at, 3).cwiseSqrt());
    columns.add_rows("moment", xyz, "force*length", squares.segment(at + 3, 3).cwiseSqrt());
    tables.push_back(std::move(columns).table());
  }
  for (std::size_t k = 0; k < seen.probes.size(); ++k) {
    const auto p = static_cast<Index>(k);
    Columns columns(names("psd", seen.probes[k]),
                    fmt::format("one-sided power spectral densities at probe '{}'", seen.probes[k]));
    columns.add("frequency", hertz, response.frequencies);
    columns.add_rows("acceleration", xyz, "length^2/time^3", response.acceleration_psd.middleRows(3 * p, 3));
    if (system.base_direction) columns.add("base_acceleration", "length^2/time^3", response.base_psd);
    columns.add_rows(moving, xyz, "length^2*time", response.displacement_psd.middleRows(3 * p, 3));
    columns.add_rows("stress", voigt, "force^2*time/length^4", response.stress_psd.middleRows(6 * p, 6));
    tables.push_back(std::move(columns).table());
  }
  tables.push_back(modes_table(system));
  return tables;
}

namespace {

struct TransientMotion {
  MatrixXd relative, displacement, velocity, acceleration; ///< (3 probes × n)
  MatrixXd stress;                                         ///< (6 probes × n)
};

TransientMotion motion_of(const ResponseSystem& system, const TransientResponse& response) {
  const Observed& seen = system.observed;
  const VectorXd base = system.base_vector();
  TransientMotion m;
  m.relative = seen.displacement * response.modal;
  m.stress = seen.stress * response.modal;
  m.displacement = m.relative + base * response.base.row(0);
  m.velocity = seen.displacement * response.velocity + base * response.base.row(1);
  m.acceleration = seen.displacement * response.acceleration + base * response.base.row(2);
  return m;
}

} // namespace

std::vector<ResultTable> tables_of(const ResponseSystem& system, const TransientResponse& response) {
  std::vector<ResultTable> tables;
  TableNames names;
  const Observed& seen = system.observed;
  const TransientMotion m = motion_of(system, response);
  for (std::size_t k = 0; k < seen.probes.size(); ++k) {
    const auto p = static_cast<Index>(k);
    Columns columns(names("probe", seen.probes[k]), fmt::format("histories at probe '{}'", seen.probes[k]));
    columns.add("time", "time", response.times);
    if (system.base_direction) columns.add_rows("relative", xyz, "length", m.relative.middleRows(3 * p, 3));
    columns.add_rows("displacement", xyz, "length", m.displacement.middleRows(3 * p, 3));
    columns.add_rows("velocity", xyz, "length/time", m.velocity.middleRows(3 * p, 3));
    columns.add_rows("acceleration", xyz, acceleration_unit, m.acceleration.middleRows(3 * p, 3));
    columns.add_rows("stress", voigt, stress_unit, m.stress.middleRows(6 * p, 6));
    columns.add("von_mises", stress_unit, von_mises_of(m.stress.middleRows(6 * p, 6)));
    tables.push_back(std::move(columns).table());
  }
  const MatrixXd reactions = seen.reaction * response.modal;
  for (std::size_t s = 0; s < seen.holders.size(); ++s) {
    const Index at = 6 * static_cast<Index>(s);
    Columns columns(names(seen.holders[s].kind, seen.holders[s].name), force_text(seen.holders[s]));
    columns.add("time", "time", response.times);
    columns.add_rows("force", xyz, "force", reactions.middleRows(at, 3));
    columns.add_rows("moment", xyz, "force*length", reactions.middleRows(at + 3, 3));
    tables.push_back(std::move(columns).table());
  }
  if (system.base_direction) {
    Columns columns("base", "motion of the base along its direction");
    columns.add("time", "time", response.times);
    columns.add("displacement", "length", response.base.row(0).transpose());
    columns.add("velocity", "length/time", response.base.row(1).transpose());
    columns.add("acceleration", acceleration_unit, response.base.row(2).transpose());
    tables.push_back(std::move(columns).table());
  }
  tables.push_back(modes_table(system));
  return tables;
}

std::vector<ProbePeaks> peaks_of(const ResponseSystem& system, const TransientResponse& response) {
  const TransientMotion m = motion_of(system, response);
  std::vector<ProbePeaks> peaks;
  for (std::size_t k = 0; k < system.observed.probes.size(); ++k) {
    const auto p = static_cast<Index>(k);
    peaks.push_back({system.observed.probes[k],
                     peak_of(m.relative.middleRows(3 * p, 3).colwise().norm().transpose(), response.times),
                     peak_of(m.acceleration.middleRows(3 * p, 3).colwise().norm().transpose(), response.times),
                     peak_of(von_mises_of(MatrixXd(m.stress.middleRows(6 * p, 6))), response.times)});
  }
  return peaks;
}

} // namespace iga::solve
