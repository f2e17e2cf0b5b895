#include "format/io/json_text.hpp"

#include "format/io/utf8.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga::io {

std::string json(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

std::string json(std::string_view value) {
  std::string text = "\"";
  for (const char c : valid_utf8(value)) {
    if (c == '"' || c == '\\')
      text.append(1, '\\').append(1, c);
    else if (static_cast<unsigned char>(c) < 0x20)
      text.append(fmt::format("\\u{:04x}", static_cast<unsigned>(c)));
    else
      text.append(1, c);
  }
  return text.append(1, '"');
}

std::string json(const JsonObject& value) {
  return value.text();
}

std::string JsonObject::text() const {
  std::string text = "{";
  for (const auto& member : members_) {
    if (text.size() > 1) text.append(", ");
    text.append(member);
  }
  return text.append("}");
}

} // namespace iga::io
