#include "preprocessor/fit/moment_fitting.hpp"

#include "format/model/vec3.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

// The solid's part fills its bounding box: volumes are exact to rounding, and a part that is not a box misses more.
constexpr double box_defect = 1e-12;
// A facet counts as parallel to an axis when its projected area along it is rounding (relative to its own area).
constexpr double parallel_defect = 1e-12;
// NNLS runs on until the residual is well below what is asked for, so that rounding of the points cannot spoil it.
constexpr double safety = 0.1;
constexpr int max_levels = 7;
// With more moments than this it pays to make the basis orthonormal before the fit: fewer exchanges than it costs.
constexpr std::size_t plain_moments = 40;
// Cholesky factors of Gram matrices are trusted down to this ratio of their diagonals (the square root of rounding).
constexpr double dependent_basis = 1e-6;
// Polynomials this small (relative) on the solid cannot change a moment by more than the tolerance.
constexpr double negligible_direction = 1e-12;

// The solid's part is [0, 1] along `axis` times a plane region: every facet is parallel to the axis or caps an end.
bool is_prism(const LocalSurface& surface, std::size_t axis) {
  for (std::size_t q = 0; q < surface.num_polygons(); ++q) {
    const auto v = surface.polygon(q);
    const auto on = [&](double end) {
      return std::all_of(v.begin(), v.end(), [&](const Point3& x) { return x[axis] == end; });
    };
    if (on(0) || on(1)) continue;
    Point3 n{};
    for (std::size_t a = 1; a + 1 < v.size(); ++a) {
      const Point3 m = twice_area(v[0], v[a], v[a + 1]);
      for (std::size_t d = 0; d < 3; ++d) n[d] += m[d];
    }
    if (std::abs(n[axis]) > parallel_defect * norm(n)) return false;
  }
  return true;
}

} // namespace

MomentFitter::MomentFitter(const SplineGrid& grid, const Trimming& trimming, const FarMoments& far,
                           const std::array<int, 3>& degree, double tolerance)
    : degree_(degree), tolerance_(tolerance), part_(grid, trimming, far, degree) {}

const SpanRule& MomentFitter::fit(std::size_t touched) {
  part_.open(touched);
  rule_ = {std::move(rule_.points), std::move(rule_.weights), 0, SpanShape::Free, -1, false, 0};
  if (part_.moments()[0] >= 1 - box_defect) {
    fit_box();
  } else {
    std::size_t axis = 0;
    while (axis < 3 && !is_prism(part_.surface(), axis)) ++axis;
    if (axis < 3) fit_prism(axis);
    if (axis == 3 || !(rule_.residual <= tolerance_) || !part_.holds(rule_.points)) fit_free();
  }
  part_.to_spans(rule_.points, rule_.weights);
  return rule_;
}

void MomentFitter::fit_box() {
  rule_.shape = SpanShape::Box;
  box_rule({product_points(degree_[0]), product_points(degree_[1]), product_points(degree_[2])}, part_.moments()[0],
           rule_.points, rule_.weights);
  rule_.residual = part_.residual(rule_.points, rule_.weights);
}

void MomentFitter::fit_prism(std::size_t axis) {
  rule_.shape = SpanShape::Prism;
  rule_.axis = static_cast<int>(axis);
  fit_nnls(part_.plane_degree(axis), part_.plane_moments(axis), rule_.axis);
  prism_rule(axis, product_points(degree_[axis]), fit_points_, fit_weights_, rule_.points, rule_.weights);
  rule_.residual = part_.residual(rule_.points, rule_.weights);
}

void MomentFitter::fit_free() {
  rule_.shape = SpanShape::Free;
  rule_.axis = -1;
  fit_nnls(degree_, part_.moments(), -1);
  rule_.points = fit_points_;
  rule_.weights = fit_weights_;
  rule_.residual = part_.residual(rule_.points, rule_.weights);
}

namespace {

std::size_t other_axis(std::size_t axis) {
  return axis == 0 ? 1 : 0;
}

void shoot(LineCaster& caster, std::size_t axis, int num_lines, int points_per_line, int min_points, int prism_axis,
           std::vector<double>& points) {
  // Along a prism the lines stay in its middle plane.
  static const std::vector<double> middle{0.5};
  const std::size_t b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  const std::vector<double>& lattice = gauss_legendre(std::min(num_lines, 64)).nodes;
  caster.append_candidates(axis, static_cast<int>(b) == prism_axis ? middle : lattice,
                           static_cast<int>(c) == prism_axis ? middle : lattice, points_per_line, min_points, points);
}

} // namespace

