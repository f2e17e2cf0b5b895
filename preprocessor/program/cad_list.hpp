// igaprep --list: what a CAD file holds, for people and for scripts.
#pragma once

#include "preprocessor/cad/cad_model.hpp"

namespace iga::prep {

/// Tables of solids and faces, with edges and vertices where asked for, ending in a newline.
std::string cad_list_text(const CadModel& cad, const std::string& file, bool edges);
/// The same as one JSON object without a newline.
std::string cad_list_json(const CadModel& cad, const std::string& file, bool edges);

} // namespace iga::prep
