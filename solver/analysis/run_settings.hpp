// What an analysis is asked to do: flags and run file (TOML) as typed, then one complete, checked struct.
#pragma once

#include "solver/analysis/buckling_settings.hpp"
#include "solver/analysis/eigen_settings.hpp"
#include "solver/analysis/heat_settings.hpp"
#include "solver/analysis/response_settings.hpp"
#include "solver/analysis/solver_choice.hpp"
#include "solver/mechanics/mass_type.hpp"
#include "solver/mechanics/material.hpp"
#include "solver/mechanics/material_table.hpp"
#include "solver/space/body_tables.hpp"
#include "solver/space/solution_space.hpp"
#include "solver/stress/stress_lines.hpp"
#include "solver/supports/added_mass.hpp"
#include "solver/supports/boundary.hpp"
#include "solver/supports/read_supports.hpp"
#include "solver/supports/spring.hpp"
#include "solver/ties/tie.hpp"

#include <filesystem>
#include <optional>

namespace iga::io {
class Progress;
}

namespace iga::solve {

enum class Analysis { Eigen, Timestep, Static, Heat, Buckling, Harmonic, Random, Transient };

/// Frequency response, random vibration and transients by modal superposition.
inline bool is_response(Analysis analysis) {
  return analysis == Analysis::Harmonic || analysis == Analysis::Random || analysis == Analysis::Transient;
}

/// [material], or the material of one of [[bodies]], as typed.
struct TypedMaterial {
  std::optional<std::string> name; ///< numbers beside it stand in place of its own
  std::optional<double> E, nu, rho, yield;
  std::optional<std::vector<double>> C; ///< 36 numbers row by row, or the 21 of the upper triangle
  std::optional<double> expansion = {}, conductivity = {};
  NamedMaterial found = {}; ///< by complete_materials: the material of that name
};

/// One of [[bodies]], as typed.
struct TypedBody {
  BodyFile file;
  std::optional<TypedMaterial> material; ///< none: [material] of the run
  std::optional<std::string> light_functions;
  std::optional<double> light_threshold;
};

/// [buckling], as typed.
struct TypedBuckling {
  std::optional<std::int64_t> factors;
  std::optional<bool> negative, sturm;
  std::vector<std::string> constant; ///< run files only; each of them is the name of a load
};

/// Settings as typed: nothing is filled in yet. Names are those of the flags with underscores.
struct TypedRun {
  std::optional<std::filesystem::path> model, output;
  std::optional<std::string> units, mass, light_functions;
  std::optional<std::string> unit_system;         ///< in which numbers of named materials are given
  std::optional<std::filesystem::path> materials; ///< a table of the user's own
  std::optional<double> light_threshold;
  TypedMaterial material;
  const UnitSystem* unit = nullptr; ///< by complete_materials: that of the numbers; null where nobody asks for one
  std::optional<std::int64_t> modes, subdivide;
  std::optional<double> modes_below; ///< cycles per time
  std::optional<bool> largest, sturm, errors, prestress, viewer;
  TypedBuckling buckling;
  std::vector<TypedBody> bodies;          ///< run files only
  std::vector<Tie> ties;                  ///< run files only
  std::vector<Support> supports;          ///< run files only
  std::vector<Spring> springs;            ///< run files only
  std::vector<AddedMass> masses;          ///< run files only
  StaticSettings statics;                 ///< run files only
  std::vector<HeatBoundary> heat = {};    ///< run files only
  ResponseSettings response = {};         ///< run files only
  std::vector<StressLine> lines = {};     ///< run files only
  std::optional<std::string> stress;      ///< recovered | raw
  std::optional<std::string> solver = {}; ///< auto | direct | multigrid
};

/// One body of a run.
struct RunBody {
  BodyFile file; ///< without a name where the run has no [[bodies]]
  ElasticMaterial material;
  LightTreatment light;
  bool has_density = true;  ///< false: the material's density stands for none
  MaterialWords words = {}; ///< about the material, for the report
};

/// Settings that every analysis has, complete.
struct RunSettings {
  Analysis analysis = Analysis::Eigen;
  std::vector<RunBody> bodies;      ///< [[bodies]]; empty: one body of `model`, `material` and `light`
  std::filesystem::path model;      ///< interchange file
  std::filesystem::path output;     ///< results file; empty: none is written
  std::optional<std::string> units; ///< label that must match the model's length_unit
  ElasticMaterial material;
  MaterialWords words; ///< about the material, for the report
  MassType mass = MassType::Consistent;
  LightTreatment light;
  bool has_density = true; ///< as in RunBody
  std::vector<Tie> ties;
  std::vector<Support> supports;
  std::vector<Spring> springs;
  std::vector<AddedMass> masses;
  EigenSettings eigen;
  BucklingSettings buckling;
  StaticSettings statics;
  std::vector<HeatBoundary> heat = {};
  ResponseSettings response = {};
  std::vector<StressLine> lines;
  SolverKind solver = SolverKind::Auto; ///< of static and eigen
  bool raw_stress = false;              ///< stress as the displacements have it, where it is not recovered
  int subdivide = 2;                    ///< surface output: longest edge at most span / subdivide
  bool viewer = true;                   ///< files for ParaView beside the results file
  io::Progress* progress = nullptr;     ///< where stages show themselves; null: nowhere
};

/// Treatment of light functions where the user asks for none: measured in README.md.
LightTreatment default_light_treatment(MassType mass);

/// Reads a run file; paths in it are relative to its folder.
/// @throws InputError with file and line for an unknown key (and the nearest known one) or a wrong type
TypedRun read_run_file(const std::filesystem::path& file);
/// `flags` where given, else `file`.
TypedRun override_run(TypedRun file, const TypedRun& flags);
/// Gives the numbers of named materials in the units of the models' length; as it is where nobody asks for a name or
/// units.
/// @throws InputError as choose_units and find_material, for a name together with C, and as read_model
TypedRun complete_materials(TypedRun typed);
/// @throws InputError naming what is missing or impossible
RunSettings validate_run(const TypedRun& typed, Analysis analysis);

/// The bodies of a run, whether it names them or not.
std::vector<RunBody> bodies_of(const RunSettings& run);

const char* name_of(MassType mass);
const char* name_of(LightFunctions remedy);

} // namespace iga::solve
