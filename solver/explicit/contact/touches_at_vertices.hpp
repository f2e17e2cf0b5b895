// The touches of a step as the vertices see them: what is summed at a vertex is summed in the order of the touches.
#pragma once

#include "solver/explicit/contact/touch.hpp"

namespace iga::solve {

class TouchesAtVertices {
 public:
  struct Entry {
    std::int32_t touch = 0, place = 0; ///< touches[touch].entries[place] is the vertex
    auto operator<=>(const Entry&) const = default;
  };
  /// Parallel; the same for any number of threads. @pre vertices that touch are active
  void find(std::span<const Touch> touches, const std::vector<MovingSurface>& surfaces);
  /// Ascending. @pre the vertex is active
  std::span<const Entry> of(std::size_t surface, std::int32_t vertex) const {
    const List& list = lists_[surface];
    const auto v = static_cast<std::size_t>(vertex);
    return {list.entries.data() + list.first[v], static_cast<std::size_t>(list.count[v])};
  }

 private:
  struct List {                             // of one surface
    std::vector<std::int32_t> first, count; ///< per vertex, of active ones
    std::vector<Entry> entries;
  };
  std::vector<List> lists_;
  std::vector<std::array<std::int32_t, 4>> rank_; ///< per touch: place of each entry in the list of its vertex, before
                                                  ///< that is sorted
};

} // namespace iga::solve
