#include "format/io/obj_reader.hpp"

#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace iga::io {

namespace {

/// Keywords of the OBJ specification (Wavefront 3.0) that say nothing about a mesh's shape.
constexpr std::array passed_over{"vt",     "vn",         "vp",        "o",      "g",     "s",        "mg",
                                 "usemtl", "mtllib",     "usemap",    "maplib", "bevel", "c_interp", "d_interp",
                                 "lod",    "shadow_obj", "trace_obj", "ctech",  "stech", "cstype",   "deg",
                                 "bmat",   "step",       "parm",      "trim",   "hole",  "scrv",     "sp",
                                 "end",    "con",        "curv",      "curv2",  "l",     "p"};

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& name) : lines_(text), name_(name) {}

  PolygonSoup parse() {
    std::string_view line;
    while (next_statement(line)) statement(line);
    check_corners();
    add_notes();
    return std::move(soup_);
  }

 private:
  /// A line with those that continue it.
  bool next_statement(std::string_view& statement) {
    std::string_view line;
    if (!lines_.next(line)) return false;
    line_ = lines_.number();
    statement = line;
    if (!line.ends_with('\\')) return true;
    joined_.clear();
    bool more = true;
    for (; more && line.ends_with('\\'); more = lines_.next(line)) {
      line.remove_suffix(1);
      joined_.append(line).push_back(' ');
    }
    if (more) joined_.append(line);
    statement = joined_;
    return true;
  }

  void statement(std::string_view line) {
    TextTokens tokens(line, '#');
    const std::string_view keyword = tokens.next();
    if (keyword.empty()) return;
    if (keyword == "v")
      vertex(tokens);
    else if (keyword == "f" || keyword == "fo")
      face(tokens);
    else if (keyword == "surf")
      ++surfaces_;
    else if (std::find(passed_over.begin(), passed_over.end(), keyword) == passed_over.end())
      refuse(expectation(keyword, "a keyword of OBJ (v, f, g, …)"));
  }

  void vertex(TextTokens& tokens) {
    if (soup_.points.size() == most_points) refuse("too many vertices; coarsen the mesh");
    Point3 x{};
    for (double& c : x) {
      const std::string_view word = tokens.next();
      const auto value = parse_number<double>(word);
      if (!value || !std::isfinite(*value)) refuse(in_line(word, "a coordinate"));
      c = *value;
    }
    // A weight or a colour may follow.
    for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next())
      if (!parse_number<double>(word)) refuse(in_line(word, "a number or the line's end"));
    soup_.points.push_back(x);
  }

  void face(TextTokens& tokens) {
    const std::size_t first = corners_.size();
    for (std::string_view word = tokens.next(); !word.empty(); word = tokens.next()) corners_.push_back(corner(word));
    if (corners_.size() - first < 3) {
      if (short_faces_++ == 0) first_short_ = line_;
      corners_.resize(first);
      return;
    }
    soup_.offsets.push_back(corners_.size());
    face_line_.push_back(line_);
  }

  /// "7", "7/1", "7//2" or "7/1/2" → 6; counted from the end where negative.
  std::int64_t corner(std::string_view word) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const auto index = parse_integer(word.substr(0, slash));
    if (!index || !are_indices(word.substr(slash))) refuse(in_line(word, "the number of a vertex"));
    if (*index == 0) refuse(fmt::format("found \"{}\": vertices are counted from 1, there is no index 0", shown(word)));
    const auto vertices = static_cast<std::int64_t>(soup_.points.size());
    if (*index < -vertices)
      refuse(fmt::format("found \"{}\", which counts back {} vertices, but only {} stand before it", shown(word),
                         word.substr(1, slash - 1), vertices));
    return *index > 0 ? *index - 1 : vertices + *index;
  }

  /// What follows a vertex number: numbers of texture points and normals, or nothing.
  static bool are_indices(std::string_view rest) {
    for (int n = 0; !rest.empty(); ++n) {
      rest.remove_prefix(1);
      const std::string_view number = rest.substr(0, rest.find('/'));
      if (n == 2 || (!number.empty() && !parse_integer(number))) return false;
      rest.remove_prefix(number.size());
    }
    return true;
  }

  /// Vertices may follow the faces that name them.
  void check_corners() {
    const auto vertices = static_cast<std::int64_t>(soup_.points.size());
    soup_.corners.reserve(corners_.size());
    std::size_t face = 0;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      while (soup_.offsets[face + 1] <= c) ++face;
      line_ = face_line_[face];
      if (corners_[c] >= vertices)
        refuse(fmt::format("a face names vertex \"{}\", the file has {} vertices", corners_[c] + 1, vertices));
      soup_.corners.push_back(static_cast<std::int32_t>(corners_[c]));
    }
  }

  void add_notes() {
    if (short_faces_ > 0)
      soup_.notes.push_back(fmt::format("{} with fewer than three corners left out (the first in line {})",
                                        short_faces_ == 1 ? "1 face" : fmt::format("{} faces", short_faces_),
                                        first_short_));
    if (surfaces_ > 0 && soup_.num_polygons() == 0)
      throw InputError(
          fmt::format("{}: OBJ with {} free-form surfaces and no face; export the part as a mesh", name_, surfaces_));
    if (surfaces_ > 0)
      soup_.notes.push_back(fmt::format("{} free-form surfaces left out: only faces are read", surfaces_));
  }

  static std::string in_line(std::string_view found, std::string_view expected) {
    return found.empty() ? fmt::format("the line ends where {} is expected", expected) : expectation(found, expected);
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: line {}: {}; export the part again", name_, line_, why));
  }

  TextLines lines_;
  const std::string& name_;
  PolygonSoup soup_;
  std::string joined_;
  std::vector<std::int64_t> corners_; // the numbers may lie beyond 32 bits until they are checked
  std::vector<std::size_t> face_line_;
  std::size_t line_ = 0, short_faces_ = 0, first_short_ = 0, surfaces_ = 0;
};

} // namespace

PolygonSoup read_obj(std::string_view bytes, const std::string& name) {
  return ObjParser(without_padding(bytes), name).parse();
}

} // namespace iga::io
