#include "format/io/stl_reader.hpp"

#include "format/model/errors.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <optional>

namespace iga::io {

namespace {

constexpr std::size_t header_size = 84; // 80 bytes of text, facet count
constexpr std::size_t facet_size = 50;  // normal and three corners as float32, two attribute bytes

static_assert(std::endian::native == std::endian::little, "binary STL is read without swapping bytes");

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}
char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// `word` is lower case.
bool equals(std::string_view token, std::string_view word) {
  return token.size() == word.size() &&
         std::equal(token.begin(), token.end(), word.begin(), [](char a, char b) { return lower(a) == b; });
}

/// Words of a text, with the line that the last one stood in.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {}

  /// The next word; empty at the end.
  std::string_view next() {
    skip();
    const std::size_t first = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(first, at_ - first);
  }
  std::string_view peek() {
    const std::size_t at = at_, line = line_;
    const std::string_view word = next();
    at_ = at;
    line_ = line;
    return word;
  }
  /// What remains of the current line, without surrounding blanks.
  std::string_view rest_of_line() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    const std::size_t first = at_;
    while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
    std::size_t last = at_;
    while (last > first && is_space(text_[last - 1])) --last;
    return text_.substr(first, last - first);
  }
  std::size_t line() const { return line_; }

 private:
  void skip() {
    while (at_ < text_.size() && is_space(text_[at_])) {
      const bool bare_cr = text_[at_] == '\r' && (at_ + 1 == text_.size() || text_[at_ + 1] != '\n');
      if (text_[at_] == '\n' || bare_cr) ++line_;
      ++at_;
    }
  }
  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
};

