// Letters beyond ASCII in TOML: texts in quotes and comments may hold them, keys and values may not.
#pragma once

#include <string>
#include <string_view>

namespace iga::io {

/// Letters outside quotes and comments are refused before parsing: their place is told better than by the parser.
/// @throws InputError "file:line:column: found …" for the first one
void refuse_letters_outside_quotes(std::string_view toml, const std::string& file);

/// What to parse in the place of `toml`: each letter U+0080 to U+FFFF is replaced by the one U+F0000 further, a
/// private-use letter, so lines and columns stay. toml++ 3.3 runs into undefined behaviour at 3019 letters, wherever it
/// asks whether they are spaces (is_non_ascii_horizontal_whitespace: U+00A1–0499, U+2C5E–2FFF, U+3001–3057,
/// U+FB26–FEFE), and where it asks follows no rule that could be screened: damaged files lead it into quotes as well.
/// Bytes that are no valid UTF-8 stay as they are, for the parser to refuse.
/// @throws InputError "file:line:column: …" where the text holds private-use letters U+F0000 to U+FFFFF itself
std::string with_stand_ins(std::string_view toml, const std::string& file);

/// `text` with the letters for which with_stand_ins() put others.
std::string without_stand_ins(std::string_view text);

} // namespace iga::io
