// [[rigid_bodies]] of a run file.
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/explicit/contact/tool_mesh.hpp"
#include "solver/explicit/run/run_parts.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

// The STL tool with a density gives its mass; other shapes have none.
struct ReadShape {
  RigidShape shape;
  Point3 centre{};
  std::optional<ToolMesh> tool;
};

ReadShape read_shape(io::SettingsTable& table, RigidRun& rigid) {
  const std::array<std::string, 5> names{"sphere", "plane", "cylinder", "box", "stl"};
  const auto word = table.text("shape");
  if (!word) refuse(table, "shape", "missing; expected sphere, plane, cylinder, box or stl");
  const std::size_t kind = choose(table, "shape", *word, names);
  ReadShape read;
  const std::array<std::vector<std::string>, 5> own{
      {{"radius"}, {"normal"}, {"radius", "axis", "height"}, {"size"}, {"file", "scale", "density"}}};
  const auto radius = table.number("radius");
  const auto normal = read_vector(table, "normal"), axis = read_vector(table, "axis"),
             size = read_vector(table, "size"), centre = read_vector(table, "centre");
  const auto height = table.number("height"), scale = table.number("scale"), density = table.number("density");
  const auto file = table.path("file");
  const std::array<std::pair<const char*, bool>, 8> given{{{"radius", radius.has_value()},
                                                           {"normal", normal.has_value()},
                                                           {"axis", axis.has_value()},
                                                           {"size", size.has_value()},
                                                           {"height", height.has_value()},
                                                           {"scale", scale.has_value()},
                                                           {"density", density.has_value()},
                                                           {"file", file.has_value()}}};
  for (const auto& [key, is_given] : given)
    if (is_given && std::find(own[kind].begin(), own[kind].end(), key) == own[kind].end())
      refuse(table, key, fmt::format("a {} has none; leave it out", names[kind]));
  const auto need = [&](const char* key, const auto& value, const char* what) {
    if (!value) refuse(table, key, fmt::format("missing; give {}", what));
    return *value;
  };
  const auto positive = [&](const char* key, double value) {
    if (!(value > 0)) refuse(table, key, fmt::format("found {:g}, expected a number above 0", value));
    return value;
  };
  if (kind != 4) read.centre = need("centre", centre, kind == 1 ? "a point of the plane" : "three numbers");
  if (kind == 0) {
    read.shape = SphereShape{positive("radius", need("radius", radius, "the sphere's radius"))};
  } else if (kind == 1) {
    read.shape = PlaneShape{unit_vector(table, "normal", need("normal", normal, "the normal, away from the solid"))};
  } else if (kind == 2) {
    read.shape = CylinderShape{unit_vector(table, "axis", need("axis", axis, "the direction of the axis")),
                               positive("radius", need("radius", radius, "the cylinder's radius")),
                               positive("height", need("height", height, "the cylinder's height")) / 2};
  } else if (kind == 3) {
    const Point3 s = need("size", size, "three side lengths");
    for (const double side : s) positive("size", side);
    read.shape = box_shape(times(s, 0.5));
  } else {
    rigid.file = need("file", file, "an STL file");
    try {
      read.tool = read_tool(rigid.file, scale ? positive("scale", *scale) : 1);
    } catch (const InputError& error) {
      refuse(table, "file", error.what());
    }
    read.shape = read.tool->shape;
    read.centre = centre.value_or(read.tool->centre);
  }
  return read;
}

std::array<std::array<double, 3>, 3> read_inertia(io::SettingsTable& table) {
  const auto v = table.numbers("inertia", {1, 3, 6, 9});
  if (!v)
    refuse(table, "inertia",
           "missing; give one number, three principal ones, six (xx yy zz xy yz zx) or nine about the centre, or "
           "rotates = false");
  const auto& n = *v;
  if (n.size() == 1) return {{{n[0], 0, 0}, {0, n[0], 0}, {0, 0, n[0]}}};
  if (n.size() == 3) return {{{n[0], 0, 0}, {0, n[1], 0}, {0, 0, n[2]}}};
  if (n.size() == 6) return {{{n[0], n[3], n[5]}, {n[3], n[1], n[4]}, {n[5], n[4], n[2]}}};
  return {{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}}};
}

