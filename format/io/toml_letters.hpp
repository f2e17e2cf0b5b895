// Letters beyond ASCII in TOML: texts in quotes and comments may hold them, keys and values may not.
#pragma once

#include <string>
#include <string_view>

namespace iga::io {

/// Call before parsing: toml++ 3.3 runs into undefined behaviour at such letters outside quotes and comments
/// (is_non_ascii_horizontal_whitespace, U+00A1 to U+0499).
/// @throws InputError "file:line:column: found …" for the first one
void refuse_letters_outside_quotes(std::string_view toml, const std::string& file);

} // namespace iga::io
