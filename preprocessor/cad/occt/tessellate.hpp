// A solid of OpenCASCADE → facets that share their vertices, faces as regions, edges as polylines of facet edges.
#pragma once

#include "preprocessor/cad/occt/load_shapes.hpp"

namespace iga::prep {

/// Facets, faces, edges, vertices and exact properties of one solid, in the frame of the solid.
/// Neighbouring faces get the same vertices along their edge, by the edge's own subdivision: the facets are closed
/// where the boundary is, whatever gaps its tolerances allow.
/// @param chord       largest distance of facets from the faces, in the unit of the shapes; 0: no facets
/// @param length      factor on all lengths afterwards
/// @param file        opens messages
/// @throws InputError where faces cannot be tessellated, naming them
CadSolid tessellate(const LoadedCad& cad, const LoadedSolid& solid, double chord, double length,
                    const std::string& file);

/// Exact volume in the unit of the shapes, cubed. OpenCASCADE's fixed rule would be off by 4e-4 where bores meet.
double exact_volume(const TopoDS_Shape& shape);

/// Longest side of the box around a solid, in the unit of the shapes.
double longest_side(const TopoDS_Shape& shape);

} // namespace iga::prep
