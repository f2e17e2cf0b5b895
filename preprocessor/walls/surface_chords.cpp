#include "preprocessor/walls/surface_chords.hpp"

#include "format/model/vec3.hpp"

#include <algorithm>
#include <limits>

namespace iga::prep {

namespace {

constexpr std::size_t most_per_span = 8;

} // namespace

std::vector<SurfaceSample> sample_surface(const TrimmedModel& model, std::size_t most) {
  const SurfacePoints& points = model.surface.quadrature;
  const std::size_t spans = model.cells.span.size();
  std::size_t with_surface = 0;
  for (std::size_t a = 0; a < spans; ++a) with_surface += points.offsets[a + 1] > points.offsets[a];
  const std::size_t per_span = std::clamp<std::size_t>(most / std::max<std::size_t>(with_surface, 1), 1, most_per_span);
  const std::size_t stride = (with_surface + most - 1) / most; // above 1 where not every span can have one
  std::vector<SurfaceSample> samples;
  std::size_t number = 0;
  for (std::size_t a = 0; a < spans; ++a) {
    const auto first = static_cast<std::size_t>(points.offsets[a]),
               last = static_cast<std::size_t>(points.offsets[a + 1]);
    if (first == last || number++ % stride != 0) continue;
    double area = 0;
    for (std::size_t q = first; q < last; ++q) area += points.weights[q];
    const double share = area / static_cast<double>(per_span);
    double passed = 0, next = 0.5 * share;
    for (std::size_t q = first; q < last; ++q) {
      passed += points.weights[q];
      double here = 0;
      for (; next < passed; next += share) here += share;
      if (here == 0) continue;
      SurfaceSample s;
      s.active = a;
      s.triangle = static_cast<std::size_t>(points.triangle[q]);
      s.x = model.grid.to_position(
          {points.parameters[3 * q], points.parameters[3 * q + 1], points.parameters[3 * q + 2]});
      s.normal = {points.normals[3 * q], points.normals[3 * q + 1], points.normals[3 * q + 2]};
      s.area = here * static_cast<double>(stride);
      samples.push_back(s);
    }
  }
  return samples;
}

std::optional<Chord> first_chord(const TriangleMesh& mesh, const TriangleTree& tree, const Point3& from,
                                 const Point3& way, bool outwards) {
  const double length = norm(way);
  double nearest = 1;
  std::optional<Chord> found;
  tree.each_on_way(from, way, [&](std::size_t t) {
    const auto corner = [&](std::size_t a) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][a])]; };
    const Point3 a = corner(0), ab = minus(corner(1), a), ac = minus(corner(2), a), n = cross(ab, ac);
    const double along = outwards ? -dot(n, way) : dot(n, way); // > 0 where the triangle is met from its face
    if (!(along > 0)) return;
    // Möller & Trumbore, Journal of Graphics Tools 2 (1997); places on an edge, within rounding, belong to both sides.
    constexpr double slack = 64 * std::numeric_limits<double>::epsilon();
    const Point3 f = minus(from, a), p = cross(way, ac), q = cross(f, ab);
    const double scale = dot(ab, p), s = dot(f, p) / scale, r = dot(way, q) / scale;
    if (!(s >= -slack && r >= -slack && s + r <= 1 + slack)) return;
    const double at = dot(ac, q) / scale;
    if (!(at >= 0 && at < nearest)) return;
    nearest = at;
    found = Chord{times(way, at), t, along / (norm(n) * length)};
  });
  return found;
}

Point3 in_spans(const SplineGrid& grid, const Point3& way) {
  const Point3 along = grid.along_axes(way), h = grid.span_size();
  return {along[0] / h[0], along[1] / h[1], along[2] / h[2]};
}

} // namespace iga::prep
