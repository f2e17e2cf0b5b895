// From the interior outward: which spans are sure to move rigidly when no point sees a strain.
#include "format/model/disjoint_sets.hpp"
#include "preprocessor/quadrature/trimmed_rules.hpp"
#include "preprocessor/reduce/kept_stiffness.hpp"
#include "preprocessor/reduce/span_reduction.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace iga::prep {

namespace {

std::vector<PieceLink> links_of_spans(const SplineGrid& grid, const std::vector<std::int64_t>& active) {
  std::vector<PieceLink> links;
  for (std::size_t a = 0; a < active.size(); ++a)
    for (std::size_t d = 0; d < 3; ++d) {
      Index3 next = grid.span_index(active[a]);
      if (++next[d] >= grid.spans()[d]) continue;
      const std::int64_t number = grid.span_number(next);
      const auto found = std::lower_bound(active.begin(), active.end(), number);
      if (found != active.end() && *found == number)
        links.push_back({static_cast<std::int32_t>(a), static_cast<std::int32_t>(found - active.begin()),
                         static_cast<std::uint8_t>(d)});
    }
  return links;
}

/// Rigid spans and the groups that move together.
class Rigidity {
 public:
  Rigidity(const SplineGrid& grid, const Trimming& trimming)
      : trimming_(trimming), rigid_(trimming.active.size(), 0), group_(trimming.active.size()) {
    std::iota(group_.begin(), group_.end(), 0);
    find_neighbours(grid);
    for (std::size_t a = 0; a < rigid_.size(); ++a)
      if (is_interior(trimming, a) || trimming.is_at_gap_end(a)) make_rigid(a);
  }

  bool is_rigid(std::size_t a) const { return rigid_[a] != 0; }

  /// Calls visit(cell) for the cells beyond a face (2 d for the lower one in direction d) that a cell is linked with.
  template <class Visit> void for_neighbours(std::size_t a, std::size_t face, const Visit& visit) const {
    for (auto k = first_[6 * a + face]; k < first_[6 * a + face + 1]; ++k) visit(neighbours_[k]);
  }

  /// A span that moves rigidly moves as its rigid neighbours do. The others beside it may now be judged.
  void make_rigid(std::size_t a) {
    rigid_[a] = 1;
    for (std::size_t face = 0; face < 6; ++face) {
      for_neighbours(a, face, [&](std::size_t n) {
        if (is_rigid(n))
          join_sets(group_, static_cast<std::int32_t>(a), static_cast<std::int32_t>(n));
        else if (!is_interior(trimming_, n)) // take_beside leaves out what has become rigid
          beside_.push_back(n);
      });
    }
  }

  /// Spans beside those that became rigid since the last call, ascending, rigid ones left out.
  std::vector<std::size_t> take_beside() {
    std::vector<std::size_t> spans = std::exchange(beside_, {});
    std::sort(spans.begin(), spans.end());
    spans.erase(std::unique(spans.begin(), spans.end()), spans.end());
    std::erase_if(spans, [&](std::size_t a) { return is_rigid(a); });
    return spans;
  }

  struct Hold {
    HeldFaces faces{};
    int directions = 0;
    bool clamped = false; ///< rigid on two opposite faces: nothing is free
  };
  /// Faces held by the group that holds most of them.
  Hold held(std::size_t a) {
    std::map<std::int32_t, Hold> by_group;
    for (std::size_t face = 0; face < 6; ++face) {
      const int way = face % 2 == 0 ? -1 : 1;
      for_neighbours(a, face, [&](std::size_t n) {
        // Across the face of a cell with functions of its own, values are continuous but slopes are not.
        if (!is_rigid(n) || trimming_.is_at_gap_end(n)) return;
        Hold& hold = by_group[find_root(group_, static_cast<std::int32_t>(n))];
        int& side = hold.faces[face / 2];
        if (side == way) return; // another cell beyond the same face
        hold.clamped = hold.clamped || side != 0;
        hold.directions += side == 0;
        side = way;
      });
    }
    Hold best;
    for (const auto& [group, hold] : by_group)
      if (hold.clamped || (!best.clamped && hold.directions > best.directions)) best = hold;
    return best;
  }

