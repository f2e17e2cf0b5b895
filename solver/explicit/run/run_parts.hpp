// The tables of a run file, one by one; shared by the sources run_*.cpp only.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/explicit/run/run_file.hpp"

#include <functional>
#include <span>

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

/// A number over time: a number (constant), [[time, value], …] or the name of a CSV file with two columns.
/// @param files  gets the CSV file
std::optional<TimeCurve> read_curve(io::SettingsTable& table, const char* key, bool smooth,
                                    std::vector<RunInput>& files);
/// [….drive] of rigid bodies and supports: curves x, y, z (and rotation), kind, smooth.
struct DriveCurves {
  std::array<std::optional<TimeCurve>, 3> along;
  std::optional<TimeCurve> rotation;
  Point3 axis{0, 0, 1};
  bool are_velocities = false;
  bool given() const { return along[0] || along[1] || along[2] || rotation; }
};
DriveCurves read_drive(io::SettingsTable& table, bool may_turn, std::vector<RunInput>& files);

/// For SettingsTable::expect_only.
std::vector<io::TableKeys> run_file_keys();

/// @param gravity  of the run, length/time²
void read_bodies(io::SettingsTable& root, const Point3& gravity, ExplicitRun& run);
void read_rigid_bodies(io::SettingsTable& root, const Point3& gravity, ExplicitRun& run);
void read_contacts(io::SettingsTable& root, ExplicitRun& run);
void read_timed_loads(io::SettingsTable& root, ExplicitRun& run);
void read_driven_regions(io::SettingsTable& root, ExplicitRun& run);

/// Number of a deformable body by name. @throws InputError naming the nearest
std::size_t body_by_name(io::SettingsTable& table, const char* key, const ExplicitRun& run);

} // namespace iga::solve
