#include "samples/write_stl.hpp"

#include "samples/surface_mesh.hpp"

#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace iga::samples {
namespace {

Point3 facet_normal(const TriangleMesh& mesh, const Triangle& t) {
  const auto& a = mesh.vertices[static_cast<std::size_t>(t[0])];
  const auto& b = mesh.vertices[static_cast<std::size_t>(t[1])];
  const auto& c = mesh.vertices[static_cast<std::size_t>(t[2])];
  const Point3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  Point3 n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::hypot(n[0], n[1], n[2]);
  for (double& component : n) component /= length;
  return n;
}

std::string ascii_stl(const TriangleMesh& mesh, const std::string& name) {
  std::string text = fmt::format("solid {}\n", name);
  for (const Triangle& t : mesh.triangles) {
    const Point3 n = facet_normal(mesh, t);
    text += fmt::format("facet normal {:.17g} {:.17g} {:.17g}\n outer loop\n", n[0], n[1], n[2]);
    for (const std::int32_t v : t) {
      const Point3& x = mesh.vertices[static_cast<std::size_t>(v)];
      text += fmt::format("  vertex {:.17g} {:.17g} {:.17g}\n", x[0], x[1], x[2]);
    }
    text += " endloop\nendfacet\n";
  }
  return text + fmt::format("endsolid {}\n", name);
}

std::string binary_stl(const TriangleMesh& mesh, const std::string& name) {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes = fmt::format("{:80.80}", name);
  const auto append = [&](const auto& value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  append(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    for (const double n : facet_normal(mesh, t)) append(static_cast<float>(n));
    for (const std::int32_t v : t)
      for (const double c : mesh.vertices[static_cast<std::size_t>(v)]) append(static_cast<float>(c));
    append(std::uint16_t{0});
  }
  return bytes;
}

} // namespace

TriangleMesh as_stored(TriangleMesh mesh, StlKind kind) {
  if (kind == StlKind::Ascii) return mesh;
  for (Point3& x : mesh.vertices)
    for (double& c : x) c = static_cast<float>(c);
  SurfaceMesh surface = to_surface_mesh(mesh);
  CGAL::Polygon_mesh_processing::remove_degenerate_faces(surface);
  return to_triangles(surface);
}

void require_sound(const TriangleMesh& mesh, const std::string& name) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw std::runtime_error(fmt::format("{}: the surface {}", name, what));
  };
  const SurfaceMesh surface = to_surface_mesh(mesh);
  require(CGAL::is_closed(surface), "is not closed");
  for (const auto f : surface.faces())
    require(!pmp::is_degenerate_triangle_face(f, surface), "has a degenerate triangle");
  require(!pmp::does_self_intersect(surface), "intersects itself");
  require(pmp::does_bound_a_volume(surface), "does not bound a volume");
}

void write_stl(const TriangleMesh& mesh, const std::string& name, StlKind kind, const std::filesystem::path& file) {
  const std::string bytes = kind == StlKind::Ascii ? ascii_stl(mesh, name) : binary_stl(mesh, name);
  std::ofstream out(file, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

} // namespace iga::samples
