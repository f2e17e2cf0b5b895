// Packs chunks of HDF5 datasets outside the library, so that several can be packed at once: the library's own filters
// run on one thread and spend most of their time on bytes that no compression can shrink.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace iga::io {

/// One chunk as it lies in the file after the filters shuffle, deflate (level 1; both only where `compress`) and
/// Fletcher-32, in this order. Any HDF5 library reads it with its own filters; the same bytes give the same chunk.
/// @param chunk  whole elements of `element_size` bytes, in the file's byte order
/// Byte planes of the shuffled chunk that do not shrink (low digits of doubles) are stored as they are, which is valid
/// deflate data. HDF5 file format specification 3.0, section IV.A.2.l, and RFC 1951, section 3.2.4.
std::vector<std::byte> pack_chunk(std::span<const std::byte> chunk, std::size_t element_size, bool compress);

} // namespace iga::io
