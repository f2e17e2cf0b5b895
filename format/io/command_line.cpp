#include "format/io/command_line.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

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
  const auto advised = [](const std::string& word, const std::vector<std::string>& known) {
    const auto near = nearest_name(word, known);
    return near ? fmt::format("; did you mean {}?", *near) : std::string();
  };
  std::string text = error.what();
  const std::vector<std::string> unknown = app.remaining();
  const bool one_missing = dynamic_cast<const CLI::RequiredError*>(&error),
             too_many = dynamic_cast<const CLI::ExtrasError*>(&error);
  if (!unknown.empty() && (one_missing || too_many)) { // what is wrong comes before what is missing
    const std::string word = unknown.front().substr(0, unknown.front().find('='));
    std::vector<std::string> flags, commands;
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
    if (word.starts_with("-"))
      text = fmt::format("unknown option {}{}", word, advised(word, flags));
    else if (!commands.empty() && app.get_subcommands().empty())
      text = fmt::format("unknown command {}{}; commands are {}", word, advised(word, commands),
                         fmt::join(commands, ", "));
    else
      text = fmt::format("{} is one argument too many", word);
  }
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
