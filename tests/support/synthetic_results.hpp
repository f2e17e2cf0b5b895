// Results whose every number is known, made without an analysis: fields are linear in space.
#pragma once

#include "format/model/results.hpp"

namespace iga::test {

/// u(x) = G x + c of step `step`: another one for each step.
struct LinearField {
  std::array<Point3, 3> G{};
  Point3 c{};
  explicit LinearField(int step);
  Point3 at(const Point3& x) const;
};

/// Displacement is the linear field, von Mises stress at vertex v of step s is 100 (s + 1) + v.
SurfaceResult make_surface_result(const TrimmedModel& model, int num_steps);

/// Eigen results of 9 modes: 6 rigid, a mechanism, 2 elastic, with their fields on the surface.
Results make_eigen_results(const TrimmedModel& model);
/// Static results with two supports, three loads, a probe and one step on the surface.
Results make_static_results(const TrimmedModel& model);
/// Buckling results of three factors, with their shapes on the surface.
Results make_buckling_results(const TrimmedModel& model);
/// A file that holds every part that there is; its analysis is `eigen`.
Results make_full_results(const TrimmedModel& model);

} // namespace iga::test
