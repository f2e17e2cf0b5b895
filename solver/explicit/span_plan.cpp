#include "solver/explicit/span_plan.hpp"

#include "solver/light_functions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace iga::solve {

namespace {

// Positions in the span are told apart to 1e-9 of its size, far above rounding and far below any difference of rules.
constexpr double same_place = 1e-9;

// A span's points as a tensor product.
struct TensorPoints {
  std::array<std::vector<double>, 3> t; // ascending
  std::vector<std::int64_t> order;      // (size): number of the point in the span, u fastest
};

// Numbers the polynomials of a model as they turn up.
class PolynomialList {
 public:
  PolynomialList(const SplineGrid& grid, std::vector<SpanPolynomials>& list) : grid_(grid), list_(list) {}

  std::array<std::int32_t, 3> of(const Index3& span) {
    std::array<std::int32_t, 3> numbers{};
    for (std::size_t d = 0; d < 3; ++d) {
      const KnotVector& knots = grid_.knots(static_cast<int>(d));
      // Distance from the ends as far as functions feel it.
      const std::int64_t far = knots.degree() - 1;
      const std::array<std::int64_t, 3> key{static_cast<std::int64_t>(d), std::min(span[d], far),
                                            std::min(knots.num_spans() - 1 - span[d], far)};
      const auto [it, is_new] = numbers_.try_emplace(key, static_cast<std::int32_t>(list_.size()));
      if (is_new) list_.push_back(span_polynomials(knots, span[d]));
      numbers[d] = it->second;
    }
    return numbers;
  }

 private:
  const SplineGrid& grid_;
  std::vector<SpanPolynomials>& list_;
  std::map<std::array<std::int64_t, 3>, std::int32_t> numbers_;
};

// Points of a span in units of it. (n × 3)
std::vector<double> local_points(const SplineGrid& grid, const Index3& span, std::span<const double> parameters) {
  const Box3 box = grid.span_box(span);
  std::vector<double> t(parameters.size());
  for (std::size_t k = 0; k < t.size(); ++k)
    t[k] = (parameters[k] - box.lower[k % 3]) / (box.upper[k % 3] - box.lower[k % 3]);
  return t;
}

std::optional<TensorPoints> as_tensor(const std::vector<double>& t) {
  TensorPoints tensor;
  for (std::size_t d = 0; d < 3; ++d) {
    auto& list = tensor.t[d];
    for (std::size_t q = d; q < t.size(); q += 3) list.push_back(t[q]);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end(), [](double a, double b) { return b - a < same_place; }),
               list.end());
  }
  const std::size_t n[3] = {tensor.t[0].size(), tensor.t[1].size(), tensor.t[2].size()};
  if (3 * n[0] * n[1] * n[2] != t.size() || n[0] > max_row_points) return {};
  tensor.order.assign(t.size() / 3, -1);
  for (std::size_t q = 0; q < t.size() / 3; ++q) {
    std::size_t place[3];
    for (std::size_t d = 0; d < 3; ++d) {
      const auto& list = tensor.t[d];
      place[d] = static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), t[3 * q + d] - same_place) -
                                          list.begin());
      if (place[d] == list.size()) return {};
    }
    auto& number = tensor.order[place[0] + n[0] * (place[1] + n[1] * place[2])];
    if (number >= 0) return {};
    number = static_cast<std::int64_t>(q);
  }
  return tensor;
}

double evaluate(const double* coefficients, int degree, double t) {
  double y = coefficients[degree];
  for (int k = degree - 1; k >= 0; --k) y = y * t + coefficients[k];
  return y;
}

TensorTable make_table(const std::array<int, 3>& degree, const std::vector<SpanPolynomials>& polynomials,
                       const std::array<std::int32_t, 3>& numbers, const TensorPoints& tensor,
                       std::span<const double> weights) {
  TensorTable table;
  for (std::size_t d = 0; d < 3; ++d) {
    table.count[d] = static_cast<int>(tensor.t[d].size());
    const SpanPolynomials& p = polynomials[static_cast<std::size_t>(numbers[d])];
    for (const double t : tensor.t[d])
      for (std::size_t a = 0; a <= static_cast<std::size_t>(degree[d]); ++a) {
        table.values[d].push_back(evaluate(p.value[a], degree[d], t));
        table.slopes[d].push_back(evaluate(p.slope[a], degree[d], t));
      }
  }
  for (const std::int64_t q : tensor.order) table.weights.push_back(weights[static_cast<std::size_t>(q)]);
  return table;
}

// Fused multiply-adds of Lanes of one evaluation, forces included: to tell which way a few spans go faster.
double group_cost(const std::array<int, 3>& p, const TensorTable& table) {
  const double w[3] = {p[0] + 1.0, p[1] + 1.0, p[2] + 1.0};
  const auto& n = table.count;
  return 2.0 * n[2] * (6 * w[0] * w[1] * w[2] + n[1] * (9 * w[0] * w[1] + n[0] * 9 * w[0]));
}
double point_cost(const std::array<int, 3>& p, int points) {
  const double w[3] = {p[0] + 1.0, p[1] + 1.0, p[2] + 1.0};
  return 2.0 * ((points + 7) / 8) * (6 * w[0] * w[1] * w[2] + 9 * w[1] * w[2] + 9 * w[2]);
}

