#include "solver/space/light_functions.hpp"

#include "format/model/errors.hpp"
#include "solver/space/span_advice.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <tbb/parallel_for.h>
#include <unordered_map>

namespace iga::solve {

namespace {

constexpr double lowest_threshold = 1e-9; // a part that has no good span above it is filled with fictitious material
constexpr double fictitious_share = 1e-3; // its stiffness and mass, relative to the material's

// Coefficients of a polynomial on one span, carried over to a function elsewhere: the blossom of the polynomial at the
// function's p inner knots, by de Boor's algorithm with one knot per level (Ramshaw 1989).
// weights[b]: share of function span + b.
void degree_p_weights(const KnotVector& knots, std::int64_t span, std::int64_t function, double* weights) {
  const int p = knots.degree();
  const auto U = knots.values();
  const auto k = static_cast<std::size_t>(span + p); // U[k] <= span <= U[k + 1]
  const auto degree = static_cast<std::size_t>(p);
  for (std::size_t b = 0; b <= degree; ++b) {
    double c[max_degree + 1]{};
    c[b] = 1;
    for (std::size_t level = 1; level <= degree; ++level) {
      const double t = U[static_cast<std::size_t>(function) + level];
      for (std::size_t j = degree; j >= level; --j) {
        const double left = U[k - degree + j], right = U[k + 1 + j - level];
        c[j] = ((right - t) * c[j - 1] + (t - left) * c[j]) / (right - left);
      }
    }
    weights[b] = c[degree];
  }
}

// Linear interpolation or extrapolation of the Greville abscissae between the two functions of the span next to it.
void linear_weights(const KnotVector& knots, std::int64_t span, std::int64_t function, double* weights) {
  const int p = knots.degree();
  const auto a = std::clamp<std::int64_t>(function - span, 0, p - 1);
  const double g0 = knots.greville(span + a), g1 = knots.greville(span + a + 1);
  std::fill(weights, weights + p + 1, 0.0);
  weights[a + 1] = (knots.greville(function) - g0) / (g1 - g0);
  weights[a] = 1 - weights[a + 1];
}

class Planner {
 public:
  Planner(const TrimmedModel& model, const LightTreatment& treatment)
      : model_(model), remedy_(treatment.remedy), threshold_(treatment.threshold),
        light_(model.functions.number.size()) {
    for (std::size_t f = 0; f < light_.size(); ++f) light_[f] = model.functions.mass_fraction[f] < threshold_;
  }

  LightFunctionPlan plan() {
    LightFunctionPlan plan;
    if (extends(remedy_)) {
      find_neighbours();
      find_good_spans(plan.warnings);
      plan.fictitious = fictitious_;
    }
    std::vector<std::int64_t> functions;
    for (std::size_t f = 0; f < light_.size(); ++f)
      if (light_[f]) functions.push_back(static_cast<std::int64_t>(f));
    plan.slaves.resize(functions.size());
    tbb::parallel_for(std::size_t{0}, functions.size(), [&](std::size_t s) {
      plan.slaves[s].function = functions[s];
      if (remedy_ != LightFunctions::Remove) follow(plan.slaves[s]);
    });
    return plan;
  }

 private:
  template <class Visit> void for_functions(std::int64_t cell, Visit visit) const {
    for (const std::int32_t f : model_.functions_of(static_cast<std::size_t>(cell))) visit(std::int64_t{f});
  }

  void find_neighbours() {
    const auto& links = model_.links.cells;
    first_neighbour_.assign(model_.num_cells() + 1, 0);
    for (const std::int32_t cell : links) ++first_neighbour_[static_cast<std::size_t>(cell) + 1];
    std::partial_sum(first_neighbour_.begin(), first_neighbour_.end(), first_neighbour_.begin());
    neighbours_.resize(links.size());
    std::vector<std::size_t> next(first_neighbour_.begin(), first_neighbour_.end() - 1);
    for (std::size_t l = 0; l < links.size(); l += 2) {
      neighbours_[next[static_cast<std::size_t>(links[l])]++] = links[l + 1];
      neighbours_[next[static_cast<std::size_t>(links[l + 1])]++] = links[l];
    }
    cells_ = cells_by_function(model_);
  }

  std::span<const std::int32_t> neighbours(std::int32_t cell) const {
    const auto c = static_cast<std::size_t>(cell);
    return std::span(neighbours_).subspan(first_neighbour_[c], first_neighbour_[c + 1] - first_neighbour_[c]);
  }

  bool is_good(std::int64_t span) const {
    bool good = true;
    for_functions(span, [&](std::int64_t f) { good = good && !light_[static_cast<std::size_t>(f)]; });
    return good;
  }

  // Good spans of each connected part; where a part has none, its threshold falls.
  void find_good_spans(std::vector<std::string>& warnings) {
    const std::size_t n = model_.cells.span.size();
    good_.resize(n);
    for (std::size_t a = 0; a < n; ++a) good_[a] = is_good(static_cast<std::int64_t>(a));
    std::vector<char> seen(n);
    for (std::size_t seed = 0; seed < n; ++seed) {
      if (seen[seed]) continue;
      std::vector<std::int32_t> part{static_cast<std::int32_t>(seed)};
      seen[seed] = 1;
      for (std::size_t next = 0; next < part.size(); ++next)
        for (const std::int32_t b : neighbours(part[next]))
          if (!seen[static_cast<std::size_t>(b)]) {
            seen[static_cast<std::size_t>(b)] = 1;
            part.push_back(b);
          }
      lower_threshold(part, warnings);
    }
  }

