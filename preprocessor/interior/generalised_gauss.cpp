// Half of a symmetric rule is found by Newton's method on the moments of the B-splines, in extended precision.
// Equations and unknowns run along the run, so the matrix is a narrow band and the cost is linear in the length of the
// run.
#include "preprocessor/interior/generalised_gauss.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/base/gauss_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

namespace iga::prep {

namespace {

using Real = long double;
using Vector = std::vector<Real>;

constexpr int max_target_degree = 8;
// Runs up to this length are solved from a simple guess; longer ones start from a shorter one's rule.
constexpr std::int64_t short_run = 15;
// The rule repeats every two spans away from the ends and from the middle. A run grows by two spans on either side,
// inserted behind the layer at the end.
constexpr std::int64_t period = 2, end_layer = 3;

/// B-splines of the target space on [0, e].
class TargetSplines {
 public:
  TargetSplines(const TargetSpace& space, std::int64_t spans)
      : degree_(space.degree), step_(space.degree - space.continuity), spans_(spans) {}

  std::int64_t size() const { return step_ * (spans_ - 1) + degree_ + 1; }
  int degree() const { return degree_; }
  Real integral(std::int64_t i) const { return (knot(i + degree_ + 1) - knot(i)) / static_cast<Real>(degree_ + 1); }
  /// Centre of function i: the mean of its inner knots.
  Real greville(std::int64_t i) const {
    Real sum = 0;
    for (int k = 1; k <= degree_; ++k) sum += knot(i + k);
    return sum / static_cast<Real>(degree_);
  }
  /// Values and derivatives of the degree + 1 functions that do not vanish at x; returns the first one's number.
  std::int64_t evaluate(Real x, Real* values, Real* derivatives) const {
    const std::int64_t span = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(x)), 0, spans_ - 1);
    const std::int64_t first = step_ * span, top = first + degree_; // knot(top) <= x < knot(top + 1)
    values[0] = 1;
    for (int q = 1; q <= degree_; ++q) {
      if (q == degree_) differentiate(top, values, derivatives);
      Real saved = 0;
      for (int a = 0; a < q; ++a) {
        const Real right = knot(top + a + 1), left = knot(top + 1 - q + a);
        const Real share = values[a] / (right - left);
        values[a] = saved + (right - x) * share;
        saved = (x - left) * share;
      }
      values[q] = saved;
    }
    return first;
  }

 private:
  Real knot(std::int64_t j) const {
    return j <= degree_ ? 0 : static_cast<Real>(std::min(spans_, 1 + (j - degree_ - 1) / step_));
  }
  // From the values of one degree less.
  void differentiate(std::int64_t top, const Real* lower, Real* derivatives) const {
    Real before = 0;
    for (int a = 0; a <= degree_; ++a) {
      Real own = 0;
      if (a < degree_) own = degree_ * lower[a] / (knot(top + a + 1) - knot(top + 1 - degree_ + a));
      derivatives[a] = before - own;
      before = own;
    }
  }

  int degree_;
  std::int64_t step_, spans_;
};

/// The left half of a symmetric rule: nodes below e / 2 and, for an odd number of points, the weight at e / 2.
struct HalfRule {
  Vector x, w;
  std::optional<Real> middle;
};