class Planner {
 public:
  explicit Planner(const SolutionSpace& space)
      : space_(space), model_(space.model()), list_(model_.grid, plan_.polynomials) {
    plan_.degree = model_.grid.degree();
    plan_.rows = function_rows(model_);
  }

  SpanPlan make() {
    choose_edges();
    find_tables();
    const Index3 n = block_counts();
    std::vector<std::vector<std::int64_t>> members(static_cast<std::size_t>(n[0] * n[1] * n[2]));
    for (std::int64_t a = 0; a < space_.num_spans(); ++a) {
      const Index3 b = block_of(a);
      members[static_cast<std::size_t>(b[0] + n[0] * (b[1] + n[1] * b[2]))].push_back(a);
    }
    // Blocks of equal parity lie at least one block apart, which is more than a function reaches: see max_degree.
    plan_.colour_offsets = {0};
    for (std::int64_t colour = 0; colour < 8; ++colour) {
      std::size_t m = 0;
      for (std::int64_t k = 0; k < n[2]; ++k)
        for (std::int64_t j = 0; j < n[1]; ++j)
          for (std::int64_t i = 0; i < n[0]; ++i, ++m)
            if ((i & 1) + 2 * (j & 1) + 4 * (k & 1) == colour && !members[m].empty()) add_block(members[m]);
      plan_.colour_offsets.push_back(static_cast<std::int64_t>(plan_.blocks.size()));
    }
    return std::move(plan_);
  }

 private:
  Index3 index(std::int64_t a) const { return model_.grid.span_index(model_.active[static_cast<std::size_t>(a)]); }
  Index3 block_of(std::int64_t a) const {
    const Index3 s = index(a);
    return {(s[0] - lower_[0]) / edge_[0], (s[1] - lower_[1]) / edge_[1], (s[2] - lower_[2]) / edge_[2]};
  }
  Index3 block_counts() const {
    Index3 n{};
    for (std::size_t d = 0; d < 3; ++d) n[d] = (upper_[d] - lower_[d]) / edge_[d] + 1;
    return n;
  }

  // Large blocks fill groups of eight better, many blocks feed more threads.
  void choose_edges() {
    lower_ = upper_ = index(0);
    for (std::int64_t a = 1; a < space_.num_spans(); ++a)
      for (std::size_t d = 0; d < 3; ++d) {
        lower_[d] = std::min(lower_[d], index(a)[d]);
        upper_[d] = std::max(upper_[d], index(a)[d]);
      }
    constexpr std::int64_t enough = 512;
    static_assert(max_degree <= 4);
    for (const Index3& edge : {Index3{16, 8, 8}, Index3{8, 8, 8}, Index3{8, 8, 4}, Index3{8, 4, 4}}) {
      edge_ = edge;
      const Index3 n = block_counts();
      if (n[0] * n[1] * n[2] >= enough) break;
    }
  }

  // Table of each interior span, -1 for spans that go point by point.
  void find_tables() {
    std::map<std::vector<std::int64_t>, std::int32_t> known;
    table_of_.assign(model_.active.size(), -1);
    for (std::int64_t a = 0; a < space_.num_spans(); ++a) {
      const auto s = static_cast<std::size_t>(a);
      const auto weights = span_weights(model_, a);
      if (static_cast<SpanState>(model_.state[static_cast<std::size_t>(model_.active[s])]) != SpanState::Interior ||
          space_.fictitious_share(a) > 0 || weights.empty())
        continue;
      const auto tensor = as_tensor(local_points(model_.grid, index(a), span_parameters(model_, a)));
      if (!tensor) continue;
      const auto numbers = list_.of(index(a));
      std::vector<std::int64_t> key(numbers.begin(), numbers.end());
      for (const auto& list : tensor->t) {
        key.push_back(static_cast<std::int64_t>(list.size()));
        for (const double t : list) key.push_back(std::llround(t / same_place));
      }
      for (const std::int64_t q : tensor->order)
        key.push_back(std::llround(weights[static_cast<std::size_t>(q)] / (model_.grid.span_volume() * same_place)));
      const auto [it, is_new] = known.try_emplace(std::move(key), static_cast<std::int32_t>(plan_.tables.size()));
      if (is_new) plan_.tables.push_back(make_table(plan_.degree, plan_.polynomials, numbers, *tensor, weights));
      table_of_[s] = it->second;
    }
  }

