// Named curves and points: whatever supports and loads may be told to act on by name.
#include "format/model/model_check.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <set>
#include <string_view>

namespace iga {

double polyline_length(std::span<const Point3> points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += norm(minus(points[i], points[i - 1]));
  return length;
}

namespace detail {

namespace {

void check_names(const std::vector<std::string>& names, ProblemKind& kind) {
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) kind.add("name {} is empty", i);
    if (!names[i].empty() && !seen.insert(names[i]).second) kind.add("the name '{}' stands there twice", names[i]);
  }
}

void check_finite(const std::vector<Point3>& points, ProblemKind& kind) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::ranges::all_of(points[i], [](double x) { return std::isfinite(x); }))
      kind.add("point {} is ({}, {}, {}), expected finite numbers", i, points[i][0], points[i][1], points[i][2]);
}

} // namespace

void check_places(const TrimmedModel& m, int limit, std::vector<std::string>& problems) {
  ProblemKind curves(problems, limit, "curves"), markers(problems, limit, "markers");
  check_names(m.curves.names, curves);
  check_finite(m.curves.points, curves);
  check_names(m.markers.names, markers);
  check_finite(m.markers.positions, markers);
  if (m.markers.positions.size() != m.markers.names.size())
    markers.add("{} positions for {} names", m.markers.positions.size(), m.markers.names.size());
  if (m.curves.offsets.empty() && m.curves.names.empty() && m.curves.points.empty()) return;
  if (m.curves.offsets.size() != m.curves.names.size() + 1) {
    curves.add("{} offsets for {} names, expected one more", m.curves.offsets.size(), m.curves.names.size());
    return;
  }
  check_offsets(m.curves.offsets, m.curves.points.size(), curves);
  if (!curves.empty()) return;
  for (std::size_t c = 0; c < m.curves.size(); ++c) {
    const auto points = m.curves.points_of(c);
    if (points.size() < 2) curves.add("'{}' has {} points, expected two or more", m.curves.names[c], points.size());
    // Far from the origin neighbours may coincide; a whole curve of no length is no curve.
    if (points.size() >= 2 && !(polyline_length(points) > 0)) curves.add("'{}' has no length", m.curves.names[c]);
  }
}

} // namespace detail

} // namespace iga
