#include "format/io/toml_letters.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::io {

namespace {

/// Where the quoted text that begins at `at` ends: behind its last quote, or at what ends it too early.
std::size_t end_of_quoted(std::string_view toml, std::size_t at) {
  const char quote = toml[at];
  const std::string three(3, quote);
  const bool has_escapes = quote == '"';
  if (toml.substr(at, 3) != three) {
    for (++at; at < toml.size() && toml[at] != '\n'; ++at) {
      if (toml[at] == quote) return at + 1;
      if (has_escapes && toml[at] == '\\') ++at;
    }
    return std::min(at, toml.size());
  }
  for (at += 3; at < toml.size(); ++at) {
    if (toml.substr(at, 3) == three) {
      at += 3; // one or two more quotes belong to the text
      for (int more = 0; more < 2 && at < toml.size() && toml[at] == quote; ++more) ++at;
      return at;
    }
    if (has_escapes && toml[at] == '\\') ++at;
  }
  return toml.size();
}

[[noreturn]] void refuse(std::string_view toml, std::size_t at, const std::string& file) {
  const std::string_view before = toml.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1; // 0 where there is none
  std::size_t end = at + 1;
  while (end < toml.size() && (static_cast<unsigned char>(toml[end]) & 0xC0U) == 0x80U) ++end;
  throw InputError(fmt::format("{}:{}:{}: this is no valid TOML: found \"{}\" outside quotes; put texts in quotes, "
                               "write keys and numbers in plain letters and digits",
                               file, line, at - line_start + 1, toml.substr(at, end - at)));
}

} // namespace

void refuse_letters_outside_quotes(std::string_view toml, const std::string& file) {
  constexpr std::string_view separators = " \t\r\n=,[]{}", starts_of_numbers = "+-0123456789";
  std::size_t at = toml.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;
  std::size_t word = at; // where the current key or value begins
  while (at < toml.size()) {
    const char c = toml[at];
    const bool begins =
        at == word || (toml[at - 1] == '.' && starts_of_numbers.find(toml[word]) == std::string_view::npos);
    if (c == '#') {
      word = at = std::min(toml.find('\n', at), toml.size());
    } else if ((c == '"' || c == '\'') && begins) { // elsewhere the parser takes it for a part of the word
      at = end_of_quoted(toml, at);
    } else if (static_cast<unsigned char>(c) >= 0x80) {
      refuse(toml, at, file);
    } else {
      ++at;
      if (separators.find(c) != std::string_view::npos) word = at;
    }
  }
}

} // namespace iga::io
