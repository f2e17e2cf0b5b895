// The foam of the impact sample (kg, mm, ms).
#pragma once

#include "solver/explicit/laws/laws.hpp"

namespace iga::bench {

inline solve::Law impact_foam() {
  solve::FoamSettings settings;
  settings.E = 0.05;
  settings.density = 6e-8;
  settings.tension_limit = 3e-4;
  settings.yield =
      solve::Curve({0, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95}, {3e-4, 3.5e-4, 6e-4, 1.2e-3, 4e-3, 0.02, 0.05}, "foam");
  return solve::CrushableFoam(settings);
}

} // namespace iga::bench
