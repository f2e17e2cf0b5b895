#include "preprocessor/interior/span_boxes.hpp"

#include "format/model/span_state.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace iga::prep {

namespace {

/// How boxes grow from a span: by the layer with the largest rating, along one axis after another (six orders), or
/// along the shortest side.
enum class Growth : std::uint8_t { Rating, Uvw, Uwv, Vuw, Vwu, Wuv, Wvu, Shortest };

struct Plan {
  Growth growth = Growth::Rating;
  /// Share of its rating that a span at the end of a run loses against one in the middle.
  double taper = 0.9;
};

// The first of them is the greedy choice of Messmer et al. (2022), section 3.2.1; ends count less in it, so that boxes
// grow from the middle of runs.
constexpr std::array<Plan, 6> whole_plans{{{Growth::Rating, 0.9},
                                           {Growth::Rating, 0.45},
                                           {Growth::Rating, 0},
                                           {Growth::Shortest, 0.9},
                                           {Growth::Shortest, 0.45},
                                           {Growth::Shortest, 0}}};
constexpr std::array<Plan, 8> small_plans{{{Growth::Rating},
                                           {Growth::Shortest},
                                           {Growth::Uvw},
                                           {Growth::Uwv},
                                           {Growth::Vuw},
                                           {Growth::Vwu},
                                           {Growth::Wuv},
                                           {Growth::Wvu}}};

// The first pass brings nine tenths of what passes bring, the second one most of the rest.
constexpr int most_passes = 6;

constexpr std::array<std::array<std::size_t, 3>, 6> axis_orders{
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

std::int64_t volume(const SpanBox& box) {
  return box.size[0] * box.size[1] * box.size[2];
}

std::int64_t total(const std::vector<SpanBox>& boxes, const BoxCost& cost) {
  return std::accumulate(boxes.begin(), boxes.end(), std::int64_t{0},
                         [&](std::int64_t sum, const SpanBox& box) { return sum + cost(box.size); });
}

/// Lays boxes over the spans that are free, from those that sit best in long runs.
class BoxLayer {
 public:
  explicit BoxLayer(const Index3& spans)
      : n_(spans), step_{1, spans[0], spans[0] * spans[1]}, free_(static_cast<std::size_t>(step_[2] * spans[2]), 0),
        rating_(free_.size(), 0) {}

  std::int64_t number(const Index3& i) const { return i[0] + step_[1] * i[1] + step_[2] * i[2]; }
  Index3 index(std::int64_t s) const { return {s % n_[0], s / step_[1] % n_[1], s / step_[2]}; }
  std::int64_t step(std::size_t d) const { return step_[d]; }

  /// Boxes over `spans` (ascending), none of which is free before or after.
  std::vector<SpanBox> lay(const std::vector<std::int64_t>& spans, const Plan& plan) {
    for (const std::int64_t s : spans) free_[at(s)] = 1;
    rate(spans, plan.taper);
    order_ = spans;
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::int64_t a, std::int64_t b) { return rating_[at(a)] > rating_[at(b)]; });
    std::vector<SpanBox> boxes;
    for (const std::int64_t s : order_) {
      if (!free_[at(s)]) continue;
      boxes.push_back(grown(s, plan.growth));
      for_rows(boxes.back(), [&](std::int64_t first, std::int64_t length) {
        std::fill_n(free_.begin() + first, length, std::uint8_t{0});
        return true;
      });
    }
    return boxes;
  }

  template <class Use> bool for_rows(const SpanBox& box, Use&& use) const {
    for (std::int64_t k = 0; k < box.size[2]; ++k)
      for (std::int64_t j = 0; j < box.size[1]; ++j)
        if (!use(number({box.first[0], box.first[1] + j, box.first[2] + k}), box.size[0])) return false;
    return true;
  }

 private:
  static std::size_t at(std::int64_t s) { return static_cast<std::size_t>(s); }

