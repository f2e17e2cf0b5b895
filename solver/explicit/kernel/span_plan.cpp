#include "solver/explicit/kernel/span_plan.hpp"

#include "solver/space/tensor_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace iga::solve {

namespace {

// Places in the span count as one within 1e-9 of its size, far above rounding and far below any difference of rules.
constexpr double same_place = 1e-9;

// Numbers the polynomials of a model as they turn up.
class PolynomialList {
 public:
  PolynomialList(const SplineGrid& grid, std::vector<SpanPolynomials>& list) : grid_(grid), list_(list) {}

  std::array<std::int32_t, 3> of(const Index3& span) {
    std::array<std::int32_t, 3> numbers{};
    for (std::size_t d = 0; d < 3; ++d) {
      const KnotVector& knots = grid_.knots(static_cast<int>(d));
      // Distance from the ends as far as it changes the functions.
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

void find_rows(const TrimmedModel& model, SpanPlan& plan) {
  const auto width = static_cast<std::size_t>(model.grid.degree()[0] + 1);
  std::vector<std::int64_t>& rows = plan.rows;
  rows.reserve(model.cells.functions.size() / width);
  std::int64_t others = 0;
  for (std::size_t c = 0; c < model.num_cells(); ++c) {
    const auto own = model.functions_of(c);
    const std::size_t first = rows.size();
    bool consecutive = true;
    for (std::size_t k = 0; k < own.size(); ++k) {
      if (k % width == 0)
        rows.push_back(own[k]);
      else
        consecutive = consecutive && own[k] == own[k - 1] + 1;
    }
    if (consecutive) continue;
    rows[first] = -1 - others++;
    plan.functions.insert(plan.functions.end(), own.begin(), own.end());
  }
}

// Costs in multiply-adds of eight lanes, forces included: to tell which way a few spans go faster.
double functions_of(const std::array<int, 3>& p) {
  return (p[0] + 1.0) * (p[1] + 1.0) * (p[2] + 1.0);
}
double tensor_cost(const std::array<int, 3>& p, const std::array<int, 3>& n) {
  const double w[3] = {p[0] + 1.0, p[1] + 1.0, p[2] + 1.0};
  return 2.0 * n[2] * (6 * w[0] * w[1] * w[2] + n[1] * (9 * w[0] * w[1] + n[0] * 9 * w[0]));
}
double block_cost(const std::array<int, 3>& p) {
  const double w[3] = {p[0] + 1.0, p[1] + 1.0, p[2] + 1.0};
  return 2.0 * (6 * w[0] * w[1] * w[2] + 9 * w[1] * w[2] + 9 * w[2]);
}
// Coefficients and forces of eight spans turned into lanes and back; forces of one span summed over its lanes.
double exchange_cost(const std::array<int, 3>& p) {
  return 18 * functions_of(p);
}
double sum_cost(const std::array<int, 3>& p) {
  return 12 * functions_of(p);
}
double own_cost(const std::array<int, 3>& p, std::size_t points) {
  return static_cast<double>((points + lanes - 1) / lanes) * block_cost(p) + sum_cost(p);
}

// What decides whether spans may share a group with a tensor.
struct TensorKind {
  std::array<std::int32_t, 3> polynomials{};
  std::array<int, 3> count{};
  auto operator<=>(const TensorKind&) const = default;
};

class Planner {
 public:
  explicit Planner(const SolutionSpace& space)
      : space_(space), model_(space.model()), list_(model_.grid, plan_.polynomials) {
    plan_.degree = model_.grid.degree();
    find_rows(model_, plan_);
  }

  SpanPlan make() {
    choose_edges();
    const Index3 n = block_counts();
    std::vector<std::vector<std::int64_t>> members(static_cast<std::size_t>(n[0] * n[1] * n[2]));
    for (std::int64_t a = 0; a < space_.num_cells(); ++a) {
      const Index3 b = block_of(a);
      members[static_cast<std::size_t>(b[0] + n[0] * (b[1] + n[1] * b[2]))].push_back(a);
    }
    // Blocks of equal parity lie at least one block apart, which is more than a function reaches: see max_degree.
    for (std::int64_t colour = 0; colour < 8; ++colour) {
      std::size_t m = 0;
      for (std::int64_t k = 0; k < n[2]; ++k)
        for (std::int64_t j = 0; j < n[1]; ++j)
          for (std::int64_t i = 0; i < n[0]; ++i, ++m)
            if ((i & 1) + 2 * (j & 1) + 4 * (k & 1) == colour && !members[m].empty()) {
              places_[{i, j, k}] = static_cast<std::int32_t>(plan_.blocks.size());
              add_block(members[m]);
            }
    }
    find_followers();
    return std::move(plan_);
  }

 private:
  Index3 index(std::int64_t a) const { return model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(a)]); }
  Index3 block_of(std::int64_t a) const {
    const Index3 s = index(a);
    return {(s[0] - lower_[0]) / edge_[0], (s[1] - lower_[1]) / edge_[1], (s[2] - lower_[2]) / edge_[2]};
  }
  Index3 block_counts() const {
    Index3 n{};
    for (std::size_t d = 0; d < 3; ++d) n[d] = (upper_[d] - lower_[d]) / edge_[d] + 1;
    return n;
  }

  // Large blocks fill groups of eight better, many blocks feed more threads: the smallest that hold enough spans.
  void choose_edges() {
    lower_ = upper_ = index(0);
    for (std::int64_t a = 1; a < space_.num_cells(); ++a)
      for (std::size_t d = 0; d < 3; ++d) {
        lower_[d] = std::min(lower_[d], index(a)[d]);
        upper_[d] = std::max(upper_[d], index(a)[d]);
      }
    constexpr std::int64_t enough = 80;
    static_assert(max_degree <= 4);
    for (const Index3& edge : {Index3{8, 4, 4}, Index3{8, 8, 4}, Index3{8, 8, 8}}) {
      edge_ = edge;
      std::map<Index3, int> used;
      for (std::int64_t a = 0; a < space_.num_cells(); ++a) used[block_of(a)] = 1;
      if (space_.num_cells() >= enough * static_cast<std::int64_t>(used.size())) break;
    }
  }

  // Only blocks side by side share functions; blocks are numbered by colour.
  void find_followers() {
    plan_.followers.resize(plan_.blocks.size());
    plan_.num_before.assign(plan_.blocks.size(), 0);
    for (const auto& [place, b] : places_)
      for (std::int64_t k = -1; k <= 1; ++k)
        for (std::int64_t j = -1; j <= 1; ++j)
          for (std::int64_t i = -1; i <= 1; ++i) {
            const auto other = places_.find({place[0] + i, place[1] + j, place[2] + k});
            if (other == places_.end() || other->second <= b) continue;
            plan_.followers[static_cast<std::size_t>(b)].push_back(other->second);
            ++plan_.num_before[static_cast<std::size_t>(other->second)];
          }
  }

  void add_block(const std::vector<std::int64_t>& spans) {
    WorkBlock block;
    std::map<TensorKind, std::vector<std::int64_t>> tensors;
    std::vector<std::int64_t> others;
    for (const std::int64_t a : spans) {
      SpanPointStorage storage;
      const SpanPoints points = span_points(space_, a, storage);
      if (points.weights.empty()) continue; // generalised rules leave spans without points
      TensorPoints tensor;
      if (as_tensor(points, tensor) && fits(tensor))
        tensors[{list_.of(index(a)), counts(tensor)}].push_back(a);
      else
        others.push_back(a);
    }
    block.groups[0] = static_cast<std::int64_t>(plan_.groups.size());
    const auto& p = plan_.degree;
    for (const auto& [kind, members] : tensors)
      for (std::size_t first = 0; first < members.size(); first += lanes) {
        const auto part = std::span(members).subspan(first, std::min(lanes, members.size() - first));
        const int size = kind.count[0] * kind.count[1] * kind.count[2];
        const double others_cost = (size * block_cost(p) + exchange_cost(p)) / lanes;
        if (tensor_cost(p, kind.count) + exchange_cost(p) < static_cast<double>(part.size()) * others_cost)
          add_tensor_group(kind, part);
        else
          others.insert(others.end(), part.begin(), part.end());
      }
    block.point_spans[0] = static_cast<std::int64_t>(plan_.point_spans.size());
    add_others(others);
    block.point_spans[1] = static_cast<std::int64_t>(plan_.point_spans.size());
    block.groups[1] = static_cast<std::int64_t>(plan_.groups.size());
    plan_.blocks.push_back(block);
  }

  static bool fits(const TensorPoints& tensor) {
    return std::all_of(tensor.position.begin(), tensor.position.end(),
                       [](const auto& list) { return list.size() <= max_row_points; });
  }
  static std::array<int, 3> counts(const TensorPoints& tensor) {
    return {static_cast<int>(tensor.position[0].size()), static_cast<int>(tensor.position[1].size()),
            static_cast<int>(tensor.position[2].size())};
  }
  std::size_t num_points(std::int64_t a) const {
    SpanPointStorage storage;
    return span_points(space_, a, storage).weights.size();
  }

  // Spans without a common tensor: those with equally many points side by side, and the few that fill no group alone.
  void add_others(const std::vector<std::int64_t>& spans) {
    std::map<std::array<std::int32_t, 3>, std::vector<std::pair<std::size_t, std::int64_t>>> by_polynomials;
    for (const std::int64_t a : spans) by_polynomials[list_.of(index(a))].emplace_back(num_points(a), a);
    for (auto& [polynomials, members] : by_polynomials) {
      std::sort(members.begin(), members.end());
      for (std::size_t first = 0; first < members.size(); first += lanes) {
        const auto part = std::span(members).subspan(first, std::min(lanes, members.size() - first));
        double alone = 0;
        for (const auto& [n, a] : part) alone += own_cost(plan_.degree, n);
        const auto most = static_cast<double>(part.back().first);
        if (most * block_cost(plan_.degree) + exchange_cost(plan_.degree) < alone)
          add_lane_group(polynomials, part);
        else
          for (const auto& [n, a] : part) add_point_span(polynomials, a);
      }
    }
  }

  // A tensor of eight spans, known or new.
  std::int32_t number_of(const LaneTensor& tensor) {
    std::vector<std::int64_t> key(tensor.polynomials.begin(), tensor.polynomials.end());
    key.insert(key.end(), tensor.count.begin(), tensor.count.end());
    const auto add = [&](const std::vector<Lanes>& values, double unit) {
      for (const Lanes& x : values)
        for (std::size_t l = 0; l < lanes; ++l) key.push_back(std::llround(x[l] / (unit * same_place)));
    };
    for (const auto& list : tensor.t) add(list, 1);
    add(tensor.weights, model_.grid.span_volume());
    const auto [it, is_new] = known_.try_emplace(std::move(key), static_cast<std::int32_t>(plan_.tensors.size()));
    if (is_new) plan_.tensors.push_back(tensor);
    return it->second;
  }

  SpanGroup new_group(const std::array<std::int32_t, 3>& polynomials, std::size_t spans, std::size_t blocks) const {
    SpanGroup group;
    group.count = static_cast<std::int32_t>(spans);
    group.blocks = static_cast<std::int32_t>(blocks);
    group.polynomials = polynomials;
    group.first_block = plan_.num_point_blocks();
    group.first_own = static_cast<std::int64_t>(plan_.own_points.size());
    return group;
  }

  // Number of the q-th point of the a-th span in the model; -1 for fictitious material, which comes after its points.
  std::int64_t number_in_model(std::int64_t a, std::size_t q) const {
    const auto s = static_cast<std::size_t>(a);
    const std::int64_t number = model_.points.offsets[s] + static_cast<std::int64_t>(q);
    return number < model_.points.offsets[s + 1] ? number : -1;
  }

  void add_tensor_group(const TensorKind& kind, std::span<const std::int64_t> members) {
    const auto size = static_cast<std::size_t>(kind.count[0] * kind.count[1] * kind.count[2]);
    SpanGroup group = new_group(kind.polynomials, members.size(), size);
    LaneTensor tensor{kind.polynomials, kind.count, {}, std::vector<Lanes>(size)};
    for (std::size_t d = 0; d < 3; ++d) tensor.t[d].resize(static_cast<std::size_t>(kind.count[d]));
    plan_.point.resize(plan_.point.size() + lanes * size, -1);
    auto* const numbers = plan_.point.data() + static_cast<std::int64_t>(lanes) * group.first_block;
    const std::size_t steps[3] = {1, tensor.t[0].size(), tensor.t[0].size() * tensor.t[1].size()};
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::int64_t a = members[std::min(l, members.size() - 1)];
      group.spans[l] = static_cast<std::int32_t>(a);
      SpanPointStorage storage;
      const auto [parameters, weights] = span_points(space_, a, storage);
      const std::vector<double> t = local_points(model_.grid, index(a), parameters);
      for (std::size_t d = 0; d < 3; ++d)
        for (std::size_t i = 0; i < tensor.t[d].size(); ++i) tensor.t[d][i][l] = t[3 * i * steps[d] + d];
      for (std::size_t q = 0; q < size; ++q) {
        tensor.weights[q][l] = weights[q];
        if (l < members.size()) numbers[lanes * q + l] = number_in_model(a, q);
      }
    }
    group.tensor = number_of(tensor);
    plan_.num_points += static_cast<std::int64_t>(size * members.size());
    plan_.num_tensor_points += static_cast<std::int64_t>(size * members.size());
    plan_.groups.push_back(group);
  }

