#include "format/model/case_envelope.hpp"

#include "format/model/vec3.hpp"

namespace iga {

namespace {

// value(step, vertex) -> double
template <class Value>
void take_largest(std::size_t steps, Value&& value, std::vector<double>& largest, std::vector<double>& which) {
  for (std::size_t v = 0; v < largest.size(); ++v)
    for (std::size_t step = 0; step < steps; ++step) {
      const double own = value(step, v);
      if (step > 0 && !(own > largest[v])) continue;
      largest[v] = own;
      which[v] = static_cast<double>(step + 1);
    }
}

} // namespace

SurfaceEnvelope surface_envelope(const SurfaceResult& surface) {
  const std::size_t n = surface.output.mesh.vertices.size(), steps = surface.steps.size();
  SurfaceEnvelope all{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  const auto length = [&](std::size_t step, std::size_t v) {
    const double* u = &surface.fields.displacement[3 * (step * n + v)];
    return norm({u[0], u[1], u[2]});
  };
  take_largest(steps, length, all.displacement, all.displacement_case);
  take_largest(
      steps, [&](std::size_t step, std::size_t v) { return surface.fields.von_mises[step * n + v]; }, all.von_mises,
      all.von_mises_case);
  return all;
}

} // namespace iga