  void add_block(const std::vector<std::int64_t>& spans) {
    WorkBlock block;
    std::map<std::int32_t, std::vector<std::int64_t>> by_table;
    std::vector<std::int64_t> own;
    for (const std::int64_t a : spans) {
      const std::int32_t table = table_of_[static_cast<std::size_t>(a)];
      if (table >= 0)
        by_table[table].push_back(a);
      else
        own.push_back(a);
    }
    block.groups[0] = static_cast<std::int64_t>(plan_.groups.size());
    for (const auto& [number, members] : by_table) {
      const TensorTable& table = plan_.tables[static_cast<std::size_t>(number)];
      for (std::size_t first = 0; first < members.size(); first += lanes) {
        const std::size_t count = std::min(lanes, members.size() - first);
        const auto part = std::span(members).subspan(first, count);
        if (static_cast<double>(count) * point_cost(plan_.degree, table.size()) < group_cost(plan_.degree, table))
          own.insert(own.end(), part.begin(), part.end());
        else
          add_group(number, part);
      }
    }
    block.groups[1] = static_cast<std::int64_t>(plan_.groups.size());
    block.point_spans[0] = static_cast<std::int64_t>(plan_.point_spans.size());
    std::sort(own.begin(), own.end());
    for (const std::int64_t a : own) add_point_span(a);
    block.point_spans[1] = static_cast<std::int64_t>(plan_.point_spans.size());
    plan_.blocks.push_back(block);
  }

  void add_group(std::int32_t table, std::span<const std::int64_t> members) {
    SpanGroup group;
    group.table = table;
    group.count = static_cast<std::int32_t>(members.size());
    group.first_block = plan_.num_point_blocks();
    std::array<TensorPoints, lanes> tensors;
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::int64_t a = members[std::min(l, members.size() - 1)];
      group.spans[l] = static_cast<std::int32_t>(a);
      tensors[l] = *as_tensor(local_points(model_.grid, index(a), span_parameters(model_, a)));
    }
    const auto size = static_cast<std::size_t>(plan_.tables[static_cast<std::size_t>(table)].size());
    for (std::size_t q = 0; q < size; ++q)
      for (std::size_t l = 0; l < lanes; ++l) {
        const std::int64_t first = model_.points.offsets[static_cast<std::size_t>(group.spans[l])];
        plan_.point.push_back(l < members.size() ? first + tensors[l].order[q] : -1);
      }
    plan_.num_points += static_cast<std::int64_t>(size * members.size());
    plan_.num_group_points += static_cast<std::int64_t>(size * members.size());
    plan_.groups.push_back(group);
  }

  void add_point_span(std::int64_t a) {
    SpanPointStorage storage;
    const auto [parameters, weights] = span_points(space_, a, storage);
    if (weights.empty()) return; // generalised rules leave spans without points
    const std::vector<double> t = local_points(model_.grid, index(a), parameters);
    const std::size_t n = weights.size();
    const auto s = static_cast<std::size_t>(a);
    const auto of_model = static_cast<std::size_t>(model_.points.offsets[s + 1] - model_.points.offsets[s]);
    PointSpan span;
    span.span = static_cast<std::int32_t>(a);
    span.blocks = static_cast<std::int32_t>((n + lanes - 1) / lanes);
    span.polynomials = list_.of(index(a));
    span.first_block = plan_.num_point_blocks();
    span.first_own = static_cast<std::int64_t>(plan_.own_points.size());
    for (std::size_t first = 0; first < n; first += lanes) {
      OwnPoints points;
      for (std::size_t l = 0; l < lanes; ++l) {
        const std::size_t q = std::min(first + l, n - 1);
        const bool padding = first + l >= n;
        for (std::size_t d = 0; d < 3; ++d) points.t[d][l] = t[3 * q + d];
        points.weight[l] = padding ? 0 : weights[q];
        plan_.point.push_back(padding || q >= of_model ? -1 : model_.points.offsets[s] + static_cast<std::int64_t>(q));
      }
      plan_.own_points.push_back(points);
    }
    plan_.num_points += static_cast<std::int64_t>(n);
    plan_.point_spans.push_back(span);
  }

  const SolutionSpace& space_;
  const TrimmedModel& model_;
  SpanPlan plan_;
  PolynomialList list_;
  Index3 lower_{}, upper_{}, edge_{};
  std::vector<std::int32_t> table_of_;
};

} // namespace

double contraction_flops(const SpanPlan& plan) {
  double lanes_of_fma = 0;
  for (const SpanGroup& group : plan.groups)
    lanes_of_fma += group.count * group_cost(plan.degree, plan.tables[static_cast<std::size_t>(group.table)]);
  const auto& p = plan.degree;
  const double polynomials = (p[0] + 1) * (2 * p[0] - 1) + (p[1] + 1) * (2 * p[1] - 1) + (p[2] + 1) * (2 * p[2] - 1);
  lanes_of_fma += static_cast<double>(plan.num_points - plan.num_group_points) * (point_cost(p, 1) + polynomials);
  return 2 * lanes_of_fma;
}

SpanPlan make_span_plan(const SolutionSpace& space) {
  return Planner(space).make();
}

} // namespace iga::solve
