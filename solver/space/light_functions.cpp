#include "solver/space/light_functions.hpp"

#include "format/model/errors.hpp"
#include "solver/space/span_advice.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unordered_map>

namespace iga::solve {

namespace {

constexpr double lowest_threshold = 1e-9; // a part that has no good span above it is filled with fictitious material
constexpr double fictitious_share = 1e-3; // its stiffness and mass, relative to the material's

std::int64_t find(const std::vector<std::int64_t>& sorted, std::int64_t value) {
  const auto it = std::lower_bound(sorted.begin(), sorted.end(), value);
  return it != sorted.end() && *it == value ? it - sorted.begin() : -1;
}

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
  Planner(const TrimmedModel& model, const std::vector<std::int64_t>& rows, const LightTreatment& treatment)
      : model_(model), rows_(rows), remedy_(treatment.remedy), threshold_(treatment.threshold),
        light_(model.active_functions.size()) {
    for (std::size_t f = 0; f < light_.size(); ++f) light_[f] = model.mass_fraction[f] < threshold_;
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
  template <class Visit> void for_functions(std::int64_t span, Visit visit) const {
    const auto degree = model_.grid.degree();
    const std::size_t count = static_cast<std::size_t>((degree[1] + 1) * (degree[2] + 1));
    for (std::size_t r = 0; r < count; ++r)
      for (std::int64_t a = 0; a <= degree[0]; ++a) visit(rows_[static_cast<std::size_t>(span) * count + r] + a);
  }

  void find_neighbours() {
    const std::size_t n = model_.active.size();
    neighbours_.assign(6 * n, -1);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t a) {
      const Index3 ijk = model_.grid.span_index(model_.active[a]), extent = model_.grid.spans();
      for (std::size_t side = 0; side < 6; ++side) {
        Index3 other = ijk;
        other[side / 2] += side % 2 ? 1 : -1;
        if (other[side / 2] < 0 || other[side / 2] >= extent[side / 2]) continue;
        neighbours_[6 * a + side] = static_cast<std::int32_t>(find(model_.active, model_.grid.span_number(other)));
      }
    });
  }

  bool is_good(std::int64_t span) const {
    bool good = true;
    for_functions(span, [&](std::int64_t f) { good = good && !light_[static_cast<std::size_t>(f)]; });
    return good;
  }

  // Good spans of each connected part; where a part has none, its threshold falls.
  void find_good_spans(std::vector<std::string>& warnings) {
    const std::size_t n = model_.active.size();
    good_.resize(n);
    for (std::size_t a = 0; a < n; ++a) good_[a] = is_good(static_cast<std::int64_t>(a));
    std::vector<char> seen(n);
    for (std::size_t seed = 0; seed < n; ++seed) {
      if (seen[seed]) continue;
      std::vector<std::int32_t> part{static_cast<std::int32_t>(seed)};
      seen[seed] = 1;
      for (std::size_t next = 0; next < part.size(); ++next)
        for (std::size_t side = 0; side < 6; ++side) {
          const std::int32_t b = neighbours_[6 * static_cast<std::size_t>(part[next]) + side];
          if (b >= 0 && !seen[static_cast<std::size_t>(b)]) {
            seen[static_cast<std::size_t>(b)] = 1;
            part.push_back(b);
          }
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
          light_[static_cast<std::size_t>(f)] = model_.mass_fraction[static_cast<std::size_t>(f)] < threshold;
        });
      for (const std::int32_t a : part) good_[static_cast<std::size_t>(a)] = is_good(a);
    }
    if (!any_good()) {
      fictitious_.resize(model_.active.size());
      for (const std::int32_t a : part) {
        fictitious_[static_cast<std::size_t>(a)] = fictitious_share;
        for_functions(a, [&](std::int64_t f) { light_[static_cast<std::size_t>(f)] = 0; });
      }
    }
    const Index3 ijk = model_.grid.span_index(model_.active[static_cast<std::size_t>(part.front())]);
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

