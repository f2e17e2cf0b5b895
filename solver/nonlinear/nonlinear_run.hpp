// The run file of `igasolve nonlinear`, read and checked: everything that can be said without the model.
#pragma once

#include "solver/explicit/laws/material_settings.hpp"
#include "solver/explicit/run/run_file.hpp"
#include "solver/mechanics/material_table.hpp"
#include "solver/nonlinear/tool_contact.hpp"
#include "solver/space/light_treatment.hpp"
#include "solver/supports/read_supports.hpp"

#include <filesystem>
#include <optional>

namespace iga::solve {

/// [nonlinear].
struct NewtonSettings {
  int steps = 10;              ///< load steps; results are kept at each of them
  double tolerance = 1e-8;     ///< of the residual, relative to the forces
  int max_iterations = 20;     ///< of a step before it is cut
  double smallest_step = 1e-3; ///< share of a load step at which the run gives up
};

/// One [[load]] with what only this analysis asks of it.
struct NonlinearLoad {
  Load load;
  bool follower = false; ///< a pressure that follows the surface
};

inline constexpr const char* nonlinear_body = "part"; ///< name of the body in run files and results

struct NonlinearRun {
  std::filesystem::path file;
  std::vector<io::SettingsEntry> settings; ///< the run file's values as written
  std::filesystem::path model, output;     ///< output may be empty
  std::optional<std::string> units;        ///< label that must match the model's length_unit
  MaterialSettings material{.law = NeoHookean{}, .inversion = {}, .name = {}, .warnings = {}};
  std::optional<MaterialWords> words; ///< of a material by name
  LightTreatment light;
  Locking locking = Locking::None;
  std::vector<Support> supports;
  std::vector<NonlinearLoad> loads;
  std::vector<Probe> probes;
  std::vector<RigidRun> rigid; ///< tools; their time is the load factor
  std::vector<ToolContactSettings> contacts;
  double depth_warning = 0.02; ///< of contact, in spans
  NewtonSettings newton;
  int subdivide = 2;                         ///< surface of the results: longest edge at most span / subdivide
  bool points = false;                       ///< stresses at the quadrature points too
  bool viewer = true;                        ///< files for ParaView
  std::vector<std::filesystem::path> inputs; ///< what the run depends on beside the run file
  std::vector<std::string> warnings;
};

/// Keys of the run file, for SettingsTable::expect_only.
std::vector<io::TableKeys> nonlinear_keys();

/// Paths in the file are relative to its folder. Keys: solver/nonlinear/README.md.
/// @throws InputError "file:line: key: found this, expected that", for an unknown key with the nearest known one
NonlinearRun read_nonlinear_run(const std::filesystem::path& file);

} // namespace iga::solve
