// ASCII STL.
#pragma once

#include "format/io/stl_reader.hpp"

namespace iga::io {

/// @param text  without padding. Parameters and errors as read_stl
StlMesh read_ascii_stl(std::string_view text, const std::string& name, double scale);

} // namespace iga::io
