// What bounds the one time step of a run, and what a step twice as long would ask for.
#pragma once

#include "solver/explicit/run/run_scene.hpp"

namespace iga::solve {

struct StepBound {
  enum class Kind { Material, Contact, Setting };
  Kind kind = Kind::Material;
  std::size_t body = 0; ///< of the run; not of a setting
  double dt = 0;        ///< the longest step that it allows at the start, time
  double span = 0;      ///< smallest edge of the body's spans, length: dt grows like it. 0 for a setting
};

/// All bounds of the undeformed bodies, the smallest first: the stability of each material, the contact of each body
/// that touches something, dt_max. @pre scene.find_limits() or scene.load()
std::vector<StepBound> step_bounds(const ExplicitScene& scene);

/// "contact of body 'cube'".
std::string name_of(const StepBound& bound, const ExplicitRun& run);

/// A sentence for each bound that forbids a step twice as long as the smallest one: what would allow it, with numbers.
std::vector<std::string> doubling_advice(const std::vector<StepBound>& bounds, const ExplicitRun& run);

} // namespace iga::solve
