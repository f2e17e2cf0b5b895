// The header of a PLY file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace iga::io {

enum class PlyFormat { Ascii, Little, Big };
enum class PlyType { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// Bytes of a number.
std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::Float32;   ///< of the number, or of a list's entries
  std::optional<PlyType> count_type; ///< of a list's length; a single number where absent
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Position of the first property of one of these names.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::Ascii;
  std::vector<PlyElement> elements; ///< in the order of their data
  std::size_t size = 0;             ///< bytes up to the data
  std::size_t lines = 0;
};

/// @throws InputError "name: line n: …" for a line that is none of a PLY header, "name: …" for a header without its end
PlyHeader read_ply_header(std::string_view bytes, const std::string& name);

} // namespace iga::io
