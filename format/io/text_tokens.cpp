#include "format/io/text_tokens.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <limits>

namespace iga::io {

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// from_chars knows no leading '+'; "+-1" stays what it is, no number.
std::string_view without_plus(std::string_view token) {
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+';
  return plus ? token.substr(1) : token;
}

} // namespace

bool equals_word(std::string_view token, std::string_view word) {
  return token.size() == word.size() &&
         std::equal(token.begin(), token.end(), word.begin(), [](char a, char b) { return lower(a) == b; });
}

template <class Real> std::optional<Real> parse_number(std::string_view token) {
  token = without_plus(token);
  Real value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (token.empty() || end != token.data() + token.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const auto e = token.find_first_of("eE");
    const bool small = e != std::string_view::npos ? token.substr(e + 1, 1) == "-" : token.find('.') < 3;
    return small ? Real{0} : std::numeric_limits<Real>::infinity();
  }
  return error == std::errc{} ? std::optional(value) : std::nullopt;
}
template std::optional<float> parse_number<float>(std::string_view);
template std::optional<double> parse_number<double>(std::string_view);

std::optional<std::int64_t> parse_integer(std::string_view token) {
  token = without_plus(token);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (token.empty() || end != token.data() + token.size() || error != std::errc{}) return std::nullopt;
  return value;
}

std::string shown(std::string_view token) {
  constexpr std::size_t most = 40;
  std::string text(token.substr(0, most));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return token.size() > most ? text + "..." : text;
}

std::string expectation(std::string_view found, std::string_view expected) {
  if (found.empty()) return fmt::format("the text ends where {} is expected", expected);
  std::string with_point(found);
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  const bool comma = found.find(',') != std::string_view::npos && parse_number<double>(with_point);
  return fmt::format("found \"{}\" where {} is expected{}", shown(found), expected,
                     comma ? " (decimals are written with a point, not a comma)" : "");
}

std::string_view without_padding(std::string_view text) {
  const auto last = text.find_last_not_of(std::string_view("\0\x1A", 2));
  text = text.substr(0, last == std::string_view::npos ? 0 : last + 1);
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  return text;
}

void TextTokens::skip() {
  while (at_ < text_.size()) {
    if (at_comment()) {
      while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
      continue;
    }
    if (!is_space(text_[at_])) return;
    const bool bare_cr = text_[at_] == '\r' && (at_ + 1 == text_.size() || text_[at_ + 1] != '\n');
    if (text_[at_] == '\n' || bare_cr) ++line_;
    ++at_;
  }
}

std::string_view TextTokens::next() {
  skip();
  const std::size_t first = at_;
  while (at_ < text_.size() && !is_space(text_[at_]) && !at_comment()) ++at_;
  return text_.substr(first, at_ - first);
}

std::string_view TextTokens::peek() {
  const std::size_t at = at_, line = line_;
  const std::string_view word = next();
  at_ = at;
  line_ = line;
  return word;
}

std::string_view TextTokens::rest_of_line() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  const std::size_t first = at_;
  while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r' && !at_comment()) ++at_;
  std::size_t last = at_;
  while (last > first && is_space(text_[last - 1])) --last;
  return text_.substr(first, last - first);
}

bool TextLines::next(std::string_view& line) {
  if (at_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
  line = text_.substr(at_, end - at_);
  at_ = std::min(end + (text_.substr(end, 2) == "\r\n" ? 2 : 1), text_.size());
  ++number_;
  return true;
}

} // namespace iga::io
