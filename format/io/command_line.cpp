#include "format/io/command_line.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace iga::io {

namespace {

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$*?;&|<>()#") == std::string::npos;
  if (plain) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

} // namespace

void refuse_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& tool) {
  std::string text = error.what();
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  for (const std::string& word : app.remaining())
    if (word.starts_with("-"))
      if (const auto near = nearest_name(word.substr(0, word.find('=')), flags))
        text += fmt::format("; did you mean {}?", *near);
  throw InputError(fmt::format("{} (see {} --help)", text, tool));
}

CLI::Option* add_switch(CLI::App& app, const std::string& names, std::optional<bool>& value, const std::string& text) {
  return app.add_flag_function(
      names, [&value](std::int64_t count) { value = count > 0; }, text);
}

std::string command_text(const std::string& tool, int argc, const char* const* argv) {
  std::string text = tool;
  for (int i = 1; i < argc; ++i) text += " " + quoted(argv[i]);
  return text;
}

} // namespace iga::io
