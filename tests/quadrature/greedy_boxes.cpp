#include "tests/quadrature/greedy_boxes.hpp"

#include "format/model/span_state.hpp"

#include <algorithm>
#include <cmath>

namespace iga::test {

namespace {

class Greedy {
 public:
  Greedy(const Index3& spans, const std::vector<std::uint8_t>& state)
      : n_(spans), free_(state.size()), rating_(state.size(), 1) {
    for (std::size_t s = 0; s < state.size(); ++s)
      free_[s] = state[s] == static_cast<std::uint8_t>(SpanState::Interior);
    for (std::size_t d = 0; d < 3; ++d) rate(d);
  }

  std::vector<prep::SpanBox> run() {
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < free_.size(); ++s)
      if (free_[s]) order.push_back(s);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rating_[a] > rating_[b]; });
    std::vector<prep::SpanBox> boxes;
    for (const std::size_t s : order) {
      if (!free_[s]) continue;
      const auto m = static_cast<std::int64_t>(s);
      prep::SpanBox box{{m % n_[0], m / n_[0] % n_[1], m / (n_[0] * n_[1])}, {1, 1, 1}};
      while (grow(box)) {
      }
      for_spans(box, [&](std::size_t t) { free_[t] = false; });
      boxes.push_back(box);
    }
    return boxes;
  }

 private:
  std::size_t number(const Index3& i) const { return static_cast<std::size_t>(i[0] + n_[0] * (i[1] + n_[1] * i[2])); }

  template <class Use> void for_spans(const prep::SpanBox& box, Use&& use) const {
    for (std::int64_t k = 0; k < box.size[2]; ++k)
      for (std::int64_t j = 0; j < box.size[1]; ++j)
        for (std::int64_t i = 0; i < box.size[0]; ++i)
          use(number({box.first[0] + i, box.first[1] + j, box.first[2] + k}));
  }

  void rate(std::size_t d) {
    const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
    Index3 at{};
    for (at[e] = 0; at[e] < n_[e]; ++at[e])
      for (at[f] = 0; at[f] < n_[f]; ++at[f])
        for (std::int64_t first = 0; first < n_[d]; ++first) {
          std::int64_t last = first;
          for (at[d] = first; last < n_[d] && free_[number(at)]; at[d] = last) ++last;
          const double half = static_cast<double>(last - first - 1) / 2;
          for (at[d] = first; at[d] < last; ++at[d]) {
            const double off = half > 0 ? std::abs(static_cast<double>(at[d] - first) - half) / half : 0;
            rating_[number(at)] *= static_cast<double>(last - first) * (1 - 0.9 * off);
          }
          first = last;
        }
  }

  bool grow(prep::SpanBox& box) const {
    double most = -1;
    prep::SpanBox best = box;
    for (std::size_t d = 0; d < 3; ++d)
      for (const bool upper : {false, true}) {
        prep::SpanBox layer = box, larger = box;
        layer.first[d] = upper ? box.first[d] + box.size[d] : box.first[d] - 1;
        layer.size[d] = 1;
        if (layer.first[d] < 0 || layer.first[d] >= n_[d]) continue;
        larger.first[d] = std::min(box.first[d], layer.first[d]);
        ++larger.size[d];
        double sum = 0;
        bool all_free = true;
        for_spans(layer, [&](std::size_t s) {
          all_free = all_free && free_[s];
          sum += rating_[s];
        });
        if (all_free && sum > most) {
          most = sum;
          best = larger;
        }
      }
    box = best;
    return most >= 0;
  }

  Index3 n_;
  std::vector<bool> free_;
  std::vector<double> rating_;
};

} // namespace

std::vector<prep::SpanBox> greedy_boxes(const Index3& spans, const std::vector<std::uint8_t>& state) {
  return Greedy(spans, state).run();
}

} // namespace iga::test
