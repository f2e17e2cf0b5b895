// Where two surfaces lie on each other: a common refinement of their triangles and of both bodies' spans.
#include "format/model/errors.hpp"
#include "format/model/triangle_rule.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/bvh.hpp"
#include "solver/base/closest_point.hpp"
#include "solver/space/convex_clip.hpp"
#include "solver/space/surface_cut.hpp"
#include "solver/supports/body_choice.hpp"
#include "solver/ties/tie.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>

namespace iga::solve {

namespace {

// Surfaces face each other where the cosine between one normal and the other's opposite is at least this.
constexpr double facing = 0.5;
// Pieces smaller than this share of the polygons that they were cut from are rounding.
constexpr double negligible_share = 1e-10;
// Area that comes up more than once beyond this share is no rounding.
constexpr double double_share = 1e-6;

double area_of(const ConvexPolygon& polygon) {
  return norm(area_vector(polygon));
}

double smallest_span(const TrimmedModel& model) {
  const Point3 h = model.grid.span_size();
  return *std::min_element(h.begin(), h.end());
}

/// One side's surface, ready to be searched.
struct Side {
  Side(const TrimmedModel& of, const RegionChoice& choice, const std::string& what)
      : model(of), polygons(choose_polygons(of, choice, what)), cells(of) {
    std::vector<Box3> boxes;
    for (const ChosenPolygon& polygon : polygons) {
      boxes.push_back(bounding_box(polygon.corners));
      areas.push_back(area_of(polygon.corners));
      area += areas.back();
    }
    tree = Bvh(boxes);
  }
  double distance2(const Point3& x) const {
    return tree.least_distance2(x, [&](std::int32_t item) {
      const auto& corners = polygons[static_cast<std::size_t>(item)].corners;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t a = 1; a + 1 < corners.size(); ++a)
        least = std::min(least, closest_on_triangle(x, corners[0], corners[a], corners[a + 1]).distance2);
      return least;
    });
  }

  const TrimmedModel& model;
  std::vector<ChosenPolygon> polygons;
  std::vector<double> areas; ///< of the polygons
  SurfaceCells cells;
  Bvh tree;
  double area = 0;
};

// From corners to the other surface, both ways: exact where the nearest places are not inside two edges.
double smallest_distance(const Side& a, const Side& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (const ChosenPolygon& polygon : from->polygons)
      for (const Point3& x : polygon.corners) least = std::min(least, to->distance2(x));
  return std::sqrt(least);
}

/// Finds the tied surface of one pair of bodies.
class Matcher {
 public:
  Matcher(const Side& a, const Side& b, double tolerance) : sides_{&a, &b}, tolerance_(tolerance) {
    int degree = 0;
    for (const Side* side : sides_)
      for (const int p : side->model.grid.degree()) degree = std::max(degree, p);
    rule_ = triangle_rule(3 * degree);
  }

  void run(const std::string& what) {
    const Side &a = *sides_[0], &b = *sides_[1];
    for (std::size_t i = 0; i < a.polygons.size(); ++i) {
      const double before = area_;
      std::vector<std::size_t> near;
      b.tree.each_overlap(grown(bounding_box(a.polygons[i].corners), tolerance_),
                          [&](std::int32_t item) { near.push_back(static_cast<std::size_t>(item)); });
      std::sort(near.begin(), near.end());
      for (const std::size_t j : near) match(i, j);
      if (area_ - before > (1 + double_share) * a.areas[i])
        throw InputError(fmt::format(
            "{}: within the tolerance of {:.4g} the surface near ({:.6g}, {:.6g}, {:.6g}) lies "
            "on several layers of the other body; choose a smaller tolerance, or the surface "
            "of either body",
            what, tolerance_, a.polygons[i].corners[0][0], a.polygons[i].corners[0][1], a.polygons[i].corners[0][2]));
    }
  }

  double area() const { return area_; }
  double largest_gap() const { return largest_gap_; }
  std::size_t points_per_triangle() const { return rule_.size(); }
  std::int64_t num_points() const { return static_cast<std::int64_t>(points_.size()); }
  std::vector<TiePair> pairs();

 private:
  struct Point {
    std::array<std::int64_t, 2> cell{};
    Point3 position{}, normal{};
    double weight = 0;
  };

