// What a run will write, checked and claimed before the work starts: no output replaces an input, no two runs write the
// same file, and what killed runs left half-written is cleared away.
#pragma once

#include "format/io/replace_file.hpp"

#include <span>
#include <vector>

namespace iga::io {

/// The files of one run.
struct OutputPlan {
  std::vector<std::filesystem::path> files;   ///< the main one first
  std::vector<std::filesystem::path> folders; ///< hold files of the run alone; need not exist yet
};

/// Refuses outputs that are inputs: the same file under another spelling of its path, a symbolic or a hard link, and
/// inputs that lie in a folder that the run fills. Two outputs must not be one file either.
/// @throws InputError naming both
void refuse_replaced_inputs(const OutputPlan& plan, std::span<const std::filesystem::path> inputs);

/// Holds the main output of a plan as long as it lives.
class OutputClaim {
 public:
  /// Checks as refuse_replaced_inputs(), removes temporary files of dead processes of this machine beside the outputs,
  /// and marks the main output as being written.
  /// @throws InputError also where another process is writing the main output (or one on another machine may be: the
  /// message names the file to remove), and with the system's reason where no file can be made
  OutputClaim(const OutputPlan& plan, std::span<const std::filesystem::path> inputs);

 private:
  ReplacementFile mark_;
};

} // namespace iga::io
