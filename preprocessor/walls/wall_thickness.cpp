#include "preprocessor/walls/wall_thickness.hpp"

#include "format/model/model_check.hpp"
#include "format/model/vec3.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iga::prep {

namespace {

constexpr double enough = 0.95;                      // of spans_across_wall: see the header
constexpr double opposite = std::numbers::sqrt3 / 2; // cosine of 30 degrees
constexpr std::size_t volume_samples = 2000;
constexpr double rounding = 1e-9; // among walls of one thickness the first is told

// A wall as one place of the surface sees it.
struct Thickness {
  std::size_t sample = 0;
  double spans = 0, length = 0;
  double taper = 0; // radians
};

// Measures walls that are thinner than `limit` spans.
class WallRuler {
 public:
  WallRuler(const TrimmedModel& model, const TriangleTree& tree, double limit)
      : model_(model), tree_(tree), limit_(limit) {}

  /// @param depth  way from x to the surface that has been covered before, along -direction
  std::optional<Chord> measure(const Point3& x, const Point3& direction, double depth = 0) const {
    const double reach = limit_ / norm(in_spans(model_.grid, direction)) - depth;
    if (!(reach > 0)) return std::nullopt;
    const auto chord = first_chord(model_.surface.mesh, tree_, x, times(direction, reach), false);
    return chord && chord->facing > opposite ? chord : std::nullopt;
  }

  bool is_thin_around(const Point3& x) const {
    const Point3 h = model_.grid.span_size();
    const auto near = tree_.nearest(x, limit_ * std::max({h[0], h[1], h[2]}));
    if (!near) return false;
    const double depth = norm(near->way);
    // On the surface itself the way there has no direction.
    constexpr double on_surface = 1e-6;
    const Point3 out =
        depth > on_surface * std::min({h[0], h[1], h[2]}) ? times(near->way, 1 / depth) : normal_of(near->triangle);
    return measure(x, times(out, -1), depth).has_value();
  }

 private:
  Point3 normal_of(std::size_t t) const {
    const TriangleMesh& mesh = model_.surface.mesh;
    const auto corner = [&](std::size_t a) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][a])]; };
    const Point3 n = twice_area(corner(0), corner(1), corner(2));
    return times(n, 1 / norm(n));
  }

  const TrimmedModel& model_;
  const TriangleTree& tree_;
  double limit_;
};

std::vector<Thickness> measure_walls(const TrimmedModel& model, const WallRuler& ruler,
                                     const std::vector<SurfaceSample>& samples) {
  std::vector<std::optional<Chord>> chords(samples.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples.size(), 64), [&](const auto& range) {
    for (std::size_t s = range.begin(); s != range.end(); ++s)
      chords[s] = ruler.measure(samples[s].x, times(samples[s].normal, -1));
  });
  std::vector<Thickness> out;
  for (std::size_t s = 0; s < samples.size(); ++s)
    if (chords[s])
      out.push_back({s, norm(in_spans(model.grid, chords[s]->way)), norm(chords[s]->way),
                     std::acos(std::min(chords[s]->facing, 1.0))});
  return out;
}

// The wall of the block of spans around each span; the thinnest of all.
std::optional<ThinWall> thinnest_block(const TrimmedModel& model, const std::vector<SurfaceSample>& samples,
                                       const std::vector<Thickness>& walls) {
  std::vector<std::size_t> first(model.cells.span.size() + 1, 0); // samples, and so walls, come span by span
  for (const Thickness& w : walls) ++first[samples[w.sample].active + 1];
  for (std::size_t a = 0; a + 1 < first.size(); ++a) first[a + 1] += first[a];
  const Index3 n = model.grid.spans();
  std::optional<ThinWall> thinnest;
  std::vector<Thickness> block;
  for (std::size_t a = 0; a + 1 < first.size(); ++a) {
    if (first[a] == first[a + 1]) continue;
    const Index3 middle = model.grid.span_index(model.cells.span[a]);
    block.clear();
    double area = 0;
    for (std::int64_t k = std::max<std::int64_t>(middle[2] - 1, 0); k <= std::min(middle[2] + 1, n[2] - 1); ++k)
      for (std::int64_t j = std::max<std::int64_t>(middle[1] - 1, 0); j <= std::min(middle[1] + 1, n[1] - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(middle[0] - 1, 0); i <= std::min(middle[0] + 1, n[0] - 1); ++i) {
          const auto [begin, end] = model.cells_of(model.grid.span_number({i, j, k}));
          for (std::size_t w = first[begin]; w < first[end]; ++w) {
            block.push_back(walls[w]);
            area += samples[walls[w].sample].area;
          }
        }
    std::sort(block.begin(), block.end(), [](const Thickness& one, const Thickness& other) {
      return one.spans != other.spans ? one.spans < other.spans : one.sample < other.sample;
    });
    double passed = 0, taper = 0;
    for (const Thickness& w : block) {
      passed += samples[w.sample].area;
      taper += samples[w.sample].area * w.taper;
      if (passed < 0.25 * area) continue;
      if (!thinnest || w.spans < (1 - rounding) * thinnest->spans)
        thinnest = ThinWall{w.length,
                            w.spans,
                            samples[w.sample].x,
                            taper / passed * 180 / std::numbers::pi,
                            w.length / spans_across_wall(model.grid),
                            0};
      break;
    }
  }
  return thinnest;
}

double thin_share(const TrimmedModel& model, const WallRuler& ruler) {
  const auto& weights = model.points.weights;
  const auto& u = model.points.parameters;
  double volume = 0;
  for (const double w : weights) volume += w;
  // Each chosen point stands for the same volume.
  const std::size_t count = std::min(weights.size(), volume_samples);
  const double share = volume / static_cast<double>(count);
  std::vector<Point3> places;
  double passed = 0, next = 0.5 * share;
  for (std::size_t q = 0; q < weights.size(); ++q) {
    passed += weights[q];
    for (; next < passed; next += share)
      places.push_back(model.grid.to_position({u[3 * q], u[3 * q + 1], u[3 * q + 2]}));
  }
  std::vector<std::uint8_t> thin(places.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, places.size(), 64), [&](const auto& range) {
    for (std::size_t q = range.begin(); q != range.end(); ++q) thin[q] = ruler.is_thin_around(places[q]);
  });
  return static_cast<double>(std::count(thin.begin(), thin.end(), 1)) / static_cast<double>(places.size());
}

} // namespace

double spans_across_wall(const SplineGrid& grid) {
  constexpr int functions = 4;
  const auto p = grid.degree();
  return std::max(functions - *std::min_element(p.begin(), p.end()), 1);
}

ThinWalls find_thin_walls(const TrimmedModel& model, const TriangleTree& tree,
                          const std::vector<SurfaceSample>& samples) {
  const WallRuler ruler(model, tree, enough * spans_across_wall(model.grid));
  ThinWalls out;
  out.thinnest = thinnest_block(model, samples, measure_walls(model, ruler, samples));
  if (!out.thinnest) return out;
  out.thinnest->num_spans = model.quadrature.part_volume / std::pow(out.thinnest->span_size, 3);
  out.volume_share = thin_share(model, ruler);
  return out;
}

} // namespace iga::prep