/// Solves A z = b in place by elimination with partial pivoting; A[i][j] is zero for |i - j| > band.
/// Row i is stored from column i - band on, with room for the rows that pivoting brings up. False where A is singular.
bool solve_band(std::vector<Vector>& rows, std::int64_t band, Vector& b) {
  const auto n = static_cast<std::int64_t>(rows.size());
  const auto at = [&](std::int64_t i, std::int64_t j) -> Real& {
    return rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j - i + 2 * band)];
  };
  for (std::int64_t k = 0; k < n; ++k) {
    const std::int64_t last = std::min(n - 1, k + band), right = std::min(n - 1, k + 2 * band);
    std::int64_t pivot = k;
    for (std::int64_t i = k + 1; i <= last; ++i)
      if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
    if (!(std::abs(at(pivot, k)) > 0)) return false;
    if (pivot != k) {
      for (std::int64_t j = k; j <= right; ++j) std::swap(at(k, j), at(pivot, j));
      std::swap(b[static_cast<std::size_t>(k)], b[static_cast<std::size_t>(pivot)]);
    }
    for (std::int64_t i = k + 1; i <= last; ++i) {
      const Real factor = at(i, k) / at(k, k);
      if (factor == 0) continue;
      for (std::int64_t j = k + 1; j <= right; ++j) at(i, j) -= factor * at(k, j);
      b[static_cast<std::size_t>(i)] -= factor * b[static_cast<std::size_t>(k)];
    }
  }
  for (std::int64_t k = n; k-- > 0;) {
    Real sum = b[static_cast<std::size_t>(k)];
    for (std::int64_t j = k + 1; j <= std::min(n - 1, k + 2 * band); ++j)
      sum -= at(k, j) * b[static_cast<std::size_t>(j)];
    b[static_cast<std::size_t>(k)] = sum / at(k, k);
  }
  return true;
}

/// The square system of a symmetric rule: as many equations (functions up to the middle one) as unknowns.
class HalfSystem {
 public:
  HalfSystem(const TargetSpace& space, std::int64_t spans) : splines_(space, spans), spans_(spans) {}

  HalfRule guess() const {
    // Two functions share a point: at their common centre, with their common integral.
    const std::int64_t m = equations(), n = splines_.size();
    HalfRule rule;
    for (std::int64_t i = 0; i + 1 < m; i += 2) {
      const bool halved = i + 2 == m && n % 2 == 1; // the middle function belongs to both halves
      const Real a = splines_.integral(i), b = splines_.integral(i + 1) * (halved ? 0.5L : 1.0L);
      rule.x.push_back(
          std::min((a * splines_.greville(i) + b * splines_.greville(i + 1)) / (a + b), 0.499L * length()));
      rule.w.push_back(a + b);
    }
    if (m % 2 == 1) rule.middle = splines_.integral(m - 1) * (n % 2 == 1 ? 1 : 2);
    return rule;
  }

  /// Newton's method with steps shortened so that the residual falls and the rule stays admissible.
  bool solve(HalfRule& rule) const {
    constexpr int most_steps = 60;
    Vector r = residual(rule);
    for (int step = 0; step < most_steps; ++step) {
      const Real size = norm(r);
      if (size <= rounding()) return true;
      Vector z = r;
      if (!newton_step(rule, z)) return false;
      Real length = 1;
      for (; length > 1e-4L; length /= 2) {
        HalfRule next = moved(rule, z, length);
        if (!is_admissible(next)) continue;
        Vector s = residual(next);
        if (!(norm(s) < size)) continue;
        rule = std::move(next);
        r = std::move(s);
        break;
      }
      if (length <= 1e-4L) return size <= 100 * rounding();
    }
    return false;
  }

 private:
  std::int64_t equations() const { return (splines_.size() + 1) / 2; }
  Real length() const { return static_cast<Real>(spans_); }
  Real rounding() const { return 4 * std::numeric_limits<Real>::epsilon() * length(); }

  static Real norm(const Vector& r) {
    Real largest = 0;
    for (const Real v : r) largest = std::max(largest, std::abs(v));
    return largest;
  }

  // use(equation, value, derivative) of everything that a left node and its mirror image add.
  template <class Use> void for_functions(Real x, Use&& use) const {
    std::array<Real, max_target_degree + 1> N, D;
    const std::int64_t first = splines_.evaluate(x, N.data(), D.data()), n = splines_.size(), m = equations();
    for (int a = 0; a <= splines_.degree(); ++a) {
      const std::int64_t i = first + a, mirrored = n - 1 - i;
      const auto k = static_cast<std::size_t>(a);
      if (i < m) use(i, N[k], D[k]);
      if (mirrored < m) use(mirrored, N[k], D[k]);
    }
  }

