#include "solver/explicit/point_stress.hpp"

namespace iga::solve {

namespace {

std::vector<double> numbers(const std::vector<Lanes>& from) {
  std::vector<double> to(lanes * from.size());
  for (std::size_t k = 0; k < from.size(); ++k) store_lanes(from[k], to.data() + lanes * k);
  return to;
}

void restore(const std::vector<double>& from, std::vector<Lanes>& to) {
  if (from.size() != lanes * to.size())
    throw InputError("the saved state of the points has another size than the model and its material ask for; restart "
                     "with the files that the run began with");
  for (std::size_t k = 0; k < to.size(); ++k) to[k] = load_lanes(from.data() + lanes * k);
}

} // namespace

PointHistory PointMemory::save() const {
  return {numbers(history), numbers(F_old), numbers(extra)};
}

void PointMemory::load(const PointHistory& saved) {
  restore(saved.history, history);
  restore(saved.F_old, F_old);
  restore(saved.extra, extra);
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
