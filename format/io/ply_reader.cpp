#include "format/io/ply_reader.hpp"

#include "format/io/ply_header.hpp"
#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace iga::io {

namespace {

static_assert(std::endian::native == std::endian::little);

/// Numbers of an ASCII file.
class AsciiNumbers {
 public:
  AsciiNumbers(std::string_view text, std::size_t lines_before, const std::string& name)
      : tokens_(without_padding(text)), lines_before_(lines_before), name_(name) {}

  double next(PlyType type) {
    const std::string_view word = tokens_.next();
    // A float keeps the precision that the header declares, as every other reader of the file sees it.
    const auto value = type == PlyType::Float32 ? widened(parse_number<float>(word)) : parse_number<double>(word);
    if (!value) refuse(word);
    return *value;
  }
  std::string place() const { return fmt::format("line {}", tokens_.line() + lines_before_); }
  /// What stands behind the last number; empty where nothing does.
  std::string rest() {
    const std::string_view word = tokens_.next();
    return word.empty() ? "" : fmt::format("{}: found \"{}\"", place(), shown(word));
  }

 private:
  static std::optional<double> widened(std::optional<float> value) {
    return value ? std::optional<double>(*value) : std::nullopt;
  }
  [[noreturn]] void refuse(std::string_view word) const {
    throw InputError(fmt::format("{}: {}: {}; export the part again", name_, place(), expectation(word, "a number")));
  }

  TextTokens tokens_;
  std::size_t lines_before_;
  const std::string& name_;
};

/// Numbers of a binary file.
class BinaryNumbers {
 public:
  BinaryNumbers(std::string_view bytes, std::size_t bytes_before, bool swapped, const std::string& name)
      : bytes_(bytes), bytes_before_(bytes_before), swapped_(swapped), name_(name) {}

  double next(PlyType type) {
    const std::size_t size = size_of(type);
    if (bytes_.size() - at_ < size)
      throw InputError(fmt::format("{}: truncated: the file ends before all that its PLY header announces; copy or "
                                   "export it again",
                                   name_));
    std::array<char, 8> raw{};
    for (std::size_t b = 0; b < size; ++b) raw[b] = bytes_[at_ + (swapped_ ? size - 1 - b : b)];
    at_ += size;
    return value(raw.data(), type);
  }
  std::string place() const { return fmt::format("byte {}", bytes_before_ + at_); }
  std::string rest() const {
    const std::string_view left = bytes_.substr(at_);
    const bool padding = std::all_of(left.begin(), left.end(), [](char c) { return c == '\0' || is_space(c); });
    return padding ? "" : fmt::format("{}: {} more bytes", place(), left.size());
  }

 private:
  template <class T> static double as(const char* raw) {
    T value{};
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }
  static double value(const char* raw, PlyType type) {
    switch (type) {
    case PlyType::Int8:
      return as<std::int8_t>(raw);
    case PlyType::Uint8:
      return as<std::uint8_t>(raw);
    case PlyType::Int16:
      return as<std::int16_t>(raw);
    case PlyType::Uint16:
      return as<std::uint16_t>(raw);
    case PlyType::Int32:
      return as<std::int32_t>(raw);
    case PlyType::Uint32:
      return as<std::uint32_t>(raw);
    case PlyType::Float32:
      return as<float>(raw);
    default:
      return as<double>(raw);
    }
  }