  Vector residual(const HalfRule& rule) const {
    Vector r(static_cast<std::size_t>(equations()));
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = -splines_.integral(static_cast<std::int64_t>(i));
    for (std::size_t q = 0; q < rule.x.size(); ++q)
      for_functions(rule.x[q], [&](std::int64_t i, Real N, Real) { r[static_cast<std::size_t>(i)] += rule.w[q] * N; });
    if (rule.middle) // its own mirror image
      for_functions(length() / 2,
                    [&](std::int64_t i, Real N, Real) { r[static_cast<std::size_t>(i)] += *rule.middle * N / 2; });
    return r;
  }

  // z: residual → change of x_0, w_0, x_1, …, (middle weight).
  bool newton_step(const HalfRule& rule, Vector& z) const {
    const std::int64_t m = equations();
    std::vector<std::tuple<std::int64_t, std::int64_t, Real>> entries;
    for (std::size_t q = 0; q < rule.x.size(); ++q)
      for_functions(rule.x[q], [&](std::int64_t i, Real N, Real D) {
        const auto column = static_cast<std::int64_t>(2 * q);
        entries.emplace_back(i, column, rule.w[q] * D);
        entries.emplace_back(i, column + 1, N);
      });
    if (rule.middle)
      for_functions(length() / 2, [&](std::int64_t i, Real N, Real) { entries.emplace_back(i, m - 1, N / 2); });
    std::int64_t band = 0;
    for (const auto& [i, j, value] : entries) band = std::max(band, std::abs(i - j));
    std::vector<Vector> rows(static_cast<std::size_t>(m), Vector(static_cast<std::size_t>(4 * band + 1), 0));
    for (const auto& [i, j, value] : entries)
      rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j - i + 2 * band)] += value;
    return solve_band(rows, band, z);
  }

  static HalfRule moved(HalfRule rule, const Vector& z, Real length) {
    for (std::size_t q = 0; q < rule.x.size(); ++q) {
      rule.x[q] -= length * z[2 * q];
      rule.w[q] -= length * z[2 * q + 1];
    }
    if (rule.middle) *rule.middle -= length * z.back();
    return rule;
  }

  bool is_admissible(const HalfRule& rule) const {
    Real before = 0;
    for (std::size_t q = 0; q < rule.x.size(); ++q) {
      if (!(rule.x[q] > before && rule.w[q] > 0)) return false;
      before = rule.x[q];
    }
    return before < length() / 2 && (!rule.middle || *rule.middle > 0);
  }

  TargetSplines splines_;
  std::int64_t spans_;
};

// A longer run's first guess: `times` more periods behind the layer at the end (and, by symmetry, before the other
// end).
HalfRule extended(const HalfRule& rule, std::int64_t times) {
  HalfRule longer;
  longer.middle = rule.middle;
  const auto take = [&](Real from, Real to, Real shift) {
    for (std::size_t q = 0; q < rule.x.size(); ++q)
      if (rule.x[q] >= from && rule.x[q] < to) {
        longer.x.push_back(rule.x[q] + shift);
        longer.w.push_back(rule.w[q]);
      }
  };
  take(0, end_layer, 0);
  for (std::int64_t k = 0; k < times; ++k) take(end_layer, end_layer + period, static_cast<Real>(k * period));
  take(end_layer, std::numeric_limits<Real>::infinity(), static_cast<Real>(times * period));
  return longer;
}

std::optional<HalfRule> half_rule(const TargetSpace& space, std::int64_t spans) {
  const HalfSystem system(space, spans);
  if (spans <= short_run) {
    HalfRule rule = system.guess();
    return system.solve(rule) ? std::optional(rule) : std::nullopt;
  }
  // All the missing periods at once; where the end layer reaches further, one by one.
  const std::int64_t missing = (spans - short_run + 2 * period - 1) / (2 * period);
  for (const std::int64_t times : {missing, std::int64_t{1}}) {
    const auto shorter = half_rule(space, spans - 2 * period * times);
    if (!shorter) return {};
    HalfRule rule = extended(*shorter, times);
    if (system.solve(rule)) return rule;
  }
  return {};
}

