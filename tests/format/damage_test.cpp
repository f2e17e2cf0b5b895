// A truncated or flipped file is refused, or read as if nothing had happened (unused bytes); it never crashes or lies.
#include "format/io/trimmed_model_io.hpp"

#include "format/model/errors.hpp"
#include "tests/support/equal_models.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <random>

namespace iga {
namespace {

enum class Outcome { Refused, Read };

Outcome read_damaged(const std::filesystem::path& file, const TrimmedModel& original) {
  try {
    const TrimmedModel model = io::load_model(file);
    EXPECT_TRUE(check(model).empty());
    test::expect_equal(model, original);
    return Outcome::Read;
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
    return Outcome::Refused;
  }
}

class Damage : public testing::Test {
 protected:
  Damage() {
    io::write_model(folder_ / "good.h5", model_);
    bytes_ = test::read_bytes(folder_ / "good.h5");
  }
  test::TempFolder folder_;
  TrimmedModel model_ = test::make_box_model();
  std::string bytes_;
  std::mt19937 random_{20240229};
};

TEST_F(Damage, TruncationIsRefused) {
  std::uniform_int_distribution<std::size_t> length(0, bytes_.size() - 1);
  for (int i = 0; i < 250; ++i) {
    const std::size_t kept = i < 10 ? static_cast<std::size_t>(i) : length(random_);
    test::write_bytes(folder_ / "cut.h5", bytes_.substr(0, kept));
    EXPECT_EQ(read_damaged(folder_ / "cut.h5", model_), Outcome::Refused) << "cut to " << kept << " bytes";
  }
}

TEST_F(Damage, FlippedBytesAreNeverBelieved) {
  std::uniform_int_distribution<std::size_t> place(0, bytes_.size() - 1);
  std::uniform_int_distribution<int> bit(0, 7);
  int refused = 0;
  for (int i = 0; i < 750; ++i) {
    std::string bytes = bytes_;
    // The first hundreds of bytes (superblock, root group) deserve more than their share.
    const std::size_t at = i < 200 ? place(random_) % 600 : place(random_);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit(random_)));
    SCOPED_TRACE(at);
    test::write_bytes(folder_ / "flipped.h5", bytes);
    refused += read_damaged(folder_ / "flipped.h5", model_) == Outcome::Refused;
  }
  EXPECT_GT(refused, 400);
}

TEST_F(Damage, OverwrittenStretchesAreNeverBelieved) {
  std::uniform_int_distribution<std::size_t> place(0, bytes_.size() - 65);
  std::uniform_int_distribution<int> value(0, 255);
  for (int i = 0; i < 60; ++i) {
    std::string bytes = bytes_;
    const std::size_t at = place(random_);
    for (std::size_t j = 0; j < 64; ++j) bytes[at + j] = static_cast<char>(value(random_));
    SCOPED_TRACE(at);
    test::write_bytes(folder_ / "noise.h5", bytes);
    read_damaged(folder_ / "noise.h5", model_);
  }
}

} // namespace
} // namespace iga
