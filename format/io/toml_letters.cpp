#include "format/io/toml_letters.hpp"

#include "format/io/utf8.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
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

[[noreturn]] void refuse(std::string_view toml, std::size_t at, const std::string& file, std::string_view why) {
  const std::string_view before = toml.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start = before.rfind('\n') + 1; // 0 where there is none
  throw InputError(fmt::format("{}:{}:{}: {}", file, line, at - line_start + 1, why));
}

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Code point of a well-formed sequence of two or three bytes.
std::uint32_t code_point(std::string_view sequence) {
  std::uint32_t code = static_cast<unsigned char>(sequence[0]) & (sequence.size() == 2 ? 0x1FU : 0x0FU);
  for (const char byte : sequence.substr(1)) code = code << 6U | (static_cast<unsigned char>(byte) & 0x3FU);
  return code;
}

/// The sequence of 2 to 4 bytes for a code point.
std::string sequence_of(std::uint32_t code, std::size_t length) {
  constexpr std::array<std::uint32_t, 5> first{0, 0, 0xC0, 0xE0, 0xF0};
  std::string sequence(length, '\0');
  for (std::size_t i = length - 1; i > 0; --i, code >>= 6U) sequence[i] = static_cast<char>(0x80U | (code & 0x3FU));
  sequence[0] = static_cast<char>(first.at(length) | code);
  return sequence;
}

constexpr std::uint32_t private_use = 0xF0000; // plane 15; its sequences begin with byte F3 and a byte from B0 on

bool is_private_use(std::string_view sequence) {
  return sequence.size() == 4 && sequence[0] == '\xF3' && static_cast<unsigned char>(sequence[1]) >= 0xB0;
}

} // namespace

void refuse_letters_outside_quotes(std::string_view toml, const std::string& file) {
  constexpr std::string_view separators = " \t\r\n=,[]{}", starts_of_numbers = "+-0123456789";
  std::size_t at = toml.substr(0, 3) == byte_order_mark ? 3 : 0;
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
      const std::string_view letter = toml.substr(at, std::max<std::size_t>(1, sequence_length(toml.substr(at))));
      refuse(
          toml, at, file,
          fmt::format("this is no valid TOML: found \"{}\" outside quotes; put texts in quotes, write keys and numbers "
                      "in plain letters and digits",
                      letter));
    } else {
      ++at;
      if (separators.find(c) != std::string_view::npos) word = at;
    }
  }
}

std::string with_stand_ins(std::string_view toml, const std::string& file) {
  std::string out;
  out.reserve(toml.size());
  std::size_t at = toml.substr(0, 3) == byte_order_mark ? 3 : 0;
  out.append(toml.substr(0, at));
  while (at < toml.size()) {
    const std::size_t length = std::max<std::size_t>(1, sequence_length(toml.substr(at)));
    const std::string_view letter = toml.substr(at, length);
    const std::string_view escape = toml.substr(at, 6);
    if (is_private_use(letter) || escape == "\\U000F" || escape == "\\U000f")
      refuse(toml, at, file, "found a private-use letter, U+F0000 to U+FFFFF; leave it out");
    if (length == 2 || length == 3)
      out.append(sequence_of(private_use + code_point(letter), 4));
    else
      out.append(letter);
    at += length;
  }
  return out;
}

std::string without_stand_ins(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = std::max<std::size_t>(1, sequence_length(text.substr(at)));
    const std::string_view letter = text.substr(at, length);
    if (is_private_use(letter)) {
      // The last 16 bits: four of the second byte, six each of the others.
      const std::uint32_t code = (static_cast<unsigned char>(letter[1]) & 0x0FU) << 12U |
                                 (static_cast<unsigned char>(letter[2]) & 0x3FU) << 6U |
                                 (static_cast<unsigned char>(letter[3]) & 0x3FU);
      out.append(sequence_of(code, code < 0x800 ? 2 : 3));
    } else {
      out.append(letter);
    }
    at += length;
  }
  return out;
}

} // namespace iga::io
