#include "format/model/knot_vector.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga {

KnotVector::KnotVector(int degree, std::vector<double> knots) : degree_(degree), knots_(std::move(knots)) {
  if (degree < 1 || degree > max_degree)
    throw InputError(fmt::format("degree {} is not supported; choose 1 … {}", degree, max_degree));
  const auto p = static_cast<std::size_t>(degree);
  if (knots_.size() < 2 * (p + 1))
    throw InputError(fmt::format("a knot vector of degree {} needs at least {} knots, found {}", degree, 2 * (p + 1),
                                 knots_.size()));
  for (double u : knots_)
    if (!std::isfinite(u)) throw InputError("a knot is not a finite number");
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
    const bool at_an_end = i < p || i + 1 >= knots_.size() - p;
    const bool fits = at_an_end ? knots_[i] == knots_[i + 1] : knots_[i] < knots_[i + 1];
    if (!fits)
      throw InputError(fmt::format("knots {} and {} ({} and {}) do not form an open knot vector of degree {} with "
                                   "simple inner knots",
                                   i, i + 1, knots_[i], knots_[i + 1], degree));
  }
}

KnotVector KnotVector::uniform(int degree, double a, double b, std::int64_t num_spans) {
  if (num_spans < 1) throw InputError(fmt::format("a direction needs at least one span, found {}", num_spans));
  if (degree < 1 || degree > max_degree)
    throw InputError(fmt::format("degree {} is not supported; choose 1 … {}", degree, max_degree));
  std::vector<double> knots;
  knots.reserve(static_cast<std::size_t>(num_spans + 2 * degree + 1));
  knots.assign(static_cast<std::size_t>(degree + 1), a);
  for (std::int64_t i = 1; i < num_spans; ++i)
    knots.push_back(a + (b - a) * (static_cast<double>(i) / static_cast<double>(num_spans)));
  knots.insert(knots.end(), static_cast<std::size_t>(degree + 1), b);
  return {degree, std::move(knots)};
}

std::int64_t KnotVector::find_span(double u) const {
  const auto first = knots_.begin() + degree_;
  const auto last = knots_.end() - degree_ - 1;
  const auto it = std::upper_bound(first, last, u);
  return std::clamp<std::int64_t>(it - first - 1, 0, num_spans() - 1);
}

double KnotVector::integral(std::int64_t function) const {
  const auto i = static_cast<std::size_t>(function), order = static_cast<std::size_t>(degree_ + 1);
  return (knots_[i + order] - knots_[i]) / static_cast<double>(order);
}

double KnotVector::greville(std::int64_t function) const {
  double sum = 0;
  for (int a = 1; a <= degree_; ++a) sum += knots_[static_cast<std::size_t>(function + a)];
  return sum / degree_;
}

} // namespace iga
