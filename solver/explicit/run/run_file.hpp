// The run file of `igasolve explicit`, read and checked: everything that can be said without more of a model
// than its length unit.
#pragma once

#include "format/io/settings_reader.hpp"
#include "solver/explicit/contact/contact_settings.hpp"
#include "solver/explicit/contact/rigid_body.hpp"
#include "solver/explicit/laws/material_settings.hpp"
#include "solver/explicit/loads/driven_region.hpp"
#include "solver/explicit/loads/timed_loads.hpp"
#include "solver/explicit/motion/explicit_body.hpp"
#include "solver/explicit/motion/integrator.hpp"
#include "solver/mechanics/material_table.hpp"
#include "solver/space/placement.hpp"

#include <filesystem>
#include <optional>

namespace iga::solve {

/// One of [[bodies]]. `where` names file and line for messages about what only the model can tell.
struct BodyRun {
  std::string where;
  std::filesystem::path model;
  Placement place; ///< of the model in the run
  MaterialSettings material{.law = NeoHookean{}, .inversion = {}, .name = {}, .warnings = {}};
  std::optional<MaterialWords> words; ///< of a material by name
  BodySettings body;
  Point3 velocity{}, spin{};    ///< at the start; length/time and 1/time
  std::optional<Point3> centre; ///< that the spin turns about; the body's centre of mass where none is given
  double edge_length = 0;       ///< of contact triangles, length; 0: half a span
  double merge_length = 0;      ///< their edges below this are merged, length; 0: none
};

/// One of [[rigid_bodies]].
struct RigidRun {
  std::string where;
  RigidBody body;
  std::filesystem::path file; ///< STL; empty for other shapes
};

/// One of [[contacts]]; sides are numbers of bodies and rigid bodies.
struct ContactRun {
  ContactPair pair;
  bool swapped = false; ///< the first-named side is the rigid one
};

struct LoadRun {
  std::string where;
  std::size_t body = 0;
  TimedLoad load;
};

struct SupportRun {
  std::string where;
  std::size_t body = 0;
  DrivenRegion region;
};

/// Ends the run when a number of the time series lies beyond a limit.
struct StopCondition {
  std::string where;
  std::string quantity; ///< path of the series below /time_series with a component: "rigid/sphere/velocity.z"
  double limit = 0;
  bool above = true; ///< else below
  double after = 0;  ///< time from which it is looked at
};

struct OutputRun {
  double interval = 0;         ///< of the time series, time
  double field_interval = 0;   ///< of fields
  double restart_interval = 0; ///< of restart files; 0: only when interrupted
  int subdivide = 2;           ///< of the surface that fields are shown on: edges at most span / subdivide
  bool points = false;         ///< stresses at the quadrature points too
  bool viewer = true;          ///< files for ParaView
};

/// What a run is warned of, and what ends it (0: never).
struct WatchLimits {
  double contact_warning = 0.01, contact_limit = 0.05; ///< energy contact gave back too much / the largest energy
  double depth_warning = 0.5, depth_limit = 1;         ///< of contact, in spans
  double wall_warning = 0.05, wall_limit = 0;          ///< of contact, as share of a wall thinner than a span
  double support_warning = 0.02, support_limit = 0;    ///< way of a support's surface from its place, in spans
  double inverted_warning = 1e-3, inverted_limit = 0;  ///< points below min_volume_ratio / all points of a body
};

/// A file that the run depends on.
struct RunInput {
  std::filesystem::path file;
  std::string where; ///< "run.toml:4: 'model' in [bodies]"
};

struct ExplicitRun {
  std::filesystem::path file;
  std::vector<io::SettingsEntry> settings;        ///< the run file's values as written
  std::filesystem::path output;                   ///< as the run file says; may be empty
  std::optional<std::string> units;               ///< label that must match the models' length_unit
  std::optional<std::string> unit_system;         ///< in which numbers of named materials are given
  std::optional<std::filesystem::path> materials; ///< a table of named materials of the user's own
  std::vector<BodyRun> bodies;
  std::vector<RigidRun> rigid;
  std::vector<ContactRun> contacts;
  ContactOptions contact;
  std::vector<LoadRun> loads;
  std::vector<SupportRun> supports;
  std::vector<StopCondition> stops;
  IntegratorSettings time;
  std::string time_where;       ///< opens messages about the time step
  double smallest_dt = 0;       ///< a step below it is refused; 0: 1e-4 of the first one
  double energy_warning = 0.01; ///< relative error of the energy balance that is warned of
  WatchLimits watch;
  OutputRun out;
  std::vector<RunInput> inputs; ///< models, tools, curves: what the run depends on beside the run file
  std::vector<std::string> warnings;
};

/// Reads and checks a run file; paths in it are relative to its folder. Its keys: README.md, run file.
/// @throws InputError "file:line: key: found this, expected that", for an unknown key with the nearest known one
ExplicitRun read_explicit_run(const std::filesystem::path& file);

} // namespace iga::solve
