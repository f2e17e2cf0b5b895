// A file that appears whole or not at all: written beside its final place, synced, renamed.
#pragma once

#include <filesystem>

namespace iga::io {

/// An empty file in the target's folder that becomes the target with commit() and vanishes without it.
/// Until commit() an existing target stays as it is.
class ReplacementFile {
 public:
  /// @throws InputError naming the folder and the system's reason where no file can be made there
  explicit ReplacementFile(std::filesystem::path target);
  ~ReplacementFile();
  ReplacementFile(const ReplacementFile&) = delete;
  ReplacementFile& operator=(const ReplacementFile&) = delete;

  /// Where to write; the same folder as the target.
  const std::filesystem::path& path() const { return temporary_; }
  const std::filesystem::path& target() const { return target_; }
  /// Forces the bytes to the disk, renames, syncs the folder. The caller has closed the file.
  /// @throws InputError with the system's reason; the temporary file is removed then
  void commit();

 private:
  std::filesystem::path target_, temporary_;
  bool committed_ = false;
};

} // namespace iga::io
