#include "solver/explicit/kernel/point_stress.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

std::vector<double> numbers(const std::vector<Lanes>& from) {
  std::vector<double> to(lanes * from.size());
  for (std::size_t k = 0; k < from.size(); ++k) std::memcpy(to.data() + lanes * k, &from[k], sizeof(Lanes));
  return to;
}

void restore(const char* name, const std::vector<double>& from, std::vector<Lanes>& to) {
  if (from.size() != lanes * to.size())
    throw InputError(
        fmt::format("{}: found {} numbers, expected {}; the state is that of another run; restart with the "
                    "files that the run began with",
                    name, from.size(), lanes * to.size()));
  for (std::size_t k = 0; k < to.size(); ++k) std::memcpy(&to[k], from.data() + lanes * k, sizeof(Lanes));
}

} // namespace

PointMemory::PointMemory(const LawAccess& law, const KernelOptions& options, std::size_t blocks) {
  const auto per_block = static_cast<std::size_t>(law.history);
  history.resize(per_block * blocks);
  if (law.history > 0)
    for (std::size_t b = 0; b < blocks; ++b) law.start(law.law.get(), history.data() + per_block * b);
  if (law.needs_old_F || options.erodes()) {
    F_old.resize(9 * blocks);
    for (std::size_t k = 0; k < F_old.size(); ++k) F_old[k] = Lanes{} + (k % 9 % 4 == 0 ? 1.0 : 0.0);
  }
  if (!options.erodes()) return;
  extra_size = 11;
  extra.resize(static_cast<std::size_t>(extra_size) * blocks);
  for (std::size_t b = 0; b < blocks; ++b) extra[static_cast<std::size_t>(extra_size) * b] = Lanes{} + 1.0;
}

PointHistory PointMemory::save() const {
  return {numbers(history), numbers(F_old), numbers(extra)};
}

void PointMemory::load(const PointHistory& saved) {
  restore("history", saved.history, history);
  restore("deformation", saved.F_old, F_old);
  restore("erosion", saved.extra, extra);
}

void PointExtremes::add(const PointExtremes& other) {
  if (other.speed_squared > speed_squared) {
    speed_squared = other.speed_squared;
    speed_span = other.speed_span;
  }
  if (other.min_J < min_J) {
    min_J = other.min_J;
    J_span = other.J_span;
  }
  if (inverted_span < 0) inverted_span = other.inverted_span;
  inverted += other.inverted;
  eroded += other.eroded;
  viscous_power += other.viscous_power;
  eroded_energy += other.eroded_energy;
}

} // namespace iga::solve
