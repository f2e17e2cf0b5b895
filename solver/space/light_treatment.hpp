// What is done with functions that hold almost no material; theory and measurements in README.md.
#pragma once

namespace iga::solve {

/// What happens to functions that hold almost no material (mass fraction below a threshold).
enum class LightFunctions {
  None,    ///< they stay as they are
  Remove,  ///< their coefficients are zero: destroys rigid motions
  Linear,  ///< slaves of the nearest well-filled span's functions, linear extrapolation (8 masters)
  DegreeP, ///< slaves by polynomials of the spline's own degree ((p + 1)³ masters)
};

/// Does a remedy make light functions follow others?
constexpr bool extends(LightFunctions remedy) {
  return remedy == LightFunctions::Linear || remedy == LightFunctions::DegreeP;
}

struct LightTreatment {
  LightFunctions remedy = LightFunctions::None;
  double threshold = 0; ///< mass fraction below which a function is light
  /// The threshold in models where gaps end, if not negative: beside the end of a gap nearly every cut cell has light
  /// functions, so that good cells are far, and polynomials of degree p grow too fast on the way (10^7 at p = 4).
  double threshold_with_gap_ends = -1;
};

} // namespace iga::solve
