// From the interior outward: which spans are sure to move rigidly when no point sees a strain.
#include "preprocessor/disjoint_sets.hpp"
#include "preprocessor/kept_stiffness.hpp"
#include "preprocessor/span_reduction.hpp"
#include "preprocessor/trimmed_rules.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace iga::prep {

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

/// Rigid spans and the groups that move together.
class Rigidity {
 public:
  Rigidity(const SplineGrid& grid, const Trimming& trimming)
      : grid_(grid), trimming_(trimming), rigid_(trimming.active.size(), 0), group_(trimming.active.size()) {
    std::iota(group_.begin(), group_.end(), 0);
    for (std::size_t a = 0; a < rigid_.size(); ++a)
      if (is_interior(trimming, a)) make_rigid(a);
  }

  bool is_rigid(std::size_t a) const { return rigid_[a] != 0; }

  /// Active span beyond a face (2 d for the lower one in direction d), or none.
  std::size_t neighbour(std::size_t a, std::size_t face) const {
    Index3 ijk = grid_.span_index(trimming_.active[a]);
    const std::size_t d = face / 2;
    ijk[d] += face % 2 == 0 ? -1 : 1;
    if (ijk[d] < 0 || ijk[d] >= grid_.spans()[d]) return none;
    const std::int64_t number = grid_.span_number(ijk);
    const auto found = std::lower_bound(trimming_.active.begin(), trimming_.active.end(), number);
    if (found == trimming_.active.end() || *found != number) return none;
    return static_cast<std::size_t>(found - trimming_.active.begin());
  }

  /// A span that moves rigidly moves as its rigid neighbours do.
  void make_rigid(std::size_t a) {
    rigid_[a] = 1;
    for (std::size_t face = 0; face < 6; ++face)
      if (const std::size_t n = neighbour(a, face); n != none && is_rigid(n))
        join_sets(group_, static_cast<std::int32_t>(a), static_cast<std::int32_t>(n));
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
      const std::size_t n = neighbour(a, face);
      if (n == none || !is_rigid(n)) continue;
      Hold& hold = by_group[find_root(group_, static_cast<std::int32_t>(n))];
      int& side = hold.faces[face / 2];
      hold.clamped = hold.clamped || side != 0;
      hold.directions += side == 0;
      side = face % 2 == 0 ? -1 : 1;
    }
    Hold best;
    for (const auto& [group, hold] : by_group)
      if (hold.clamped || (!best.clamped && hold.directions > best.directions)) best = hold;
    return best;
  }

 private:
  const SplineGrid& grid_;
  const Trimming& trimming_;
  std::vector<std::uint8_t> rigid_;
  std::vector<std::int32_t> group_; // disjoint sets
};

/// What a thread needs to judge a span.
struct Judge {
  MomentFitter fitter;
  SpanPart part;
  KeptStiffness kept;
};

} // namespace