// First candidates, along the axis that shows the most surface: about twice as many as moments; thin and pointed parts
// need more lines for that, needles rays that start at their surface.
void MomentFitter::shoot_first(int prism_axis, std::size_t num_moments) {
  const int q = std::max({degree_[0], degree_[1], degree_[2]});
  const bool plane = prism_axis >= 0;
  std::size_t axis = part_.caster().main_axis();
  if (static_cast<int>(axis) == prism_axis) axis = other_axis(axis);
  for (int n = plane ? 2 * q + 3 : q + 2; n <= 8 * (q + 2); n += n / 2) {
    new_points_.clear();
    shoot(part_.caster(), axis, n, q + 2, 2, prism_axis, new_points_);
    if (new_points_.size() >= 3 * 2 * num_moments) return;
  }
  if (!plane) part_.caster().append_inward_candidates(2 * q, 2 * num_moments, 3, new_points_);
}

// Denser candidates along all axes, and into the solid from its surface; each level has its own lines.
void MomentFitter::shoot_more(int level, int prism_axis) {
  const int q = std::max({degree_[0], degree_[1], degree_[2]});
  new_points_.clear();
  for (int d = 0; d < 3; ++d)
    if (d != prism_axis)
      shoot(part_.caster(), static_cast<std::size_t>(d), (prism_axis >= 0 ? 4 : 1) * (q + 1) + (q + 1) * level + d,
            q + 2 + level, 2 + level, prism_axis, new_points_);
  if (prism_axis < 0)
    part_.caster().append_inward_candidates(2 * q + 2 * level, 2 * part_.moments().size(), 2 + level, new_points_);
}

// Values of the tensor Legendre basis at points: one column of m entries a point.
void MomentFitter::evaluate_columns(const std::array<int, 3>& degree, std::span<const double> points) {
  const std::size_t n = points.size() / 3;
  const auto m = static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1));
  columns_.resize(n * m);
  double P[3][max_moment_degree + 1];
  double* out = columns_.data();
  for (std::size_t g = 0; g < n; ++g) {
    for (std::size_t d = 0; d < 3; ++d) legendre(points[3 * g + d], degree[d], P[d]);
    for (int c = 0; c <= degree[2]; ++c)
      for (int b = 0; b <= degree[1]; ++b) {
        const double bc = P[1][b] * P[2][c];
        for (int a = 0; a <= degree[0]; ++a) *out++ = P[0][a] * bc;
      }
  }
}

void MomentFitter::fit_nnls(const std::array<int, 3>& degree, std::span<const double> moments, int prism_axis) {
  const std::size_t m = moments.size();
  shoot_first(prism_axis, m);
  candidates_ = new_points_;
  evaluate_columns(degree, new_points_);
  const std::size_t count = new_points_.size() / 3;
  rhs_.assign(moments.begin(), moments.end());
  bool sound = true;
  if (m > plain_moments) sound = whiten_by_cholesky(count);
  if (sound) {
    nnls_.start(rhs_);
    nnls_.add_columns(columns_, count);
    sound = nnls_.solve(safety * tolerance_, 3 * static_cast<int>(m)) == Nnls::Status::Converged;
    rule_.nnls_steps += nnls_.num_steps();
  }
  if (!sound) {
    rule_.refined = true;
    fit_nnls_whitened(degree, moments, prism_axis);
  }
  take_points();
}

// Makes the basis orthonormal over the candidates: columns and right-hand side are multiplied by L^{-1} of the Gram
// matrix A A^T = L L^T. False where the basis is too dependent for that.
bool MomentFitter::whiten_by_cholesky(std::size_t count) {
  const auto m = static_cast<Eigen::Index>(rhs_.size());
  Eigen::Map<Eigen::MatrixXd> A(columns_.data(), m, static_cast<Eigen::Index>(count));
  gram_.setZero(m, m);
  gram_.selfadjointView<Eigen::Lower>().rankUpdate(A);
  cholesky_.compute(gram_);
  if (cholesky_.info() != Eigen::Success) return false;
  const auto diagonal = cholesky_.matrixLLT().diagonal();
  if (diagonal.minCoeff() < dependent_basis * diagonal.maxCoeff()) return false;
  cholesky_.matrixL().solveInPlace(A);
  Eigen::Map<Eigen::VectorXd> b(rhs_.data(), m);
  cholesky_.matrixL().solveInPlace(b);
  return true;
}