  // Product over the directions of L (1 - taper · distance from the run's middle), L the length of the run of free
  // spans.
  void rate(const std::vector<std::int64_t>& spans, double taper) {
    for (const std::int64_t s : spans) rating_[at(s)] = 1;
    for (std::size_t d = 0; d < 3; ++d)
      for (const std::int64_t s : spans) {
        const std::int64_t place = s / step_[d] % n_[d];
        if (place > 0 && free_[at(s - step_[d])]) continue; // not the first of its run
        std::int64_t length = 1;
        while (place + length < n_[d] && free_[at(s + length * step_[d])]) ++length;
        const double half = 0.5 * static_cast<double>(length - 1);
        for (std::int64_t i = 0; i < length; ++i) {
          const double off = length > 1 ? std::abs(static_cast<double>(i) - half) / half : 0;
          rating_[at(s + i * step_[d])] *= static_cast<float>(static_cast<double>(length) * (1 - taper * off));
        }
      }
  }

  // Summed rating of the layer beyond a face; nothing where it is not free.
  std::optional<double> layer_rating(const SpanBox& box, std::size_t d, bool upper) const {
    SpanBox layer = box;
    layer.first[d] = upper ? box.first[d] + box.size[d] : box.first[d] - 1;
    layer.size[d] = 1;
    if (layer.first[d] < 0 || layer.first[d] >= n_[d]) return {};
    double sum = 0;
    const bool free = for_rows(layer, [&](std::int64_t first, std::int64_t length) {
      for (std::int64_t s = first; s < first + length; ++s) {
        if (!free_[at(s)]) return false;
        sum += rating_[at(s)];
      }
      return true;
    });
    return free ? std::optional(sum) : std::nullopt;
  }

  static void add_layer(SpanBox& box, std::size_t d, bool upper) {
    if (!upper) --box.first[d];
    ++box.size[d];
  }

  // Grows along one axis by one layer, at the better end.
  bool grow(SpanBox& box, std::size_t d) const {
    const auto lower = layer_rating(box, d, false), upper = layer_rating(box, d, true);
    if (!lower && !upper) return false;
    add_layer(box, d, !lower || (upper && *upper > *lower));
    return true;
  }

  SpanBox grown(std::int64_t seed, Growth growth) const {
    SpanBox box{index(seed), {1, 1, 1}};
    if (growth == Growth::Rating) {
      for (;;) {
        double most = -1;
        std::size_t axis = 0;
        bool end = false;
        for (std::size_t d = 0; d < 3; ++d)
          for (const bool upper : {false, true})
            if (const auto sum = layer_rating(box, d, upper); sum && *sum > most) {
              most = *sum;
              axis = d;
              end = upper;
            }
        if (most < 0) return box;
        add_layer(box, axis, end);
      }
    }
    if (growth == Growth::Shortest) {
      std::array<bool, 3> open{true, true, true};
      for (;;) {
        std::size_t axis = 3;
        for (std::size_t d = 0; d < 3; ++d)
          if (open[d] && (axis == 3 || box.size[d] < box.size[axis])) axis = d;
        if (axis == 3) return box;
        open[axis] = grow(box, axis);
      }
    }
    for (const std::size_t d : axis_orders[static_cast<std::size_t>(growth) - static_cast<std::size_t>(Growth::Uvw)])
      while (grow(box, d)) {
      }
    return box;
  }

  Index3 n_;
  std::array<std::int64_t, 3> step_;
  std::vector<std::uint8_t> free_;
  std::vector<float> rating_;
  std::vector<std::int64_t> order_;
};

/// Takes a box and its neighbours away and lays them anew in several ways; the best one stays.
class Refinement {
 public:
  Refinement(const Index3& spans, std::vector<SpanBox> boxes, const BoxCost& cost)
      : n_(spans), layer_(spans), cost_(cost), boxes_(std::move(boxes)),
        owner_(static_cast<std::size_t>(spans[0] * spans[1] * spans[2]), -1) {
    for (std::size_t b = 0; b < boxes_.size(); ++b) own(b);
  }

  /// Points saved by one pass over all boxes that changed since their last turn.
  std::int64_t pass() {
    std::int64_t saved = 0;
    changed_.resize(boxes_.size(), true);
    const std::size_t last = boxes_.size();
    for (std::size_t b = 0; b < last; ++b)
      if (boxes_[b].size[0] > 0 && changed_[b]) saved += renew(b);
    return saved;
  }
  std::vector<SpanBox> take_boxes() {
    std::erase_if(boxes_, [](const SpanBox& box) { return box.size[0] == 0; });
    return std::move(boxes_);
  }

 private:
  void own(std::size_t b) {
    layer_.for_rows(boxes_[b], [&](std::int64_t first, std::int64_t length) {
      std::fill_n(owner_.begin() + first, length, static_cast<std::int32_t>(b));
      return true;
    });
  }

