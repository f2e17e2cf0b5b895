// Runs a harness over the files of its corpus, without a fuzzer: what once went wrong stays mended.
//   replay FOLDER [FILE …]
// A crash, an exception that is no refusal, 10 s on one file or more than 1 GiB in all fail.
#include "tests/fuzz/fuzz_input.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sys/resource.h>
#include <vector>

namespace {

constexpr double longest = 10;              // seconds
constexpr long most_memory = 1024L * 1024L; // KiB

std::vector<std::filesystem::path> files_below(int argc, char** argv) {
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    if (!std::filesystem::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[i]))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

double seconds_for(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  const auto start = std::chrono::steady_clock::now();
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

int main(int argc, char** argv) {
  const auto files = files_below(argc, argv);
  bool good = !files.empty();
  for (const auto& file : files) {
    // Said first, so that the name of a file that crashes is the last line.
    fmt::print("{}\n", file.string());
    std::fflush(stdout);
    if (const double taken = seconds_for(file); taken > longest) {
      fmt::print("  took {:.1f} s\n", taken);
      good = false;
    }
  }
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  fmt::print("{} files, {} MiB at most\n", files.size(), used.ru_maxrss / 1024);
  return good && used.ru_maxrss < most_memory ? 0 : 1;
}
