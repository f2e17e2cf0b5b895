// Words, lines and numbers of text files, with the line that each word stands in. Line ends: LF, CR LF or CR.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace iga::io {

/// ASCII blanks and line ends, whatever the locale.
constexpr bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

/// Equal but for the case of ASCII letters; `word` is lower case.
bool equals_word(std::string_view token, std::string_view word);

/// The whole token as a number of any usual spelling ("+1.", ".5e-3", "nan"); nothing where it is none. Overflow gives
/// infinity, underflow zero.
template <class Real> std::optional<Real> parse_number(std::string_view token);
extern template std::optional<float> parse_number<float>(std::string_view);
extern template std::optional<double> parse_number<double>(std::string_view);

/// The whole token as an integer; nothing where it is none or does not fit.
std::optional<std::int64_t> parse_integer(std::string_view token);

/// A token for messages: at most 40 characters, '?' for each byte that cannot be shown.
std::string shown(std::string_view token);

/// "found "x" where … is expected", or that the text ends there; with a word on decimal commas where one is meant.
std::string expectation(std::string_view found, std::string_view expected);

/// A text without what some programs put around it: a byte order mark, NUL bytes and Ctrl-Z at its end.
std::string_view without_padding(std::string_view text);

class TextTokens {
 public:
  /// @param comment  starts a comment up to the end of the line; '\0' for formats without comments
  explicit TextTokens(std::string_view text, char comment = '\0') : text_(text), comment_(comment) {}

  /// The next word; empty at the end.
  std::string_view next();
  /// The next word without taking it.
  std::string_view peek();
  /// What remains of the current line, without surrounding blanks and comment.
  std::string_view rest_of_line();
  /// Line of the last word taken, counted from 1; at the end the line behind the last line end.
  std::size_t line() const { return line_; }
  /// Bytes from the start of the text to the end of the last word.
  std::size_t position() const { return at_; }

 private:
  void skip();
  bool at_comment() const { return comment_ != '\0' && text_[at_] == comment_; }

  std::string_view text_;
  char comment_;
  std::size_t at_ = 0, line_ = 1;
};

/// Splits a text into its lines.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : text_(text) {}
  /// The next line without its end; false at the end of the text.
  bool next(std::string_view& line);
  /// Of the last line, counted from 1.
  std::size_t number() const { return number_; }
  /// Bytes from the start of the text to the start of the next line.
  std::size_t position() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0, number_ = 0;
};

} // namespace iga::io