  // The box and those that touch a face of it, as far as they are small.
  void gather(std::size_t b) {
    constexpr std::int64_t most_spans = 1024;
    group_.assign(1, b);
    std::int64_t spans = volume(boxes_[b]);
    for (std::size_t d = 0; d < 3; ++d)
      for (const bool upper : {false, true}) {
        SpanBox face = boxes_[b];
        face.first[d] = upper ? face.first[d] + face.size[d] : face.first[d] - 1;
        face.size[d] = 1;
        if (face.first[d] < 0 || face.first[d] >= n_[d]) continue;
        layer_.for_rows(face, [&](std::int64_t first, std::int64_t length) {
          for (std::int64_t s = first; s < first + length; ++s) {
            const std::int32_t other = owner_[static_cast<std::size_t>(s)];
            if (other < 0) continue;
            const auto o = static_cast<std::size_t>(other);
            if (o == group_.back() || std::find(group_.begin(), group_.end(), o) != group_.end()) continue;
            if (spans + volume(boxes_[o]) > most_spans) continue;
            spans += volume(boxes_[o]);
            group_.push_back(o);
          }
          return true;
        });
      }
  }

  std::int64_t renew(std::size_t b) {
    gather(b);
    if (group_.size() < 2) return 0;
    std::int64_t before = 0;
    spans_.clear();
    for (const std::size_t g : group_) {
      before += cost_(boxes_[g].size);
      layer_.for_rows(boxes_[g], [&](std::int64_t first, std::int64_t length) {
        for (std::int64_t s = first; s < first + length; ++s) spans_.push_back(s);
        return true;
      });
    }
    std::sort(spans_.begin(), spans_.end());
    std::int64_t least = before;
    std::vector<SpanBox> best;
    for (const Plan& plan : small_plans) {
      std::vector<SpanBox> boxes = layer_.lay(spans_, plan);
      const std::int64_t points = total(boxes, cost_);
      if (points >= least) continue;
      least = points;
      best = std::move(boxes);
    }
    changed_[b] = false;
    if (best.empty()) return 0;
    for (const std::size_t g : group_) {
      boxes_[g].size = {0, 0, 0};
      changed_[g] = true;
    }
    for (std::size_t k = 0; k < best.size(); ++k) {
      const std::size_t slot = k < group_.size() ? group_[k] : boxes_.size();
      if (slot == boxes_.size()) {
        boxes_.emplace_back();
        changed_.push_back(true);
      }
      boxes_[slot] = best[k];
      own(slot);
    }
    return before - least;
  }

  Index3 n_;
  BoxLayer layer_;
  const BoxCost& cost_;
  std::vector<SpanBox> boxes_;
  std::vector<std::int32_t> owner_;
  std::vector<bool> changed_;
  std::vector<std::size_t> group_;
  std::vector<std::int64_t> spans_;
};

} // namespace

BoxCost::BoxCost(const std::array<TargetSpace, 3>& spaces, std::int64_t longest) {
  for (std::size_t d = 0; d < 3; ++d) {
    points_[d].push_back(0);
    for (std::int64_t e = 1; e <= longest; ++e) points_[d].push_back(run_points(spaces[d], e));
  }
}

bool BoxCost::is_additive() const {
  return std::all_of(points_.begin(), points_.end(), [](const auto& points) {
    return points.back() == points[1] * (static_cast<std::int64_t>(points.size()) - 1);
  });
}

std::vector<SpanBox> lay_boxes(const Index3& spans, const std::vector<std::uint8_t>& state, const BoxCost& cost) {
  std::vector<std::int64_t> interior;
  for (std::size_t s = 0; s < state.size(); ++s)
    if (state[s] == static_cast<std::uint8_t>(SpanState::Interior)) interior.push_back(static_cast<std::int64_t>(s));
  std::array<std::vector<SpanBox>, whole_plans.size()> found;
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t p) { found[p] = BoxLayer(spans).lay(interior, whole_plans[p]); });
  const auto best = std::min_element(found.begin(), found.end(),
                                     [&](const auto& a, const auto& b) { return total(a, cost) < total(b, cost); });
  Refinement refinement(spans, std::move(*best), cost);
  for (int pass = 0; pass < most_passes; ++pass)
    if (refinement.pass() == 0) break;
  return refinement.take_boxes();
}

} // namespace iga::prep
