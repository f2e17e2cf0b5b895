#include "solver/linalg/free_memory.hpp"

#include "format/model/errors.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace iga::solve {

namespace {

namespace fs = std::filesystem;

// First number after `key` in a file of lines "key number"; the first number of the file where key is empty. Nothing
// where the file is not there or says "max".
std::optional<double> number_in(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  std::string word;
  if (!key.empty())
    while (in >> word && word != key) in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  double value = 0;
  if (in >> value) return value;
  return {};
}

// What a control group and the groups around it leave. Pages of files count as used but are given back when needed.
double left_in_groups(const fs::path& root, const std::string& group, const char* limit_name, const char* used_name,
                      const char* cache_key) {
  double left = std::numeric_limits<double>::infinity();
  fs::path path = group;
  for (;;) {
    const fs::path folder = root / path.relative_path();
    const auto limit = number_in(folder / limit_name, ""), used = number_in(folder / used_name, "");
    if (limit && used) left = std::min(left, *limit - *used + number_in(folder / "memory.stat", cache_key).value_or(0));
    if (!path.has_relative_path()) return left;
    path = path.parent_path();
  }
}

double left_in_all_groups() {
  double left = std::numeric_limits<double>::infinity();
  std::ifstream in("/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (controllers.empty())
      left = std::min(left, left_in_groups("/sys/fs/cgroup", group, "memory.max", "memory.current", "inactive_file"));
    else if (controllers == "memory")
      left = std::min(left, left_in_groups("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes",
                                           "memory.usage_in_bytes", "total_inactive_file"));
  }
  return left;
}

double left_in_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<double>::infinity();
  rlimit stack{};
  constexpr double usual_stack = 8 << 20, openmp_threads = 4; // that CHOLMOD starts; they take room for their stacks
  const bool known = getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur != RLIM_INFINITY;
  return static_cast<double>(limit.rlim_cur) - 1024 * number_in("/proc/self/status", "VmSize:").value_or(0) -
         openmp_threads * (known ? static_cast<double>(stack.rlim_cur) : usual_stack);
}

} // namespace

double free_memory() {
  const double system =
      1024 * number_in("/proc/meminfo", "MemAvailable:").value_or(std::numeric_limits<double>::infinity());
  return std::max(0.0, std::min({system, left_in_all_groups(), left_in_address_space()}));
}

void require_memory(const FactorCost& cost, std::int64_t unknowns, double available) {
  if (cost.bytes <= available) return;
  constexpr double GiB = 1024.0 * 1024 * 1024;
  throw InputError(fmt::format(
      "this model needs about {:.3g} GiB of memory for its factor ({} unknowns, {:.3g} nonzeros), but only {:.3g} GiB "
      "are free; use larger spans (halving the number of spans per direction takes about a sixteenth of the memory), a "
      "lower degree, or a machine with more memory",
      cost.bytes / GiB, unknowns, static_cast<double>(cost.nonzeros), available / GiB));
}

} // namespace iga::solve