  void lower_threshold(const std::vector<std::int32_t>& part, std::vector<std::string>& warnings) {
    const auto any_good = [&] {
      return std::any_of(part.begin(), part.end(), [&](std::int32_t a) { return good_[static_cast<std::size_t>(a)]; });
    };
    if (any_good()) return;
    double threshold = threshold_;
    while (threshold > lowest_threshold && !any_good()) {
      threshold /= 10;
      for (const std::int32_t a : part)
        for_functions(a, [&](std::int64_t f) {
          light_[static_cast<std::size_t>(f)] = model_.functions.mass_fraction[static_cast<std::size_t>(f)] < threshold;
        });
      for (const std::int32_t a : part) good_[static_cast<std::size_t>(a)] = is_good(a);
    }
    if (!any_good()) {
      fictitious_.resize(model_.cells.span.size());
      for (const std::int32_t a : part) {
        fictitious_[static_cast<std::size_t>(a)] = fictitious_share;
        for_functions(a, [&](std::int64_t f) { light_[static_cast<std::size_t>(f)] = 0; });
      }
    }
    const Index3 ijk = model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(part.front())]);
    const Box3 box = model_.grid.span_box(ijk);
    const Point3 x = model_.grid.to_position(box.lower);
    warnings.push_back(fmt::format(
        "a part of {} spans near ({:.4g}, {:.4g}, {:.4g}) is too thin for its grid: no span has all its functions "
        "above the mass fraction {:.3g}; {}; {}",
        part.size(), x[0], x[1], x[2], threshold_,
        any_good() ? fmt::format("there the threshold is {:.3g}, and its modes may come out too stiff", threshold)
                   : fmt::format("its spans are filled with fictitious material ({} of stiffness and "
                                 "mass), which makes it too heavy and too stiff",
                                 fictitious_share),
        span_advice(model_, {part.begin(), part.end()})));
  }

  // Breadth-first from the function's cells through links; a few rings beyond the first good span, where a nearer one
  // may be.
  std::int32_t nearest_good_span(std::int64_t f) const {
    const Index3 i = model_.grid.function_index(model_.functions.number[static_cast<std::size_t>(f)]);
    const auto p = model_.grid.degree();
    const auto distance = [&](std::int32_t a) { // squared and times four: whole numbers
      const Index3 s = model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(a)]);
      std::int64_t sum = 0;
      for (std::size_t d = 0; d < 3; ++d) sum += (2 * (i[d] - s[d]) - p[d]) * (2 * (i[d] - s[d]) - p[d]);
      return sum;
    };
    const auto own = cells_.of(f);
    std::vector<std::int32_t> ring(own.begin(), own.end()), next;
    std::unordered_map<std::int32_t, char> seen;
    for (const std::int32_t a : ring) seen[a] = 1;
    std::int32_t best = -1;
    for (int rings_left = -1; !ring.empty() && rings_left != 0;) {
      for (const std::int32_t a : ring)
        if (good_[static_cast<std::size_t>(a)] &&
            (best < 0 || std::pair(distance(a), a) < std::pair(distance(best), best)))
          best = a;
      if (best >= 0) rings_left = rings_left < 0 ? 2 : rings_left - 1;
      next.clear();
      for (const std::int32_t a : ring)
        for (const std::int32_t b : neighbours(a))
          if (seen.emplace(b, 1).second) next.push_back(b);
      ring.swap(next);
    }
    return best;
  }

  void follow(Slave& slave) const {
    const std::int32_t span = nearest_good_span(slave.function);
    if (span < 0)
      throw NumericalError(
          fmt::format("light function {}: no good span is connected with its support", slave.function));
    const Index3 i = model_.grid.function_index(model_.functions.number[static_cast<std::size_t>(slave.function)]);
    const Index3 s = model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(span)]);
    const auto p = model_.grid.degree();
    double weights[3][max_degree + 1];
    for (std::size_t d = 0; d < 3; ++d)
      (remedy_ == LightFunctions::Linear ? linear_weights : degree_p_weights)(model_.grid.knots(static_cast<int>(d)),
                                                                              s[d], i[d], weights[d]);
    std::size_t entry = 0;
    for_functions(span, [&](std::int64_t f) {
      const std::size_t a = entry % static_cast<std::size_t>(p[0] + 1), bc = entry / static_cast<std::size_t>(p[0] + 1);
      const std::size_t b = bc % static_cast<std::size_t>(p[1] + 1), c = bc / static_cast<std::size_t>(p[1] + 1);
      const double weight = weights[0][a] * weights[1][b] * weights[2][c];
      if (weight != 0) slave.masters.emplace_back(f, weight);
      ++entry;
    });
  }

  const TrimmedModel& model_;
  LightFunctions remedy_;
  double threshold_;
  std::vector<char> light_, good_;
  std::vector<double> fictitious_;
  std::vector<std::size_t> first_neighbour_; // (num_cells + 1)
  std::vector<std::int32_t> neighbours_;     // linked cells
  FunctionCells cells_;
};

} // namespace

LightFunctionPlan plan_light_functions(const TrimmedModel& model, const LightTreatment& treatment) {
  if (treatment.remedy == LightFunctions::None) return {};
  return Planner(model, treatment).plan();
}

} // namespace iga::solve