  void match(std::size_t i, std::size_t j) {
    const ChosenPolygon &a = sides_[0]->polygons[i], &b = sides_[1]->polygons[j];
    const double cosine = -dot(a.normal, b.normal);
    if (cosine < facing) return;
    // From a place on a along its normal to the plane of b.
    const auto gap = [&](const Point3& x) { return -dot(b.normal, minus(b.corners[0], x)) / cosine; };
    ConvexPolygon piece = clip_convex(a.corners, [&](const Point3& x) { return gap(x) - tolerance_; });
    piece = clip_convex(piece, [&](const Point3& x) { return -gap(x) - tolerance_; });
    for (std::size_t k = 0; k < b.corners.size() && piece.size() >= 3; ++k) {
      const Point3 &p = b.corners[k], &q = b.corners[(k + 1) % b.corners.size()];
      const Point3 outward = cross(a.normal, minus(q, p)); // seen along a's normal b runs clockwise
      if (!(norm(outward) > 0)) continue;
      const Point3 unit = times(outward, 1 / norm(outward));
      piece = clip_convex(piece, [&](const Point3& x) { return dot(unit, minus(x, p)); });
    }
    if (piece.size() < 3) return;
    if (!(area_of(piece) > negligible_share * std::min(sides_[0]->areas[i], sides_[1]->areas[j]))) return;
    for (const Point3& x : piece) largest_gap_ = std::max(largest_gap_, std::abs(gap(x)));
    for_span_pieces(sides_[1]->model.grid, piece, [&](const ConvexPolygon& part) {
      for_span_pieces(sides_[0]->model.grid, part, [&](const ConvexPolygon& both) { add_points(a, b, both, gap); });
    });
  }

  template <class Gap>
  void add_points(const ChosenPolygon& a, const ChosenPolygon& b, const ConvexPolygon& piece, const Gap& gap) {
    Point3 middle{};
    for (const Point3& x : piece) middle = plus(middle, times(x, 1.0 / static_cast<double>(piece.size())));
    const Point3 opposite = plus(middle, times(a.normal, gap(middle)));
    const auto cell = [&](std::size_t s, const ChosenPolygon& polygon, const Point3& x) {
      return sides_[s]->cells.find(polygon.triangle, sides_[s]->model.grid.to_parameter(x)).cell;
    };
    Point point{{cell(0, a, middle), cell(1, b, opposite)}, {}, a.normal, 0};
    for (std::size_t k = 1; k + 1 < piece.size(); ++k) {
      const std::array<Point3, 3> corner{piece[0], piece[k], piece[k + 1]};
      const double area = 0.5 * norm(cross(minus(corner[1], corner[0]), minus(corner[2], corner[0])));
      if (!(area > 0)) continue;
      area_ += area;
      for (const TrianglePoint& q : rule_) {
        point.position = {};
        for (std::size_t c = 0; c < 3; ++c) point.position = plus(point.position, times(corner[c], q.barycentric[c]));
        point.weight = area * q.weight;
        points_.push_back(point);
      }
    }
  }

  std::array<const Side*, 2> sides_;
  double tolerance_;
  std::span<const TrianglePoint> rule_;
  std::vector<Point> points_;
  double area_ = 0, largest_gap_ = 0;
};

std::vector<TiePair> Matcher::pairs() {
  std::stable_sort(points_.begin(), points_.end(), [](const Point& x, const Point& y) { return x.cell < y.cell; });
  std::vector<TiePair> pairs;
  for (const Point& point : points_) {
    if (pairs.empty() || pairs.back().cell != point.cell) pairs.emplace_back().cell = point.cell;
    TiePair& pair = pairs.back();
    for (std::size_t s = 0; s < 2; ++s) {
      const Point3 u = sides_[s]->model.grid.to_parameter(point.position);
      pair.parameters[s].insert(pair.parameters[s].end(), u.begin(), u.end());
    }
    pair.weights.push_back(point.weight);
    pair.normals.push_back(point.normal);
  }
  return pairs;
}

/// A pair of bodies that a tie asks for, the lower number first.
struct Candidate {
  std::array<std::size_t, 2> body{};
  std::array<const RegionChoice*, 2> choice{};
};

std::vector<Candidate> candidates(const BodySystem& system, const Tie& tie, const std::string& what) {
  std::vector<Candidate> all;
  if (!tie.bodies) { // whole surfaces
    for (std::size_t a = 0; a < system.size(); ++a)
      for (std::size_t b = a + 1; b < system.size(); ++b) all.push_back({{a, b}, {&tie.choice[0], &tie.choice[0]}});
    return all;
  }
  Candidate one;
  for (std::size_t s = 0; s < 2; ++s) {
    one.body[s] = body_by_name(system, (*tie.bodies)[s], what);
    one.choice[s] = &tie.choice[s];
  }
  if (one.body[0] == one.body[1])
    throw InputError(fmt::format("{}: both bodies are '{}'; a tie joins two bodies", what, (*tie.bodies)[0]));
  if (one.body[0] > one.body[1]) {
    std::swap(one.body[0], one.body[1]);
    std::swap(one.choice[0], one.choice[1]);
  }
  return {one};
}

/// Finds the surfaces of one tie.
class TieFinder {
 public:
  TieFinder(const BodySystem& system, const Tie& tie)
      : system_(system), tie_(tie),
        what_(fmt::format("{}{}tie '{}'", tie.where, tie.where.empty() ? "" : ": ", tie.name)),
        candidates_(candidates(system, tie, what_)) {}

