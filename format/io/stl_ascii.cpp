#include "format/io/stl_ascii.hpp"

#include "format/io/stl_builder.hpp"
#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace iga::io {

namespace {

class AsciiParser {
 public:
  AsciiParser(std::string_view text, const std::string& name, double scale)
      : tokens_(text), name_(name), builder_(name, scale) {
    builder_.reserve(text.size() / 200); // bytes of a facet as programs write them
  }

  StlMesh parse() {
    for (std::string_view word = tokens_.next(); !word.empty(); word = tokens_.next()) {
      if (equals_word(word, "solid")) {
        builder_.begin_region(tokens_.rest_of_line());
        open_ = true;
      } else if (equals_word(word, "endsolid") || equals_word(word, "end")) {
        tokens_.rest_of_line();
        open_ = false;
      } else if (equals_word(word, "facet")) {
        if (!open_) builder_.begin_region("");
        open_ = true;
        facet();
      } else if (!open_) {
        pass_over_tail(word);
        break;
      } else {
        fail(word, "\"facet\" or \"endsolid\"");
      }
    }
    if (open_) builder_.note("the last solid has no \"endsolid\"; its facets are complete");
    return builder_.finish("ASCII STL");
  }

 private:
  void facet() {
    Point3 normal{};
    if (equals_word(tokens_.peek(), "normal")) {
      tokens_.next();
      for (double& n : normal) {
        if (equals_word(tokens_.peek(), "outer")) break;
        const auto value = parse_number<double>(tokens_.next());
        n = value ? *value : std::numeric_limits<double>::quiet_NaN();
      }
    }
    expect("outer");
    expect("loop");
    std::array<Point3, 3> corners{};
    for (Point3& corner : corners) {
      expect("vertex");
      for (double& x : corner) {
        const std::string_view word = tokens_.next();
        const auto value = parse_number<double>(word);
        if (!value) fail(word, "a coordinate");
        x = *value;
      }
    }
    if (equals_word(tokens_.peek(), "vertex"))
      throw InputError(fmt::format("{}: line {}: a facet with more than three vertices; STL knows triangles only, "
                                   "export the part again",
                                   name_, tokens_.line()));
    expect("endloop");
    expect("endfacet");
    builder_.add(normal, corners);
  }

  void expect(std::string_view wanted) {
    const std::string_view word = tokens_.next();
    if (!equals_word(word, wanted)) fail(word, fmt::format("\"{}\"", wanted));
  }

  /// Notes of other programs may follow the last solid, more geometry may not.
  void pass_over_tail(std::string_view first) {
    const std::size_t line = tokens_.line();
    for (std::string_view word = first; !word.empty(); word = tokens_.next()) {
      const bool text = std::none_of(word.begin(), word.end(), [](char c) { return c >= 0 && c < ' '; });
      if (!text || equals_word(word, "facet") || equals_word(word, "vertex"))
        throw InputError(fmt::format("{}: line {}: behind the last solid follows something else than a solid, perhaps "
                                     "another file (found \"{}\"); give one file, or export the part again",
                                     name_, line, shown(first)));
    }
    builder_.note(fmt::format("text after the last solid (line {}) was ignored", line));
  }

  [[noreturn]] void fail(std::string_view found, const std::string& wanted) {
    if (found.empty())
      throw InputError(fmt::format("{}: truncated: the text ends in line {} where {} was expected; copy or export the "
                                   "file again",
                                   name_, tokens_.line(), wanted));
    throw InputError(
        fmt::format("{}: line {}: {}; export the part again", name_, tokens_.line(), expectation(found, wanted)));
  }

  TextTokens tokens_;
  const std::string& name_;
  StlBuilder builder_;
  bool open_ = false;
};

} // namespace

StlMesh read_ascii_stl(std::string_view text, const std::string& name, double scale) {
  return AsciiParser(text, name, scale).parse();
}

} // namespace iga::io
