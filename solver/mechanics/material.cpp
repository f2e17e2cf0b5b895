#include "solver/mechanics/material.hpp"

#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <fmt/format.h>

namespace iga::solve {

namespace {

// Squares and ratios of numbers within 10^±most_digits, and their products with lengths, stay finite and above zero.
constexpr double most_digits = 100;

void need_range(const char* what, double value) {
  const double digits = std::log10(value);
  if (!(std::abs(digits) <= most_digits))
    throw InputError(fmt::format("material: {} = {:g} is beyond what can be computed with (1e-{:g} … 1e{:g}): its "
                                 "square is no finite number above zero; check the number, or choose other units",
                                 what, value, most_digits, most_digits));
}

void need_density(double density) {
  if (!(density > 0) || !std::isfinite(density))
    throw InputError(fmt::format("material: density rho = {} is not positive; give rho in mass per length³", density));
  need_range("density rho", density);
}

// The wave speed √(E / ρ) sets frequencies and time steps.
void need_wave_speed(double modulus, double density) {
  need_range("modulus / density", modulus / density);
}

// Eigenvalues of the acoustic tensor A_ac = n_b C_abcd n_d over directions n: extremes over corners, edges and faces of
// a cube and the points between them; exact for isotropic materials.
template <class Pick> double wave_speed(const ElasticMaterial& m, double start, Pick pick) {
  double extreme = start;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = 0; z <= 2; ++z) {
        const Eigen::Vector3d direction(x, y, z);
        if (direction.isZero()) continue;
        const Eigen::Vector3d n = direction.normalized();
        Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
        for (int a = 0; a < 3; ++a)
          for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b)
              for (int d = 0; d < 3; ++d) A(a, c) += n[b] * m.C(voigt_place[a][b], voigt_place[c][d]) * n[d];
        extreme = pick(extreme, symmetric_eigenvalues_3(A));
      }
  return std::sqrt(extreme / m.density);
}

} // namespace

double ElasticMaterial::fastest_wave() const {
  return wave_speed(*this, 0, [](double e, const Eigen::Vector3d& v) { return std::max(e, v[2]); });
}

double ElasticMaterial::slowest_wave() const {
  return wave_speed(*this, INFINITY, [](double e, const Eigen::Vector3d& v) { return std::min(e, v[0]); });
}

ElasticMaterial isotropic(double E, double nu, double density) {
  if (!(E > 0) || !std::isfinite(E))
    throw InputError(fmt::format("material: Young's modulus E = {} is not positive; give E in force per length²", E));
  if (!(nu > -1 && nu < 0.5))
    throw InputError(fmt::format("material: Poisson's ratio nu = {} does not lie between -1 and 0.5; {}", nu,
                                 nu == 0.5 ? "an incompressible material is outside what displacements alone can "
                                             "describe: take 0.49 and degree 3 for a rubber"
                                           : "steel has about 0.3, rubber up to 0.49"));
  need_range("Young's modulus E", E);
  need_density(density);
  need_wave_speed(E, density);
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  ElasticMaterial m;
  m.C.topLeftCorner<3, 3>().setConstant(lambda);
  m.C.diagonal() << lambda + 2 * mu, lambda + 2 * mu, lambda + 2 * mu, mu, mu, mu;
  m.density = density;
  return m;
}

ElasticMaterial anisotropic(const VoigtMatrix& C, double density) {
  if (!C.allFinite()) throw InputError("material: C holds a number that is not finite");
  const double asymmetry = (C - C.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > 1e-9 * C.cwiseAbs().maxCoeff())
    throw InputError(fmt::format("material: C is not symmetric: two entries that should agree differ by {:.3g}; give "
                                 "the rows in the order xx yy zz xy yz zx",
                                 asymmetry));
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(C);
  if (!(eigenvalues[0] > 1e-12 * eigenvalues[5]))
    throw InputError(
        fmt::format("material: C is not positive definite: its smallest eigenvalue is {:.6g}; every strain "
                    "must store energy",
                    eigenvalues[0]));
  need_density(density);
  need_range("the largest entry of C", eigenvalues[5]);
  need_wave_speed(eigenvalues[5], density);
  ElasticMaterial m;
  m.C = (C + C.transpose()) / 2;
  m.density = density;
  return m;
}

VoigtMatrix voigt_matrix(const std::vector<double>& entries) {
  VoigtMatrix matrix;
  std::size_t next = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = entries.size() == 21 ? i : 0; j < 6; ++j, ++next) {
      matrix(i, j) = entries[next];
      if (entries.size() == 21) matrix(j, i) = entries[next];
    }
  return matrix;
}

// C'_ijkl = R_ia R_jb R_kc R_ld C_abcd = T C Tᵀ, where T turns a stress: σ'_ij = R_ia R_jb σ_ab.
ElasticMaterial turned(const ElasticMaterial& material, const Rotation& R) {
  if (R == identity_rotation) return material;
  VoigtMatrix T = VoigtMatrix::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j)
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) T(voigt_place[i][j], voigt_place[a][b]) += R[i][a] * R[j][b];
  ElasticMaterial m = material;
  m.C = T * material.C * T.transpose();
  m.C = (0.5 * (m.C + m.C.transpose())).eval();
  return m;
}

double von_mises(const Voigt& s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

} // namespace iga::solve
