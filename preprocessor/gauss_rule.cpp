#include "preprocessor/gauss_rule.hpp"

#include <Eigen/Eigenvalues>

#include <array>
#include <cassert>
#include <cmath>
#include <mutex>

namespace iga::prep {

namespace {

constexpr int max_points = 64;

/// Rules made on demand, one slot per number of points; safe to ask from several threads.
template <class Rule, std::size_t size> class RuleCache {
public:
  template <class Make> const Rule& get(int n, Make&& make) {
    assert(n >= 0 && static_cast<std::size_t>(n) < size);
    const auto slot = static_cast<std::size_t>(n);
    std::call_once(once_[slot], [&] { rules_[slot] = make(n); });
    return rules_[slot];
  }

private:
  std::array<std::once_flag, size> once_;
  std::array<Rule, size> rules_;
};

LineRule make_gauss_legendre(int n) {
  LineRule rule{std::vector<double>(static_cast<std::size_t>(n)), std::vector<double>(static_cast<std::size_t>(n))};
  for (int i = 0; i < n; ++i) {
    double x = -std::cos((i + 0.75) / (n + 0.5) * 3.14159265358979323846), derivative = 1;
    for (int step = 0; step < 100; ++step) {
      double p0 = 1, p1 = x;
      for (int a = 1; a < n; ++a) {
        const double p2 = ((2 * a + 1) * x * p1 - a * p0) / (a + 1);
        p0 = p1;
        p1 = p2;
      }
      derivative = n * (x * p1 - p0) / (x * x - 1);
      const double dx = p1 / derivative;
      x -= dx;
      if (std::abs(dx) <= 1e-16) break;
    }
    rule.nodes[static_cast<std::size_t>(i)] = 0.5 * (1 + x);
    rule.weights[static_cast<std::size_t>(i)] = 1 / ((1 - x * x) * derivative * derivative);
  }
  return rule;
}

LineRule make_gauss_jacobi(int n) {
  // Monic recurrence of Jacobi(1, 0) on [-1, 1]: weight (1 - x), mass 2.
  Eigen::VectorXd diagonal(n), off(std::max(n - 1, 0));
  for (int k = 0; k < n; ++k) diagonal[k] = -1.0 / ((2.0 * k + 1) * (2.0 * k + 3));
  for (int k = 1; k < n; ++k) off[k - 1] = std::sqrt(k * (k + 1.0)) / (2.0 * k + 1);
  LineRule rule;
  if (n == 1) {
    rule.nodes = {0.5 * (1 + diagonal[0])};
    rule.weights = {0.5};
    return rule;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, off);
  for (int i = 0; i < n; ++i) {
    rule.nodes.push_back(0.5 * (1 + solver.eigenvalues()[i]));
    rule.weights.push_back(0.5 * solver.eigenvectors()(0, i) * solver.eigenvectors()(0, i));
  }
  return rule;
}

TriangleProductRule make_triangle_rule(int degree) {
  const int n = degree / 2 + 1;
  const LineRule& a = gauss_jacobi(n);
  const LineRule& b = gauss_legendre(n);
  TriangleProductRule rule;
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    for (std::size_t j = 0; j < b.nodes.size(); ++j) {
      rule.s.push_back(a.nodes[i]);
      rule.t.push_back((1 - a.nodes[i]) * b.nodes[j]);
      rule.weights.push_back(2 * a.weights[i] * b.weights[j]);
    }
  return rule;
}

} // namespace

const LineRule& gauss_legendre(int n) {
  static RuleCache<LineRule, max_points + 1> cache;
  return cache.get(n, make_gauss_legendre);
}

const LineRule& gauss_jacobi(int n) {
  static RuleCache<LineRule, max_points + 1> cache;
  return cache.get(n, make_gauss_jacobi);
}

const TriangleProductRule& triangle_product_rule(int degree) {
  static RuleCache<TriangleProductRule, 2 * max_points> cache;
  return cache.get(degree, make_triangle_rule);
}

} // namespace iga::prep