  std::string_view bytes_;
  std::size_t bytes_before_, at_ = 0;
  bool swapped_;
  const std::string& name_;
};

/// Reads the elements in the order of the header.
template <class Numbers> class PlyData {
 public:
  PlyData(const PlyHeader& header, Numbers numbers, const std::string& name)
      : header_(header), numbers_(std::move(numbers)), name_(name) {}

  PolygonSoup read() {
    const PlyElement& vertex = need("vertex");
    const PlyElement& face = need_faces();
    if (vertex.count > most_points) refuse(fmt::format("{} vertices are too many; coarsen the mesh", vertex.count));
    num_points_ = vertex.count;
    for (const PlyElement& element : header_.elements)
      if (&element == &vertex)
        read_points(element);
      else if (&element == &face)
        read_faces(element);
      else
        pass_over(element);
    if (const std::string rest = numbers_.rest(); !rest.empty())
      refuse(rest +
             " behind all that the header announces; a count in the header may be damaged, export the part again");
    if (short_faces_ > 0)
      soup_.notes.push_back(fmt::format("{} with fewer than three corners left out",
                                        short_faces_ == 1 ? "1 face" : fmt::format("{} faces", short_faces_)));
    return std::move(soup_);
  }

 private:
  const PlyElement* find(std::string_view name) const {
    for (const PlyElement& e : header_.elements)
      if (e.name == name) return &e;
    return nullptr;
  }
  const PlyElement& need(std::string_view name) const {
    if (const PlyElement* element = find(name)) return *element;
    refuse(fmt::format("the PLY header has no element \"{}\"; export the part again as a mesh", name));
  }
  const PlyElement& need_faces() const {
    if (!find("face") && find("tristrips"))
      refuse("the PLY file holds triangle strips, which are not read; export the part again as faces");
    if (!find("face")) refuse("the PLY file is a cloud of points without faces; a closed surface is needed");
    return need("face");
  }

  void read_points(const PlyElement& element) {
    std::array<std::size_t, 3> at{};
    for (std::size_t d = 0; d < 3; ++d) {
      constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
      const auto found = element.find({names[d]});
      if (!found || element.properties[*found].count_type)
        refuse(
            fmt::format("element \"vertex\" of the PLY header has no number \"{}\"; export the part again", names[d]));
      at[d] = *found;
    }
    for (std::uint64_t v = 0; v < element.count; ++v) {
      Point3 x{};
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const auto d = std::find(at.begin(), at.end(), p);
        if (d == at.end()) {
          skip(element.properties[p]);
          continue;
        }
        const double value = numbers_.next(element.properties[p].type);
        if (!std::isfinite(value))
          refuse(fmt::format("vertex {} (counted from 1, {}): a coordinate is {}; export the part again", v + 1,
                             numbers_.place(), value));
        x[static_cast<std::size_t>(d - at.begin())] = value;
      }
      soup_.points.push_back(x);
    }
  }

  void read_faces(const PlyElement& element) {
    const auto corners = element.find({"vertex_indices", "vertex_index"});
    if (!corners || !element.properties[*corners].count_type)
      refuse("element \"face\" of the PLY header has no list \"vertex_indices\"; export the part again");
    for (std::uint64_t f = 0; f < element.count; ++f)
      for (std::size_t p = 0; p < element.properties.size(); ++p)
        if (p == *corners)
          read_corners(element.properties[p], f);
        else
          skip(element.properties[p]);
  }

  void read_corners(const PlyProperty& list, std::uint64_t face) {
    const std::size_t first = soup_.corners.size();
    const std::uint64_t count = length(list);
    for (std::uint64_t i = 0; i < count; ++i) {
      const double index = numbers_.next(list.type);
      if (!(index >= 0) || !(index < static_cast<double>(num_points_)) || index != std::floor(index))
        refuse(fmt::format("{}: face {} (counted from 1) names vertex \"{}\", the file has {} vertices, counted from "
                           "0; export the part again",
                           numbers_.place(), face + 1, index, num_points_));
      soup_.corners.push_back(static_cast<std::int32_t>(index));
    }
    if (count < 3) {
      ++short_faces_;
      soup_.corners.resize(first);
    } else {
      soup_.offsets.push_back(soup_.corners.size());
    }
  }

  void pass_over(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) skip(property);
  }

  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.count_type ? length(property) : 1;
    for (std::uint64_t i = 0; i < count; ++i) numbers_.next(property.type);
  }

  std::uint64_t length(const PlyProperty& list) {
    const double count = numbers_.next(*list.count_type);
    if (!(count >= 0) || !(count <= 4294967295.0) || count != std::floor(count))
      refuse(fmt::format("{}: a list \"{}\" has the length {}; export the part again", numbers_.place(),
                         shown(list.name), count));
    return static_cast<std::uint64_t>(count);
  }

  [[noreturn]] void refuse(const std::string& why) const { throw InputError(fmt::format("{}: {}", name_, why)); }

  const PlyHeader& header_;
  Numbers numbers_;
  const std::string& name_;
  PolygonSoup soup_;
  std::uint64_t num_points_ = 0, short_faces_ = 0;
};

} // namespace

PolygonSoup read_ply(std::string_view bytes, const std::string& name) {
  const PlyHeader header = read_ply_header(bytes, name);
  const std::string_view data = bytes.substr(header.size);
  if (header.format == PlyFormat::Ascii) return PlyData(header, AsciiNumbers(data, header.lines, name), name).read();
  const bool swapped = header.format == PlyFormat::Big;
  return PlyData(header, BinaryNumbers(data, header.size, swapped, name), name).read();
}

} // namespace iga::io
