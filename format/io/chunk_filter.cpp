#include "format/io/chunk_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <zlib.h>

namespace iga::io {

namespace {

constexpr int deflate_level = 1; // on doubles higher levels cost much more time than they save space

// A plane of bytes is judged by two samples of this size and stored where they keep more than this share of it: the low
// digits of coordinates, which take nearly all of the time and make the file some 10 % smaller.
constexpr std::size_t sample_size = 4096;
constexpr double worth_packing = 0.8;

// All first bytes of the elements, then all second bytes …
std::vector<std::byte> shuffled(std::span<const std::byte> chunk, std::size_t element_size) {
  const std::size_t count = chunk.size() / element_size;
  std::vector<std::byte> out(chunk.size());
  for (std::size_t b = 0; b < element_size; ++b)
    for (std::size_t e = 0; e < count; ++e) out[b * count + e] = chunk[e * element_size + b];
  return out;
}

const Bytef* input(std::span<const std::byte> bytes) {
  return reinterpret_cast<const Bytef*>(bytes.data());
}

// What deflate would roughly leave of a sample: the entropy of the bytes that no earlier four repeat.
double packed_share(std::span<const std::byte> sample) {
  std::array<std::uint32_t, 1024> seen{}; // last four bytes with this hash
  std::array<int, 256> count{};
  std::size_t repeats = 0;
  for (std::size_t i = 0; i + 4 <= sample.size(); ++i) {
    std::uint32_t four;
    std::memcpy(&four, &sample[i], 4);
    std::uint32_t& last = seen[four * 2654435761u >> 22];
    repeats += last == four;
    last = four;
    ++count[std::to_integer<std::size_t>(sample[i])];
  }
  const auto n = static_cast<double>(sample.size());
  double bits = 0;
  for (const int c : count)
    if (c > 0) bits -= c * std::log2(c / n);
  return (1 - static_cast<double>(repeats) / n) * bits / (8 * n);
}

bool shrinks(std::span<const std::byte> plane) {
  if (plane.size() <= 4 * sample_size) return true;
  return packed_share(plane.first(sample_size)) < worth_packing ||
         packed_share(plane.subspan(plane.size() / 2, sample_size)) < worth_packing;
}

// One deflate stream over all planes; the level changes between planes.
std::vector<std::byte> deflated(std::span<const std::byte> data, std::size_t num_planes) {
  z_stream stream{};
  if (deflateInit(&stream, deflate_level) != Z_OK) throw std::bad_alloc();
  // Stored blocks and changes of level add a few bytes each.
  std::vector<std::byte> out(compressBound(static_cast<uLong>(data.size())) + 64 * (num_planes + 1));
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const std::size_t plane_size = data.size() / num_planes;
  bool good = true;
  int level = deflate_level;
  for (std::size_t p = 0; p < num_planes; ++p) {
    const auto plane = data.subspan(p * plane_size, plane_size);
    const int wanted = shrinks(plane) ? deflate_level : Z_NO_COMPRESSION;
    if (wanted != level) good = good && deflateParams(&stream, wanted, Z_DEFAULT_STRATEGY) == Z_OK;
    level = wanted;
    stream.next_in = const_cast<Bytef*>(input(plane));
    stream.avail_in = static_cast<uInt>(plane.size());
    const int status = deflate(&stream, p + 1 == num_planes ? Z_FINISH : Z_NO_FLUSH);
    good = good && status == (p + 1 == num_planes ? Z_STREAM_END : Z_OK) && stream.avail_in == 0;
  }
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (!good) throw std::logic_error("a chunk could not be packed");
  return out;
}

// As H5_checksum_fletcher32 of the library: big-endian words of 16 bits; an odd last byte is a high one.
std::uint32_t fletcher32(std::span<const std::byte> data) {
  std::uint32_t sum1 = 0, sum2 = 0;
  std::size_t at = 0, words = data.size() / 2;
  const auto fold = [](std::uint32_t sum) { return (sum & 0xffff) + (sum >> 16); };
  while (words > 0) {
    const std::size_t block = std::min<std::size_t>(words, 360); // sums stay below 2^32
    words -= block;
    for (std::size_t w = 0; w < block; ++w, at += 2) {
      sum1 += std::to_integer<std::uint32_t>(data[at]) << 8 | std::to_integer<std::uint32_t>(data[at + 1]);
      sum2 += sum1;
    }
    sum1 = fold(sum1);
    sum2 = fold(sum2);
  }
  if (data.size() % 2) {
    sum1 += std::to_integer<std::uint32_t>(data[at]) << 8;
    sum2 += sum1;
    sum1 = fold(sum1);
    sum2 = fold(sum2);
  }
  sum1 = fold(sum1);
  sum2 = fold(sum2);
  return sum2 << 16 | sum1;
}

} // namespace

std::vector<std::byte> pack_chunk(std::span<const std::byte> chunk, std::size_t element_size, bool compress) {
  std::vector<std::byte> out(chunk.begin(), compress ? chunk.begin() : chunk.end());
  if (compress) out = element_size > 1 ? deflated(shuffled(chunk, element_size), element_size) : deflated(chunk, 1);
  const std::uint32_t sum = fletcher32(out);
  for (int b = 0; b < 4; ++b) out.push_back(static_cast<std::byte>(sum >> (8 * b) & 0xff));
  return out;
}

} // namespace iga::io
