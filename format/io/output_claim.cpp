#include "format/io/output_claim.hpp"

#include "format/io/temporary_name.hpp"
#include "format/model/errors.hpp"

#include <fmt/format.h>

namespace iga::io {

namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

// Also true for files that are not there yet.
bool same_place(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (same_file(a, b)) return true;
  const fs::path first = fs::weakly_canonical(fs::absolute(a), error),
                 second = fs::weakly_canonical(fs::absolute(b), error);
  return !error && first == second;
}

[[noreturn]] void refuse_input(const fs::path& output, const fs::path& input) {
  throw InputError(fmt::format("{}: this output is the same file as the input {}; an input is never replaced, not even "
                               "with --force; choose another name for the output",
                               output.string(), input.string()));
}

void refuse_inputs_in(const fs::path& folder, std::span<const fs::path> inputs) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    for (const fs::path& input : inputs)
      if (same_file(entry->path(), input))
        throw InputError(fmt::format("{}: this input lies in the folder {} that the run fills with its own files; move "
                                     "it, or choose another name for the output",
                                     input.string(), folder.string()));
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

void remove_left_files(const fs::path& folder) {
  std::error_code ignored;
  for (const TemporaryFile& file : temporary_files(folder))
    if (file.owner == Owner::Dead) fs::remove(file.path, ignored);
}

void refuse_other_writers(const ReplacementFile& mark) {
  const fs::path& target = mark.target();
  for (const TemporaryFile& file : temporary_files(folder_of(target))) {
    if (file.target != shortened_name(target)) continue;
    if (file.owner == Owner::Alive)
      throw InputError(fmt::format("{}: another run (process {}) is writing this file; wait for it, or choose another "
                                   "name for the output",
                                   target.string(), file.by.process));
    if (file.owner == Owner::Unknown)
      throw InputError(fmt::format("{}: a run on another machine ({}, process {}) is writing this file, or was killed "
                                   "while it did; if it no longer runs, remove {}",
                                   target.string(), file.by.host, file.by.process, file.path.string()));
  }
}

// Else it would show when the finished file is put in place.
void refuse_long_names(const OutputPlan& plan) {
  for (const fs::path& output : plan.files) {
    std::error_code error;
    [[maybe_unused]] const fs::file_status status = fs::symlink_status(output, error);
    if (error == std::errc::filename_too_long)
      throw InputError(
          fmt::format("{}: this output's name of {} bytes is too long for the file system; choose a shorter one",
                      output.string(), output.filename().string().size()));
  }
}

// Checked before the mark is made: making it asks for the folder.
const fs::path& checked(const OutputPlan& plan, std::span<const fs::path> inputs) {
  refuse_long_names(plan);
  refuse_replaced_inputs(plan, inputs);
  return plan.files.front();
}

} // namespace

void refuse_replaced_inputs(const OutputPlan& plan, std::span<const fs::path> inputs) {
  for (const fs::path& output : plan.files)
    for (const fs::path& input : inputs)
      if (same_file(output, input)) refuse_input(output, input);
  for (const fs::path& folder : plan.folders) refuse_inputs_in(folder, inputs);
  for (std::size_t i = 0; i < plan.files.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (same_place(plan.files[i], plan.files[j]))
        throw InputError(fmt::format("{}: two outputs of this run, {} and {}, would be the same file; choose another "
                                     "name for the output (a results file ends in .h5)",
                                     plan.files[i].string(), plan.files[j].filename().string(),
                                     plan.files[i].filename().string()));
}

OutputClaim::OutputClaim(const OutputPlan& plan, std::span<const fs::path> inputs) : mark_(checked(plan, inputs)) {
  remove_left_files(folder_of(mark_.target()));
  for (const fs::path& folder : plan.folders) remove_left_files(folder);
  refuse_other_writers(mark_);
}

} // namespace iga::io