  // Puts the q-th point of a span into a lane; beyond its last one, that one again with weight 0.
  void put_point(std::int64_t a, const SpanPoints& points, std::size_t q, bool counts, std::size_t lane,
                 OwnPoints& block, std::int64_t& number) const {
    const std::size_t n = points.weights.size(), k = std::min(q, n - 1);
    const std::vector<double> t = local_points(model_.grid, index(a), points.parameters.subspan(3 * k, 3));
    for (std::size_t d = 0; d < 3; ++d) block.t[d][lane] = t[d];
    const bool own = counts && q < n;
    block.weight[lane] = own ? points.weights[k] : 0;
    number = own ? number_in_model(a, k) : -1;
  }

  void add_lane_group(const std::array<std::int32_t, 3>& polynomials,
                      std::span<const std::pair<std::size_t, std::int64_t>> members) {
    const std::size_t size = members.back().first;
    SpanGroup group = new_group(polynomials, members.size(), size);
    plan_.point.resize(plan_.point.size() + lanes * size, -1);
    plan_.own_points.resize(plan_.own_points.size() + size);
    auto* const numbers = plan_.point.data() + static_cast<std::int64_t>(lanes) * group.first_block;
    auto* const own = plan_.own_points.data() + group.first_own;
    for (std::size_t l = 0; l < lanes; ++l) {
      const bool counts = l < members.size();
      const auto [n, a] = members[counts ? l : members.size() - 1];
      group.spans[l] = static_cast<std::int32_t>(a);
      SpanPointStorage storage;
      const SpanPoints points = span_points(space_, a, storage);
      for (std::size_t q = 0; q < size; ++q) put_point(a, points, q, counts, l, own[q], numbers[lanes * q + l]);
      if (counts) plan_.num_lane_points += static_cast<std::int64_t>(n);
      if (counts) plan_.num_points += static_cast<std::int64_t>(n);
    }
    plan_.groups.push_back(group);
  }

