#include "format/io/provenance_io.hpp"

#include "format/io/dataset_names.hpp"
#include "format/io/h5_arrays.hpp"

#include <charconv>
#include <fmt/format.h>
#include <string_view>

namespace iga::io {

void expect_format(const H5Reader& file, const char* format, int major, const char* version_written) {
  const std::string found = file.text(names::root, "format");
  if (found != format) file.refuse("/ attribute format", fmt::format("is '{}', expected '{}'", found, format));
  const std::string version = file.text(names::root, "format_version");
  int number = -1;
  const auto end = std::from_chars(version.data(), version.data() + version.size(), number);
  if (end.ec != std::errc() || number != major || (*end.ptr != '.' && *end.ptr != '\0')) {
    std::string advice;
    if (number >= 0 && number < major)
      advice = format == std::string_view(names::format)
                   ? fmt::format(": made by an older igaprep (format {}.x); make the model again with igaprep", number)
                   : ": made by an older version; make it again";
    file.refuse("/ attribute format_version", fmt::format("is '{}', this program reads {}.x (it writes {}){}", version,
                                                          major, version_written, advice));
  }
}

void write_provenance(H5Writer& file, const Provenance& p) {
  const char* group = names::provenance;
  std::vector<std::string> input_names, hashes, stages;
  std::vector<double> seconds;
  for (const InputFile& input : p.inputs) {
    input_names.push_back(input.name);
    hashes.push_back(input.sha256);
  }
  for (const auto& [stage, time] : p.timings) {
    stages.push_back(stage);
    seconds.push_back(time);
  }
  file.group(group, "who made this file from what");
  file.attribute(group, "producer", p.producer);
  file.attribute(group, "version", p.version);
  file.attribute(group, "command_line", p.command_line);
  file.attribute(group, "created", p.created);
  file.attribute(group, "settings_sha256", p.settings_sha256);
  file.attribute(group, "input_names", input_names);
  file.attribute(group, "input_sha256", hashes);
  file.strings(names::timing_stages, stages);
  write(file, names::timing_seconds, seconds);
  file.strings(names::findings, p.findings);
  file.strings(names::warnings, p.warnings);
}

Provenance read_provenance(const H5Reader& file) {
  Provenance p;
  p.producer.clear();
  const char* group = names::provenance;
  if (!file.has(group)) return p;
  const auto text = [&](const char* name) {
    return file.has_attribute(group, name) ? file.text(group, name) : std::string();
  };
  const auto texts = [&](const char* name) {
    return file.has_attribute(group, name) ? file.texts(group, name) : std::vector<std::string>();
  };
  p.producer = text("producer");
  p.version = text("version");
  p.command_line = text("command_line");
  p.created = text("created");
  p.settings_sha256 = text("settings_sha256");
  const auto input_names = texts("input_names"), hashes = texts("input_sha256");
  if (input_names.size() != hashes.size())
    file.refuse(
        "/provenance attribute input_sha256",
        fmt::format("holds {} strings, expected as many as input_names: {}", hashes.size(), input_names.size()));
  for (std::size_t i = 0; i < hashes.size(); ++i) p.inputs.push_back({input_names[i], hashes[i]});
  if (file.has(names::timing_stages.path)) {
    const auto stages = file.strings(names::timing_stages.path);
    const auto seconds = read<double>(file, names::timing_seconds, static_cast<std::int64_t>(stages.size()));
    for (std::size_t i = 0; i < stages.size(); ++i) p.timings.emplace_back(stages[i], seconds[i]);
  }
  if (file.has(names::findings.path)) p.findings = file.strings(names::findings.path);
  if (file.has(names::warnings.path)) p.warnings = file.strings(names::warnings.path);
  return p;
}

} // namespace iga::io