FreeMotion read_free(io::SettingsTable& table, const ReadShape& read, const Point3& gravity) {
  FreeMotion motion;
  motion.rotates = table.boolean("rotates").value_or(true);
  const auto density = table.number("density"), mass = table.number("mass");
  if (density && read.tool) {
    if (mass) refuse(table, "mass", "given together with density; give one of them");
    if (!(*density > 0)) refuse(table, "density", fmt::format("found {:g}, expected a number above 0", *density));
    const bool rotates = motion.rotates;
    motion = solid_tool(*read.tool, *density);
    motion.rotates = rotates;
  } else {
    if (!mass) refuse(table, "mass", "missing; a free body has a mass");
    if (!(*mass > 0)) refuse(table, "mass", fmt::format("found {:g}, expected a mass above 0", *mass));
    motion.mass = *mass;
    if (motion.rotates) motion.inertia = read_inertia(table);
  }
  motion.velocity = read_vector(table, "velocity").value_or(Point3{});
  motion.angular_velocity = read_vector(table, "spin").value_or(Point3{});
  motion.acceleration = gravity;
  if (const auto guided = table.text("guided"))
    for (const char c : *guided) {
      const auto d = std::string_view("xyz").find(c);
      if (d == std::string_view::npos)
        refuse(table, "guided", fmt::format("found \"{}\", expected letters out of x, y, z", *guided));
      motion.guided[d] = true;
    }
  return motion;
}

// Keys that belong to another motion are refused rather than passed over.
void refuse_keys(io::SettingsTable& table, const char* motion, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (table.holds(key))
      refuse(table, key, fmt::format("a {} body has none; leave it out or change its motion", motion));
}

RigidRun read_rigid(io::SettingsTable& table, const Point3& gravity, ExplicitRun& run) {
  RigidRun rigid;
  rigid.where = place_of(table, "shape");
  const ReadShape read = read_shape(table, rigid);
  if (!rigid.file.empty()) run.inputs.push_back({rigid.file, table.where("file")});
  rigid.body.name = read_name(table, "name", fmt::format("rigid {}", run.rigid.size() + 1));
  rigid.body.shape = read.shape;
  rigid.body.centre = read.centre;
  const DriveCurves drive = read_drive(table, true, run.inputs);
  const std::array<std::string, 3> motions{"fixed", "driven", "free"};
  const std::size_t motion =
      choose(table, "motion", table.text("motion").value_or(motions[drive.given() ? 1 : 0]), motions);
  if (motion != 2)
    refuse_keys(table, motions[motion].c_str(),
                {"mass", "inertia", "velocity", "spin", "guided", "rotates", "density"});
  if (motion != 1 && drive.given())
    refuse(table, "drive",
           fmt::format("a {} body is not driven; leave it out or set motion = \"driven\"", motions[motion]));
  if (motion == 1) {
    if (!drive.given()) refuse(table, "drive", "missing; give [rigid_bodies.drive] with curves x, y, z or rotation");
    rigid.body.motion = PrescribedMotion{drive.along, drive.rotation, drive.axis, drive.are_velocities};
  } else if (motion == 2) {
    if (std::holds_alternative<PlaneShape>(read.shape))
      refuse(table, "motion", "a plane has no end and cannot move freely; use a box");
    rigid.body.motion = read_free(table, read, gravity);
  }
  try {
    const RigidState trial(rigid.body);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", rigid.where, error.what()));
  }
  return rigid;
}

} // namespace

void read_rigid_bodies(io::SettingsTable& root, const Point3& gravity, ExplicitRun& run) {
  for (io::SettingsTable& table : root.tables("rigid_bodies")) {
    run.rigid.push_back(read_rigid(table, gravity, run));
    const std::string& name = run.rigid.back().body.name;
    bool taken = false;
    for (const BodyRun& body : run.bodies) taken = taken || body.body.name == name;
    for (std::size_t r = 0; r + 1 < run.rigid.size(); ++r) taken = taken || run.rigid[r].body.name == name;
    if (taken) refuse(table, "name", fmt::format("there is another body '{}'; give each a name", name));
  }
}

} // namespace iga::solve
