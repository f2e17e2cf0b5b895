#include "format/io/ply_header.hpp"

#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace iga::io {

namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array type_names{
    TypeName{"char", PlyType::Int8},       TypeName{"int8", PlyType::Int8},       TypeName{"uchar", PlyType::Uint8},
    TypeName{"uint8", PlyType::Uint8},     TypeName{"short", PlyType::Int16},     TypeName{"int16", PlyType::Int16},
    TypeName{"ushort", PlyType::Uint16},   TypeName{"uint16", PlyType::Uint16},   TypeName{"int", PlyType::Int32},
    TypeName{"int32", PlyType::Int32},     TypeName{"uint", PlyType::Uint32},     TypeName{"uint32", PlyType::Uint32},
    TypeName{"float", PlyType::Float32},   TypeName{"float32", PlyType::Float32}, TypeName{"double", PlyType::Float64},
    TypeName{"float64", PlyType::Float64},
};

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& name) : bytes_(bytes), lines_(bytes), name_(name) {}

  PlyHeader parse() {
    std::string_view line;
    if (!lines_.next(line) || TextTokens(line).next() != "ply") refuse("a PLY file starts with a line \"ply\"");
    while (lines_.next(line)) {
      TextTokens tokens(line);
      const std::string_view keyword = tokens.next();
      if (keyword == "end_header") return finish();
      if (keyword == "format")
        format(tokens);
      else if (keyword == "element")
        element(tokens);
      else if (keyword == "property")
        property(tokens);
      else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty())
        refuse(expectation(keyword, "format, element, property, comment, obj_info or end_header"));
    }
    throw InputError(fmt::format("{}: truncated: the PLY header ends in line {} without \"end_header\"; copy or export "
                                 "the file again",
                                 name_, lines_.number()));
  }

 private:
  PlyHeader finish() {
    if (!has_format_) refuse("the PLY header has no line \"format …\"");
    // Lines that end with CR alone end so here too, even where the data begin with the byte of LF.
    const std::size_t first_end = bytes_.find_first_of("\r\n");
    const bool bare_cr = bytes_[first_end] == '\r' && bytes_.substr(first_end + 1, 1) != "\n";
    header_.size = lines_.position();
    if (bare_cr && bytes_.substr(header_.size - 2, 2) == "\r\n") --header_.size;
    header_.lines = lines_.number();
    return std::move(header_);
  }

  void format(TextTokens& tokens) {
    const std::string_view word = tokens.next();
    if (word == "ascii")
      header_.format = PlyFormat::Ascii;
    else if (word == "binary_little_endian")
      header_.format = PlyFormat::Little;
    else if (word == "binary_big_endian")
      header_.format = PlyFormat::Big;
    else
      refuse(in_line(word, "ascii, binary_little_endian or binary_big_endian"));
    if (const std::string_view version = tokens.next(); version != "1.0") refuse(in_line(version, "version 1.0"));
    has_format_ = true;
  }

  void element(TextTokens& tokens) {
    const std::string_view word = tokens.next();
    if (word.empty()) refuse(in_line(word, "the name of an element"));
    for (const PlyElement& e : header_.elements)
      if (e.name == word) refuse(fmt::format("a second element \"{}\"", shown(word)));
    const std::string_view number = tokens.next();
    const auto count = parse_integer(number);
    if (!count || *count < 0) refuse(in_line(number, "a count, 0 or more"));
    header_.elements.push_back({std::string(word), static_cast<std::uint64_t>(*count), {}});
  }

  void property(TextTokens& tokens) {
    if (header_.elements.empty()) refuse("found \"property\" before any line \"element NAME COUNT\"");
    PlyProperty p;
    std::string_view word = tokens.next();
    if (word == "list") {
      p.count_type = type(tokens.next());
      if (*p.count_type == PlyType::Float32 || *p.count_type == PlyType::Float64)
        refuse("the length of a list cannot be a float");
      word = tokens.next();
    }
    p.type = type(word);
    p.name = tokens.next();
    if (p.name.empty()) refuse(in_line("", "the name of a property"));
    header_.elements.back().properties.push_back(std::move(p));
  }

  PlyType type(std::string_view word) const {
    const auto found =
        std::find_if(type_names.begin(), type_names.end(), [&](const TypeName& t) { return t.name == word; });
    if (found == type_names.end())
      refuse(in_line(word, "a type (char, uchar, short, ushort, int, uint, float or double)"));
    return found->type;
  }

  static std::string in_line(std::string_view found, std::string_view expected) {
    return found.empty() ? fmt::format("the line ends where {} is expected", expected) : expectation(found, expected);
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(
        fmt::format("{}: line {}: {}; export the part again", name_, std::max<std::size_t>(lines_.number(), 1), why));
  }

  std::string_view bytes_;
  TextLines lines_;
  const std::string& name_;
  PlyHeader header_;
  bool has_format_ = false;
};

} // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
  case PlyType::Int8:
  case PlyType::Uint8:
    return 1;
  case PlyType::Int16:
  case PlyType::Uint16:
    return 2;
  case PlyType::Float64:
    return 8;
  default:
    return 4;
  }
}

std::optional<std::size_t> PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t p = 0; p < properties.size(); ++p)
    for (const std::string_view wanted : names)
      if (properties[p].name == wanted) return p;
  return std::nullopt;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& name) {
  return HeaderParser(bytes, name).parse();
}

} // namespace iga::io
