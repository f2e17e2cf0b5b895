// Write → read is bit-equal; a failed write leaves nothing behind and keeps the old file.
#include "format/io/trimmed_model_io.hpp"

#include "format/model/errors.hpp"
#include "tests/support/equal_models.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/temp_folder.hpp"

#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

namespace iga {
namespace {

using test::make_box_model;

test::BoxCase rotated_case() {
  test::BoxCase box;
  box.rotation = test::some_rotation(0.4);
  box.degree = {1, 3, 4};
  return box;
}

std::size_t files_in(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator entries(folder);
  return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

TEST(ModelFile, GivesBackEveryBit) {
  const test::TempFolder folder;
  for (const auto& box : {test::BoxCase{}, rotated_case()}) {
    TrimmedModel model = make_box_model(box);
    if (box.degree[0] == 1) test::add_places(model);
    io::write_model(folder / "part.h5", model);
    test::expect_equal(io::read_model(folder / "part.h5"), model);
  }
}

TEST(ModelFile, GivesBackEmptyTextsAndLists) {
  const test::TempFolder folder;
  TrimmedModel model = make_box_model();
  model.title.clear();
  model.provenance = {};
  io::write_model(folder / "part.h5", model);
  test::expect_equal(io::read_model(folder / "part.h5"), model);
}

TEST(ModelFile, GivesBackLongTexts) {
  const test::TempFolder folder;
  TrimmedModel model = make_box_model();
  model.provenance.command_line = std::string(200'000, 'x');
  model.provenance.findings.assign(3000, std::string(90, 'f'));
  io::write_model(folder / "part.h5", model);
  test::expect_equal(io::read_model(folder / "part.h5"), model);
}

TEST(ModelFile, OfAVeryFineGridHoldsNoTableOfControlPoints) {
  const test::TempFolder folder;
  const TrimmedModel model = make_box_model(test::very_fine_case());
  io::write_model(folder / "part.h5", model);
  EXPECT_LT(std::filesystem::file_size(folder / "part.h5"), model.state.size());
  test::expect_equal(io::read_model(folder / "part.h5"), model);
}

TEST(ModelFile, HasTheSameBytesEachTime) {
  const test::TempFolder folder;
  const TrimmedModel model = make_box_model();
  io::write_model(folder / "a.h5", model);
  io::write_model(folder / "b.h5", model);
  EXPECT_EQ(test::read_bytes(folder / "a.h5"), test::read_bytes(folder / "b.h5"));
}

TEST(ModelFile, ProvenanceIsReadByItself) {
  const test::TempFolder folder;
  const TrimmedModel model = make_box_model();
  io::write_model(folder / "part.h5", model);
  test::expect_equal(io::read_provenance(folder / "part.h5"), model.provenance);
}

TEST(ModelFile, ReplacesAnOldFileAndLeavesNothingElse) {
  const test::TempFolder folder;
  std::ofstream(folder / "part.h5") << "old";
  io::write_model(folder / "part.h5", make_box_model());
  EXPECT_NO_THROW(io::read_model(folder / "part.h5"));
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(ModelFile, MissingFileAndFolderAreInputErrors) {
  const test::TempFolder folder;
  EXPECT_THROW(io::read_model(folder / "none.h5"), InputError);
  EXPECT_THROW(io::read_provenance(folder / "none.h5"), InputError);
  EXPECT_THROW(io::read_model(folder.path()), InputError);
  EXPECT_THROW(io::write_model(folder.path(), make_box_model()), InputError);
  try {
    io::write_model(folder / "missing" / "part.h5", make_box_model());
    FAIL() << "written into a folder that does not exist";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("No such file or directory"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("missing"), std::string::npos) << error.what();
  }
}

TEST(ModelFile, UnwritableFolderIsNamed) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  const test::TempFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THROW(io::write_model(folder / "part.h5", make_box_model()), InputError);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(ModelFile, OnlyOrdinaryFilesAreReplaced) {
  EXPECT_THROW(io::write_model("/dev/full", make_box_model()), InputError);
}

// A limit on the size of files stands for a disk that fills up at that byte.
class FullDisk : public testing::TestWithParam<int> {};

TEST_P(FullDisk, KeepsTheOldFileAndSaysWhy) {
  const test::TempFolder folder;
  std::ofstream(folder / "part.h5") << "old";
  const TrimmedModel model = make_box_model(rotated_case());
  const auto whole = [&] {
    io::write_model(folder / "whole.h5", model);
    const auto size = std::filesystem::file_size(folder / "whole.h5");
    std::filesystem::remove(folder / "whole.h5");
    return size;
  }();
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{whole * static_cast<rlim_t>(GetParam()) / 100, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string message;
  try {
    io::write_model(folder / "part.h5", model);
  } catch (const InputError& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
  EXPECT_EQ(test::read_bytes(folder / "part.h5"), "old");
  EXPECT_EQ(files_in(folder.path()), 1u);
  // The library is still fit for work.
  io::write_model(folder / "part.h5", model);
  EXPECT_NO_THROW(io::read_model(folder / "part.h5"));
}

INSTANTIATE_TEST_SUITE_P(AtPercent, FullDisk, testing::Values(0, 1, 30, 60, 90, 99));

} // namespace
} // namespace iga
