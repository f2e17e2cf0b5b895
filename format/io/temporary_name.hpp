// Names of the files that a run writes before it renames them: they say whose they are, so that the next run can tell a
// file that is being written from one that a killed run left behind.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace iga::io {

/// A process as temporary files name it.
struct ProcessName {
  std::string host;
  long process = 0;
  unsigned long long start = 0; ///< clock ticks since the machine started; 0 where the system does not tell
};

/// This process.
const ProcessName& this_process();

/// Pattern for mkstemp: a hidden name beside `target` that says which process writes it.
std::filesystem::path temporary_pattern(const std::filesystem::path& target);

enum class Owner { This, Alive, Dead, Unknown }; ///< Unknown: on another machine

struct TemporaryFile {
  std::filesystem::path path;
  std::string target; ///< name of the file that it was to become; shortened where that is very long
  ProcessName by;
  Owner owner = Owner::Unknown;
};

/// Reads a name made from temporary_pattern(); nothing for any other file.
std::optional<TemporaryFile> read_temporary_name(const std::filesystem::path& file);

/// The temporary files of a folder; none where it cannot be read.
std::vector<TemporaryFile> temporary_files(const std::filesystem::path& folder);

/// Name of `target` as TemporaryFile::target gives it.
std::string shortened_name(const std::filesystem::path& target);

} // namespace iga::io
