// One JSON object written piece by piece: the reports of both tools.
#pragma once

#include <cmath>
#include <concepts>
#include <fmt/format.h>
#include <ranges>
#include <string>
#include <string_view>

namespace iga::io {

/// Text as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD.
inline std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += text[i++];
    } else if (c < 0x20) {
      out += fmt::format("\\u{:04x}", c);
      ++i;
    } else if (c < 0x80) {
      out += text[i++];
    } else {
      // RFC 3629: the first byte gives the length, the second byte's range excludes overlong forms and surrogates.
      const std::size_t length = c >= 0xC2 && c <= 0xDF ? 2 : (c & 0xF0) == 0xE0 ? 3 : c >= 0xF0 && c <= 0xF4 ? 4 : 0;
      bool valid = length != 0 && i + length <= text.size();
      for (std::size_t k = 1; valid && k < length; ++k) {
        const auto next = static_cast<unsigned char>(text[i + k]);
        const unsigned low = k > 1 ? 0x80 : c == 0xE0 ? 0xA0 : c == 0xF0 ? 0x90 : 0x80;
        const unsigned high = k > 1 ? 0xBF : c == 0xED ? 0x9F : c == 0xF4 ? 0x8F : 0xBF;
        valid = next >= low && next <= high;
      }
      out += valid ? std::string(text.substr(i, length)) : std::string("\xEF\xBF\xBD");
      i += valid ? length : 1;
    }
  }
  return out + '"';
}

/// Builds one object; members appear in the order of the calls. Numbers are written with as many digits as it takes to
/// read the same bits back; what is not finite becomes null.
class JsonWriter {
 public:
  void member(std::string_view key, std::string_view text) { open(key) += json_string(text); }
  void member(std::string_view key, const char* text) { member(key, std::string_view(text)); }
  void member(std::string_view key, bool value) { open(key) += value ? "true" : "false"; }
  template <class T>
  requires std::integral<T> || std::floating_point<T>
  void member(std::string_view key, T value) { open(key) += number(value); }
  /// An array of numbers or of strings.
  template <std::ranges::input_range R>
  requires(!std::convertible_to<R, std::string_view>) void member(std::string_view key, const R& values) {
    std::string& out = open(key);
    out += '[';
    bool first = true;
    for (const auto& value : values) {
      if (!first) out += ", ";
      first = false;
      if constexpr (std::convertible_to<decltype(value), std::string_view>)
        out += json_string(value);
      else
        out += number(value);
    }
    out += ']';
  }
  /// A nested object.
  void member(std::string_view key, const JsonWriter& object) { open(key) += object.text(); }

  std::string text() const { return "{" + body_ + "}"; }

 private:
  template <class T> static std::string number(T value) {
    if constexpr (std::floating_point<T>)
      if (!std::isfinite(value)) return "null";
    return fmt::format("{}", value);
  }
  std::string& open(std::string_view key) {
    if (!body_.empty()) body_ += ", ";
    body_ += json_string(key);
    body_ += ": ";
    return body_;
  }

  std::string body_;
};

} // namespace iga::io
