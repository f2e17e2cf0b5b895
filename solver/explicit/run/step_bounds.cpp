#include "solver/explicit/run/step_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

std::vector<StepBound> step_bounds(const ExplicitScene& scene) {
  const ExplicitRun& run = scene.run();
  std::vector<StepBound> bounds;
  for (std::size_t b = 0; b < scene.num_bodies(); ++b) {
    const Point3 h = scene.body(b).space().model().grid.span_size();
    const double span = std::min({h[0], h[1], h[2]});
    bounds.push_back({StepBound::Kind::Material, b, run.time.safety * scene.limits()[b].dt, span});
    if (scene.contact() && std::isfinite(scene.contact()->largest_step(b)))
      bounds.push_back({StepBound::Kind::Contact, b, scene.contact()->largest_step(b), span});
  }
  if (run.time.largest_dt > 0) bounds.push_back({StepBound::Kind::Setting, 0, run.time.largest_dt, 0});
  std::stable_sort(bounds.begin(), bounds.end(), [](const StepBound& a, const StepBound& b) { return a.dt < b.dt; });
  return bounds;
}

std::string name_of(const StepBound& bound, const ExplicitRun& run) {
  if (bound.kind == StepBound::Kind::Setting) return "dt_max in [time]";
  return fmt::format("{} of body '{}'", bound.kind == StepBound::Kind::Contact ? "contact" : "material",
                     run.bodies[bound.body].body.name);
}

std::vector<std::string> doubling_advice(const std::vector<StepBound>& bounds, const ExplicitRun& run) {
  std::vector<std::string> advice;
  const double wanted = 2 * bounds.front().dt;
  for (const StepBound& bound : bounds) {
    if (bound.dt >= wanted) break;
    if (bound.kind == StepBound::Kind::Setting) {
      advice.push_back(fmt::format("dt_max of {:.3g} instead of {:.3g}", wanted, bound.dt));
      continue;
    }
    const double factor = wanted / bound.dt;
    advice.push_back(fmt::format("{}: spans of {:.3g} instead of {:.3g}, or a wave speed √(E/ρ) {:.3g} times lower",
                                 name_of(bound, run), factor * bound.span, bound.span, factor));
  }
  return advice;
}

} // namespace iga::solve
