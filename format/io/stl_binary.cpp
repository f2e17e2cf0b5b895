#include "format/io/stl_binary.hpp"

#include "format/io/stl_builder.hpp"
#include "format/io/text_tokens.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <bit>
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

/// One binary STL: where it begins in the bytes and how many facets its header announces.
struct BinaryPart {
  std::size_t start = 0, count = 0;
  std::size_t end() const { return start + header_size + facet_size * count; }
};

/// The facets that the header at `start` announces.
std::size_t announced(std::string_view bytes, std::size_t start) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + start + 80, sizeof count);
  return count;
}

/// The part that begins at `start`; nothing where the bytes end before it does.
std::optional<BinaryPart> binary_part(std::string_view bytes, std::size_t start) {
  if (bytes.size() - start < header_size) return std::nullopt;
  const BinaryPart part{start, announced(bytes, start)};
  return part.end() <= bytes.size() ? std::optional(part) : std::nullopt;
}

class BinaryParser {
 public:
  BinaryParser(std::string_view bytes, BinaryPart first, const std::string& name, double scale)
      : bytes_(bytes), name_(name), builder_(name, scale), parts_{first} {}

  StlMesh parse() {
    find_what_follows();
    builder_.reserve(bytes_.size() / facet_size);
    for (const BinaryPart& part : parts_) {
      builder_.begin_region("");
      for (std::size_t f = 0; f < part.count; ++f) {
        const Facet facet = read_facet(part.start + header_size + facet_size * f);
        builder_.add(facet.normal, facet.corners);
      }
    }
    return builder_.finish("binary STL");
  }

 private:
  struct Facet {
    Point3 normal;
    std::array<Point3, 3> corners;
  };
  Facet read_facet(std::size_t at) const {
    std::array<float, 12> raw{};
    std::memcpy(raw.data(), bytes_.data() + at, sizeof raw);
    const auto point = [&](std::size_t i) { return Point3{raw[3 * i], raw[3 * i + 1], raw[3 * i + 2]}; };
    return {point(0), {point(1), point(2), point(3)}};
  }

  /// What stands behind the announced facets may be geometry too: further facets or further files. Short padding and
  /// text are passed over with a note, all else is refused.
  void find_what_follows() {
    const std::size_t end = parts_.front().end();
    const std::string_view tail = bytes_.substr(end);
    if (tail.empty() || add_parts(end)) return;
    const bool padding = std::all_of(tail.begin(), tail.end(), [](char c) { return c == '\0'; });
    const bool text =
        std::all_of(tail.begin(), tail.end(), [](char c) { return is_space(c) || (c >= ' ' && c <= '~'); });
    if (text && looks_like_ascii_stl(tail))
      refuse_tail("follows an ASCII STL; give the two files one by one, or join them in one format");
    if (padding || text || tail.size() < facet_size) {
      builder_.note(fmt::format("{} bytes after the last facet were ignored{}", tail.size(),
                                padding ? " (all zero)"
                                : text  ? fmt::format(" (text: \"{}\")", shown(TextTokens(tail).rest_of_line()))
                                        : ""));
      return;
    }
    const std::size_t more = tail.size() / facet_size;
    if (tail.size() % facet_size != 0 || !are_facets(end, more))
      refuse_tail(fmt::format("follow {} more bytes, which are neither whole facets nor another STL; the count or the "
                              "file is damaged, export the part again",
                              tail.size()));
    builder_.note(fmt::format("the header announces {} facets, but {} more follow them; they were read too",
                              parts_.front().count, more));
    parts_.front().count += more;
  }

  /// Complete files one after the other, as "cat a.stl b.stl" makes them.
  bool add_parts(std::size_t at) {
    std::vector<BinaryPart> found;
    while (at < bytes_.size()) {
      const auto part = binary_part(bytes_, at);
      if (!part || part->count == 0) return false;
      found.push_back(*part);
      at = part->end();
    }
    parts_.insert(parts_.end(), found.begin(), found.end());
    builder_.note(fmt::format("{} binary STL files stand one after the other in it; all were read", parts_.size()));
    return true;
  }

  /// Corners that are numbers of a size like those of the announced facets.
  bool are_facets(std::size_t at, std::size_t count) const {
    constexpr double larger = 1000;
    const BinaryPart& first = parts_.front();
    double most = 0;
    for (std::size_t f = 0; f < first.count; ++f)
      most = std::max(most, extent(first.start + header_size + facet_size * f));
    for (std::size_t f = 0; f < count; ++f)
      if (!(extent(at + facet_size * f) <= (first.count > 0 ? larger * most : std::numeric_limits<float>::max())))
        return false;
    return true;
  }
  /// Largest coordinate of a facet's corners; infinite where one is no number.
  double extent(std::size_t at) const {
    double most = 0;
    for (const Point3& x : read_facet(at).corners)
      for (const double c : x)
        most = std::max(most, std::isfinite(c) ? std::abs(c) : std::numeric_limits<double>::infinity());
    return most;
  }

  [[noreturn]] void refuse_tail(const std::string& what) const {
    if (parts_.front().count == 0)
      throw InputError(
          fmt::format("{}: not an STL file: no \"solid\" at its start, and as binary STL it would announce 0 "
                      "facets in {} bytes; give an STL, OBJ, PLY or OFF file",
                      name_, bytes_.size()));
    throw InputError(
        fmt::format("{}: behind the {} facets that the header announces {}", name_, parts_.front().count, what));
  }

  std::string_view bytes_;
  const std::string& name_;
  StlBuilder builder_;
  std::vector<BinaryPart> parts_;
};

[[noreturn]] void refuse_short(std::string_view bytes, const std::string& name) {
  if (bytes.size() < header_size)
    throw InputError(
        fmt::format("{}: not an STL file: {} bytes that do not start with \"solid\", and a binary STL has at "
                    "least {}; give an STL, OBJ, PLY or OFF file",
                    name, bytes.size(), header_size));
  const std::size_t count = announced(bytes, 0);
  const std::size_t expected = header_size + facet_size * count;
  // A cut-off file announces about as much as it holds; anything else is some other format.
  const bool plausible = bytes.size() >= header_size + facet_size && expected / bytes.size() < 1000;
  if (plausible)
    throw InputError(
        fmt::format("{}: truncated: the header announces {} facets ({} bytes), the file has {} bytes; copy "
                    "or export it again",
                    name, count, expected, bytes.size()));
  throw InputError(fmt::format("{}: not an STL file: no \"solid\" at its start, and read as binary its {} bytes would "
                               "announce {} facets ({} bytes); give an STL, OBJ, PLY or OFF file",
                               name, bytes.size(), count, expected));
}

} // namespace

bool is_whole_binary_stl(std::string_view bytes) {
  const auto part = binary_part(bytes, 0);
  return part && part->end() == bytes.size();
}

StlMesh read_binary_stl(std::string_view bytes, const std::string& name, double scale) {
  const auto first = binary_part(bytes, 0);
  if (!first) refuse_short(bytes, name);
  return BinaryParser(bytes, *first, name, scale).parse();
}

} // namespace iga::io
