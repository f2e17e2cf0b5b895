// Files that are no triangulated surface, called by their own name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace iga::io {

/// What is known of a file that is none of STL, OBJ, PLY and OFF.
struct ForeignFile {
  std::string name;   ///< with its article: "a STEP file"
  std::string advice; ///< what to do instead
};

/// Names of the CAD formats that igaprep reads otherwise than as triangles.
inline constexpr const char* step_file = "a STEP file";
inline constexpr const char* iges_file = "an IGES file";
inline constexpr const char* brep_file = "an OpenCASCADE BREP file";

/// By the first bytes: CAD, mesh and picture formats, archives (looked into), web pages, Git LFS pointers.
std::optional<ForeignFile> recognise_content(std::string_view bytes);
/// By the name's ending.
std::optional<ForeignFile> recognise_name(const std::filesystem::path& file);

/// Call before reading `bytes` as STL: by content first, then by name. A binary STL whose size fits its count passes,
/// whatever its 80 bytes of text and its name say.
/// @throws InputError "file: this is a STEP file; …"
void refuse_foreign(std::string_view bytes, const std::filesystem::path& file);

} // namespace iga::io