  // Active spans in the support of a function.
  std::vector<std::int32_t> support(std::int64_t f) const {
    const Index3 i = model_.grid.function_index(model_.active_functions[static_cast<std::size_t>(f)]);
    const Index3 extent = model_.grid.spans();
    const auto p = model_.grid.degree();
    std::vector<std::int32_t> spans;
    for (std::int64_t w = std::max<std::int64_t>(i[2] - p[2], 0); w <= std::min(i[2], extent[2] - 1); ++w)
      for (std::int64_t v = std::max<std::int64_t>(i[1] - p[1], 0); v <= std::min(i[1], extent[1] - 1); ++v)
        for (std::int64_t u = std::max<std::int64_t>(i[0] - p[0], 0); u <= std::min(i[0], extent[0] - 1); ++u) {
          const std::int64_t a = find(model_.active, model_.grid.span_number({u, v, w}));
          if (a >= 0) spans.push_back(static_cast<std::int32_t>(a));
        }
    return spans;
  }

  // Breadth-first from the support through faces; a few rings beyond the first good span, where a nearer one may be.
  std::int32_t nearest_good_span(std::int64_t f) const {
    const Index3 i = model_.grid.function_index(model_.active_functions[static_cast<std::size_t>(f)]);
    const auto p = model_.grid.degree();
    const auto distance = [&](std::int32_t a) { // squared and times four: whole numbers
      const Index3 s = model_.grid.span_index(model_.active[static_cast<std::size_t>(a)]);
      std::int64_t sum = 0;
      for (std::size_t d = 0; d < 3; ++d) sum += (2 * (i[d] - s[d]) - p[d]) * (2 * (i[d] - s[d]) - p[d]);
      return sum;
    };
    std::vector<std::int32_t> ring = support(f), next;
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
        for (std::size_t side = 0; side < 6; ++side) {
          const std::int32_t b = neighbours_[6 * static_cast<std::size_t>(a) + side];
          if (b >= 0 && seen.emplace(b, 1).second) next.push_back(b);
        }
      ring.swap(next);
    }
    return best;
  }

  void follow(Slave& slave) const {
    const std::int32_t span = nearest_good_span(slave.function);
    if (span < 0) // only where support and part differ: a support across two parts of which one has good spans
      throw NumericalError(
          fmt::format("light function {}: no good span is connected with its support", slave.function));
    const Index3 i = model_.grid.function_index(model_.active_functions[static_cast<std::size_t>(slave.function)]);
    const Index3 s = model_.grid.span_index(model_.active[static_cast<std::size_t>(span)]);
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
  const std::vector<std::int64_t>& rows_;
  LightFunctions remedy_;
  double threshold_;
  std::vector<char> light_, good_;
  std::vector<double> fictitious_;
  std::vector<std::int32_t> neighbours_; // (num_active × 6), -1 where none is active
};

} // namespace

std::vector<std::int64_t> function_rows(const TrimmedModel& model) {
  const auto p = model.grid.degree();
  const std::size_t count = static_cast<std::size_t>((p[1] + 1) * (p[2] + 1));
  std::vector<std::int64_t> rows(model.active.size() * count);
  std::atomic<std::int64_t> missing{-1};
  tbb::parallel_for(std::size_t{0}, model.active.size(), [&](std::size_t a) {
    const Index3 s = model.grid.span_index(model.active[a]);
    std::size_t r = a * count;
    for (std::int64_t c = 0; c <= p[2]; ++c)
      for (std::int64_t b = 0; b <= p[1]; ++b, ++r) {
        const std::int64_t first = model.grid.function_number({s[0], s[1] + b, s[2] + c});
        rows[r] = find(model.active_functions, first);
        const auto last = static_cast<std::size_t>(rows[r] + p[0]);
        if (rows[r] < 0 || last >= model.active_functions.size() || model.active_functions[last] != first + p[0])
          missing = model.active[a];
      }
  });
  if (missing >= 0)
    throw FormatError(
        fmt::format("/functions/active: lacks a function of the active span {}; make the model again", missing.load()));
  return rows;
}

LightFunctionPlan plan_light_functions(const TrimmedModel& model, const std::vector<std::int64_t>& rows,
                                       const LightTreatment& treatment) {
  if (treatment.remedy == LightFunctions::None) return {};
  return Planner(model, rows, treatment).plan();
}

} // namespace iga::solve
