// Values and gradients of a span's shape functions at many points at once: univariate values point by point in vector
// registers, then their tensor products.
#include "format/model/bspline_basis.hpp"
#include "solver/space/solution_space.hpp"

#include <cassert>

namespace iga::solve {

namespace {

// Univariate values and derivatives in one direction; column a holds the n points' values of function span + a.
struct Univariate {
  Eigen::MatrixXd values, derivatives; // (n × p + 1)
};

// Spans whose functions see equal knots only: no repeated end knot enters.
bool is_cardinal(const KnotVector& knots, std::int64_t span) {
  const int p = knots.degree();
  return span >= p - 1 && span <= knots.num_spans() - p;
}

// Cox–de Boor on equal knots, in units of the span (t = 0 … 1 inside it): the denominators are the degrees.
template <int p>
void cardinal_values(std::span<const double> parameters, std::size_t d, double lower, double h, Univariate& result) {
  const std::size_t n = parameters.size() / 3;
  double* values = result.values.data();
  double* derivatives = result.derivatives.data();
  for (std::size_t q = 0; q < n; ++q) {
    const double t = (parameters[3 * q + d] - lower) / h;
    double N[p + 1] = {1};
    for (int degree = 1; degree <= p; ++degree) {
      if (degree == p) {
        double before = 0;
        for (int a = 0; a < p; ++a) {
          derivatives[static_cast<std::size_t>(a) * n + q] = (before - N[a]) / h;
          before = N[a];
        }
        derivatives[static_cast<std::size_t>(p) * n + q] = before / h;
      }
      double saved = 0;
      for (int a = 0; a < degree; ++a) {
        const double share = N[a] / degree;
        N[a] = saved + (a + 1 - t) * share;
        saved = (t + degree - 1 - a) * share;
      }
      N[degree] = saved;
    }
    for (int a = 0; a <= p; ++a) values[static_cast<std::size_t>(a) * n + q] = N[a];
  }
}

void general_values(const KnotVector& knots, std::int64_t span, std::span<const double> parameters, std::size_t d,
                    Univariate& result) {
  const std::size_t n = parameters.size() / 3, width = static_cast<std::size_t>(knots.degree()) + 1;
  double N[max_degree + 1], D[max_degree + 1];
  for (std::size_t q = 0; q < n; ++q) {
    evaluate_basis(knots, span, parameters[3 * q + d], {N, width});
    evaluate_basis_derivatives(knots, span, parameters[3 * q + d], {D, width});
    for (std::size_t a = 0; a < width; ++a) {
      result.values.data()[a * n + q] = N[a];
      result.derivatives.data()[a * n + q] = D[a];
    }
  }
}

// Bernstein polynomials of a span, by de Casteljau's recursion.
void bernstein_values(const KnotVector& knots, std::int64_t span, std::span<const double> parameters, std::size_t d,
                      Univariate& result) {
  const std::size_t n = parameters.size() / 3;
  const auto p = static_cast<std::size_t>(knots.degree());
  result.values.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(p + 1));
  result.derivatives.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(p + 1));
  const double lower = knots.lower(span), h = knots.upper(span) - lower;
  for (std::size_t q = 0; q < n; ++q) {
    const double t = (parameters[3 * q + d] - lower) / h;
    double B[max_degree + 1] = {1};
    for (std::size_t degree = 1; degree <= p; ++degree) {
      if (degree == p)
        for (std::size_t a = 0; a <= p; ++a)
          result.derivatives.data()[a * n + q] =
              static_cast<double>(p) * ((a > 0 ? B[a - 1] : 0) - (a < p ? B[a] : 0)) / h;
      B[degree] = t * B[degree - 1];
      for (std::size_t a = degree - 1; a > 0; --a) B[a] = t * B[a - 1] + (1 - t) * B[a];
      B[0] *= 1 - t;
    }
    for (std::size_t a = 0; a <= p; ++a) result.values.data()[a * n + q] = B[a];
  }
}

void univariate_values(const KnotVector& knots, std::int64_t span, std::span<const double> parameters, std::size_t d,
                       Univariate& result) {
  const auto n = static_cast<Eigen::Index>(parameters.size() / 3);
  result.values.resize(n, knots.degree() + 1);
  result.derivatives.resize(n, knots.degree() + 1);
  if (!is_cardinal(knots, span)) return general_values(knots, span, parameters, d, result);
  const double lower = knots.lower(span), h = knots.upper(span) - lower;
  switch (knots.degree()) {
  case 1:
    return cardinal_values<1>(parameters, d, lower, h, result);
  case 2:
    return cardinal_values<2>(parameters, d, lower, h, result);
  case 3:
    return cardinal_values<3>(parameters, d, lower, h, result);
  default:
    return cardinal_values<4>(parameters, d, lower, h, result);
  }
}

