#include "solver/space/light_functions.hpp"

#include "format/model/bspline_basis.hpp"
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

// What an unknown is the coefficient of, in one direction: the p knots at which the polar form of a polynomial gives
// it.
struct Coefficient {
  std::array<double, max_degree> knots{};
  double greville = 0; // their mean
};

// Linear interpolation or extrapolation of the Greville abscissae between the two functions of the span next to it.
void linear_weights(const KnotVector& knots, std::int64_t span, const Coefficient& coefficient,
                    std::span<double> weights) {
  const int p = knots.degree();
  std::int64_t a = 0;
  while (a < p - 1 && knots.greville(span + a + 1) <= coefficient.greville) ++a;
  const double g0 = knots.greville(span + a), g1 = knots.greville(span + a + 1);
  std::fill(weights.begin(), weights.end(), 0.0);
  weights[static_cast<std::size_t>(a) + 1] = (coefficient.greville - g0) / (g1 - g0);
  weights[static_cast<std::size_t>(a)] = 1 - weights[static_cast<std::size_t>(a) + 1];
}

void degree_p_weights(const KnotVector& knots, std::int64_t span, const Coefficient& coefficient,
                      std::span<double> weights) {
  blossom_weights(knots, span, std::span(coefficient.knots).first(static_cast<std::size_t>(knots.degree())), weights);
}

class Planner {
 public:
  Planner(const TrimmedModel& model, const LightTreatment& treatment)
      : model_(model), remedy_(treatment.remedy), threshold_(treatment.threshold), light_(model.num_unknowns()),
        unknowns_(model) {
    find_gap_ends();
    for (std::size_t u = 0; u < light_.size(); ++u) light_[u] = is_light(u, threshold_);
  }

  LightFunctionPlan plan() {
    LightFunctionPlan plan;
    if (extends(remedy_)) {
      find_neighbours();
      find_good_cells(plan.warnings);
      plan.fictitious = fictitious_;
    }
    std::vector<std::int64_t> light;
    for (std::size_t u = 0; u < light_.size(); ++u)
      if (light_[u]) light.push_back(static_cast<std::int64_t>(u));
    plan.slaves.resize(light.size());
    tbb::parallel_for(std::size_t{0}, light.size(), [&](std::size_t s) {
      plan.slaves[s].unknown = light[s];
      if (remedy_ != LightFunctions::Remove) follow(plan.slaves[s]);
    });
    return plan;
  }

 private:
  template <class Visit> void for_unknowns(std::int64_t cell, Visit visit) const {
    for (const std::int32_t u : unknowns_.of(static_cast<std::size_t>(cell))) visit(std::int64_t{u});
  }

  // Under the linear remedy unknowns that cells at gap ends see stay on their own unless they are very light:
  // continuous functions in cut cells cost no time step beside those in whole ones (stiffness over mass goes with the
  // depth of the cut to the power p - 2), and good cells are so far that extrapolation of all would take more mass from
  // their nodes than these have. The very light ones follow, since contact and rounding would throw them.
  void find_gap_ends() {
    if (model_.unknowns.empty() || remedy_ != LightFunctions::Linear) return;
    stays_.assign(light_.size(), 0);
    for (std::size_t c = 0; c < model_.num_cells(); ++c)
      if (model_.is_at_gap_end(c))
        for (const std::int32_t u : unknowns_.of(c)) stays_[static_cast<std::size_t>(u)] = 1;
  }

  bool is_light(std::size_t unknown, double threshold) const {
    const bool stays = !stays_.empty() && stays_[unknown] != 0;
    return model_.unknown_mass_fraction()[unknown] < (stays ? threshold * threshold : threshold);
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
    cells_ = unknowns_.by_unknown();
  }

  std::span<const std::int32_t> neighbours(std::int32_t cell) const {
    const auto c = static_cast<std::size_t>(cell);
    return std::span(neighbours_).subspan(first_neighbour_[c], first_neighbour_[c + 1] - first_neighbour_[c]);
  }

  bool is_good(std::int64_t cell) const {
    bool good = stays_.empty() || !model_.is_at_gap_end(static_cast<std::size_t>(cell));
    for_unknowns(cell, [&](std::int64_t u) {
      const auto unknown = static_cast<std::size_t>(u);
      good = good && !light_[unknown] && (stays_.empty() || model_.unknown_mass_fraction()[unknown] >= threshold_);
    });
    return good;
  }

