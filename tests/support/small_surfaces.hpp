// Small closed surfaces with known volumes, as meshes and as ASCII STL.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <fmt/format.h>
#include <string>

namespace iga::test {

/// Axis-aligned box, outward-oriented, 12 triangles.
inline TriangleMesh box_mesh(const Point3& lower, const Point3& upper) {
  TriangleMesh mesh;
  for (std::size_t v = 0; v < 8; ++v)
    mesh.vertices.push_back({(v & 1 ? upper : lower)[0], (v & 2 ? upper : lower)[1], (v & 4 ? upper : lower)[2]});
  constexpr std::int32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                        {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  mesh.region.assign(mesh.triangles.size(), 0);
  mesh.region_names = {"box"};
  return mesh;
}

/// Numbers with all their digits; normals left zero, which readers accept.
inline std::string ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid part\n";
  for (const Triangle& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::int32_t v : t) {
      const Point3& x = mesh.vertices[static_cast<std::size_t>(v)];
      text += fmt::format("vertex {} {} {}\n", x[0], x[1], x[2]);
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid part\n";
}

} // namespace iga::test
