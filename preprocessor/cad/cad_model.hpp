// What a CAD file (STEP, IGES, BREP) holds once its solids are tessellated: facets with their faces as regions, edges,
// vertices, exact properties, and where each solid stands.
#pragma once

#include "format/model/spline_grid.hpp"
#include "format/model/triangle_mesh.hpp"

#include <string>
#include <vector>

namespace iga::prep {

/// A face of the boundary: one region of the surface.
struct CadFace {
  std::string name; ///< as in the file, else "face 12"; no two of a solid are equal
  /// "plane", "cylinder", "cone", "sphere", "torus", "spline" …; hollow cylinders are a "bore" from half a turn on,
  /// else a "fillet".
  std::string kind;
  std::string colour;  ///< "#rrggbb", empty where the file gives none
  double area = 0;     ///< exact, length²
  Point3 centroid{};   ///< of the exact face, length
  Point3 direction{};  ///< plane: outward normal; cylinder, cone, torus: axis; else zero
  Point3 axis_point{}; ///< a point of the axis, or the sphere's centre; else zero
  double radius = 0;   ///< cylinder, sphere; torus: the larger one; cone: at axis_point; else zero
};

/// An edge of the boundary, as corners of a polyline that consists of edges of the facets.
struct CadEdge {
  std::string name;               ///< as in the file, else "edge 7"
  std::string kind;               ///< "line", "circle", "ellipse", "spline" …
  double length = 0;              ///< exact
  double radius = 0;              ///< circle; else zero
  Point3 middle{};                ///< at half of its parameters, length
  std::vector<std::string> faces; ///< names of those that it bounds
  std::vector<Point3> points;     ///< empty without facets
};

struct CadVertex {
  std::string name; ///< as in the file, else "vertex 3"
  Point3 position{};
};

/// Where a solid stands: x = rotation · y + shift, with y in the frame in which its surface is given.
struct CadPlace {
  std::string name; ///< of the instance
  Rotation rotation = identity_rotation;
  Point3 shift{}; ///< length
};

/// A solid that the file holds once or, at several places, repeatedly.
struct CadSolid {
  std::string name;   ///< as in the file, else "solid 2"; no two are equal
  std::string colour; ///< "#rrggbb" or empty
  TriangleMesh mesh;  ///< facets of each face together, in the order of `faces`; regions are the faces
  std::vector<CadFace> faces;
  std::vector<CadEdge> edges;
  std::vector<CadVertex> vertices;
  double volume = 0, area = 0;  ///< exact: length³, length²
  Point3 centroid{};            ///< exact
  double chord = 0;             ///< what was asked for, length
  double deviation = 0;         ///< largest distance found between the facets and the exact faces, length
  std::vector<CadPlace> places; ///< at least one; an identity where it stands once
};

/// Two instances that share material.
struct CadOverlap {
  std::string first, second; ///< names of the instances
  double volume = 0;         ///< length³
};

struct CadModel {
  std::string format;      ///< "STEP", "IGES", "BREP"
  std::string length_unit; ///< of all numbers here; "unspecified" where the file tells none
  std::string sha256;      ///< of the file's bytes
  std::string file_unit;   ///< the one that the file was written in
  std::vector<CadSolid> solids;
  std::vector<CadOverlap> overlaps;
  std::vector<std::string> findings, warnings; ///< one sentence each
};

/// What to do with a CAD file.
struct CadOptions {
  double chord = 0;          ///< largest distance of facets from the surface, length; 0: from chord_share
  double chord_share = 5e-5; ///< the same as a share of the longest side of each solid's box
  double scale = 1;          ///< factor on all coordinates
  std::string length_unit;   ///< convert to this unit; empty: stay in that of the file
  double sew = 0;            ///< join faces without a solid across gaps up to this length; 0: do not
  bool merge = false;        ///< unite all solids
  bool tessellate = true;    ///< false: no facets, for a list
  bool overlaps = false;     ///< look for solids that share material
};

} // namespace iga::prep
