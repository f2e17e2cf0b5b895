#include "solver/supports/read_supports.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <numbers>

namespace iga::solve {

namespace {

std::optional<Point3> vector3(io::SettingsTable& table, const char* key) {
  const auto v = table.numbers(key, {3});
  return v ? std::optional(Point3{(*v)[0], (*v)[1], (*v)[2]}) : std::nullopt;
}

[[noreturn]] void refuse(const io::SettingsTable& table, const char* key, const std::string& why) {
  throw InputError(fmt::format("{}: {}", table.where(key), why));
}

Point3 need_vector3(io::SettingsTable& table, const char* key, const char* what) {
  const auto v = vector3(table, key);
  if (!v) refuse(table, key, fmt::format("missing; give {} as three numbers", what));
  return *v;
}

std::string name_or(io::SettingsTable& table, const char* what, std::size_t number) {
  return table.text("name").value_or(fmt::format("{} {}", what, number));
}

} // namespace

// As igaprep's grid: `rotation`, 9 numbers row by row whose columns are the frame's axes, or `rotate_axis_angle`, an
// axis and degrees.
Rotation read_frame(io::SettingsTable& table) {
  const auto matrix = table.numbers("rotation", {9});
  const auto turn = table.numbers("rotate_axis_angle", {4});
  if (matrix && turn) refuse(table, "rotation", "given together with rotate_axis_angle; give one of them");
  Rotation R = identity_rotation;
  if (matrix) {
    for (std::size_t k = 0; k < 9; ++k) R[k / 3][k % 3] = (*matrix)[k];
    constexpr double typed_digits = 1e-6; // people type six digits
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const double product = R[0][a] * R[0][b] + R[1][a] * R[1][b] + R[2][a] * R[2][b];
        if (std::abs(product - (a == b ? 1 : 0)) > typed_digits)
          refuse(table, "rotation",
                 "its columns are no orthogonal unit vectors; use rotate_axis_angle = [ax, ay, az, "
                 "degrees] where you know the axis");
      }
  }
  if (turn) {
    const Point3 axis{(*turn)[0], (*turn)[1], (*turn)[2]};
    if (!(norm(axis) > 0)) refuse(table, "rotate_axis_angle", "the axis has no length");
    const Point3 k = times(axis, 1 / norm(axis));
    const double angle = (*turn)[3] * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    for (std::size_t a = 0; a < 3; ++a) { // Rodrigues' formula, column by column
      Point3 e{};
      e[a] = 1;
      const Point3 turned = plus(plus(times(e, c), times(cross(k, e), s)), times(k, dot(k, e) * (1 - c)));
      for (std::size_t r = 0; r < 3; ++r) R[r][a] = turned[r];
    }
  }
  return R;
}

namespace {

/// All keys that choose surface; `given` says whether any was there.
struct ReadRegion {
  RegionChoice choice;
  bool given = false;
};

// A name, a number, or a list of one kind: any of them will do.
void read_regions(io::SettingsTable& table, RegionChoice& choice) {
  if (table.holds_text("region"))
    choice.names = {*table.text("region")};
  else if (table.holds_number("region"))
    choice.numbers = {*table.integer("region")};
  else if (table.holds_numbers("region"))
    choice.numbers = *table.integers("region");
  else if (const auto names = table.texts("region"))
    choice.names = *names;
  if (table.holds("region") && choice.names.empty() && choice.numbers.empty())
    refuse(table, "region", "the list is empty; give names or numbers of regions, or leave it out");
}

void read_patch(io::SettingsTable& table, RegionChoice& choice) {
  if (table.holds_text("patch")) {
    choice.patch = RegionChoice::Patch{*table.path("patch"), std::nullopt};
    return;
  }
  io::SettingsTable patch = table.table("patch");
  const auto file = patch.path("file");
  const auto tolerance = patch.number("tolerance");
  if (!file && tolerance) refuse(patch, "file", "missing; give the STL file of the patch");
  if (tolerance && *tolerance < 0) refuse(patch, "tolerance", fmt::format("found {}, expected 0 or more", *tolerance));
  if (file) choice.patch = RegionChoice::Patch{*file, tolerance};
}

} // namespace