  void add_point_span(const std::array<std::int32_t, 3>& polynomials, std::int64_t a) {
    SpanPointStorage storage;
    const SpanPoints points = span_points(space_, a, storage);
    const std::size_t n = points.weights.size();
    PointSpan span;
    span.span = static_cast<std::int32_t>(a);
    span.blocks = static_cast<std::int32_t>((n + lanes - 1) / lanes);
    span.polynomials = polynomials;
    span.first_block = plan_.num_point_blocks();
    span.first_own = static_cast<std::int64_t>(plan_.own_points.size());
    for (std::size_t first = 0; first < n; first += lanes) {
      OwnPoints block;
      for (std::size_t l = 0; l < lanes; ++l) {
        std::int64_t number = -1;
        put_point(a, points, first + l, true, l, block, number);
        plan_.point.push_back(number);
      }
      plan_.own_points.push_back(block);
    }
    plan_.num_points += static_cast<std::int64_t>(n);
    plan_.point_spans.push_back(span);
  }

  const SolutionSpace& space_;
  const TrimmedModel& model_;
  SpanPlan plan_;
  PolynomialList list_;
  Index3 lower_{}, upper_{}, edge_{};
  std::map<Index3, std::int32_t> places_;                   // numbers of the blocks
  std::map<std::vector<std::int64_t>, std::int32_t> known_; // numbers of the tensors
};

} // namespace

double contraction_flops(const SpanPlan& plan) {
  double lanes_of_fma = 0;
  for (const SpanGroup& group : plan.groups)
    if (group.tensor >= 0)
      lanes_of_fma +=
          group.count * tensor_cost(plan.degree, plan.tensors[static_cast<std::size_t>(group.tensor)].count);
  const auto& p = plan.degree;
  const double polynomials = (p[0] + 1) * (2 * p[0] - 1) + (p[1] + 1) * (2 * p[1] - 1) + (p[2] + 1) * (2 * p[2] - 1);
  lanes_of_fma += static_cast<double>(plan.num_points - plan.num_tensor_points) * (block_cost(p) + polynomials);
  return 2 * lanes_of_fma;
}

SpanPlan make_span_plan(const SolutionSpace& space) {
  return Planner(space).make();
}

} // namespace iga::solve