void tensor_values(const Univariate (&U)[3], Eigen::MatrixXd& values) {
  const Eigen::Index n = U[0].values.rows();
  const Eigen::Index m[3] = {U[0].values.cols(), U[1].values.cols(), U[2].values.cols()};
  values.resize(n, m[0] * m[1] * m[2]);
  if (n == 0) return;
  Eigen::Index column = 0;
  for (Eigen::Index c = 0; c < m[2]; ++c)
    for (Eigen::Index b = 0; b < m[1]; ++b)
      for (Eigen::Index a = 0; a < m[0]; ++a, ++column) {
        const double *u = &U[0].values(0, a), *v = &U[1].values(0, b), *w = &U[2].values(0, c);
        double* out = &values(0, column);
        for (Eigen::Index q = 0; q < n; ++q) out[q] = u[q] * v[q] * w[q];
      }
}

void tensor_gradients(const Univariate (&U)[3], const Rotation& R, Eigen::MatrixXd& gradients) {
  const Eigen::Index n = U[0].values.rows();
  const Eigen::Index m[3] = {U[0].values.cols(), U[1].values.cols(), U[2].values.cols()};
  gradients.resize(n, 3 * m[0] * m[1] * m[2]);
  if (n == 0) return;
  const bool rotated = R != identity_rotation;
  Eigen::Index column = 0;
  for (Eigen::Index c = 0; c < m[2]; ++c)
    for (Eigen::Index b = 0; b < m[1]; ++b)
      for (Eigen::Index a = 0; a < m[0]; ++a, column += 3) {
        const double *u = &U[0].values(0, a), *v = &U[1].values(0, b), *w = &U[2].values(0, c);
        const double *du = &U[0].derivatives(0, a), *dv = &U[1].derivatives(0, b), *dw = &U[2].derivatives(0, c);
        double *gx = &gradients(0, column), *gy = &gradients(0, column + 1), *gz = &gradients(0, column + 2);
        for (Eigen::Index q = 0; q < n; ++q) {
          gx[q] = du[q] * v[q] * w[q];
          gy[q] = u[q] * dv[q] * w[q];
          gz[q] = u[q] * v[q] * dw[q];
        }
        if (!rotated) continue;
        for (Eigen::Index q = 0; q < n; ++q) {
          const double g[3] = {gx[q], gy[q], gz[q]};
          gx[q] = R[0][0] * g[0] + R[0][1] * g[1] + R[0][2] * g[2];
          gy[q] = R[1][0] * g[0] + R[1][1] * g[1] + R[1][2] * g[2];
          gz[q] = R[2][0] * g[0] + R[2][1] * g[1] + R[2][2] * g[2];
        }
      }
}

// Gradient columns of one component: every third one.
using Component = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

Component component(Eigen::MatrixXd& gradients, Eigen::Index d) {
  return {gradients.data() + d * gradients.rows(), gradients.rows(), gradients.cols() / 3,
          Eigen::OuterStride<>(3 * gradients.rows())};
}

} // namespace

void evaluate(const SolutionSpace& space, std::int64_t a, std::span<const double> parameters, Shapes what,
              SpanShapes& shapes) {
  assert(parameters.size() % 3 == 0);
  const SplineGrid& grid = space.model().grid;
  const Index3 ijk = grid.span_index(space.model().cells.span[static_cast<std::size_t>(a)]);
  thread_local Univariate U[3];
  const auto univariate = space.is_bernstein(a) ? bernstein_values : univariate_values;
  for (std::size_t d = 0; d < 3; ++d) univariate(grid.knots(static_cast<int>(d)), ijk[d], parameters, d, U[d]);
  const Eigen::MatrixXd& extension = space.local_extension(a);
  const bool plain = extension.size() == 0;
  if (what != Shapes::Gradients) {
    tensor_values(U, plain ? shapes.values : shapes.work[0]);
    if (!plain) shapes.values.noalias() = shapes.work[0] * extension;
  }
  if (what != Shapes::Values) {
    tensor_gradients(U, grid.rotation(), plain ? shapes.gradients : shapes.work[1]);
    if (plain) return;
    shapes.gradients.resize(shapes.work[1].rows(), 3 * extension.cols());
    for (Eigen::Index d = 0; d < 3; ++d)
      component(shapes.gradients, d).noalias() = component(shapes.work[1], d) * extension;
  }
}

namespace {

std::span<const double> rows_of(const std::vector<double>& values, const std::vector<std::int64_t>& offsets,
                                std::int64_t a, std::size_t columns) {
  const auto first = static_cast<std::size_t>(offsets[static_cast<std::size_t>(a)]);
  const auto last = static_cast<std::size_t>(offsets[static_cast<std::size_t>(a) + 1]);
  return std::span(values).subspan(columns * first, columns * (last - first));
}

} // namespace

std::span<const double> cell_parameters(const TrimmedModel& model, std::int64_t a) {
  return rows_of(model.points.parameters, model.points.offsets, a, 3);
}
std::span<const double> cell_weights(const TrimmedModel& model, std::int64_t a) {
  return rows_of(model.points.weights, model.points.offsets, a, 1);
}
std::span<const double> surface_parameters(const TrimmedModel& model, std::int64_t a) {
  return rows_of(model.surface.quadrature.parameters, model.surface.quadrature.offsets, a, 3);
}

} // namespace iga::solve
