#include "solver/space/surface_region.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/surface_cut.hpp"
#include "solver/space/surface_patch.hpp"

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
  std::vector<std::string> regions;
  for (const std::string& name : choice.names) regions.push_back(fmt::format("'{}'", name));
  for (const std::int64_t number : choice.numbers) regions.push_back(fmt::format("number {}", number));
  if (!regions.empty()) tests.push_back(fmt::format("region {}", fmt::join(regions, " or ")));
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
  if (choice.patch) tests.push_back(fmt::format("patch {}", choice.patch->file.string()));
  return tests.empty() ? "the whole surface" : fmt::format("{}", fmt::join(tests, " and "));
}

Point3 unit(const Point3& v, const std::string& what, const char* which) {
  const double length = norm(v);
  if (!(length > 0))
    throw InputError(fmt::format("{}: the {} has no length; give a vector other than zero", what, which));
  return times(v, 1 / length);
}

/// A choice made ready for testing many triangles.
class Chooser {
 public:
  Chooser(const TrimmedModel& model, const RegionChoice& choice, const std::string& what)
      : model_(model), snap_(surface_depth(model)) {
    choose_regions(choice, what);
    if (choice.normal) {
      direction_ = unit(choice.normal->direction, what, "direction of the normal");
      least_cosine_ = std::cos(choice.normal->angle * std::numbers::pi / 180);
    }
    if (choice.plane) {
      const Point3 n = unit(choice.plane->normal, what, "plane's normal");
      for (const double side : {1.0, -1.0})
        half_spaces_.push_back({times(n, side), choice.plane->point, choice.plane->tolerance});
    }
    if (choice.box)
      for (std::size_t d = 0; d < 3; ++d) {
        Point3 axis{};
        axis[d] = 1;
        half_spaces_.push_back({axis, choice.box->upper, 0});
        half_spaces_.push_back({times(axis, -1), choice.box->lower, 0});
      }
  }

  CutTriangle choose(std::size_t triangle, const Point3& normal) const {
    if (!regions_.empty() && !regions_[static_cast<std::size_t>(model_.surface.mesh.region[triangle])]) return {};
    if (least_cosine_ > -1 && dot(normal, direction_) < least_cosine_ - rounding) return {};
    return cut_triangle(model_.surface.mesh, triangle, half_spaces_, snap_);
  }

 private:
  // Cosines of parallel unit vectors miss 1 by rounding.
  static constexpr double rounding = 1e-12;

  void choose_regions(const RegionChoice& choice, const std::string& what) {
    const auto& names = model_.surface.mesh.region_names;
    if (choice.names.empty() && choice.numbers.empty()) return;
    regions_.resize(names.size());
    for (const std::int64_t number : choice.numbers) {
      if (number < 0 || number >= static_cast<std::int64_t>(names.size()))
        throw InputError(fmt::format("{}: there is no region number {}; {}", what, number, regions_that_exist(model_)));
      regions_[static_cast<std::size_t>(number)] = true;
    }
    for (const std::string& name : choice.names) {
      bool found = false; // a name may stand for several regions
      for (std::size_t r = 0; r < names.size(); ++r)
        if (names[r] == name) found = regions_[r] = true;
      if (found) continue;
      const auto near = io::nearest_name(name, names);
      throw InputError(fmt::format("{}: there is no region '{}'{}; {}", what, name,
                                   near ? fmt::format(", did you mean '{}'?", *near) : "", regions_that_exist(model_)));
    }
  }

  const TrimmedModel& model_;
  double snap_;               // length
  std::vector<bool> regions_; // of the model, those chosen; empty: all
  std::vector<HalfSpace> half_spaces_;
  Point3 direction_{};
  double least_cosine_ = -1;
};

Point3 normal_of(const TriangleMesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const auto corner = [&](std::size_t a) { return mesh.vertices[static_cast<std::size_t>(t[a])]; };
  const Point3 n = twice_area(corner(0), corner(1), corner(2));
  const double length = norm(n);
  return length > 0 ? times(n, 1 / length) : n;
}

bool is_all(const std::vector<ConvexPolygon>& parts, const ConvexPolygon& polygon) {
  constexpr double sums = 1e-9; // rounding of the cuts
  double area = 0;
  for (const ConvexPolygon& part : parts) area += polygon_area(part);
  return area >= (1 - sums) * polygon_area(polygon);
}

// What a patch, where there is one, leaves of a triangle.
std::vector<ConvexPolygon> chosen_parts(const std::optional<SurfacePatch>& patch, const CutTriangle& cut,
                                        const Point3& normal) {
  return patch ? patch->part_of(cut.polygon, normal) : std::vector<ConvexPolygon>{cut.polygon};
}

[[noreturn]] void refuse_empty(const TrimmedModel& model, const RegionChoice& choice,
                               const std::optional<SurfacePatch>& patch, const std::string& what) {
  throw InputError(fmt::format("{}: no part of the surface meets its choice ({}){}; {}", what, describe(choice),
                               patch ? "; " + patch->how_near() : "", regions_that_exist(model)));
}