PlaceChoice read_place(io::SettingsTable& table) {
  PlaceChoice place;
  const char* first = nullptr;
  for (const char* key : {"curve", "line", "point", "at"}) {
    if (!table.holds(key)) continue;
    if (first) refuse(table, key, fmt::format("given together with {}; give one of them", first));
    first = key;
  }
  if (table.holds_text("curve"))
    place.curves = {*table.text("curve")};
  else if (const auto names = table.texts("curve"))
    place.curves = *names;
  if (table.holds("curve") && place.curves.empty())
    refuse(table, "curve", "the list is empty; give names of curves of the model (igasolve info lists them)");
  if (const auto rows = table.rows("line", 3)) {
    for (const auto& row : *rows) place.line.push_back({row[0], row[1], row[2]});
    if (place.line.size() < 2)
      refuse(table, "line",
             fmt::format("found {} point(s), expected two or more: [[x, y, z], [x, y, z], …]", place.line.size()));
  }
  place.marker = table.text("point").value_or("");
  if (table.holds("point") && place.marker.empty())
    refuse(table, "point",
           "the name is empty; give a marker of the model (igasolve info lists them), or at = [x, y, z]");
  place.at = vector3(table, "at");
  return place;
}

namespace {

ReadRegion read_region(io::SettingsTable& table) {
  ReadRegion region;
  RegionChoice& choice = region.choice;
  read_regions(table, choice);
  read_patch(table, choice);
  if (const auto box = table.numbers("box", {6})) {
    choice.box = Box3{{(*box)[0], (*box)[1], (*box)[2]}, {(*box)[3], (*box)[4], (*box)[5]}};
    for (std::size_t d = 0; d < 3; ++d)
      if (choice.box->lower[d] > choice.box->upper[d])
        refuse(table, "box",
               fmt::format("the first corner lies beyond the second one along {} ({} > {}); give the "
                           "lower corner first",
                           "xyz"[d], choice.box->lower[d], choice.box->upper[d]));
  }
  io::SettingsTable plane = table.table("plane"), normal = table.table("normal");
  const auto point = vector3(plane, "point"), plane_normal = vector3(plane, "normal");
  const auto tolerance = plane.number("tolerance");
  if (point || plane_normal || tolerance) {
    if (!point || !plane_normal) refuse(plane, point ? "normal" : "point", "missing; a plane has a point and a normal");
    if (tolerance && *tolerance < 0)
      refuse(plane, "tolerance", fmt::format("found {}, expected 0 or more", *tolerance));
    choice.plane = RegionChoice::Plane{*point, *plane_normal, tolerance.value_or(0)};
  }
  const auto direction = vector3(normal, "direction");
  const auto angle = normal.number("angle");
  if (direction || angle) {
    if (!direction) refuse(normal, "direction", "missing; give the direction that outward normals should have");
    if (angle && !(*angle >= 0 && *angle <= 180))
      refuse(normal, "angle", fmt::format("found {}, expected 0 … 180 degrees", *angle));
    constexpr double default_angle = 1; // degrees: flat faces of parts written with single precision
    choice.normal = RegionChoice::Direction{*direction, angle.value_or(default_angle)};
  }
  const bool whole = table.boolean("whole_surface").value_or(false);
  const bool some =
      !choice.names.empty() || !choice.numbers.empty() || choice.box || choice.plane || choice.normal || choice.patch;
  if (whole && some) refuse(table, "whole_surface", "given together with a choice of surface; give one of them");
  region.given = whole || some;
  return region;
}

constexpr const char* how_to_choose =
    "choose surface by region (names or numbers), box, plane, normal, patch, or whole_surface = true";
constexpr const char* or_a_place =
    ", a line by curve = \"name\" or line = [[x, y, z], …], or a point by point = \"name\" or at = [x, y, z]";

void read_fixed(io::SettingsTable& table, Support& support) {
  const auto fixed = table.text("fixed");
  if (!fixed) return;
  support.along_normal = *fixed == "normal";
  support.radial = *fixed == "pinned" || *fixed == "radial";
  support.axial = *fixed == "pinned";
  if ((support.along_normal || support.radial) && support.place.given())
    refuse(table, "fixed",
           fmt::format("a line or a point has no \"{}\" direction; give letters out of x, y, z", *fixed));
  if (support.along_normal || support.radial) return;
  support.fixed = {};
  for (const char c : *fixed) {
    const auto d = std::string_view("xyz").find(c);
    if (d == std::string_view::npos || support.fixed[d])
      refuse(table, "fixed",
             fmt::format("found \"{}\", expected letters out of x, y, z, each once, or \"normal\", "
                         "\"pinned\", \"radial\"",
                         *fixed));
    support.fixed[d] = true;
  }
  if (fixed->empty())
    refuse(table, "fixed",
           "nothing is fixed; expected letters out of x, y, z, or \"normal\", \"pinned\", "
           "\"radial\"");
}

Support read_support(io::SettingsTable& table, std::size_t number) {
  Support support;
  support.name = name_or(table, "support", number);
  support.body = table.text("body").value_or("");
  support.place = read_place(table);
  const ReadRegion region = read_region(table);
  if (region.given && support.place.given())
    refuse(table, "region", "a line or a point is given together with a choice of surface; give one of them");
  if (!region.given && !support.place.given())
    refuse(table, "region", fmt::format("missing; {}{}", how_to_choose, or_a_place));
  support.region = region.choice;
  read_fixed(table, support);
  support.frame = read_frame(table);
  if (support.along_normal || support.radial) {
    const auto value = table.number("value");
    support.value = {value.value_or(0), 0, 0};
  } else if (const auto value = vector3(table, "value")) {
    support.value = *value;
  }
  if (const auto gradient = table.numbers("gradient", {9})) {
    if (support.along_normal || support.radial)
      refuse(table, "gradient", "a displacement along the normal or away from an axis is one number, value");
    for (std::size_t k = 0; k < 9; ++k) support.gradient[k / 3][k % 3] = (*gradient)[k];
  }
  const std::vector<std::string> methods{"nitsche", "penalty", "lagrange"};
  const std::string method = table.text("method").value_or(methods[support.place.given() ? 1 : 0]);
  const auto found = std::find(methods.begin(), methods.end(), method);
  if (found == methods.end()) {
    const auto near = io::nearest_name(method, methods);
    refuse(table, "method",
           fmt::format("found \"{}\", expected one of {}{}", method, fmt::join(methods, ", "),
                       near ? fmt::format("; did you mean {}?", *near) : ""));
  }
  support.method = static_cast<SupportMethod>(found - methods.begin());
  if (support.place.given() && support.method != SupportMethod::Penalty)
    refuse(table, "method",
           fmt::format("found \"{}\", but a line or a point is held by the method \"penalty\" alone: "
                       "it has no area that a traction could act on",
                       method));
  if (support.radial && support.method == SupportMethod::Lagrange)
    refuse(table, "method", "a cylinder is held by \"nitsche\" or \"penalty\"; leave the method out");
  if (const auto factor = table.number("penalty_factor")) {
    if (support.method != SupportMethod::Penalty)
      refuse(table, "penalty_factor",
             fmt::format("the method {} has none; add method = \"penalty\" or leave it out", method));
    if (!(*factor > 0)) refuse(table, "penalty_factor", fmt::format("found {}, expected a number above 0", *factor));
    support.penalty_factor = *factor;
  }
  return support;
}

} // namespace

