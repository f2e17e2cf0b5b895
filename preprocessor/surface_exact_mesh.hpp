// Shells as CGAL meshes with exact coordinates and region numbers. Include in few .cpp files: slow to compile.
#pragma once

#include "preprocessor/surface_topology.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>
#include <memory>

namespace iga::prep {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactMesh = CGAL::Surface_mesh<ExactKernel::Point_3>;
using ExactRegions = ExactMesh::Property_map<ExactMesh::Face_index, std::int32_t>;

/// The map that holds each facet's region; made on first use.
ExactRegions regions_of(ExactMesh& mesh);
/// @pre the map exists
ExactRegions regions_of(const ExactMesh& mesh);

/// Hands the region of a facet on to the facets that replace it.
struct RegionKeeper : CGAL::Polygon_mesh_processing::Corefinement::Default_visitor<ExactMesh> {
  std::shared_ptr<std::int32_t> current = std::make_shared<std::int32_t>(0);

  void before_subface_creations(face_descriptor old_face, ExactMesh& mesh) { *current = regions_of(mesh)[old_face]; }
  void after_subface_created(face_descriptor new_face, ExactMesh& mesh) { regions_of(mesh)[new_face] = *current; }
  void after_face_copy(face_descriptor old_face, const ExactMesh& from, face_descriptor new_face, ExactMesh& to) {
    regions_of(to)[new_face] = regions_of(from)[old_face];
  }
};

/// The listed facets as a mesh; edges shared by more than two facets are parted.
/// @return false where the facets do not form a closed orientable mesh
bool to_exact_mesh(const TriangleMesh& mesh, std::span<const std::int32_t> facets, ExactMesh& out);

/// Appends the mesh's vertices (rounded to double), facets and regions.
void append_exact_mesh(ExactMesh& mesh, Surface& surface);

} // namespace iga::prep