void MomentFitter::take_points() {
  fit_points_.clear();
  fit_weights_.clear();
  for (std::size_t i = 0; i < nnls_.num_passive(); ++i) {
    const double* x = &candidates_[3 * nnls_.passive(i)];
    fit_points_.insert(fit_points_.end(), x, x + 3);
    fit_weights_.push_back(nnls_.weight(i));
  }
}

// On wedges, corners and thin sheets the Legendre polynomials of the box are almost dependent, and directions of small
// singular values are drowned. Here the basis is made orthonormal over the candidates first, A^T P = Q R: the rows of Q
// are the columns of the problem, R^{-T} P^T b its right-hand side, and directions below the rounding of b are left
// out.
void MomentFitter::fit_nnls_whitened(const std::array<int, 3>& degree, std::span<const double> moments,
                                     int prism_axis) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto m = static_cast<Eigen::Index>(moments.size());
  for (int level = 1; candidates_.size() < 3 * 5 * moments.size() && level < 4; ++level) {
    shoot_more(level, prism_axis);
    candidates_.insert(candidates_.end(), new_points_.begin(), new_points_.end());
  }
  evaluate_columns(degree, candidates_);
  auto count = static_cast<Eigen::Index>(candidates_.size() / 3);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(Eigen::Map<const RowMajor>(columns_.data(), count, m));
  Eigen::Index rank = std::min(m, count);
  while (rank > 1 && std::abs(qr.matrixQR()(rank - 1, rank - 1)) < negligible_direction * std::abs(qr.matrixQR()(0, 0)))
    --rank;
  const Eigen::MatrixXd R = qr.matrixQR().topLeftCorner(rank, rank);
  const auto whiten = [&](const Eigen::VectorXd& column) -> Eigen::VectorXd {
    Eigen::VectorXd x = (qr.colsPermutation().transpose() * column).head(rank);
    R.triangularView<Eigen::Upper>().transpose().solveInPlace(x);
    return x;
  };
  const Eigen::VectorXd b = whiten(Eigen::Map<const Eigen::VectorXd>(moments.data(), m));
  nnls_.start(std::span(b.data(), static_cast<std::size_t>(rank)));
  RowMajor Q = qr.householderQ() * Eigen::MatrixXd::Identity(count, rank);
  nnls_.add_columns(std::span(Q.data(), static_cast<std::size_t>(Q.size())), static_cast<std::size_t>(count));
  for (int level = 2;; ++level) {
    const auto status = nnls_.solve(safety * tolerance_, 5 * static_cast<int>(m));
    if (status == Nnls::Status::Converged || level > max_levels) {
      rule_.nnls_steps += nnls_.num_steps();
      return;
    }
    // The residual is a polynomial with a positive integral over the solid: it is positive somewhere inside, and only
    // candidates where it is can lower it.
    shoot_more(level, prism_axis);
    evaluate_columns(degree, new_points_);
    const Eigen::Map<const Eigen::VectorXd> r(nnls_.residual().data(), rank);
    std::vector<std::pair<double, Eigen::Index>> order;
    count = static_cast<Eigen::Index>(new_points_.size() / 3);
    const Eigen::Map<const RowMajor> columns(columns_.data(), count, m);
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(m); // r^T R^{-T} P^T as a row over the original columns
    direction.head(rank) = R.triangularView<Eigen::Upper>().solve(r);
    direction = qr.colsPermutation() * direction;
    const Eigen::VectorXd ascent = columns * direction;
    for (Eigen::Index g = 0; g < count; ++g)
      if (ascent[g] > 0) order.emplace_back(-ascent[g], g);
    std::sort(order.begin(), order.end());
    order.resize(std::min(order.size(), 2 * moments.size()));
    RowMajor added(static_cast<Eigen::Index>(order.size()), rank);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Eigen::Index g = order[i].second;
      added.row(static_cast<Eigen::Index>(i)) = whiten(columns.row(g).transpose()).transpose();
      candidates_.insert(candidates_.end(), &new_points_[static_cast<std::size_t>(3 * g)],
                         &new_points_[static_cast<std::size_t>(3 * g)] + 3);
    }
    nnls_.add_columns(std::span(added.data(), static_cast<std::size_t>(added.size())), order.size());
  }
}

} // namespace iga::prep
