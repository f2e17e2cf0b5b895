#include "solver/explicit/run/run_file.hpp"

#include "solver/explicit/run/run_parts.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

void read_time(io::SettingsTable& root, ExplicitRun& run) {
  io::SettingsTable time = root.table("time");
  IntegratorSettings& s = run.time;
  run.time_where = place_of(time, "end");
  s.end_time = need_number(time, "end", "the time at which the run ends");
  if (!(s.end_time > 0)) refuse(time, "end", fmt::format("found {:g}, expected a time above 0", s.end_time));
  s.safety = number_from(time, "safety", s.safety, 0, true);
  if (s.safety > 1) refuse(time, "safety", fmt::format("found {:g}, expected at most 1", s.safety));
  s.start_share = number_from(time, "start_share", s.start_share, 0, true);
  if (s.start_share > 1) refuse(time, "start_share", fmt::format("found {:g}, expected at most 1", s.start_share));
  s.largest_dt = number_from(time, "dt_max", 0, 0);
  run.smallest_dt = number_from(time, "dt_min", 0, 0);
  if (s.largest_dt > 0 && run.smallest_dt >= s.largest_dt)
    refuse(time, "dt_min", fmt::format("found {:g}, expected less than dt_max = {:g}", run.smallest_dt, s.largest_dt));
  s.hold = static_cast<int>(time.integer("hold").value_or(s.hold));
  if (s.hold < 1) refuse(time, "hold", fmt::format("found {}, expected at least 1 step", s.hold));
  s.growth = number_from(time, "growth", s.growth, 1, true);
  s.max_steps = time.integer("max_steps").value_or(0);
  if (s.max_steps < 0) refuse(time, "max_steps", fmt::format("found {}, expected 0 (no limit) or more", s.max_steps));
  io::SettingsTable energy = root.table("energy");
  s.energy_limit = number_from(energy, "limit", 0.1, 0);
  run.energy_warning = number_from(energy, "warning", run.energy_warning, 0);
  io::SettingsTable watch = root.table("watch");
  for (const auto& [key, value] :
       {std::pair("contact_warning", &run.watch.contact_warning), std::pair("contact_limit", &run.watch.contact_limit),
        std::pair("depth_warning", &run.watch.depth_warning), std::pair("depth_limit", &run.watch.depth_limit),
        std::pair("wall_warning", &run.watch.wall_warning), std::pair("wall_limit", &run.watch.wall_limit),
        std::pair("support_warning", &run.watch.support_warning), std::pair("support_limit", &run.watch.support_limit),
        std::pair("inverted_warning", &run.watch.inverted_warning),
        std::pair("inverted_limit", &run.watch.inverted_limit)})
    *value = number_from(watch, key, *value, 0);
}

void read_output(io::SettingsTable& root, ExplicitRun& run) {
  io::SettingsTable output = root.table("output");
  OutputRun& out = run.out;
  const double end = run.time.end_time;
  out.interval = number_from(output, "interval", end / 1000, 0, true);
  out.field_interval = number_from(output, "field_interval", end / 50, 0, true);
  out.restart_interval = number_from(output, "restart_interval", 0, 0);
  out.subdivide = static_cast<int>(output.integer("subdivide").value_or(out.subdivide));
  if (out.subdivide < 1 || out.subdivide > 64)
    refuse(output, "subdivide", fmt::format("found {}, expected 1 … 64", out.subdivide));
  out.points = output.boolean("points").value_or(false);
  out.viewer = output.boolean("viewer").value_or(true);
  if (const auto file = output.path("file")) run.output = *file;
  constexpr double most = 1e6; // rows that nobody would read
  for (const auto& [key, interval] :
       {std::pair("interval", out.interval), std::pair("field_interval", out.field_interval)})
    if (end / interval > most)
      refuse(output, key,
             fmt::format("{:.3g} outputs until the end are more than {:g}; choose a longer interval", end / interval,
                         most));
}

void read_stops(io::SettingsTable& root, ExplicitRun& run) {
  for (io::SettingsTable& table : root.tables("stop")) {
    StopCondition stop;
    stop.where = table.where("quantity");
    const auto quantity = table.text("quantity");
    if (!quantity)
      refuse(table, "quantity", "missing; give a series such as \"rigid/sphere/velocity.z\" or \"energy/kinetic\"");
    stop.quantity = *quantity;
    const auto above = table.number("above"), below = table.number("below");
    if (above.has_value() == below.has_value()) refuse(table, "above", "give either above or below in each [[stop]]");
    stop.above = above.has_value();
    stop.limit = above ? *above : *below;
    stop.after = table.number("after").value_or(0);
    run.stops.push_back(std::move(stop));
  }
}

} // namespace

ExplicitRun read_explicit_run(const std::filesystem::path& file) {
  io::SettingsTable root = io::SettingsTable::read(file);
  root.expect_only(run_file_keys());
  ExplicitRun run;
  run.file = file;
  run.settings = root.entries();
  run.units = root.text("units");
  run.unit_system = root.text("unit_system");
  run.materials = root.path("materials");
  if (run.materials) run.inputs.push_back({*run.materials, root.where("materials")});
  const Point3 gravity = read_vector(root, "gravity").value_or(Point3{});
  read_bodies(root, gravity, run);
  if (run.bodies.empty())
    refuse(root, "bodies", "missing; a run has at least one [[bodies]] with a model and a material");
  read_rigid_bodies(root, gravity, run);
  read_contacts(root, run);
  read_timed_loads(root, run);
  read_driven_regions(root, run);
  read_time(root, run);
  read_output(root, run);
  read_stops(root, run);
  return run;
}

} // namespace iga::solve
