#include "format/io/temporary_name.hpp"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace iga::io {

namespace {

constexpr std::string_view mark = ".iga-tmp-"; // between the target's name and host-process-start-XXXXXX
constexpr std::size_t longest_name = 120;      // bytes of the target's name: a folder allows 255 in all
constexpr std::size_t longest_host = 60;

// When a process started, 0 where the system does not tell, and whether it has ended without its parent having asked.
struct ProcessState {
  unsigned long long start = 0;
  bool ended = false;
};

// Fields 3 and 22 of /proc/PID/stat; the second one, the program's name, may hold anything but ends with the last
// bracket.
ProcessState state_of(long process) {
  std::ifstream in(fmt::format("/proc/{}/stat", process));
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  std::size_t at = text.rfind(')');
  ProcessState state;
  if (at == text.npos || at + 2 >= text.size()) return state;
  state.ended = text[at + 2] == 'Z' || text[at + 2] == 'X';
  for (int field = 2; field < 22 && at != text.npos; ++field) at = text.find(' ', at + 1);
  if (at != text.npos) std::from_chars(text.data() + at + 1, text.data() + text.size(), state.start);
  return state;
}

std::string host_name() {
  char name[256] = "";
  if (gethostname(name, sizeof name - 1) != 0 || name[0] == '\0') return "unknown";
  return std::string(name).substr(0, longest_host);
}

Owner owner_of(const ProcessName& by) {
  const ProcessName& ours = this_process();
  if (by.host != ours.host) return Owner::Unknown;
  if (by.process == ours.process && by.start == ours.start) return Owner::This;
  if (kill(static_cast<pid_t>(by.process), 0) != 0 && errno == ESRCH) return Owner::Dead;
  // Another process may have got the number since.
  const ProcessState state = state_of(by.process);
  const bool another = state.start != 0 && by.start != 0 && state.start != by.start;
  return another || state.ended ? Owner::Dead : Owner::Alive;
}

template <class T> bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

} // namespace

const ProcessName& this_process() {
  static const ProcessName name{host_name(), getpid(), state_of(getpid()).start};
  return name;
}

std::string shortened_name(const std::filesystem::path& target) {
  return target.filename().string().substr(0, longest_name);
}

std::filesystem::path temporary_pattern(const std::filesystem::path& target) {
  const ProcessName& by = this_process();
  return target.parent_path() /
         fmt::format(".{}{}{}-{}-{}-XXXXXX", shortened_name(target), mark, by.host, by.process, by.start);
}

std::optional<TemporaryFile> read_temporary_name(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  const std::size_t at = name.rfind(mark);
  if (name.empty() || name.front() != '.' || at == name.npos || at < 2) return {};
  TemporaryFile found;
  found.path = file;
  found.target = name.substr(1, at - 1);
  std::string_view rest = std::string_view(name).substr(at + mark.size());
  std::string_view parts[3]; // from the end: random letters, start, process; a host's name may hold dashes
  for (auto& part : parts) {
    const std::size_t dash = rest.rfind('-');
    if (dash == rest.npos) return {};
    part = rest.substr(dash + 1);
    rest = rest.substr(0, dash);
  }
  if (!parse(parts[1], found.by.start) || !parse(parts[2], found.by.process)) return {};
  if (rest.empty() || found.by.process <= 0) return {};
  found.by.host = rest;
  found.owner = owner_of(found.by);
  return found;
}

std::vector<TemporaryFile> temporary_files(const std::filesystem::path& folder) {
  std::vector<TemporaryFile> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (auto file = read_temporary_name(entry->path())) files.push_back(std::move(*file));
  return files;
}

} // namespace iga::io
