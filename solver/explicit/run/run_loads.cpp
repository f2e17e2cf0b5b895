// [[loads]] and [[supports]] of a run file.
#include "solver/explicit/run/run_parts.hpp"
#include "solver/supports/read_supports.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

// The run depends on the file of a patch.
void note_patch(const io::SettingsTable& table, const RegionChoice& region, ExplicitRun& run) {
  if (region.patch) run.inputs.push_back({region.patch->file, table.where("patch")});
}

} // namespace

void read_timed_loads(io::SettingsTable& root, ExplicitRun& run) {
  for (io::SettingsTable& table : root.tables("loads")) {
    LoadRun load;
    load.where = place_of(table, "name");
    load.body = body_by_name(table, "body", run);
    load.load.load = read_load(table, run.loads.size() + 1);
    if (load.load.load.spin.rpm)
      refuse(table, "centrifugal", "explicit runs know no unit of time; give speed in radians per time instead of rpm");
    note_patch(table, load.load.load.region, run);
    const bool smooth = table.boolean("smooth").value_or(false);
    if (auto factor = read_curve(table, "factor", smooth, run.inputs)) load.load.factor = std::move(*factor);
    load.load.follows = table.boolean("follows").value_or(false);
    if (load.load.follows && load.load.load.kind != LoadKind::Pressure)
      refuse(table, "follows", "only a pressure follows the surface; leave it out");
    run.loads.push_back(std::move(load));
  }
}

void read_driven_regions(io::SettingsTable& root, ExplicitRun& run) {
  for (io::SettingsTable& table : root.tables("supports")) {
    SupportRun support;
    support.where = place_of(table, "name");
    support.body = body_by_name(table, "body", run);
    DrivenRegion& region = support.region;
    region.name = read_name(table, "name", fmt::format("support {}", run.supports.size() + 1));
    region.region = need_region(table);
    note_patch(table, region.region, run);
    DriveCurves drive = read_drive(table, false, run.inputs);
    region.motion = std::move(drive.along);
    region.curves_are_velocities = drive.are_velocities;
    const auto fixed = table.text("fixed");
    if (!fixed && !drive.given())
      refuse(table, "fixed", "missing; give fixed = \"xyz\" or [supports.drive] with curves x, y, z");
    for (const char c : fixed.value_or("")) {
      const auto d = std::string_view("xyz").find(c);
      if (d == std::string_view::npos)
        refuse(table, "fixed", fmt::format("found \"{}\", expected letters out of x, y, z", *fixed));
      if (region.motion[d]) refuse(table, "fixed", fmt::format("{} is driven; it cannot be fixed too", c));
      region.motion[d] = TimeCurve(0.0);
    }
    region.stiffness = number_from(table, "stiffness", region.stiffness, 0, true);
    region.damping = number_from(table, "damping", region.damping, 0);
    for (const SupportRun& other : run.supports)
      if (other.region.name == region.name)
        refuse(table, "name", fmt::format("there is another support '{}'; give each a name", region.name));
    run.supports.push_back(std::move(support));
  }
}

} // namespace iga::solve
