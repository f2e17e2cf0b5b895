// Tells CAD files by their first bytes.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace iga::prep {

enum class CadFormat { Step, Iges, Brep };

/// By the first bytes; by the name's ending for a file that announces nothing but is called .step, .iges, .brep.
/// @return nothing for a file of triangles, or of anything else, such as a web page called part.step
std::optional<CadFormat> cad_format(std::string_view bytes, const std::filesystem::path& file);

} // namespace iga::prep
