// Text that leaves the program (the model file, JSON) is UTF-8, whatever the names of files and solids hold.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace iga::io {

/// Length in bytes, 1 to 4, of the well-formed UTF-8 sequence at the start of `text`, which is not empty; 0 where there
/// is none (The Unicode Standard 15, table 3-7: no overlong forms, no surrogates, nothing above U+10FFFF).
std::size_t sequence_length(std::string_view text);

/// `text` with U+FFFD, the replacement character, for every byte that belongs to no well-formed UTF-8 sequence.
std::string valid_utf8(std::string_view text);

} // namespace iga::io
