// Values of run files with the checks that many tables share.
#pragma once

#include "format/io/settings_reader.hpp"
#include "format/model/types.hpp"

#include <optional>
#include <span>
#include <string>

namespace iga::solve {

/// Throws InputError "file:line: 'key' in [table]: why".
[[noreturn]] void refuse(const io::SettingsTable& table, std::string_view key, const std::string& why);
/// "file:line" of a table, to open messages later.
std::string place_of(const io::SettingsTable& table, std::string_view key);

std::optional<Point3> read_vector(io::SettingsTable& table, const char* key);
/// @throws InputError where it is missing, saying what it is
double need_number(io::SettingsTable& table, const char* key, const char* what);
Point3 need_vector(io::SettingsTable& table, const char* key, const char* what);
/// `otherwise` where absent. @throws InputError for a number below (or, where `open`, not above) `least`
double number_from(io::SettingsTable& table, const char* key, double otherwise, double least, bool open = false);
Point3 unit_vector(const io::SettingsTable& table, const char* key, const Point3& v);
/// Position of a word in a list. @throws InputError naming the nearest
std::size_t choose(const io::SettingsTable& table, const char* key, const std::string& word,
                   std::span<const std::string> known);
/// A name that is a name in the results file too: no slash, no dot at its start, not empty.
std::string read_name(io::SettingsTable& table, const char* key, const std::string& otherwise);

} // namespace iga::solve
