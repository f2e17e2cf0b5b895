// Binary STL.
#pragma once

#include "format/io/stl_reader.hpp"

namespace iga::io {

/// Geometry behind the announced facets is read too: further facets, or further files, each a region of its own.
/// Parameters and errors as read_stl
StlMesh read_binary_stl(std::string_view bytes, const std::string& name, double scale);

} // namespace iga::io
