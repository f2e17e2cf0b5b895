// Open knot vectors: degree, knots, spans; the rule that gives a parameter its span.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace iga {

constexpr int max_degree = 4;

/// Open (clamped) knot vector of degree p over n non-empty, simple knot spans:
/// knots = { a (p+1 times), inner knots, b (p+1 times) }, n + p functions. Immutable.
class KnotVector {
 public:
  KnotVector() = default;
  /// @param degree  1 … max_degree
  /// @param knots   n + 2p + 1 values, ascending, first and last repeated p + 1 times, inner knots simple
  /// @throws InputError where the values are not such a vector
  KnotVector(int degree, std::vector<double> knots);
  /// `num_spans` equal spans between a and b; the inner knot i is a + (b - a) i / num_spans, correctly rounded once.
  static KnotVector uniform(int degree, double a, double b, std::int64_t num_spans);

  int degree() const { return degree_; }
  std::int64_t num_spans() const { return static_cast<std::int64_t>(knots_.size()) - 2 * degree_ - 1; }
  std::int64_t num_functions() const { return num_spans() + degree_; }
  std::span<const double> values() const { return knots_; }
  double lower(std::int64_t span) const { return knots_[static_cast<std::size_t>(span + degree_)]; }
  double upper(std::int64_t span) const { return knots_[static_cast<std::size_t>(span + degree_ + 1)]; }
  /// Span e with lower(e) <= u < upper(e); the last span for u = b, the nearest one outside [a, b].
  std::int64_t find_span(double u) const;
  /// Mean of the p knots that follow knot i: the coefficient of function i in the identity u = Σ g_i N_i(u).
  double greville(std::int64_t function) const;
  /// ∫ N over all spans, parameter units: (U[i + p + 1] - U[i]) / (p + 1). Piegl & Tiller (1997), exercise of
  /// section 2.
  double integral(std::int64_t function) const;

 private:
  int degree_ = 1;
  std::vector<double> knots_;
};

} // namespace iga