  // Good cells of each connected part; where a part has none, its threshold falls.
  void find_good_cells(std::vector<std::string>& warnings) {
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
    if (std::any_of(part.begin(), part.end(), [&](std::int32_t a) {
          return !stays_.empty() && model_.is_at_gap_end(static_cast<std::size_t>(a));
        })) { // nothing to follow but what stays on its own
      for (const std::int32_t a : part)
        for_unknowns(a, [&](std::int64_t u) { light_[static_cast<std::size_t>(u)] = 0; });
      return;
    }
    double threshold = threshold_;
    while (threshold > lowest_threshold && !any_good()) {
      threshold /= 10;
      for (const std::int32_t a : part)
        for_unknowns(a, [&](std::int64_t u) {
          light_[static_cast<std::size_t>(u)] = is_light(static_cast<std::size_t>(u), threshold);
        });
      for (const std::int32_t a : part) good_[static_cast<std::size_t>(a)] = is_good(a);
    }
    if (!any_good()) {
      fictitious_.resize(model_.cells.span.size());
      for (const std::int32_t a : part) {
        fictitious_[static_cast<std::size_t>(a)] = fictitious_share;
        for_unknowns(a, [&](std::int64_t u) { light_[static_cast<std::size_t>(u)] = 0; });
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

  Coefficient coefficient(std::int64_t unknown, std::size_t d) const {
    const KnotVector& knots = model_.grid.knots(static_cast<int>(d));
    const auto p = static_cast<std::size_t>(knots.degree());
    const auto u = static_cast<std::size_t>(unknown);
    Coefficient c;
    const std::int64_t function = model_.function_of(u);
    if (function >= 0) {
      const auto i = static_cast<std::size_t>(
          model_.grid.function_index(model_.functions.number[static_cast<std::size_t>(function)])[d]);
      for (std::size_t k = 0; k < p; ++k) c.knots[k] = knots.values()[i + 1 + k];
      c.greville = knots.greville(static_cast<std::int64_t>(i));
      return c;
    }
    // A Bernstein coefficient: the ends of its span, the upper one as often as its Greville point lies p-ths from
    // below.
    c.greville = model_.unknowns.parameters[3 * u + d];
    const std::int64_t span = knots.find_span(c.greville);
    const double low = knots.lower(span), high = knots.upper(span);
    const auto upper =
        static_cast<std::size_t>(std::lround(static_cast<double>(p) * (c.greville - low) / (high - low)));
    std::fill_n(c.knots.begin(), p, low);
    std::fill_n(c.knots.begin(), std::min(upper, p), high);
    return c;
  }

  // Breadth-first from the unknown's cells through links; a few rings beyond the first good cell, where a nearer one
  // may be.
  std::int32_t nearest_good_cell(std::int64_t unknown) const {
    Point3 centre; // of its support, or its Greville point, in spans less one half
    const std::int64_t function = model_.function_of(static_cast<std::size_t>(unknown));
    for (std::size_t d = 0; d < 3; ++d)
      if (function >= 0) {
        const Index3 i = model_.grid.function_index(model_.functions.number[static_cast<std::size_t>(function)]);
        centre[d] = static_cast<double>(i[d]) - 0.5 * model_.grid.degree()[d];
      } else {
        centre[d] = (model_.unknowns.parameters[3 * static_cast<std::size_t>(unknown) + d] - model_.grid.A()[d]) /
                        model_.grid.span_size()[d] -
                    0.5;
      }
    const auto distance = [&](std::int32_t a) { // squared
      const Index3 s = model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(a)]);
      double sum = 0;
      for (std::size_t d = 0; d < 3; ++d)
        sum += (centre[d] - static_cast<double>(s[d])) * (centre[d] - static_cast<double>(s[d]));
      return sum;
    };
    const auto own = cells_.of(unknown);
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
    const std::int32_t cell = nearest_good_cell(slave.unknown);
    if (cell < 0)
      throw NumericalError(fmt::format("light function {}: no good cell is connected with its support", slave.unknown));
    const Index3 s = model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(cell)]);
    const auto p = model_.grid.degree();
    double weights[3][max_degree + 1];
    for (std::size_t d = 0; d < 3; ++d)
      (remedy_ == LightFunctions::Linear ? linear_weights : degree_p_weights)(
          model_.grid.knots(static_cast<int>(d)), s[d], coefficient(slave.unknown, d),
          std::span(weights[d]).first(static_cast<std::size_t>(p[d]) + 1));
    std::size_t entry = 0;
    for (const std::int32_t f : model_.functions_of(static_cast<std::size_t>(cell))) {
      const std::size_t a = entry % static_cast<std::size_t>(p[0] + 1), bc = entry / static_cast<std::size_t>(p[0] + 1);
      const std::size_t b = bc % static_cast<std::size_t>(p[1] + 1), c = bc / static_cast<std::size_t>(p[1] + 1);
      const double weight = weights[0][a] * weights[1][b] * weights[2][c];
      ++entry;
      if (weight == 0) continue;
      model_.for_terms(
          f, [&](std::int32_t unknown, double factor) { slave.masters.emplace_back(unknown, weight * factor); });
    }
    if (model_.unknowns.empty()) return; // functions are ascending, each once
    std::stable_sort(slave.masters.begin(), slave.masters.end(),
                     [](const auto& x, const auto& y) { return x.first < y.first; });
    std::size_t last = 0;
    for (std::size_t m = 1; m < slave.masters.size(); ++m)
      if (slave.masters[m].first == slave.masters[last].first)
        slave.masters[last].second += slave.masters[m].second;
      else
        slave.masters[++last] = slave.masters[m];
    slave.masters.resize(last + 1);
  }

  const TrimmedModel& model_;
  LightFunctions remedy_;
  double threshold_;
  std::vector<char> light_, good_;
  std::vector<char> stays_; // (n_u); empty unless gaps end and the remedy is linear
  std::vector<double> fictitious_;
  std::vector<std::size_t> first_neighbour_; // (num_cells + 1)
  std::vector<std::int32_t> neighbours_;     // linked cells
  CellUnknowns unknowns_;
  FunctionCells cells_; // of each unknown
};

} // namespace

LightFunctionPlan plan_light_functions(const TrimmedModel& model, const LightTreatment& treatment) {
  if (treatment.remedy == LightFunctions::None) return {};
  return Planner(model, treatment).plan();
}

} // namespace iga::solve