// Appends a point to the cell that is being filled.
void add_point(SurfaceRegion& region, const Point3& u, double weight, const Point3& normal, const Point3& origin,
               Point3& first_moment) {
  region.parameters.insert(region.parameters.end(), u.begin(), u.end());
  region.weights.push_back(weight);
  region.normals.push_back(normal);
  region.report.area += weight;
  first_moment = plus(first_moment, times(minus(u, origin), weight));
}

} // namespace

SurfaceRegion choose_region(const TrimmedModel& model, const RegionChoice& choice, const std::string& what) {
  const Chooser chooser(model, choice, what);
  const auto& q = model.surface.quadrature;
  const TriangleMesh& mesh = model.surface.mesh;
  const SurfaceCells surface(model);
  std::vector<bool> whole(mesh.triangles.size());
  struct CutPoint {
    SurfacePoint point;
    Point3 normal;
  };
  std::vector<CutPoint> cut_points;
  std::vector<SurfacePoint> added;
  std::optional<SurfacePatch> patch;
  if (choice.patch) patch.emplace(model, *choice.patch, what);
  SurfaceRegion region;
  const bool is_exact = model.quadrature.surface_rule == "exact"; // else every triangle gets points of its own
  for (std::size_t t = 0; t < whole.size(); ++t) {
    const Point3 normal = normal_of(mesh, t);
    const CutTriangle cut = chooser.choose(t, normal);
    if (cut.part == CutTriangle::Part::None) continue;
    const auto parts = chosen_parts(patch, cut, normal);
    if (parts.empty()) continue;
    region.triangles.push_back(static_cast<std::int64_t>(t));
    whole[t] = is_exact && cut.part == CutTriangle::Part::Whole && (!patch || is_all(parts, cut.polygon));
    if (whole[t]) continue;
    added.clear();
    for (const ConvexPolygon& part : parts) add_polygon_points(model, surface, t, part, added);
    for (const SurfacePoint& point : added) cut_points.push_back({point, normal});
  }
  std::stable_sort(cut_points.begin(), cut_points.end(),
                   [](const CutPoint& a, const CutPoint& b) { return a.point.cell < b.point.cell; });

  region.offsets = {0};
  Point3 first{};
  auto next = cut_points.begin();
  for (std::size_t a = 0; a < model.cells.span.size(); ++a) {
    const std::size_t before = region.weights.size();
    for (auto s = static_cast<std::size_t>(q.offsets[a]); s < static_cast<std::size_t>(q.offsets[a + 1]); ++s)
      if (whole[static_cast<std::size_t>(q.triangle[s])])
        add_point(region, {q.parameters[3 * s], q.parameters[3 * s + 1], q.parameters[3 * s + 2]}, q.weights[s],
                  {q.normals[3 * s], q.normals[3 * s + 1], q.normals[3 * s + 2]}, model.grid.A(), first);
    for (; next != cut_points.end() && next->point.cell == static_cast<std::int64_t>(a); ++next)
      add_point(region, next->point.parameter, next->point.weight, next->normal, model.grid.A(), first);
    if (region.weights.size() == before) continue;
    region.cells.push_back(static_cast<std::int64_t>(a));
    region.offsets.push_back(static_cast<std::int64_t>(region.weights.size()));
  }
  if (!(region.report.area > 0)) refuse_empty(model, choice, patch, what);
  if (patch) patch->describe(region.report);
  region.report.points = static_cast<std::int64_t>(region.weights.size());
  region.report.centroid = model.grid.to_position(plus(model.grid.A(), times(first, 1 / region.report.area)));
  return region;
}

std::vector<ChosenPolygon> choose_polygons(const TrimmedModel& model, const RegionChoice& choice,
                                           const std::string& what) {
  const Chooser chooser(model, choice, what);
  const TriangleMesh& mesh = model.surface.mesh;
  std::optional<SurfacePatch> patch;
  if (choice.patch) patch.emplace(model, *choice.patch, what);
  std::vector<ChosenPolygon> polygons;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Point3 normal = normal_of(mesh, t);
    const CutTriangle cut = chooser.choose(t, normal);
    if (cut.part == CutTriangle::Part::None || !(norm(normal) > 0)) continue;
    for (ConvexPolygon& part : chosen_parts(patch, cut, normal)) polygons.push_back({t, normal, std::move(part)});
  }
  if (polygons.empty()) refuse_empty(model, choice, patch, what);
  return polygons;
}

PointBatch gather(const TrimmedModel& model, const SurfaceRegion& region, std::size_t s) {
  PointBatch batch;
  batch.cell = region.cells[s];
  const auto first = static_cast<std::ptrdiff_t>(region.offsets[s]),
             last = static_cast<std::ptrdiff_t>(region.offsets[s + 1]);
  batch.parameters.assign(region.parameters.begin() + 3 * first, region.parameters.begin() + 3 * last);
  batch.weights.assign(region.weights.begin() + first, region.weights.begin() + last);
  batch.normals.assign(region.normals.begin() + first, region.normals.begin() + last);
  for (std::size_t q = 0; q < batch.size(); ++q)
    batch.positions.push_back(
        model.grid.to_position({batch.parameters[3 * q], batch.parameters[3 * q + 1], batch.parameters[3 * q + 2]}));
  return batch;
}

} // namespace iga::solve
