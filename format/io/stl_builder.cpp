#include "format/io/stl_builder.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace iga::io {

namespace {

bool finite(const Point3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

} // namespace

void StlBuilder::reserve(std::size_t facets) {
  constexpr std::size_t limit = std::numeric_limits<std::int32_t>::max() / 3;
  if (facets > limit)
    throw InputError(fmt::format("{}: {} facets, at most {} can be read; coarsen the mesh", name_, facets, limit));
  out_.mesh.vertices.reserve(3 * facets);
  out_.mesh.triangles.reserve(facets);
  out_.mesh.region.reserve(facets);
  out_.facet_normals.reserve(facets);
}

void StlBuilder::begin_region(std::string_view wanted) {
  const std::string base = wanted.empty() ? "surface" : std::string(wanted);
  std::string text = base;
  for (int& n = last_number_[base]; !taken_.insert(text).second; text = fmt::format("{}_{}", base, n))
    n = std::max(n + 1, 2);
  out_.mesh.region_names.push_back(text);
}

void StlBuilder::add(const Point3& normal, const std::array<Point3, 3>& corners) {
  const auto facet = out_.mesh.triangles.size();
  for (const Point3& c : corners) {
    const Point3 x{c[0] * scale_, c[1] * scale_, c[2] * scale_};
    if (!finite(x))
      throw InputError(fmt::format("{}: facet {} (counted from 1) has the vertex ({} {} {}), which is not a finite "
                                   "position; export the part again",
                                   name_, facet + 1, c[0], c[1], c[2]));
    out_.mesh.vertices.push_back(x);
  }
  const auto v = static_cast<std::int32_t>(3 * facet);
  out_.mesh.triangles.push_back({v, v + 1, v + 2});
  out_.mesh.region.push_back(static_cast<std::int32_t>(out_.mesh.region_names.size()) - 1);
  if (!finite(normal)) ++odd_normals_;
  out_.facet_normals.push_back(finite(normal) ? normal : Point3{});
}

StlMesh StlBuilder::finish(std::string format) {
  if (out_.mesh.triangles.empty())
    throw InputError(fmt::format("{}: {} without any facet; a closed surface needs at least four: export the part "
                                 "again",
                                 name_, format));
  drop_empty_regions();
  if (odd_normals_ > 0)
    note(fmt::format("{} stored facet normals are not numbers; normals come from the vertices", odd_normals_));
  out_.format = std::move(format);
  return std::move(out_);
}

void StlBuilder::drop_empty_regions() {
  std::vector<std::int32_t> used(out_.mesh.region_names.size(), -1);
  for (std::int32_t r : out_.mesh.region) used[static_cast<std::size_t>(r)] = 0;
  std::vector<std::string> names;
  for (std::size_t r = 0; r < used.size(); ++r)
    if (used[r] == 0) {
      used[r] = static_cast<std::int32_t>(names.size());
      names.push_back(out_.mesh.region_names[r]);
    }
  for (std::int32_t& r : out_.mesh.region) r = used[static_cast<std::size_t>(r)];
  out_.mesh.region_names = std::move(names);
}

} // namespace iga::io
