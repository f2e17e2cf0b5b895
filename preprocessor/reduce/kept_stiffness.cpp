#include "preprocessor/reduce/kept_stiffness.hpp"

#include "format/model/bspline_basis.hpp"
#include "preprocessor/base/gauss_rule.hpp"

#include <cmath>

namespace iga::prep {

namespace {

// Of the trace: fields that the fitted rule gives no energy to beyond rounding ask nothing of the reduced one.
constexpr double rounding = 1e-11;

struct Univariate {
  int count = 0;
  double value[max_degree + 1], slope[max_degree + 1];
};

// Polynomials of one direction at t (spans) and their slopes.
Univariate polynomials(int p, int held, double t, double lower, double upper) {
  Univariate f;
  if (held != 0) {
    const double x = held < 0 ? t : 1 - t;
    f.count = 1;
    f.value[0] = std::pow(x, p);
    f.slope[0] = (held < 0 ? p : -p) * std::pow(x, p - 1);
    return f;
  }
  f.count = p + 1;
  const double scale = 1 / (upper - lower);
  legendre((t - lower) * scale, p, f.value);
  legendre_slopes(p, f.value, f.slope);
  for (int a = 0; a <= p; ++a) f.slope[a] *= scale;
  return f;
}

} // namespace

bool KeptStiffness::keeps(const Box3& box, const HeldFaces& held, const PointSet& rule, const PointSet& fitted) {
  Eigen::Index fields = 3;
  for (std::size_t d = 0; d < 3; ++d) fields *= held[d] == 0 ? degree_[d] + 1 : 1;
  const bool free = held == HeldFaces{0, 0, 0};
  energy_.setZero(fields, fields);
  add_energy(box, held, fitted);
  const double trace = energy_.trace();
  energy_ *= -share;
  add_energy(box, held, rule);
  // Without a held face the six rigid motions have no energy in either rule.
  energy_.diagonal().array() += (free ? 10 : 1) * rounding * trace;
  factor_.compute(energy_);
  return factor_.info() == Eigen::Success;
}

// Σ w |ε|² as a matrix of the fields' coefficients (lower triangle): columns of six strains each, shears over √2.
void KeptStiffness::add_energy(const Box3& box, const HeldFaces& held, const PointSet& points) {
  const Eigen::Index fields = energy_.rows(), scalars = fields / 3;
  strains_.setZero(6 * static_cast<Eigen::Index>(points.size()), fields);
  for (std::size_t k = 0; k < points.size(); ++k) {
    std::array<Univariate, 3> f;
    for (std::size_t d = 0; d < 3; ++d)
      f[d] = polynomials(degree_[d], held[d], points.x[3 * k + d], box.lower[d], box.upper[d]);
    const double root = std::sqrt(points.w[k]), shear = root * std::sqrt(0.5);
    const Eigen::Index row = 6 * static_cast<Eigen::Index>(k);
    Eigen::Index n = 0;
    for (int c = 0; c < f[2].count; ++c)
      for (int b = 0; b < f[1].count; ++b)
        for (int a = 0; a < f[0].count; ++a, ++n) {
          const double gx = f[0].slope[a] * f[1].value[b] * f[2].value[c] / size_[0];
          const double gy = f[0].value[a] * f[1].slope[b] * f[2].value[c] / size_[1];
          const double gz = f[0].value[a] * f[1].value[b] * f[2].slope[c] / size_[2];
          strains_(row, n) = root * gx;
          strains_(row + 3, n) = shear * gy;
          strains_(row + 5, n) = shear * gz;
          strains_(row + 1, scalars + n) = root * gy;
          strains_(row + 3, scalars + n) = shear * gx;
          strains_(row + 4, scalars + n) = shear * gz;
          strains_(row + 2, 2 * scalars + n) = root * gz;
          strains_(row + 4, 2 * scalars + n) = shear * gy;
          strains_(row + 5, 2 * scalars + n) = shear * gx;
        }
  }
  energy_.selfadjointView<Eigen::Lower>().rankUpdate(strains_.transpose());
}

} // namespace iga::prep
