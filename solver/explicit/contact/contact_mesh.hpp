// What contact knows of a triangulated side beside its corners: neighbours, areas, normals, sharp edges, thickness.
#pragma once

#include "format/model/triangle_mesh.hpp"

#include <span>
#include <vector>

namespace iga::solve {

/// An edge where two faces meet at an angle, seen from outside like the edge of a box.
struct SharpEdge {
  std::int32_t a = 0, b = 0;        ///< vertices
  std::int32_t left = 0, right = 0; ///< faces
  double area = 0;                  ///< a third of both faces', length²
};

/// All in the reference. Vertices keep the numbers of the mesh.
struct ContactMesh {
  std::vector<Point3> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::array<std::int32_t, 3>> neighbour; ///< across the edge from corner i to the next; -1 at a border
  std::vector<std::int32_t> face_offsets, faces;      ///< faces of each vertex, ascending
  std::vector<double> face_area;                      ///< length²
  std::vector<Point3> face_normal;                    ///< unit; zero for a face without area
  std::vector<Point3> vertex_normal;                  ///< unit, weighted by area
  std::vector<double> vertex_area;                    ///< a third of its faces', length²
  std::vector<SharpEdge> sharp_edges;                 ///< convex ones, ascending (a, b)
  std::vector<std::uint8_t> is_sharp;                 ///< per vertex: end of a sharp edge
  std::vector<double> thickness;                      ///< per face: along the inward normal, at most the given reach

  std::span<const std::int32_t> faces_of(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    const auto first = static_cast<std::size_t>(face_offsets[v]), last = static_cast<std::size_t>(face_offsets[v + 1]);
    return {faces.data() + first, last - first};
  }
};

/// @param reach  how far thickness is looked for, length
ContactMesh make_contact_mesh(const TriangleMesh& mesh, double reach);

/// One vertex for each position (bit by bit), triangles that lose a corner dropped: STL gives each facet its own.
TriangleMesh merge_equal_vertices(const TriangleMesh& mesh);

} // namespace iga::solve
