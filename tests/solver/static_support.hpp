// What the tests of static analyses share: linear fields, runs with supports, errors of a solution.
#pragma once

#include "format/model/vec3.hpp"
#include "solver/analysis/static_analysis.hpp"

#include <algorithm>

namespace iga::test {

const std::array<Point3, 3> some_gradient{{{1e-3, 4e-4, -2e-4}, {-3e-4, -5e-4, 6e-4}, {7e-4, -1e-4, 2e-4}}};
const Point3 some_offset{1e-3, -2e-3, 3e-3};

inline Point3 linear_field(const Point3& x) {
  Point3 u{};
  for (std::size_t d = 0; d < 3; ++d) u[d] = some_offset[d] + dot(some_gradient[d], x);
  return u;
}

inline solve::Voigt constant_stress(const solve::ElasticMaterial& material) {
  const auto& G = some_gradient;
  solve::Voigt strain;
  strain << G[0][0], G[1][1], G[2][2], G[0][1] + G[1][0], G[1][2] + G[2][1], G[2][0] + G[0][2];
  return material.C * strain;
}

inline Point3 traction(const solve::Voigt& s, const Point3& n) {
  return {s[0] * n[0] + s[3] * n[1] + s[5] * n[2], s[3] * n[0] + s[1] * n[1] + s[4] * n[2],
          s[5] * n[0] + s[4] * n[1] + s[2] * n[2]};
}

/// Prescribes the linear field on a region (everywhere unless changed).
inline solve::Support linear_support(solve::SupportMethod method) {
  solve::Support support;
  support.name = "clamp";
  support.value = some_offset;
  support.gradient = some_gradient;
  support.method = method;
  return support;
}

inline solve::LightTreatment usual() {
  return solve::default_light_treatment(solve::MassType::Consistent);
}

inline solve::RunSettings run_with(std::vector<solve::Support> supports) {
  solve::RunSettings run;
  run.material = solve::isotropic(210, 0.3, 7.8e-6);
  run.supports = std::move(supports);
  return run;
}

/// Largest errors against the linear field at the quadrature points: displacement relative to the largest displacement,
/// stress to the largest stress.
struct LinearErrors {
  double displacement = 0, stress = 0;
};

inline LinearErrors errors_of(const FieldSamples& fields, const std::vector<double>& positions,
                              const solve::ElasticMaterial& material) {
  const solve::Voigt exact = constant_stress(material);
  LinearErrors errors;
  double largest = 0;
  for (std::size_t q = 0; 3 * q < positions.size(); ++q) {
    const double* x = positions.data() + 3 * q;
    const Point3 u = linear_field({x[0], x[1], x[2]});
    for (std::size_t d = 0; d < 3; ++d) {
      largest = std::max(largest, std::abs(u[d]));
      errors.displacement = std::max(errors.displacement, std::abs(fields.displacement[3 * q + d] - u[d]));
    }
    for (std::size_t k = 0; k < 6; ++k)
      errors.stress = std::max(errors.stress, std::abs(fields.stress[6 * q + k] - exact[static_cast<Eigen::Index>(k)]));
  }
  errors.displacement /= largest;
  errors.stress /= exact.cwiseAbs().maxCoeff();
  return errors;
}

} // namespace iga::test
