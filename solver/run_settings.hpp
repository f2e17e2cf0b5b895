// What an analysis is asked to do: the command line and the run file (TOML) filled into one checked struct.
#pragma once

#include "solver/boundary.hpp"
#include "solver/material.hpp"
#include "solver/solution_space.hpp"

#include <filesystem>
#include <optional>

namespace iga::io {
class SettingsTable;
}

namespace iga::solve {

enum class MassType { Consistent, Lumped, TwoPass, ThreePass };

/// Settings that every analysis has.
struct RunSettings {
  std::filesystem::path run_file; ///< empty where there is none
  std::filesystem::path model;    ///< interchange file
  std::filesystem::path output;   ///< results file; empty: none is written
  bool force = false;             ///< replace an existing results file
  int threads = 0;                ///< 0: all
  bool quiet = false, json = false;
  std::string command_line;
  std::optional<std::string> units; ///< label that must match the model's length_unit
  ElasticMaterial material;
  MassType mass = MassType::Consistent;
  std::optional<LightFunctions> light_functions; ///< default by mass type
  std::optional<double> light_threshold;
  std::vector<Support> supports;
  int subdivide = 2;  ///< surface output: longest edge at most span / subdivide
  bool viewer = true; ///< write .pvd/.vtp beside the results file

  /// The treatment asked for, or the default of the mass type (README.md, light functions).
  LightTreatment light_treatment() const;
};

/// [material]: E, nu, rho or C (6 × 6 or 21 numbers of the upper triangle) and rho.
/// @throws InputError with file and line
ElasticMaterial read_material(io::SettingsTable& table);

} // namespace iga::solve
