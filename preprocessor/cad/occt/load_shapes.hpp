// CAD file → solids of OpenCASCADE with names, colours and places. The folder occt/ alone knows OpenCASCADE.
#pragma once

#include "preprocessor/cad/cad_model.hpp"

#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <gp_Trsf.hxx>
#include <map>
#include <set>

namespace iga::prep {

/// Text and colour that a file gives to a face, edge or vertex.
struct ShapeLabel {
  std::string name, colour;
};

/// Makes names unique: "bolt", "bolt (2)".
class UniqueNames {
 public:
  std::string operator()(const std::string& name);

 private:
  std::set<std::string> used_;
};

/// A solid in its own frame and where it stands.
struct LoadedSolid {
  TopoDS_Shape shape; ///< without a location
  std::string name, colour;
  std::vector<std::pair<std::string, gp_Trsf>> places; ///< name of the instance; at least one
};

struct LoadedCad {
  std::string sha256;            ///< of the file's bytes
  std::string format, file_unit; ///< "mm", "in", …; "unspecified"
  double millimetres = 1;        ///< of file_unit; shapes are in millimetres, or in the file's unit where it tells none
  std::vector<LoadedSolid> solids;
  std::vector<std::string> findings, warnings;
  TopTools_DataMapOfShapeInteger label_of; ///< of faces, edges and vertices without a location: entry of `labels`
  std::vector<ShapeLabel> labels;
};

/// Reads a STEP, IGES or BREP file, told by its first bytes.
/// @param sew  join faces without a solid across gaps up to this length, in the unit of the file; 0: refuse them
/// @throws InputError where it cannot be read whole, or holds no solid
LoadedCad load_shapes(const std::filesystem::path& file, double sew);

/// "in" for 25.4; empty where no unit in use has so many millimetres.
std::string unit_of_millimetres(double millimetres);
/// Millimetres of mm, cm, m, um, in, ft; 0 for anything else.
double millimetres_of(const std::string& unit);

} // namespace iga::prep
