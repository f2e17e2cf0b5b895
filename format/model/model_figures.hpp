// The promises of schema/README.md that have a number, measured: what the table of `igasolve check` shows.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <string>
#include <vector>

namespace iga {

/// One promise with what was found and how much is allowed, both in the unit that `what` says.
struct CheckFigure {
  std::string what;
  double found = 0, allowed = 0;
  bool passes() const { return found <= allowed; } ///< false for NaN
};

/// Measures points, weights, volumes, areas and moments of the whole part, from the points alone.
/// Moments: ∫ s^a t^b r^c dV of the volume's points against ∮ s^(a+1)/(a+1) t^b r^c n·e_u dA of the surface's
/// (divergence theorem), a, b, c up to the degree or to what trimmed cells reproduce, s, t, r in -1 … 1 over the part's
/// spans. Allowed is what the rules' tolerance and layers of the sliver depth leave, and the volume of dropped spans.
/// What the surface says is left out where a leak was accepted, moments where its rule is "reduced".
/// @pre check(model) found nothing
std::vector<CheckFigure> measure(const TrimmedModel& model);

} // namespace iga
