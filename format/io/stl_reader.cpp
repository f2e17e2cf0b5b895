#include "format/io/stl_reader.hpp"

#include "format/io/stl_ascii.hpp"
#include "format/io/stl_binary.hpp"
#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <fmt/format.h>

namespace iga::io {

bool looks_like_ascii_stl(std::string_view bytes) {
  const std::string_view head = without_padding(bytes).substr(0, 4096);
  if (head.find('\0') != std::string_view::npos) return false;
  TextTokens tokens(head);
  if (!equals_word(tokens.next(), "solid")) return false;
  tokens.rest_of_line();
  const std::string_view second = tokens.next();
  return second.empty() || equals_word(second, "facet") || equals_word(second, "endsolid");
}

StlMesh read_stl(std::string_view bytes, const std::string& name, double scale) {
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty; export the part again", name));
  if (looks_like_ascii_stl(bytes)) return read_ascii_stl(without_padding(bytes), name, scale);
  return read_binary_stl(bytes, name, scale);
}

} // namespace iga::io
