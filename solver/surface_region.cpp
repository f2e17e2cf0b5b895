#include "solver/surface_region.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

namespace iga::solve {

namespace {

// How many regions a message lists before it says "…".
constexpr std::size_t listed_regions = 12;

std::vector<double> region_areas(const TrimmedModel& model) {
  const auto& q = model.surface.quadrature;
  std::vector<double> areas(model.surface.mesh.region_names.size(), 0);
  for (std::size_t i = 0; i < q.weights.size(); ++i) {
    const auto t = static_cast<std::size_t>(q.triangle[i]);
    areas[static_cast<std::size_t>(model.surface.mesh.region[t])] += q.weights[i];
  }
  return areas;
}

std::string regions_that_exist(const TrimmedModel& model) {
  const std::vector<double> areas = region_areas(model);
  std::vector<std::string> lines;
  for (std::size_t r = 0; r < areas.size() && r < listed_regions; ++r)
    lines.push_back(fmt::format("{} '{}' (area {:.6g})", r, model.surface.mesh.region_names[r], areas[r]));
  if (areas.size() > listed_regions) lines.push_back(fmt::format("… {} in all", areas.size()));
  const Box3 box = bounding_box(model.surface.mesh);
  return fmt::format("the surface lies between ({:.6g}) and ({:.6g}) and has the regions {}",
                     fmt::join(box.lower, ", "), fmt::join(box.upper, ", "), fmt::join(lines, ", "));
}

std::string describe(const RegionChoice& choice) {
  std::vector<std::string> tests;
  if (choice.name) tests.push_back(fmt::format("region '{}'", *choice.name));
  if (choice.number) tests.push_back(fmt::format("region number {}", *choice.number));
  if (choice.box)
    tests.push_back(
        fmt::format("box ({:.6g}) … ({:.6g})", fmt::join(choice.box->lower, ", "), fmt::join(choice.box->upper, ", ")));
  if (choice.plane)
    tests.push_back(fmt::format("plane through ({:.6g}) with normal ({:.6g}), tolerance {:.3g}",
                                fmt::join(choice.plane->point, ", "), fmt::join(choice.plane->normal, ", "),
                                choice.plane->tolerance));
  if (choice.normal)
    tests.push_back(fmt::format("normals within {:.3g} degrees of ({:.6g})", choice.normal->angle,
                                fmt::join(choice.normal->direction, ", ")));
  return tests.empty() ? "the whole surface" : fmt::format("{}", fmt::join(tests, " and "));
}

Point3 unit(const Point3& v, const std::string& what, const char* which) {
  const double length = norm(v);
  if (!(length > 0))
    throw InputError(fmt::format("{}: the {} has no length; give a vector other than zero", what, which));
  return times(v, 1 / length);
}

/// A choice made ready for testing many points.
class Tests {
 public:
  Tests(const TrimmedModel& model, const RegionChoice& choice, const std::string& what)
      : model_(model), choice_(choice), number_(-1), depth_(surface_depth(model)) {
    const auto& names = model.surface.mesh.region_names;
    if (choice.number) {
      if (*choice.number < 0 || *choice.number >= static_cast<std::int64_t>(names.size()))
        throw InputError(
            fmt::format("{}: there is no region number {}; {}", what, *choice.number, regions_that_exist(model)));
      number_ = *choice.number;
    }
    if (choice.name) {
      const auto found = std::find(names.begin(), names.end(), *choice.name);
      if (found == names.end()) {
        const auto near = io::nearest_name(*choice.name, names);
        throw InputError(fmt::format("{}: there is no region '{}'{}; {}", what, *choice.name,
                                     near ? fmt::format(", did you mean '{}'?", *near) : "",
                                     regions_that_exist(model)));
      }
      named_ = true; // a name may stand for several regions
    }
    if (choice.plane) {
      plane_normal_ = unit(choice.plane->normal, what, "plane's normal");
      plane_depth_ = std::max(choice.plane->tolerance, depth_);
    }
    if (choice.normal) {
      direction_ = unit(choice.normal->direction, what, "direction of the normal");
      least_cosine_ = std::cos(choice.normal->angle * std::numbers::pi / 180);
    }
  }

