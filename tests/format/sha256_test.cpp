#include "format/io/sha256.hpp"

#include "format/model/errors.hpp"
#include "tests/support/temp_folder.hpp"

#include <gtest/gtest.h>

namespace iga {
namespace {

// FIPS 180-4 examples.
TEST(Sha256, MatchesThePublishedExamples) {
  EXPECT_EQ(io::sha256_text(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(io::sha256_text("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, FilesAndTextsAgree) {
  const test::TempFolder folder;
  const std::string bytes(3'000'000, 'a');
  test::write_bytes(folder / "file", bytes);
  EXPECT_EQ(io::sha256_file(folder / "file"), io::sha256_text(bytes));
  EXPECT_THROW(io::sha256_file(folder / "none"), InputError);
}

} // namespace
} // namespace iga
