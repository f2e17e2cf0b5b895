#include "preprocessor/walls/narrow_gaps.hpp"

#include "format/model/disjoint_sets.hpp"
#include "format/model/vec3.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace iga::prep {

namespace {

// A gap this wide, relative to what no function reaches over, leaves its two sides a thin slice or a corner of a
// support.
constexpr double hardly = 0.75;
constexpr std::size_t most_tested = 300, batch = 64;

// Two places that see each other, one per span.
struct Candidate {
  std::size_t sample = 0;
  Chord chord;
  double reach = 0; // of functions; at 1 none reaches across
};

// Along the grid's axes: the distance of two parallel faces over the reach of a function, a block of (p + 1) units. A
// face whose normal is no axis is nearest at a corner of such a block.
double over_reach(const Point3& way, const std::array<int, 3>& p) {
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d) sum += std::abs(way[d]) * (p[d] + 1);
  return sum > 0 ? dot(way, way) / sum : 0;
}

std::vector<Candidate> find_candidates(const TrimmedModel& model, const TriangleTree& tree,
                                       const std::vector<SurfaceSample>& samples) {
  const auto p = model.grid.degree();
  std::vector<std::optional<Chord>> chords(samples.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples.size(), 64), [&](const auto& range) {
    for (std::size_t s = range.begin(); s != range.end(); ++s) {
      const Point3& n = samples[s].normal;
      const double reach = hardly / over_reach(in_spans(model.grid, n), p);
      chords[s] = first_chord(model.surface.mesh, tree, samples[s].x, times(n, reach), true);
    }
  });
  std::vector<Candidate> out;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (!chords[s]) continue;
    const Candidate one{s, *chords[s], over_reach(in_spans(model.grid, chords[s]->way), p)};
    if (!out.empty() && samples[out.back().sample].active == samples[s].active) {
      if (one.reach < out.back().reach) out.back() = one;
    } else {
      out.push_back(one);
    }
  }
  const auto order = [](const Candidate& c) { return std::pair(std::llround(c.reach * 1e9), c.sample); };
  std::sort(out.begin(), out.end(), [&](const Candidate& a, const Candidate& b) { return order(a) < order(b); });
  if (out.size() > most_tested) { // evenly, from the narrowest on
    for (std::size_t i = 0; i < most_tested; ++i) out[i] = out[i * out.size() / most_tested];
    out.resize(most_tested);
  }
  return out;
}

// The surface within the support-sized block around a place.
class SurfaceInBlock {
 public:
  SurfaceInBlock(const TrimmedModel& model, const TriangleTree& tree, const Point3& middle)
      : mesh_(model.surface.mesh), grid_(model.grid), middle_(middle) {
    const auto p = grid_.degree();
    for (std::size_t d = 0; d < 3; ++d) half_[d] = 0.5 * (p[d] + 1);
    tree.each_in_box(box(), [&](std::size_t t) { add(t); });
  }

  bool connects(std::size_t one, std::size_t other) {
    const auto a = number_.find(one), b = number_.find(other);
    return a != number_.end() && b != number_.end() && find_root(sets_, a->second) == find_root(sets_, b->second);
  }

 private:
  Box3 box() const {
    const Rotation& R = grid_.rotation();
    const Point3 h = grid_.span_size();
    Box3 out{middle_, middle_};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t d = 0; d < 3; ++d) {
        const double reach = std::abs(R[c][d]) * half_[d] * h[d];
        out.lower[c] -= reach;
        out.upper[c] += reach;
      }
    return out;
  }

  void add(std::size_t t) {
    const Triangle& corners = mesh_.triangles[t];
    std::array<Point3, 3> at; // spans from the middle
    for (std::size_t c = 0; c < 3; ++c)
      at[c] = in_spans(grid_, minus(mesh_.vertices[static_cast<std::size_t>(corners[c])], middle_));
    for (std::size_t d = 0; d < 3; ++d)
      if (std::min({at[0][d], at[1][d], at[2][d]}) > half_[d] || std::max({at[0][d], at[1][d], at[2][d]}) < -half_[d])
        return;
    const auto own = static_cast<std::int32_t>(sets_.size());
    number_.emplace(t, own);
    sets_.push_back(own);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t next = (c + 1) % 3;
      if (!meets_block(at[c], at[next])) continue;
      const auto [a, b] = std::minmax(corners[c], corners[next]);
      const auto key = (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint64_t>(b);
      const auto [edge, added] = edges_.try_emplace(key, own);
      if (!added) join_sets(sets_, edge->second, own);
    }
  }

  bool meets_block(const Point3& from, const Point3& to) const {
    double enter = 0, leave = 1;
    for (std::size_t d = 0; d < 3; ++d) {
      const double way = to[d] - from[d];
      if (way == 0) {
        if (std::abs(from[d]) > half_[d]) return false;
        continue;
      }
      const double one = (-half_[d] - from[d]) / way, other = (half_[d] - from[d]) / way;
      enter = std::max(enter, std::min(one, other));
      leave = std::min(leave, std::max(one, other));
    }
    return enter <= leave;
  }

  const TriangleMesh& mesh_;
  const SplineGrid& grid_;
  Point3 middle_, half_{};
  std::unordered_map<std::size_t, std::int32_t> number_; // triangle → set
  std::vector<std::int32_t> sets_;
  std::unordered_map<std::uint64_t, std::int32_t> edges_; // → the first triangle at it
};

} // namespace

std::optional<NarrowGap> find_narrow_gap(const TrimmedModel& model, const TriangleTree& tree,
                                         const std::vector<SurfaceSample>& samples) {
  const std::vector<Candidate> candidates = find_candidates(model, tree, samples);
  for (std::size_t first = 0; first < candidates.size(); first += batch) {
    const std::size_t last = std::min(first + batch, candidates.size());
    std::array<std::uint8_t, batch> is_gap{};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, last, 1), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Candidate& c = candidates[i];
        const SurfaceSample& s = samples[c.sample];
        SurfaceInBlock block(model, tree, plus(s.x, times(c.chord.way, 0.5)));
        is_gap[i - first] = !block.connects(s.triangle, c.chord.triangle);
      }
    });
    for (std::size_t i = first; i < last; ++i) {
      if (!is_gap[i - first]) continue;
      const Point3 way = candidates[i].chord.way;
      const double size = over_reach(model.grid.along_axes(way), model.grid.degree());
      return NarrowGap{norm(way), norm(in_spans(model.grid, way)), samples[candidates[i].sample].x, size,
                       model.quadrature.part_volume / std::pow(size, 3)};
    }
  }
  return std::nullopt;
}

} // namespace iga::prep