// Gauss points in every span.
RunRule separate_spans(int points, std::int64_t spans) {
  const LineRule& gauss = gauss_legendre(points);
  RunRule rule;
  for (std::int64_t i = 0; i <= spans; ++i) rule.first.push_back(static_cast<std::int32_t>(i * points));
  for (std::int64_t i = 0; i < spans; ++i) {
    rule.position.insert(rule.position.end(), gauss.nodes.begin(), gauss.nodes.end());
    rule.weights.insert(rule.weights.end(), gauss.weights.begin(), gauss.weights.end());
  }
  return rule;
}

RunRule whole_rule(const HalfRule& half, std::int64_t spans) {
  // Position and span of the left nodes; the right ones are their exact mirror images.
  std::vector<std::pair<std::int64_t, double>> left;
  for (const Real x : half.x) {
    const auto span = static_cast<std::int64_t>(std::floor(x));
    left.emplace_back(span, static_cast<double>(x - static_cast<Real>(span)));
  }
  RunRule rule;
  rule.first.push_back(0);
  std::int64_t span = 0;
  const auto add = [&](std::int64_t own, double position, Real weight) {
    for (; span < own; ++span) rule.first.push_back(static_cast<std::int32_t>(rule.position.size()));
    rule.position.push_back(position);
    rule.weights.push_back(static_cast<double>(weight));
  };
  for (std::size_t q = 0; q < left.size(); ++q) add(left[q].first, left[q].second, half.w[q]);
  if (half.middle) add(spans / 2, spans % 2 == 1 ? 0.5 : 0.0, *half.middle);
  for (std::size_t q = left.size(); q-- > 0;) add(spans - 1 - left[q].first, 1 - left[q].second, half.w[q]);
  for (; span < spans; ++span) rule.first.push_back(static_cast<std::int32_t>(rule.position.size()));
  return rule;
}

} // namespace

TargetSpace target_space(const std::string& interior_rule, int p) {
  if (interior_rule == "gauss") return {2 * p + 1, -1};
  if (interior_rule == "ggq") return {2 * p, p - 2};
  if (interior_rule == "ggq-reduced") return p == 1 ? TargetSpace{2, -1} : TargetSpace{2 * p - 1, p - 2};
  if (interior_rule != "ggq-reduced2")
    throw InputError(
        fmt::format("interior rule '{}' is not known; choose gauss, ggq, ggq-reduced or ggq-reduced2", interior_rule));
  if (p <= 2)
    throw InputError(
        fmt::format("interior rule ggq-reduced2 at degree {}: so few points leave hourglass modes (motions "
                    "without energy); choose ggq-reduced, or a degree of at least 3 in all directions",
                    p));
  return {2 * p - 2, p - 2};
}

std::int64_t run_points(const TargetSpace& space, std::int64_t spans) {
  if (space.continuity < 0) return spans * ((space.degree + 2) / 2);
  return ((space.degree - space.continuity) * spans + space.continuity + 2) / 2;
}

std::shared_ptr<const RunRule> run_rule(const TargetSpace& space, std::int64_t spans) {
  static std::mutex mutex;
  static std::map<std::tuple<int, int, std::int64_t>, std::shared_ptr<const RunRule>> rules;
  const std::tuple key(space.degree, space.continuity, spans);
  {
    const std::lock_guard lock(mutex);
    if (const auto found = rules.find(key); found != rules.end()) return found->second;
  }
  std::shared_ptr<const RunRule> rule;
  if (space.continuity < 0) {
    rule = std::make_shared<const RunRule>(separate_spans((space.degree + 2) / 2, spans));
  } else {
    const auto half = half_rule(space, spans);
    if (!half)
      throw NumericalError(
          fmt::format("no generalised Gaussian rule was found for degree {}, continuity {} on {} spans; "
                      "choose --quadrature gauss",
                      space.degree, space.continuity, spans));
    rule = std::make_shared<const RunRule>(whole_rule(*half, spans));
  }
  const std::lock_guard lock(mutex);
  return rules.try_emplace(key, std::move(rule)).first->second;
}

} // namespace iga::prep
