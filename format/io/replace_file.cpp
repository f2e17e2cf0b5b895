#include "format/io/replace_file.hpp"

#include "format/io/temporary_name.hpp"
#include "format/model/errors.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace iga::io {

namespace {

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

[[noreturn]] void fail(const std::filesystem::path& target, const char* what) {
  const int error = errno;
  throw InputError(fmt::format("{}: {} in folder {}: {}; nothing was changed", target.string(), what,
                               folder_of(target).string(), std::strerror(error)));
}

// Permissions of an ordinary new file; the process-wide mask can only be read by setting it.
mode_t new_file_mode() {
  const mode_t mask = umask(022);
  umask(mask);
  return 0666 & ~mask;
}

} // namespace

ReplacementFile::ReplacementFile(std::filesystem::path target) : target_(std::move(target)) {
  std::error_code error;
  if (std::filesystem::is_directory(target_, error))
    throw InputError(fmt::format("{}: is a folder; name a file in it", target_.string()));
  // A link is written through: the file that it names is replaced, the link stays.
  if (std::filesystem::is_symlink(target_, error)) {
    const auto named = std::filesystem::weakly_canonical(target_, error);
    if (error)
      throw InputError(fmt::format("{}: is a link that leads to no file: {}", target_.string(), error.message()));
    target_ = named;
  }
  if (std::filesystem::exists(target_, error) && !std::filesystem::is_regular_file(target_, error))
    throw InputError(fmt::format("{}: is not an ordinary file and cannot be replaced by one", target_.string()));
  std::string name = temporary_pattern(target_).string();
  const int fd = mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) fail(target_, "no file can be made");
  temporary_ = name;
  fchmod(fd, new_file_mode());
  close(fd);
}

ReplacementFile::~ReplacementFile() {
  if (!committed_) unlink(temporary_.c_str());
}

void ReplacementFile::commit() {
  const int fd = open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) fail(target_, "the written file cannot be opened");
  const int synced = fsync(fd);
  const int error = errno;
  close(fd);
  errno = error;
  if (synced != 0) fail(target_, "the written file cannot be stored");
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(target_, "the written file cannot be put in place");
  committed_ = true;
  // The rename itself survives a power cut once the folder is synced; some file systems refuse that, which is no error.
  const int folder = open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    fsync(folder);
    close(folder);
  }
}

} // namespace iga::io
