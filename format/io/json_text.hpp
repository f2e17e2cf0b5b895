// Small JSON reports for `--json`: objects whose keys stay in the order they were added.
#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace iga::io {

/// Text of one JSON value. Numbers are written so that reading them back gives the same bits; NaN and infinity, which
/// JSON lacks, become null; bytes of a text that are no UTF-8 become U+FFFD.
std::string json(double value);
std::string json(std::string_view value);
inline std::string json(const char* value) {
  return json(std::string_view(value));
}
inline std::string json(const std::string& value) {
  return json(std::string_view(value));
}
inline std::string json(bool value) {
  return value ? "true" : "false";
}
inline std::string json(std::integral auto value) {
  return std::to_string(value);
}

class JsonObject;
std::string json(const JsonObject& value);

template <class Range>
requires requires(const Range& r) {
  r.begin() != r.end();
} &&(!std::convertible_to<Range, std::string_view>)std::string json(const Range& values) {
  std::string text = "[";
  for (const auto& value : values) {
    if (text.size() > 1) text.append(", ");
    text.append(json(value));
  }
  return text.append("]");
}

class JsonObject {
 public:
  template <class T> JsonObject& add(std::string_view key, const T& value) {
    members_.push_back(json(key) + ": " + json(value));
    return *this;
  }
  std::string text() const;

 private:
  std::vector<std::string> members_;
};

} // namespace iga::io