  void run(std::vector<TieSurface>& found) {
    const std::size_t before = found.size();
    for (const Candidate& candidate : candidates_) {
      const double tolerance = tolerance_of(candidate);
      Matcher matcher(side(candidate, 0), side(candidate, 1), tolerance);
      matcher.run(what_);
      if (!(matcher.area() > 0)) continue;
      need_short_continuation(candidate, tolerance);
      found.push_back({tie_, candidate.body, matcher.pairs(), matcher.points_per_triangle(),
                       report_of(candidate, matcher, tolerance)});
    }
    if (found.size() == before) refuse_nothing();
  }

 private:
  const Side& side(const Candidate& candidate, std::size_t s) {
    const std::size_t body = candidate.body[s];
    auto& known = sides_[{body, candidate.choice[s]}];
    if (!known)
      known = std::make_unique<Side>(system_[body].space->model(), *candidate.choice[s],
                                     fmt::format("{}, body '{}'", what_, system_[body].name));
    return *known;
  }
  double smallest_span_of(const Candidate& candidate) const {
    const auto h = [&](std::size_t s) { return smallest_span(system_[candidate.body[s]].space->model()); };
    return std::min(h(0), h(1));
  }
  double tolerance_of(const Candidate& candidate) const {
    return tie_.tolerance.value_or(tie_tolerance * smallest_span_of(candidate));
  }
  void need_short_continuation(const Candidate& candidate, double tolerance) const {
    const double most = most_tie_tolerance * smallest_span_of(candidate);
    if (tolerance > most)
      throw InputError(
          fmt::format("{}: the tolerance is {:.4g}, expected at most {:.4g}, half the smallest span of '{}' and "
                      "'{}': functions are continued across the gap; bring the surfaces together",
                      what_, tolerance, most, system_[candidate.body[0]].name, system_[candidate.body[1]].name));
  }
  TieReport report_of(const Candidate& candidate, const Matcher& matcher, double tolerance) {
    TieReport report;
    report.name = tie_.name;
    for (std::size_t s = 0; s < 2; ++s) {
      report.bodies[s] = system_[candidate.body[s]].name;
      report.chosen[s] = side(candidate, s).area;
    }
    report.area = matcher.area();
    report.largest_gap = matcher.largest_gap();
    report.tolerance = tolerance;
    report.points = matcher.num_points();
    return report;
  }
  [[noreturn]] void refuse_nothing() {
    double nearest = std::numeric_limits<double>::infinity(), tolerance = 0;
    for (const Candidate& candidate : candidates_) {
      nearest = std::min(nearest, smallest_distance(side(candidate, 0), side(candidate, 1)));
      tolerance = std::max(tolerance, tolerance_of(candidate));
    }
    const std::string who = tie_.bodies          ? fmt::format("'{}' and '{}'", (*tie_.bodies)[0], (*tie_.bodies)[1])
                            : system_.size() > 1 ? "different bodies"
                                                 : "different bodies (there is one body)";
    throw InputError(
        fmt::format("{}: nothing is tied: no surfaces of {} face each other within the tolerance of {:.4g}; the "
                    "smallest distance found is {:.4g}; choose other surfaces, move the bodies "
                    "([bodies.place]), or raise 'tolerance'",
                    what_, who, tolerance, nearest));
  }

  const BodySystem& system_;
  const Tie& tie_;
  std::string what_;
  std::vector<Candidate> candidates_;
  std::map<std::pair<std::size_t, const RegionChoice*>, std::unique_ptr<Side>> sides_; // by body and choice
};

} // namespace

std::vector<TieSurface> find_ties(const BodySystem& system, std::span<const Tie> ties) {
  std::vector<TieSurface> found;
  for (const Tie& tie : ties) TieFinder(system, tie).run(found);
  return found;
}

} // namespace iga::solve
