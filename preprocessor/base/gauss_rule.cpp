#include "preprocessor/base/gauss_rule.hpp"

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

/// Rule in extended precision, nodes ascending.
struct LongRule {
  std::vector<long double> nodes, weights;
};

// Gauss rule on [-1, 1] for the weight (1 - x)^alpha, alpha = 0 or 1, from the recurrence of its orthonormal
// polynomials β_{k+1} p_{k+1} = (x - α_k) p_k - β_k p_{k-1}; the weight of a node is 1 / Σ p_k².
LongRule make_gauss(int n, int alpha) {
  const auto diagonal = [&](int k) { return alpha == 0 ? 0.0L : -1.0L / ((2.0L * k + 1) * (2.0L * k + 3)); };
  const auto off = [&](int k) {
    return alpha == 0 ? k / std::sqrt(4.0L * k * k - 1) : std::sqrt(k * (k + 1.0L)) / (2.0L * k + 1);
  };
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < n; ++k) {
    jacobi(k, k) = static_cast<double>(diagonal(k));
    if (k > 0) jacobi(k, k - 1) = jacobi(k - 1, k) = static_cast<double>(off(k));
  }
  const Eigen::VectorXd guess =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(jacobi, Eigen::EigenvaluesOnly).eigenvalues();
  const long double p_first = std::sqrt(0.5L); // both weights have the mass 2
  LongRule rule;
  for (int i = 0; i < n; ++i) {
    long double x = guess[i], squares = 0;
    for (int step = 0; step < 4; ++step) {
      long double p0 = 0, p1 = p_first, d0 = 0, d1 = 0;
      squares = p1 * p1;
      for (int k = 0; k < n; ++k) {
        const long double b0 = k > 0 ? off(k) : 0, b1 = off(k + 1);
        const long double p2 = ((x - diagonal(k)) * p1 - b0 * p0) / b1;
        const long double d2 = (p1 + (x - diagonal(k)) * d1 - b0 * d0) / b1;
        p0 = p1, p1 = p2, d0 = d1, d1 = d2;
        if (k + 1 < n) squares += p1 * p1;
      }
      x -= p1 / d1;
    }
    rule.nodes.push_back((1 + x) / 2);
    rule.weights.push_back(1 / squares / (alpha == 0 ? 2 : 4)); // d(x) and (1 - x) both halve on [0, 1]
  }
  return rule;
}

LineRule make_gauss_legendre(int n) {
  const LongRule rule = make_gauss(n, 0);
  return {{rule.nodes.begin(), rule.nodes.end()}, {rule.weights.begin(), rule.weights.end()}};
}

template <class T> TriangleProductRule<T> make_triangle_rule(int degree) {
  const int n = degree / 2 + 1;
  const LongRule a = make_gauss(n, 1), b = make_gauss(n, 0);
  TriangleProductRule<T> rule;
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    for (std::size_t j = 0; j < b.nodes.size(); ++j) {
      rule.s.push_back(static_cast<T>(a.nodes[i]));
      rule.t.push_back(static_cast<T>((1 - a.nodes[i]) * b.nodes[j]));
      rule.weights.push_back(static_cast<T>(2 * a.weights[i] * b.weights[j]));
    }
  return rule;
}

} // namespace

const LineRule& gauss_legendre(int n) {
  static RuleCache<LineRule, max_points + 1> cache;
  return cache.get(n, make_gauss_legendre);
}

template <class T> const TriangleProductRule<T>& triangle_product_rule(int degree) {
  static RuleCache<TriangleProductRule<T>, 2 * max_points> cache;
  return cache.get(degree, make_triangle_rule<T>);
}

template const TriangleProductRule<double>& triangle_product_rule<double>(int);
template const TriangleProductRule<long double>& triangle_product_rule<long double>(int);

} // namespace iga::prep