 private:
  // From the links of the cells; neighbouring spans where spans were not split into cells.
  void find_neighbours(const SplineGrid& grid) {
    const std::vector<PieceLink> links =
        trimming_.links.empty() ? links_of_spans(grid, trimming_.active) : trimming_.links;
    first_.assign(6 * trimming_.active.size() + 1, 0);
    const auto slot = [](std::int32_t cell, std::size_t face) { return 6 * static_cast<std::size_t>(cell) + face; };
    for (const PieceLink& link : links) {
      ++first_[slot(link.low, 2 * link.axis + 1U) + 1];
      ++first_[slot(link.high, 2U * link.axis) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    neighbours_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const PieceLink& link : links) {
      neighbours_[next[slot(link.low, 2 * link.axis + 1U)]++] = static_cast<std::size_t>(link.high);
      neighbours_[next[slot(link.high, 2U * link.axis)]++] = static_cast<std::size_t>(link.low);
    }
  }

  const Trimming& trimming_;
  std::vector<std::size_t> first_, neighbours_; // of each cell's faces
  std::vector<std::uint8_t> rigid_;
  std::vector<std::int32_t> group_; // disjoint sets
  std::vector<std::size_t> beside_;
};

/// A span that needs more points, and what held it when that became clear.
struct WeakSpan {
  std::size_t active;
  Rigidity::Hold hold;
};

/// The waves from the interior outward. @tparam Resists  bool(active span, hold), called in parallel
template <class Resists> class RigiditySearch {
 public:
  RigiditySearch(const SplineGrid& grid, const Trimming& trimming, const Resists& resists)
      : trimming_(trimming), rigidity_(grid, trimming), resists_(resists), tried_(trimming.active.size()) {}

  /// Spans that cannot be shown to be rigid with the points they have, ascending.
  std::vector<WeakSpan> run() {
    do {
      while (wave()) {
      }
    } while (give_up_some() || begin_parts());
    std::sort(weak_.begin(), weak_.end(), [](const WeakSpan& x, const WeakSpan& y) { return x.active < y.active; });
    return std::move(weak_);
  }

 private:
  bool fuller(std::size_t x, std::size_t y) const {
    const auto& fraction = trimming_.fraction;
    return fraction[x] != fraction[y] ? fraction[x] > fraction[y] : x < y;
  }

  // All spans beside newly rigid ones that are held in a way they have not been judged in.
  bool wave() {
    std::vector<WeakSpan> spans;
    for (const std::size_t a : rigidity_.take_beside())
      if (const Rigidity::Hold hold = rigidity_.held(a); hold.clamped || hold.faces != tried_[a])
        spans.push_back({a, hold});
    std::vector<std::uint8_t> passes(spans.size());
    tbb::parallel_for(std::size_t{0}, spans.size(),
                      [&](std::size_t i) { passes[i] = resists_(spans[i].active, spans[i].hold); });
    for (std::size_t i = 0; i < spans.size(); ++i) {
      const std::size_t a = spans[i].active;
      if (passes[i])
        rigidity_.make_rigid(a);
      else if (tried_[a] == HeldFaces{})
        failed_.push_back(a);
      tried_[a] = spans[i].hold.faces;
    }
    return !spans.empty();
  }

  // Of the spans that failed, the fullest of every neighbourhood will get more points: the others may do beside it.
  bool give_up_some() {
    std::erase_if(failed_, [&](std::size_t a) { return rigidity_.is_rigid(a); });
    std::vector<WeakSpan> chosen;
    for (const std::size_t a : failed_) {
      bool fullest = true;
      for (std::size_t face = 0; face < 6; ++face)
        rigidity_.for_neighbours(a, face, [&](std::size_t n) {
          fullest = fullest && (rigidity_.is_rigid(n) || tried_[n] == HeldFaces{} || fuller(a, n));
        });
      if (fullest) chosen.push_back({a, rigidity_.held(a)});
    }
    for (const WeakSpan& weak : chosen) {
      rigidity_.make_rigid(weak.active);
      weak_.push_back(weak);
    }
    return !chosen.empty();
  }

  // Parts without any rigid span: each begins with its fullest one.
  bool begin_parts() {
    std::vector<std::size_t> open;
    for (std::size_t a = 0; a < tried_.size(); ++a)
      if (!rigidity_.is_rigid(a)) open.push_back(a);
    std::vector<std::int32_t> part(tried_.size());
    std::iota(part.begin(), part.end(), 0);
    for (const std::size_t a : open)
      for (std::size_t face = 1; face < 6; face += 2)
        rigidity_.for_neighbours(a, face, [&](std::size_t n) {
          join_sets(part, static_cast<std::int32_t>(a), static_cast<std::int32_t>(n));
        });
    std::map<std::int32_t, std::size_t> first;
    for (const std::size_t a : open) {
      const auto [entry, added] = first.try_emplace(find_root(part, static_cast<std::int32_t>(a)), a);
      if (!added && fuller(a, entry->second)) entry->second = a;
    }
    for (const auto& [root, a] : first) {
      if (!resists_(a, {})) weak_.push_back({a, {}});
      rigidity_.make_rigid(a);
    }
    return !open.empty();
  }

  const Trimming& trimming_;
  Rigidity rigidity_;
  const Resists& resists_;
  std::vector<HeldFaces> tried_; // (num_active): how a span was held when it was last judged
  std::vector<std::size_t> failed_;
  std::vector<WeakSpan> weak_;
};

/// What a thread needs to judge a span.
struct Judge {
  MomentFitter fitter;
  KeptStiffness kept;

