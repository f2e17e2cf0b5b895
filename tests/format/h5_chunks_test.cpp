// Chunks that are packed outside the library: the library's own filters give back every bit, whatever the shape, and
// the file does not depend on the number of threads.
#include "format/io/h5_file.hpp"

#include "format/model/errors.hpp"
#include "tests/support/temp_folder.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <tbb/global_control.h>

namespace iga {
namespace {

constexpr io::DatasetText text{"/values", "1", "any", "numbers"};
constexpr std::array<io::EnumName, 3> letters{{{"A", 0}, {"B", 1}, {"C", 2}}};

std::int64_t size_of(const io::Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
}

// Smooth and repeated numbers in the first half, digits without any pattern in the second.
std::vector<double> mixed_numbers(std::int64_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> values(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = i < values.size() / 2 ? std::sqrt(static_cast<double>(i % 27)) : uniform(random);
  return values;
}

TEST(H5Chunks, NumbersOfAnyShapeComeBack) {
  const test::TempFolder folder;
  // One short chunk, one long one, many with a rest, rows wider than a chunk, single numbers.
  for (const io::Shape& shape : {io::Shape{3}, io::Shape{9000}, io::Shape{600000, 3}, io::Shape{5, 200000},
                                 io::Shape{3, 7, 50000}, io::Shape{1, 1, 1}}) {
    const std::vector<double> values = mixed_numbers(size_of(shape));
    {
      io::H5Writer file(folder / "a.h5");
      file.dataset<double>(text, shape, values);
      file.commit();
    }
    EXPECT_EQ(io::H5Reader(folder / "a.h5").dataset<double>("/values", shape), values)
        << shape.size() << " " << shape[0];
  }
}

TEST(H5Chunks, StatesOfLargeGridsComeBack) {
  const test::TempFolder folder;
  // Many layers to a chunk with a rest, and layers larger than a chunk.
  for (const io::Shape& shape : {io::Shape{40, 300, 301}, io::Shape{3, 1201, 1103}}) {
    std::vector<std::uint8_t> values(static_cast<std::size_t>(size_of(shape)));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint8_t>(i / 1000 % 3);
    {
      io::H5Writer file(folder / "a.h5");
      file.enums(text, shape, values, letters);
      file.commit();
    }
    EXPECT_EQ(io::H5Reader(folder / "a.h5").enums("/values", shape, letters), values);
    EXPECT_LT(std::filesystem::file_size(folder / "a.h5"), values.size() / 20);
  }
}

TEST(H5Chunks, SameBytesForAnyNumberOfThreads) {
  const test::TempFolder folder;
  const std::vector<double> values = mixed_numbers(6'000'000); // more chunks than are packed at once
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    io::H5Writer file(folder / std::to_string(threads));
    file.dataset<double>(text, {2'000'000, 3}, values);
    file.commit();
  }
  const std::string one = test::read_bytes(folder / "1");
  EXPECT_TRUE(one == test::read_bytes(folder / "2"));
  EXPECT_TRUE(one == test::read_bytes(folder / "5"));
}

TEST(H5Chunks, FlippedBitIsRefused) {
  const test::TempFolder folder;
  {
    io::H5Writer file(folder / "a.h5");
    file.dataset<double>(text, {100000}, mixed_numbers(100000));
    file.commit();
  }
  std::string bytes = test::read_bytes(folder / "a.h5");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 8);
  test::write_bytes(folder / "a.h5", bytes);
  EXPECT_THROW(io::H5Reader(folder / "a.h5").dataset<double>("/values", {100000}), FormatError);
}

} // namespace
} // namespace iga
