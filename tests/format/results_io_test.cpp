// Write → read is bit-equal; an existing file is refused, a failed write leaves nothing behind, damage is not believed.
#include "format/io/results_io.hpp"
#include "format/io/vtp_writer.hpp"

#include "format/model/errors.hpp"
#include "tests/support/equal_results.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/synthetic_results.hpp"
#include "tests/support/temp_folder.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

namespace iga {
namespace {

const TrimmedModel& box() {
  static const TrimmedModel model = test::make_box_model();
  return model;
}

std::size_t files_in(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator entries(folder);
  return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

template <class Action> std::string input_error(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

TEST(ResultsFile, GivesBackEveryBit) {
  const test::TempFolder folder;
  int number = 0;
  for (const Results& results : {test::make_eigen_results(box()), test::make_static_results(box()),
                                 test::make_buckling_results(box()), test::make_full_results(box())}) {
    const auto file = folder / std::to_string(number++);
    io::write_results(file, results, false);
    test::expect_equal(io::read_results(file), results);
  }
}

TEST(ResultsFile, GivesBackWhatIsEmpty) {
  const test::TempFolder folder;
  Results results = test::make_static_results(box());
  results.header.provenance = {};
  results.header.title.clear();
  results.surface.reset();
  StaticResult& s = *results.statics;
  s.probes = {};
  s.loads.clear();
  s.supports.clear();
  s.points.strain.clear();
  io::write_results(folder / "static.h5", results, false);
  test::expect_equal(io::read_results(folder / "static.h5"), results);

  Results none = test::make_eigen_results(box());
  none.surface.reset();
  none.eigen = EigenResult{};
  io::write_results(folder / "none.h5", none, false);
  test::expect_equal(io::read_results(folder / "none.h5"), none);
}

TEST(ResultsFile, HasTheSameBytesEachTime) {
  const test::TempFolder folder;
  const Results results = test::make_full_results(box());
  io::write_results(folder / "a.h5", results, false);
  io::write_results(folder / "b.h5", results, false);
  EXPECT_EQ(test::read_bytes(folder / "a.h5"), test::read_bytes(folder / "b.h5"));
}

TEST(ResultsFile, IsReplacedOnlyWhenAsked) {
  const test::TempFolder folder;
  const auto file = folder / "modes.h5";
  test::write_bytes(file, "of another day");
  const Results results = test::make_eigen_results(box());
  for (const auto& message : {input_error([&] { io::write_results(file, results, false); }),
                              input_error([&] { io::check_results_target(file, false); })}) {
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_NE(message.find("--force"), std::string::npos) << message;
  }
  EXPECT_EQ(test::read_bytes(file), "of another day");
  EXPECT_NO_THROW(io::check_results_target(file, true));
  EXPECT_EQ(test::read_bytes(file), "of another day");
  io::write_results(file, results, true);
  test::expect_equal(io::read_results(file), results);
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(ResultsFile, AFolderThatCannotBeWrittenIsNamedBeforeTheWork) {
  const test::TempFolder folder;
  EXPECT_NE(input_error([&] { io::check_results_target(folder / "missing" / "modes.h5", false); }).find("missing"),
            std::string::npos);
  // Nobody, the superuser included, makes files there.
  EXPECT_NE(input_error([] { io::check_results_target("/proc/modes.h5", false); }).find("/proc"), std::string::npos);
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may write everywhere";
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const auto early = input_error([&] { io::check_results_target(folder / "modes.h5", false); });
  const auto late =
      input_error([&] { io::write_results(folder / "modes.h5", test::make_eigen_results(box()), false); });
  const auto viewer =
      input_error([&] { io::write_viewer_files(folder / "modes.h5", test::make_eigen_results(box()), false); });
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  for (const auto& message : {early, late, viewer}) {
    EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
    EXPECT_NE(message.find("Permission denied"), std::string::npos) << message;
  }
  EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(ResultsFile, AModelIsNoResultsFile) {
  const test::TempFolder folder;
  EXPECT_THROW(io::read_results(folder / "none.h5"), InputError);
  test::write_bytes(folder / "text.h5", "no HDF5 file");
  EXPECT_THROW(io::read_results(folder / "text.h5"), FormatError);
}

TEST(ResultsFile, NumbersThatCannotBeAreRefusedWithTheirPath) {
  const test::TempFolder folder;
  const auto refusal = [&](const Results& results) -> std::string {
    io::write_results(folder / "bad.h5", results, true);
    try {
      io::read_results(folder / "bad.h5");
    } catch (const FormatError& error) {
      return error.what();
    }
    return "was believed";
  };
  const auto expect_refused = [&](const char* path, auto change) {
    Results results = test::make_full_results(box());
    change(results);
    const auto message = refusal(results);
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_NE(message.find("bad.h5"), std::string::npos) << message;
  };
  expect_refused("/modes", [](Results& r) { r.eigen->modes[7] = std::nan(""); });
  expect_refused("/frequencies", [](Results& r) { r.eigen->frequencies[8] = -HUGE_VAL; });
  expect_refused("/surface/steps", [](Results& r) { r.surface->steps[3] = 2.5; });
  expect_refused("/eigen/kind", [](Results& r) { r.eigen->kind[0] = 3; });
  expect_refused("/surface/triangles", [](Results& r) { r.surface->output.mesh.triangles[1][2] = 8; });
  expect_refused("/surface/region", [](Results& r) { r.surface->output.mesh.region[1] = -1; });
  expect_refused("/static/points/stress", [](Results& r) { r.statics->points.stress[3] = HUGE_VAL; });
  expect_refused("/functions/active", [](Results& r) { std::swap(r.active_functions[3], r.active_functions[4]); });
  expect_refused("analysis", [](Results& r) { r.header.analysis = "guess"; });
  expect_refused("/static", [](Results& r) {
    r.header.analysis = "static";
    r.statics.reset();
  });
}

TEST(ResultsFile, DamageIsNeverBelieved) {
  const test::TempFolder folder;
  const Results results = test::make_full_results(box());
  const auto file = folder / "good.h5";
  io::write_results(file, results, false);
  const std::string good = test::read_bytes(file);
  std::mt19937 random(20240301);
  std::uniform_int_distribution<std::size_t> place(0, good.size() - 1);
  const auto read = [&](const std::string& bytes) {
    test::write_bytes(folder / "damaged.h5", bytes);
    try {
      test::expect_equal(io::read_results(folder / "damaged.h5"), results);
      return false;
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find("damaged.h5"), std::string::npos) << error.what();
      return true;
    }
  };
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(read(good.substr(0, place(random))));
  int refused = 0;
  for (int i = 0; i < 150; ++i) {
    std::string bytes = good;
    const std::size_t at = i < 40 ? place(random) % 600 : place(random);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << (i % 8)));
    SCOPED_TRACE(at);
    refused += read(bytes);
  }
  EXPECT_GT(refused, 75);
}

TEST(ViewerFiles, LieBesideTheResultsAndFollowThem) {
  const test::TempFolder folder;
  const auto file = folder / "modes.h5";
  Results results = test::make_eigen_results(box());
  io::write_viewer_files(file, results, false);
  EXPECT_EQ(io::viewer_index(file), folder / "modes.pvd");
  EXPECT_EQ(files_in(folder / "modes_vtp"), 9u);
  EXPECT_NE(input_error([&] { io::write_viewer_files(file, results, false); }).find("modes.pvd"), std::string::npos);
  results.surface = test::make_surface_result(box(), 4);
  io::write_viewer_files(file, results, true);
  EXPECT_EQ(files_in(folder / "modes_vtp"), 4u);
  EXPECT_EQ(files_in(folder.path()), 2u);
}

} // namespace
} // namespace iga