  /// Opens the span. @return the rule that resists everything
  SpanRule open(std::size_t touched, const std::array<int, 3>& degree) {
    const SpanRule& fitted = fitter.fit(touched);
    return resisting_rule(fitter.part(), fitted, degree);
  }
  bool keeps(const Rigidity::Hold& hold, const SpanRule& rule, const SpanRule& full) {
    return kept.keeps(fitter.part().surface().box, hold.faces, {rule.points, rule.weights},
                      {full.points, full.weights});
  }
};

} // namespace

void TrimmedRules::secure(const QuadratureOptions& options) {
  tbb::enumerable_thread_specific<Judge> judges([&] {
    return Judge{MomentFitter(*grid_, *trimming_, far_, options.moment_degree, options.tolerance),
                 KeptStiffness(*grid_)};
  });
  const auto resists = [&](std::size_t a, const Rigidity::Hold& hold) {
    if (hold.clamped) return true;
    const SpanRule own = rule(a);
    if (!reduced_ && own.shape == SpanShape::Free) return true; // the fitted rule
    Judge& judge = judges.local();
    const SpanRule full = judge.open(static_cast<std::size_t>(trimming_->touched[a]), grid_->degree());
    return judge.keeps(hold, own, full);
  };
  const std::vector<WeakSpan> weak = RigiditySearch(*grid_, *trimming_, resists).run();
  std::vector<std::pair<std::size_t, SpanRule>> rules(weak.size());
  tbb::parallel_for(std::size_t{0}, weak.size(), [&](std::size_t i) {
    const auto& [a, hold] = weak[i];
    Judge& judge = judges.local();
    const SpanRule full = judge.open(static_cast<std::size_t>(trimming_->touched[a]), grid_->degree());
    // As in SpanReducer::reduce: a sliver where positions have few digits left keeps the rule it has.
    const auto fits = [&](const SpanRule& rule) { return rule.residual <= options.tolerance; };
    rules[i] = {a, fits(full) ? full : rule(a)};
    for (SpanRule& product : stronger_products(judge.fitter.part(), rule(a), grid_->degree()))
      if (fits(product) && judge.keeps(hold, product, full)) {
        rules[i].second = std::move(product);
        break;
      }
  });
  replace(rules);
  counts_.stabilised_spans = static_cast<std::int64_t>(rules.size());
}

} // namespace iga::prep