/// A number of any usual spelling; from_chars knows no leading '+'. Overflow gives infinity, underflow zero.
std::optional<double> number(std::string_view token) {
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (end != token.data() + token.size() || token.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const auto e = token.find_first_of("eE");
    const bool small = e != std::string_view::npos && e + 1 < token.size() && token[e + 1] == '-';
    return small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  if (error != std::errc{}) return std::nullopt;
  return value;
}

bool finite(const Point3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/// Collects facets; three vertices of its own for each.
class Builder {
 public:
  Builder(const std::string& name, double scale) : name_(name), scale_(scale) { out_.mesh.region_names.clear(); }

  void reserve(std::size_t facets) {
    out_.mesh.vertices.reserve(3 * facets);
    out_.mesh.triangles.reserve(facets);
    out_.mesh.region.reserve(facets);
    out_.facet_normals.reserve(facets);
  }
  void begin_region(std::string_view wanted) {
    std::string text = wanted.empty() ? "surface" : std::string(wanted);
    const auto taken = [&](const std::string& t) {
      return std::find(out_.mesh.region_names.begin(), out_.mesh.region_names.end(), t) != out_.mesh.region_names.end();
    };
    for (int n = 2; taken(text); ++n) text = fmt::format("{}_{}", wanted.empty() ? "surface" : wanted, n);
    out_.mesh.region_names.push_back(text);
  }
  void add(const Point3& normal, const std::array<Point3, 3>& corners) {
    const auto facet = out_.mesh.triangles.size();
    for (const Point3& c : corners) {
      const Point3 x{c[0] * scale_, c[1] * scale_, c[2] * scale_};
      if (!finite(x))
        throw InputError(fmt::format("{}: facet {} (counted from 1) has the vertex ({} {} {}), which is not a finite "
                                     "position; export the part again",
                                     name_, facet + 1, c[0], c[1], c[2]));
      out_.mesh.vertices.push_back(x);
    }
    const auto v = static_cast<std::int32_t>(3 * facet);
    out_.mesh.triangles.push_back({v, v + 1, v + 2});
    out_.mesh.region.push_back(static_cast<std::int32_t>(out_.mesh.region_names.size()) - 1);
    if (!finite(normal)) ++odd_normals_;
    out_.facet_normals.push_back(finite(normal) ? normal : Point3{});
  }
  void note(std::string text) { out_.notes.push_back(std::move(text)); }

  StlMesh finish(std::string format) {
    if (out_.mesh.triangles.empty())
      throw InputError(fmt::format("{}: {} without any facet; a closed surface needs at least four: export the part "
                                   "again",
                                   name_, format));
    drop_empty_regions();
    if (odd_normals_ > 0)
      note(fmt::format("{} stored facet normals are not numbers; normals come from the vertices", odd_normals_));
    out_.format = std::move(format);
    return std::move(out_);
  }

 private:
  void drop_empty_regions() {
    std::vector<std::int32_t> used(out_.mesh.region_names.size(), -1);
    for (std::int32_t r : out_.mesh.region) used[static_cast<std::size_t>(r)] = 0;
    std::vector<std::string> names;
    for (std::size_t r = 0; r < used.size(); ++r)
      if (used[r] == 0) {
        used[r] = static_cast<std::int32_t>(names.size());
        names.push_back(out_.mesh.region_names[r]);
      }
    for (std::int32_t& r : out_.mesh.region) r = used[static_cast<std::size_t>(r)];
    out_.mesh.region_names = std::move(names);
  }

  const std::string& name_;
  double scale_;
  StlMesh out_;
  std::size_t odd_normals_ = 0;
};

std::uint32_t binary_count(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

void check_facet_limit(const std::string& name, std::size_t facets) {
  constexpr std::size_t limit = std::numeric_limits<std::int32_t>::max() / 3;
  if (facets > limit)
    throw InputError(fmt::format("{}: {} facets, at most {} can be read; coarsen the mesh", name, facets, limit));
}

StlMesh read_binary(std::string_view bytes, const std::string& name, double scale) {
  const std::size_t count = binary_count(bytes);
  check_facet_limit(name, count);
  const std::size_t expected = header_size + facet_size * count;
  Builder builder(name, scale);
  if (bytes.size() > expected)
    builder.note(fmt::format("{} bytes after the last facet were ignored", bytes.size() - expected));
  builder.reserve(count);
  builder.begin_region("");
  for (std::size_t f = 0; f < count; ++f) {
    std::array<float, 12> raw{};
    std::memcpy(raw.data(), bytes.data() + header_size + facet_size * f, sizeof raw);
    const auto point = [&](std::size_t i) { return Point3{raw[3 * i], raw[3 * i + 1], raw[3 * i + 2]}; };
    builder.add(point(0), {point(1), point(2), point(3)});
  }
  return builder.finish("binary STL");
}

class AsciiParser {
 public:
  AsciiParser(std::string_view text, const std::string& name, double scale)
      : tokens_(text), name_(name), builder_(name, scale) {
    check_facet_limit(name, text.size() / 60);
    builder_.reserve(text.size() / 200);
  }

  StlMesh parse() {
    for (std::string_view word = tokens_.next(); !word.empty(); word = tokens_.next()) {
      if (equals(word, "solid")) {
        builder_.begin_region(tokens_.rest_of_line());
        open_ = true;
      } else if (equals(word, "endsolid") || equals(word, "end")) {
        tokens_.rest_of_line();
        open_ = false;
      } else if (equals(word, "facet")) {
        if (!open_) builder_.begin_region("");
        open_ = true;
        facet();
      } else if (!open_) {
        builder_.note(fmt::format("text after the last solid (line {}) was ignored", tokens_.line()));
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
    if (equals(tokens_.peek(), "normal")) {
      tokens_.next();
      for (double& n : normal) {
        if (equals(tokens_.peek(), "outer")) break;
        const auto value = number(tokens_.next());
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
        const auto value = number(word);
        if (!value) fail(word, "a coordinate");
        x = *value;
      }
    }
    if (equals(tokens_.peek(), "vertex"))
      throw InputError(fmt::format("{}: line {}: a facet with more than three vertices; STL knows triangles only, "
                                   "export the part again",
                                   name_, tokens_.line()));
    expect("endloop");
    expect("endfacet");
    builder_.add(normal, corners);
  }

  void expect(std::string_view wanted) {
    const std::string_view word = tokens_.next();
    if (!equals(word, wanted)) fail(word, fmt::format("\"{}\"", wanted));
  }

  [[noreturn]] void fail(std::string_view found, const std::string& wanted) {
    if (found.empty())
      throw InputError(fmt::format("{}: truncated: the text ends in line {} where {} was expected; copy or export the "
                                   "file again",
                                   name_, tokens_.line(), wanted));
    throw InputError(fmt::format("{}: line {}: found \"{}\" where an ASCII STL has {}; export the part again", name_,
                                 tokens_.line(), found.substr(0, 40), wanted));
  }

  Tokens tokens_;
  const std::string& name_;
  Builder builder_;
  bool open_ = false;
};

/// A text without the NUL bytes and end-of-file marks (Ctrl-Z) that some programs pad it with.
std::string_view without_padding(std::string_view text) {
  const auto last = text.find_last_not_of(std::string_view("\0\x1A", 2));
  return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

} // namespace

bool looks_like_ascii_stl(std::string_view bytes) {
  bytes = without_padding(bytes);
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (bytes.substr(0, 3) == byte_order_mark) bytes.remove_prefix(3);
  const std::string_view head = bytes.substr(0, 4096);
  if (head.find('\0') != std::string_view::npos) return false;
  Tokens tokens(head);
  if (!equals(tokens.next(), "solid")) return false;
  tokens.rest_of_line();
  const std::string_view second = tokens.next();
  return second.empty() || equals(second, "facet") || equals(second, "endsolid");
}

StlMesh read_stl(std::string_view bytes, const std::string& name, double scale) {
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty; export the part again", name));
  if (looks_like_ascii_stl(bytes)) {
    if (bytes.substr(0, 3) == "\xEF\xBB\xBF") bytes.remove_prefix(3);
    return AsciiParser(without_padding(bytes), name, scale).parse();
  }
  if (bytes.size() < header_size)
    throw InputError(
        fmt::format("{}: not an STL file: {} bytes that do not start with \"solid\", and a binary STL has at "
                    "least {}; give an STL, OBJ, PLY or OFF file",
                    name, bytes.size(), header_size));
  const std::size_t count = binary_count(bytes);
  const std::size_t expected = header_size + facet_size * count;
  if (bytes.size() < expected) {
    // A cut-off file still reads as facets with finite corners; anything else is some other format.
    const bool plausible = bytes.size() >= header_size + facet_size && expected / bytes.size() < 1000;
    if (plausible)
      throw InputError(
          fmt::format("{}: truncated: the header announces {} facets ({} bytes), the file has {} bytes; copy "
                      "or export it again",
                      name, count, expected, bytes.size()));
    throw InputError(
        fmt::format("{}: not an STL file: no \"solid\" at its start, and read as binary its {} bytes would "
                    "announce {} facets ({} bytes); give an STL, OBJ, PLY or OFF file",
                    name, bytes.size(), count, expected));
  }
  return read_binary(bytes, name, scale);
}

} // namespace iga::io
