#include "solver/explicit/contact/touches_at_vertices.hpp"

#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"

#include <algorithm>
#include <atomic>

namespace iga::solve {

namespace {

constexpr std::size_t grain = 256;

} // namespace

void TouchesAtVertices::find(std::span<const Touch> touches, const std::vector<MovingSurface>& surfaces) {
  lists_.resize(surfaces.size());
  rank_.resize(touches.size());
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    List& list = lists_[s];
    list.first.resize(surfaces[s].mesh().vertices.size());
    list.count.resize(list.first.size());
    const auto& active = surfaces[s].active();
    for_indices(active.size(), 4096, [&](std::size_t k) { list.count[at(active[k])] = 0; });
  }
  // Entries of a vertex come in any order here, and are put in order below.
  for_indices(touches.size(), grain, [&](std::size_t c) {
    for (int i = 0; i < touches[c].count; ++i) {
      const Touch::Entry& e = touches[c].entries[at(i)];
      std::atomic_ref<std::int32_t> count(lists_[e.surface].count[at(e.vertex)]);
      rank_[c][at(i)] = count.fetch_add(1, std::memory_order_relaxed);
    }
  });
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    List& list = lists_[s];
    std::int32_t sum = 0;
    for (const std::int32_t v : surfaces[s].active()) {
      list.first[at(v)] = sum;
      sum += list.count[at(v)];
    }
    list.entries.resize(at(sum));
  }
  for_indices(touches.size(), grain, [&](std::size_t c) {
    for (int i = 0; i < touches[c].count; ++i) {
      const Touch::Entry& e = touches[c].entries[at(i)];
      List& list = lists_[e.surface];
      list.entries[at(list.first[at(e.vertex)] + rank_[c][at(i)])] = {static_cast<std::int32_t>(c), i};
    }
  });
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    List& list = lists_[s];
    const auto& active = surfaces[s].active();
    for_indices(active.size(), 1024, [&](std::size_t k) {
      const std::size_t v = at(active[k]);
      if (list.count[v] < 2) return;
      Entry* const first = list.entries.data() + list.first[v];
      std::sort(first, first + list.count[v]);
    });
  }
}

} // namespace iga::solve