void TrimmedRules::secure(const QuadratureOptions& options) {
  Rigidity rigidity(*grid_, *trimming_);
  tbb::enumerable_thread_specific<Judge> judges([&] {
    return Judge{MomentFitter(*grid_, *trimming_, far_, options.moment_degree, options.tolerance),
                 SpanPart(*grid_, *trimming_, far_, options.moment_degree), KeptStiffness(*grid_)};
  });
  const auto keeps = [](Judge& judge, const Rigidity::Hold& hold, const SpanRule& rule, const SpanRule& full) {
    return judge.kept.keeps(judge.part.surface().box, hold.faces, {rule.points, rule.weights},
                            {full.points, full.weights});
  };
  const auto open_full = [&](Judge& judge, std::size_t a) {
    judge.part.open(touched_[a]);
    return resisting_rule(judge.part, judge.fitter.fit(touched_[a]), grid_->degree());
  };
  const auto resists = [&](std::size_t a, const Rigidity::Hold& hold) {
    if (hold.clamped) return true;
    const SpanRule own = rule(a);
    if (!reduced_ && own.shape == SpanShape::Free) return true; // the fitted rule
    Judge& judge = judges.local();
    const SpanRule full = open_full(judge, a);
    return keeps(judge, hold, own, full);
  };
  const auto stronger = [&](std::size_t a, const Rigidity::Hold& hold) {
    Judge& judge = judges.local();
    const SpanRule full = open_full(judge, a);
    for (SpanRule& product : stronger_products(judge.part, rule(a), grid_->degree()))
      if (keeps(judge, hold, product, full)) return product;
    return full;
  };

  std::vector<std::size_t> open; // trimmed spans not yet known to be rigid
  for (std::size_t a = 0; a < touched_.size(); ++a)
    if (!is_interior(*trimming_, a)) open.push_back(a);
  std::vector<HeldFaces> tried(touched_.size(), HeldFaces{});
  std::vector<std::pair<std::size_t, Rigidity::Hold>> secured; // with what held them then
  const auto still_open = [&] { std::erase_if(open, [&](std::size_t a) { return rigidity.is_rigid(a); }); };

  while (!open.empty()) {
    // A wave: all spans beside rigid ones that are held in a way they have not been judged in.
    std::vector<std::pair<std::size_t, Rigidity::Hold>> wave;
    for (const std::size_t a : open)
      if (const Rigidity::Hold hold = rigidity.held(a); hold.clamped || (hold.directions > 0 && hold.faces != tried[a]))
        wave.emplace_back(a, hold);
    std::vector<std::uint8_t> passes(wave.size());
    tbb::parallel_for(std::size_t{0}, wave.size(),
                      [&](std::size_t i) { passes[i] = resists(wave[i].first, wave[i].second); });
    bool any = false;
    for (std::size_t i = 0; i < wave.size(); ++i) {
      tried[wave[i].first] = wave[i].second.faces;
      if (passes[i]) rigidity.make_rigid(wave[i].first);
      any = any || passes[i];
    }
    still_open();
    if (any || open.empty()) continue;

    // No span passes any more. Among those that failed, the fullest of a neighbourhood gets a rule that resists: the
    // others may do with it beside them.
    const auto fuller = [&](std::size_t x, std::size_t y) {
      return trimming_->fraction[x] != trimming_->fraction[y] ? trimming_->fraction[x] > trimming_->fraction[y] : x < y;
    };
    std::vector<std::size_t> chosen;
    for (const std::size_t a : open) {
      if (tried[a] == HeldFaces{}) continue;
      bool fullest = true;
      for (std::size_t face = 0; face < 6; ++face) {
        const std::size_t n = rigidity.neighbour(a, face);
        fullest = fullest && (n == none || rigidity.is_rigid(n) || tried[n] == HeldFaces{} || fuller(a, n));
      }
      if (fullest) chosen.push_back(a);
    }
    for (const std::size_t a : chosen) secured.emplace_back(a, rigidity.held(a));
    for (const std::size_t a : chosen) rigidity.make_rigid(a);
    if (chosen.empty()) {
      // Parts without any rigid span: each begins with its fullest span.
      std::vector<std::int32_t> parts(touched_.size());
      std::iota(parts.begin(), parts.end(), 0);
      for (const std::size_t a : open)
        for (std::size_t face = 1; face < 6; face += 2)
          if (const std::size_t n = rigidity.neighbour(a, face); n != none)
            join_sets(parts, static_cast<std::int32_t>(a), static_cast<std::int32_t>(n));
      std::map<std::int32_t, std::size_t> first;
      for (const std::size_t a : open) {
        const auto [entry, added] = first.try_emplace(find_root(parts, static_cast<std::int32_t>(a)), a);
        if (!added && fuller(a, entry->second)) entry->second = a;
      }
      for (const auto& [part, a] : first) {
        if (!resists(a, {})) secured.emplace_back(a, Rigidity::Hold{});
        rigidity.make_rigid(a);
      }
    }
    still_open();
  }

  std::sort(secured.begin(), secured.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
  std::vector<std::pair<std::size_t, SpanRule>> rules(secured.size());
  tbb::parallel_for(std::size_t{0}, secured.size(), [&](std::size_t i) {
    rules[i] = {secured[i].first, stronger(secured[i].first, secured[i].second)};
  });
  replace(rules);
  counts_.secured_spans = static_cast<std::int64_t>(rules.size());
}

} // namespace iga::prep
