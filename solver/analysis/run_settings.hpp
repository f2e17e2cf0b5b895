// What an analysis is asked to do: flags and run file (TOML) as typed, then one complete, checked struct.
#pragma once

#include "solver/analysis/eigen_settings.hpp"
#include "solver/mechanics/mass_type.hpp"
#include "solver/mechanics/material.hpp"
#include "solver/mechanics/material_table.hpp"
#include "solver/space/solution_space.hpp"
#include "solver/supports/boundary.hpp"
#include "solver/supports/read_supports.hpp"

#include <filesystem>
#include <optional>

namespace iga::io {
class Progress;
}

namespace iga::solve {

enum class Analysis { Eigen, Timestep, Static };

/// Settings as typed: nothing is filled in yet. Names are those of the flags with underscores.
struct TypedRun {
  std::optional<std::filesystem::path> model, output;
  std::optional<std::string> units, mass, light_functions;
  std::optional<std::string> material;            ///< a name; numbers beside it stand in place of its own
  std::optional<std::string> unit_system;         ///< in which numbers of named materials are given
  std::optional<std::filesystem::path> materials; ///< a table of the user's own
  std::optional<double> E, nu, rho, light_threshold;
  std::optional<std::vector<double>> C; ///< 36 numbers row by row, or the 21 of the upper triangle
  std::optional<std::int64_t> modes, subdivide;
  std::optional<bool> largest, sturm, viewer;
  std::vector<Support> supports; ///< run files only
  StaticSettings statics;        ///< run files only
};

/// Settings that every analysis has, complete.
struct RunSettings {
  Analysis analysis = Analysis::Eigen;
  std::filesystem::path model;      ///< interchange file
  std::filesystem::path output;     ///< results file; empty: none is written
  std::optional<std::string> units; ///< label that must match the model's length_unit
  ElasticMaterial material;
  MaterialWords words; ///< about the material, for the report
  MassType mass = MassType::Consistent;
  LightTreatment light;
  std::vector<Support> supports;
  EigenSettings eigen;
  StaticSettings statics;
  int subdivide = 2;                ///< surface output: longest edge at most span / subdivide
  bool viewer = true;               ///< files for ParaView beside the results file
  io::Progress* progress = nullptr; ///< where stages show themselves; null: nowhere
};

/// Treatment of light functions where the user asks for none: measured in README.md.
LightTreatment default_light_treatment(MassType mass);

/// Reads a run file; paths in it are relative to its folder.
/// @throws InputError with file and line for an unknown key (and the nearest known one) or a wrong type
TypedRun read_run_file(const std::filesystem::path& file);
/// `flags` where given, else `file`.
TypedRun override_run(TypedRun file, const TypedRun& flags);
/// Numbers of a named material, and units, from the model's length unit; as it is where neither is asked for.
struct CompletedRun {
  TypedRun typed;
  NamedMaterial named; ///< empty where no name is given
  const UnitSystem* units = nullptr;
};
/// @throws InputError as choose_units and find_material, for a name together with C, and as read_model
CompletedRun complete_material(TypedRun typed);
/// @throws InputError naming what is missing or impossible
RunSettings validate_run(const TypedRun& typed, Analysis analysis);

const char* name_of(MassType mass);
const char* name_of(LightFunctions remedy);

} // namespace iga::solve