std::vector<io::TableKeys> region_keys(const std::string& table) {
  return {{table, {"region", "box", "plane", "normal", "patch", "whole_surface"}},
          {table + ".patch", {"file", "tolerance"}},
          {table + ".plane", {"point", "normal", "tolerance"}},
          {table + ".normal", {"direction", "angle"}}};
}

std::vector<io::TableKeys> place_keys(const std::string& table) {
  return {{table, {"curve", "line", "point", "at"}}};
}

std::vector<io::TableKeys> load_keys(const std::string& table) {
  std::vector<io::TableKeys> keys = region_keys(table);
  keys.push_back(place_keys(table).front());
  keys.push_back({table,
                  {"name", "rotation", "rotate_axis_angle", "traction", "force", "moment", "remote", "spread",
                   "bearing", "body_force", "acceleration", "pressure"}});
  keys.push_back({table + ".centrifugal", {"axis", "point", "speed", "rpm", "angular_acceleration"}});
  return keys;
}

std::vector<io::TableKeys> static_keys() {
  std::vector<io::TableKeys> keys{
      {"load", {"body"}},
      {"support",
       {"name", "body", "fixed", "rotation", "rotate_axis_angle", "value", "gradient", "method", "penalty_factor"}},
      {"probe", {"name", "body", "position"}}};
  for (const auto& more : {load_keys("load"), region_keys("support"), place_keys("support")})
    keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

RegionChoice need_region(io::SettingsTable& table) {
  const ReadRegion region = read_region(table);
  if (!region.given) refuse(table, "region", fmt::format("missing; {}", how_to_choose));
  return region.choice;
}

std::optional<RegionChoice> region_if_given(io::SettingsTable& table) {
  const ReadRegion region = read_region(table);
  return region.given ? std::optional(region.choice) : std::nullopt;
}

RegionChoice region_or_all(io::SettingsTable& table) {
  return read_region(table).choice;
}

namespace {

// centrifugal = { axis, point, speed or rpm, angular_acceleration }
void read_spin(io::SettingsTable& table, Load& load) {
  io::SettingsTable spin = table.table("centrifugal");
  const auto axis = vector3(spin, "axis"), point = vector3(spin, "point");
  const auto speed = spin.number("speed"), acceleration = spin.number("angular_acceleration");
  load.spin.rpm = spin.number("rpm");
  if (!table.holds("centrifugal")) return;
  load.kind = LoadKind::Centrifugal;
  if (!axis) refuse(spin, "axis", "missing; give the direction of the axis as three numbers");
  if (!(norm(*axis) > 0)) refuse(spin, "axis", "the axis has no length");
  if (speed && load.spin.rpm) refuse(spin, "rpm", "given together with speed; give one of them");
  if (!speed && !load.spin.rpm && !acceleration)
    refuse(spin, "speed",
           "missing; give speed in radians per time, rpm in turns per minute, or angular_acceleration in radians per "
           "time²");
  load.spin.axis = times(*axis, 1 / norm(*axis));
  load.spin.point = point.value_or(Point3{});
  load.spin.speed = speed.value_or(0);
  load.spin.acceleration = acceleration.value_or(0);
}

void read_value(io::SettingsTable& table, Load& load) {
  constexpr std::array<std::pair<const char*, LoadKind>, 5> vectors{{{"traction", LoadKind::Traction},
                                                                     {"force", LoadKind::TotalForce},
                                                                     {"bearing", LoadKind::Bearing},
                                                                     {"body_force", LoadKind::BodyForce},
                                                                     {"acceleration", LoadKind::Acceleration}}};
  int kinds = 0;
  for (const auto& [key, kind] : vectors)
    if (const auto v = vector3(table, key)) {
      load.kind = kind;
      load.vector = *v;
      ++kinds;
    }
  if (const auto pressure = table.number("pressure")) {
    load.kind = LoadKind::Pressure;
    load.pressure = *pressure;
    ++kinds;
  }
  read_spin(table, load);
  if (table.holds("centrifugal")) ++kinds;
  if (kinds == 0 && table.holds("moment")) return; // alone
  if (kinds != 1)
    refuse(table, "traction",
           fmt::format(
               "{}; give one of traction, pressure, force (with or without a moment), moment, bearing, body_force, "
               "acceleration, centrifugal in each [[load]]",
               kinds == 0 ? "this load has no value" : "this load has more than one value"));
}

// Forces and moments that act on a region from a place beside it: moment, remote, spread.
void read_remote(io::SettingsTable& table, Load& load) {
  const auto moment = vector3(table, "moment");
  load.remote = vector3(table, "remote");
  const auto spread = table.text("spread");
  const char* first = moment ? "moment" : load.remote ? "remote" : spread ? "spread" : nullptr;
  if (!first) return;
  if (load.kind != LoadKind::TotalForce && !(load.kind == LoadKind::Traction && !table.holds("traction")))
    refuse(table, first, "only a force on a choice of surface, or a moment alone, has one; leave it out");
  if (load.place.given()) refuse(table, first, "a line or a point takes a force alone; choose surface");
  if (spread && *spread != "even" && *spread != "rigid")
    refuse(table, "spread",
           fmt::format("found \"{}\", expected \"even\" (the region deforms) or \"rigid\" (it does not)", *spread));
  load.kind = LoadKind::Remote;
  load.moment = moment.value_or(Point3{});
  load.rigid = spread && *spread == "rigid";
}

} // namespace

Load read_load(io::SettingsTable& table, std::size_t number) {
  Load load;
  load.name = name_or(table, "load", number);
  load.frame = read_frame(table);
  const ReadRegion region = read_region(table);
  load.region = region.choice;
  load.place = read_place(table);
  read_value(table, load);
  read_remote(table, load);
  const bool is_force = load.kind == LoadKind::TotalForce;
  if (is_force && load.place.given()) {
    load.kind = load.place.is_line() ? LoadKind::Line : LoadKind::Point;
  } else if (load.place.given()) {
    const char* key = table.holds("curve")  ? "curve"
                      : table.holds("line") ? "line"
                      : table.holds("at")   ? "at"
                                            : "point";
    refuse(table, key, "only a force acts along a line or at a point; leave it out, or write force = [fx, fy, fz]");
  }
  const bool on_surface = !load.place.given() && !acts_on_volume(load.kind);
  if (on_surface && !region.given)
    refuse(table, "region", fmt::format("missing; {}{}", how_to_choose, is_force ? or_a_place : ""));
  if (!on_surface && region.given)
    refuse(table, "region", "this load acts on no surface; leave the choice of surface out");
  return load;
}

std::vector<Support> read_supports(io::SettingsTable& root) {
  std::vector<Support> supports;
  for (io::SettingsTable& table : root.tables("support")) supports.push_back(read_support(table, supports.size() + 1));
  return supports;
}

namespace {

constexpr const char* thermal = "temperature"; // stands for [temperature] among the loads of a case

LoadCase read_case(io::SettingsTable& table, const StaticSettings& settings) {
  LoadCase one;
  one.name = name_or(table, "case", settings.cases.size() + 1);
  one.prescribed = table.number("prescribed").value_or(1);
  io::SettingsTable loads = table.table("loads");
  for (const Load& load : settings.loads) {
    one.factors.push_back(loads.number(load.name).value_or(0));
    const auto same = [&](const Load& other) { return other.name == load.name; };
    if (load.name == thermal && settings.temperature)
      refuse(table, "loads", "a load is called \"temperature\", which stands for [temperature] here; rename the load");
    if (std::count_if(settings.loads.begin(), settings.loads.end(), same) > 1)
      refuse(table, "loads", fmt::format("several loads are called '{}'; give each a name of its own", load.name));
  }
  for (const Bolt& bolt : settings.bolts) {
    one.bolts.push_back(loads.number(bolt.name).value_or(0));
    if (bolt.name == thermal || std::any_of(settings.loads.begin(), settings.loads.end(),
                                            [&](const Load& load) { return load.name == bolt.name; }))
      refuse(table, "loads", fmt::format("bolt '{}' has the name of something else; rename it", bolt.name));
  }
  const auto factor = loads.number(thermal);
  if (factor && !settings.temperature &&
      std::none_of(settings.loads.begin(), settings.loads.end(), [](const Load& load) { return load.name == thermal; }))
    refuse(loads, thermal, "the run has no [temperature]");
  one.temperature = factor.value_or(0);
  if (!table.holds("loads"))
    refuse(table, "loads", "missing; give factors by the names of loads: loads = { gravity = 1.5, pressure = 1 }");
  return one;
}

} // namespace

std::vector<io::TableKeys> case_keys(const io::SettingsTable& root) {
  std::map<std::string, std::string> named; // "load[2]" → its name
  for (const io::SettingsEntry& entry : root.entries()) {
    if (!entry.path.starts_with("load[") && !entry.path.starts_with("bolt[")) continue;
    const std::string table = entry.path.substr(0, entry.path.find(']') + 1);
    const std::string number = table.substr(5, table.size() - 6);
    std::string& name = named.try_emplace(table, table.substr(0, 5).replace(4, 1, " ") + number).first->second;
    if (entry.path == table + ".name" && entry.value.size() >= 2) name = entry.value.substr(1, entry.value.size() - 2);
  }
  io::TableKeys loads{"case.loads", {thermal}};
  for (const auto& [table, name] : named) loads.keys.push_back(name);
  return {{"case", {"name", "prescribed"}}, loads};
}

StaticSettings read_static_settings(io::SettingsTable& root) {
  StaticSettings settings;
  for (io::SettingsTable& table : root.tables("load")) {
    settings.loads.push_back(read_load(table, settings.loads.size() + 1));
    settings.loads.back().body = table.text("body").value_or("");
  }
  for (io::SettingsTable& table : root.tables("probe")) {
    Probe probe;
    probe.name = name_or(table, "probe", settings.probes.size() + 1);
    probe.body = table.text("body").value_or("");
    probe.position = need_vector3(table, "position", "the position");
    settings.probes.push_back(std::move(probe));
  }
  settings.temperature = read_temperature(root);
  settings.bolts = read_bolts(root);
  settings.inertia_relief = root.boolean("inertia_relief").value_or(false);
  for (io::SettingsTable& table : root.tables("case")) {
    settings.cases.push_back(read_case(table, settings));
    for (std::size_t k = 0; k + 1 < settings.cases.size(); ++k)
      if (settings.cases[k].name == settings.cases.back().name)
        refuse(table, "name",
               fmt::format("there is another case '{}'; give each a name of its own", settings.cases[k].name));
  }
  return settings;
}

} // namespace iga::solve
