// The tables of a run file, one by one; shared by the sources run_*.cpp only.
#pragma once

#include "solver/base/run_tables.hpp"
#include "solver/explicit/run/run_file.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <span>

namespace iga::solve {

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

/// For SettingsTable::expect_only: of explicit runs, and of [[rigid_bodies]], [contact] and [[contacts]] in any run.
std::vector<io::TableKeys> run_file_keys();
std::vector<io::TableKeys> tool_keys();

/// Numbers of material.name in the units of the model; nothing where there is no name.
/// @param words  gets what the report says of it
/// @throws InputError for an unknown name, naming the nearest
std::optional<MaterialDefaults> named_material(io::SettingsTable& table, const std::optional<std::string>& unit_system,
                                               const std::optional<std::filesystem::path>& materials,
                                               const std::filesystem::path& model, std::optional<MaterialWords>& words);

/// @param gravity  of the run, length/time²
void read_bodies(io::SettingsTable& root, const Point3& gravity, ExplicitRun& run);
void read_rigid_bodies(io::SettingsTable& root, const Point3& gravity, ExplicitRun& run);
void read_contacts(io::SettingsTable& root, ExplicitRun& run);
void read_timed_loads(io::SettingsTable& root, ExplicitRun& run);
void read_driven_regions(io::SettingsTable& root, ExplicitRun& run);

/// Number of a deformable body by name. @throws InputError naming the nearest
std::size_t body_by_name(io::SettingsTable& table, const char* key, const ExplicitRun& run);

} // namespace iga::solve
