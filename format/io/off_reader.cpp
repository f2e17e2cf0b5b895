#include "format/io/off_reader.hpp"

#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::io {

namespace {

constexpr char comment = '#';

/// The first word taken apart: [ST][C][N][4][n]OFF[count].
struct Magic {
  bool textures = false, colours = false, normals = false, other_dimension = false;
  std::string_view count; ///< digits that follow without a blank
};

/// Nothing where the word is no OFF header.
std::optional<Magic> take_apart(std::string_view word) {
  Magic magic;
  const auto take = [&word](std::string_view prefix) {
    if (!equals_word(word.substr(0, prefix.size()), prefix)) return false;
    word.remove_prefix(prefix.size());
    return true;
  };
  magic.textures = take("st");
  magic.colours = take("c");
  magic.other_dimension = take("4n") || take("4");
  magic.normals = take("n");
  magic.other_dimension = take("4") || magic.other_dimension;
  magic.other_dimension = take("n") || magic.other_dimension;
  if (!take("off")) return std::nullopt;
  if (word.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  magic.count = word;
  return magic;
}

/// How the numbers lie in the lines.
enum class Layout {
  Lines, ///< every vertex and face begins a line; what follows its last number in that line is passed over
  Stream ///< lines mean nothing, and there is nothing to pass over
};

class OffParser {
 public:
  OffParser(std::string_view text, Layout layout, const std::string& name)
      : tokens_(text, comment), layout_(layout), name_(name) {}

  PolygonSoup parse() {
    read_header();
    read_points();
    read_faces();
    if (const std::string_view word = tokens_.next(); !word.empty())
      refuse(fmt::format("found \"{}\" behind the last of the {} faces that the header announces", shown(word),
                         num_faces_));
    if (short_faces_ > 0)
      soup_.notes.push_back(fmt::format("{} with fewer than three corners left out",
                                        short_faces_ == 1 ? "1 face" : fmt::format("{} faces", short_faces_)));
    return std::move(soup_);
  }

 private:
  void read_header() {
    std::string_view first_count;
    if (const auto magic = take_apart(tokens_.peek())) {
      tokens_.next();
      magic_ = *magic;
      first_count = magic->count;
      if (magic->other_dimension) refuse("points of another dimension than three");
      if (equals_word(tokens_.peek(), "binary")) refuse("binary OFF is not read");
    }
    num_points_ = count(first_count.empty() ? tokens_.next() : first_count, "the number of vertices");
    num_faces_ = count(tokens_.next(), "the number of faces");
    // The number of edges counts for nothing and is missing in some files.
    TextTokens ahead = tokens_;
    const std::string_view edges = ahead.next();
    const bool same_line = ahead.line() == tokens_.line();
    if (!edges.empty() && (same_line || ahead.rest_of_line().empty())) count(tokens_.next(), "the number of edges");
  }

  std::uint64_t count(std::string_view word, const std::string& what) {
    const auto value = parse_integer(word);
    if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > most_points) refuse(expectation(word, what));
    return static_cast<std::uint64_t>(*value);
  }

  void read_points() {
    for (std::uint64_t v = 0; v < num_points_; ++v) {
      Point3 x{};
      for (double& c : x) c = coordinate();
      skip_extras((magic_.normals ? 3U : 0U) + (magic_.textures ? 2U : 0U));
      soup_.points.push_back(x);
    }
  }

  void read_faces() {
    for (std::uint64_t f = 0; f < num_faces_; ++f) {
      const std::string_view word = tokens_.next();
      const auto corners = parse_integer(word);
      if (!corners || *corners < 0) refuse(expectation(word, "the number of a face's corners"));
      const std::size_t first = soup_.corners.size();
      for (std::int64_t i = 0; i < *corners; ++i) soup_.corners.push_back(corner());
      if (*corners < 3) {
        ++short_faces_;
        soup_.corners.resize(first);
      } else {
        soup_.offsets.push_back(soup_.corners.size());
      }
      if (layout_ == Layout::Lines) skip_rest_of_line();
    }
  }

  double coordinate() {
    const std::string_view word = tokens_.next();
    const auto value = parse_number<double>(word);
    if (!value || !std::isfinite(*value)) refuse(expectation(word, "a coordinate"));
    return *value;
  }

  std::int32_t corner() {
    const std::string_view word = tokens_.next();
    const auto index = parse_integer(word);
    if (!index) refuse(expectation(word, "the number of a vertex"));
    if (*index < 0 || static_cast<std::uint64_t>(*index) >= num_points_)
      refuse(fmt::format("a face names vertex \"{}\", the file has {} vertices, counted from 0", shown(word),
                         num_points_));
    return static_cast<std::int32_t>(*index);
  }

  void skip_extras(unsigned numbers) {
    if (layout_ == Layout::Lines) return skip_rest_of_line();
    if (magic_.colours) refuse("vertices with colours, each of which must begin a line");
    for (unsigned n = 0; n < numbers; ++n) coordinate();
  }

  void skip_rest_of_line() {
    TextTokens rest(tokens_.rest_of_line());
    for (std::string_view word = rest.next(); !word.empty(); word = rest.next())
      if (!parse_number<double>(word)) refuse(expectation(word, "a number or the line's end"));
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: line {}: {}; export the part again", name_, tokens_.line(), why));
  }

  TextTokens tokens_;
  Layout layout_;
  const std::string& name_;
  Magic magic_;
  PolygonSoup soup_;
  std::uint64_t num_points_ = 0, num_faces_ = 0, short_faces_ = 0;
};

} // namespace

bool looks_like_off(std::string_view bytes) {
  bytes = without_padding(bytes);
  return take_apart(TextTokens(bytes.substr(0, 4096), comment).next()).has_value();
}

PolygonSoup read_off(std::string_view bytes, const std::string& name) {
  const std::string_view text = without_padding(bytes);
  try {
    return OffParser(text, Layout::Lines, name).parse();
  } catch (const InputError& as_lines) {
    try {
      return OffParser(text, Layout::Stream, name).parse();
    } catch (const InputError&) {
      throw as_lines;
    }
  }
}

} // namespace iga::io
