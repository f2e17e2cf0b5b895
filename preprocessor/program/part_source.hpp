// Where a part comes from: a file of triangles, or a solid of a CAD file.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/cad/cad_model.hpp"
#include "preprocessor/program/settings.hpp"

#include <functional>

namespace iga::prep {

/// A surface with what only CAD files tell.
struct Part {
  ReadMesh read;
  std::string length_unit; ///< of the coordinates; empty: the user's label holds
  Curves curves;
  Markers markers;
  std::vector<std::string> findings, warnings;
};

/// By the file's first bytes, or its ending. @throws InputError where it cannot be read
bool is_cad_file(const std::filesystem::path& file);

/// All solids of a CAD file, tessellated for the spans that the settings ask for.
/// @param stop  ends the reader early (run_cad_reader.hpp)
CadModel read_cad_file(const Settings& settings, const std::function<bool()>& stop);
/// Its solids and faces alone.
CadModel list_cad_file(const Settings& settings, const std::function<bool()>& stop);

/// The solid that settings.cad.solid names, or the only one.
/// @throws InputError where the name is unknown or missing, with the names that there are
const CadSolid& choose_solid(const CadModel& cad, const Settings& settings);

/// One solid as a part.
Part part_of(const CadModel& cad, const CadSolid& solid, const std::filesystem::path& file);

} // namespace iga::prep