  bool hold(std::size_t i) const {
    const auto& q = model_.surface.quadrature;
    const auto r = model_.surface.mesh.region[static_cast<std::size_t>(q.triangle[i])];
    if (number_ >= 0 && r != number_) return false;
    if (named_ && model_.surface.mesh.region_names[static_cast<std::size_t>(r)] != *choice_.name) return false;
    const Point3 n{q.normals[3 * i], q.normals[3 * i + 1], q.normals[3 * i + 2]};
    if (choice_.normal && dot(n, direction_) < least_cosine_ - rounding) return false;
    if (!choice_.box && !choice_.plane) return true;
    const Point3 x = model_.grid.to_position({q.parameters[3 * i], q.parameters[3 * i + 1], q.parameters[3 * i + 2]});
    if (choice_.plane && std::abs(dot(minus(x, choice_.plane->point), plane_normal_)) > plane_depth_) return false;
    if (choice_.box)
      for (std::size_t d = 0; d < 3; ++d)
        if (x[d] < choice_.box->lower[d] - depth_ || x[d] > choice_.box->upper[d] + depth_) return false;
    return true;
  }

 private:
  // Cosines of parallel unit vectors miss 1 by rounding.
  static constexpr double rounding = 1e-12;
  const TrimmedModel& model_;
  const RegionChoice& choice_;
  std::int64_t number_;
  bool named_ = false;
  Point3 plane_normal_{}, direction_{};
  double depth_, plane_depth_ = 0, least_cosine_ = -1;
};

} // namespace

SurfaceRegion choose_region(const TrimmedModel& model, const RegionChoice& choice, const std::string& what) {
  const Tests tests(model, choice, what);
  const auto& q = model.surface.quadrature;
  SurfaceRegion region;
  region.offsets = {0};
  Point3 first{};
  for (std::size_t a = 0; a < model.active.size(); ++a) {
    const std::size_t before = region.points.size();
    for (std::int64_t i = q.offsets[a]; i < q.offsets[a + 1]; ++i) {
      const auto s = static_cast<std::size_t>(i);
      if (!tests.hold(s)) continue;
      region.points.push_back(i);
      region.report.area += q.weights[s];
      for (std::size_t d = 0; d < 3; ++d) first[d] += q.weights[s] * (q.parameters[3 * s + d] - model.grid.A()[d]);
    }
    if (region.points.size() == before) continue;
    region.spans.push_back(static_cast<std::int64_t>(a));
    region.offsets.push_back(static_cast<std::int64_t>(region.points.size()));
  }
  if (!(region.report.area > 0))
    throw InputError(fmt::format("{}: no part of the surface meets its choice ({}); {}", what, describe(choice),
                                 regions_that_exist(model)));
  region.report.points = static_cast<std::int64_t>(region.points.size());
  region.report.centroid = model.grid.to_position(plus(model.grid.A(), times(first, 1 / region.report.area)));
  return region;
}

PointBatch gather(const TrimmedModel& model, const SurfaceRegion& region, std::size_t s) {
  const auto& q = model.surface.quadrature;
  PointBatch batch;
  batch.span = region.spans[s];
  for (const std::int64_t point : region.points_of(s)) {
    const auto i = static_cast<std::size_t>(point);
    const Point3 u{q.parameters[3 * i], q.parameters[3 * i + 1], q.parameters[3 * i + 2]};
    batch.parameters.insert(batch.parameters.end(), u.begin(), u.end());
    batch.weights.push_back(q.weights[i]);
    batch.normals.push_back({q.normals[3 * i], q.normals[3 * i + 1], q.normals[3 * i + 2]});
    batch.positions.push_back(model.grid.to_position(u));
  }
  return batch;
}

} // namespace iga::solve
