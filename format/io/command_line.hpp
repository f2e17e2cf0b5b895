// What the command lines of both tools share: refusals with the nearest flag, the command as typed.
#pragma once

#include <optional>
#include <string>

namespace CLI {
class App;
class Option;
class ParseError;
} // namespace CLI

namespace iga::io {

/// Throws InputError with the parser's reason and, for an unknown flag, the nearest one that `app` knows.
/// @param tool  whose --help to point at
[[noreturn]] void refuse_usage(const CLI::App& app, const CLI::ParseError& error, const std::string& tool);

/// A flag "--x,!--no-x" that stays without value unless it is typed. (CLI11 sets an optional bool to false when its
/// flag is absent, which would override a settings file.)
CLI::Option* add_switch(CLI::App& app, const std::string& names, std::optional<bool>& value, const std::string& text);

/// The command as one could type it again, words quoted where a shell needs it.
std::string command_text(const std::string& tool, int argc, const char* const* argv);

} // namespace iga::io
