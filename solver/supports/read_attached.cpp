#include "solver/supports/read_attached.hpp"

#include "solver/base/dense_algebra.hpp"
#include "solver/base/run_tables.hpp"
#include "solver/supports/read_supports.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr const char* how_to_choose =
    "missing; choose surface by region (names or numbers), box, plane, normal, patch, or whole_surface = true, a line "
    "by "
    "curve = \"name\" or line = [[x, y, z], …], or a point by point = \"name\" or at = [x, y, z]";

double stiffness(io::SettingsTable& table, const char* key) {
  return number_from(table, key, 0, 0);
}

// The other end, where the spring has one.
void read_other_end(io::SettingsTable& table, bool is_region, Spring& spring) {
  io::SettingsTable to = table.table("to");
  Spring::End end;
  end.body = to.text("body").value_or("");
  end.place = read_place(to);
  const auto region = region_if_given(to);
  if (region && end.place.given())
    refuse(to, "region", "a line or a point is given together with a choice of surface; give one of them");
  spring.axial = number_from(table, "axial", 0, 0);
  if (!region && !end.place.given()) {
    if (!end.body.empty() || table.holds("to")) refuse(to, "region", how_to_choose);
    if (table.holds("axial"))
      refuse(table, "axial", "only a spring between two ends has it; give the other end, to = { … }");
    return;
  }
  if (region) end.region = *region;
  if (table.holds("normal_stiffness") || table.holds("tangential_stiffness"))
    refuse(table, table.holds("normal_stiffness") ? "normal_stiffness" : "tangential_stiffness",
           "an elastic foundation stands on the ground; leave 'to' out, or give axial or stiffness");
  if (table.holds("axial") == spring.total.has_value())
    refuse(table, "axial",
           "a spring between two ends has either axial = k, along the line between them, or stiffness = [kx, ky, kz] "
           "between two surfaces (force/length)");
  if (spring.total && (!is_region || !region))
    refuse(
        table, "stiffness",
        "across the line between its ends a spring turns what it holds, which a line or a point does not resist; give "
        "axial = k, or surface at both ends");
  if (!spring.total && !(spring.axial > 0)) refuse(table, "axial", "the spring has no stiffness at all");
  if (!spring.total && (table.holds("rotation") || table.holds("rotate_axis_angle")))
    refuse(table, table.holds("rotation") ? "rotation" : "rotate_axis_angle",
           "an axial spring follows the line between its ends and takes no frame");
  spring.to = end;
}

Spring read_spring(io::SettingsTable& table, std::size_t number) {
  Spring spring;
  spring.name = table.text("name").value_or(fmt::format("spring {}", number));
  spring.body = table.text("body").value_or("");
  spring.place = read_place(table);
  const auto region = region_if_given(table);
  if (region && spring.place.given())
    refuse(table, "region", "a line or a point is given together with a choice of surface; give one of them");
  if (!region && !spring.place.given()) refuse(table, "region", how_to_choose);
  if (region) spring.region = *region;
  const bool foundation = table.holds("normal_stiffness") || table.holds("tangential_stiffness");
  spring.normal = stiffness(table, "normal_stiffness");
  spring.tangential = stiffness(table, "tangential_stiffness");
  spring.total = read_vector(table, "stiffness");
  spring.frame = read_frame(table);
  read_other_end(table, region.has_value(), spring);
  if (spring.to && !spring.total) return spring;
  if (foundation && spring.total)
    refuse(table, "stiffness",
           "given together with normal_stiffness or tangential_stiffness; give the spring of the whole region "
           "(force/length), or that of a unit area (force/length³)");
  if (!foundation && !spring.total)
    refuse(table, "stiffness",
           "missing; give stiffness = [kx, ky, kz] of the whole region (force/length), or normal_stiffness and "
           "tangential_stiffness of a unit area (force/length³)");
  if (foundation && !region)
    refuse(table, table.holds("normal_stiffness") ? "normal_stiffness" : "tangential_stiffness",
           "an elastic foundation needs a surface; give stiffness = [kx, ky, kz] for a line or a point");
  if (foundation && (table.holds("rotation") || table.holds("rotate_axis_angle")))
    refuse(table, table.holds("rotation") ? "rotation" : "rotate_axis_angle",
           "an elastic foundation follows the surface's normal and takes no frame");
  const auto negative = [](double k) { return !(k >= 0); };
  if (spring.total && std::any_of(spring.total->begin(), spring.total->end(), negative))
    refuse(table, "stiffness", "found a number below 0, expected three numbers of at least 0");
  const auto zero = [](double k) { return k == 0; };
  if (spring.total ? std::all_of(spring.total->begin(), spring.total->end(), zero)
                   : spring.normal == 0 && spring.tangential == 0)
    refuse(table, spring.total ? "stiffness" : "normal_stiffness", "the spring has no stiffness at all");
  return spring;
}

// Ixx, Iyy, Izz, Ixy, Iyz, Izx with off-diagonal entries of the matrix itself (-∫ x y dm).
void read_inertia(io::SettingsTable& table, AddedMass& mass) {
  const auto v = table.numbers("inertia", {3, 6});
  if (!v) return;
  for (Eigen::Index d = 0; d < 3; ++d) mass.inertia(d, d) = (*v)[static_cast<std::size_t>(d)];
  if (v->size() == 6)
    for (const auto& [i, j, k] : {std::array<int, 3>{0, 1, 3}, {1, 2, 4}, {2, 0, 5}})
      mass.inertia(i, j) = mass.inertia(j, i) = (*v)[static_cast<std::size_t>(k)];
  const Eigen::VectorXd principal = symmetric_eigen(mass.inertia).values;
  constexpr double typed_digits = 1e-6;
  const double room = typed_digits * std::max(principal[2], 0.0);
  if (principal[0] < -room || principal[2] > principal[0] + principal[1] + room)
    refuse(table, "inertia",
           fmt::format("its principal moments are {:.6g}, {:.6g}, {:.6g}: no body has such, each is at most the sum of "
                       "the others; give [Ixx, Iyy, Izz] or [Ixx, Iyy, Izz, Ixy, Iyz, Izx] about the body's own "
                       "centre, Ixy = -∫ x y dm",
                       principal[0], principal[1], principal[2]));
}

AddedMass read_mass(io::SettingsTable& table, std::size_t number) {
  AddedMass mass;
  mass.name = table.text("name").value_or(fmt::format("added mass {}", number));
  mass.body = table.text("body").value_or("");
  mass.mass = need_number(table, "mass", "the mass that is added");
  if (!(mass.mass >= 0)) refuse(table, "mass", fmt::format("found {:g}, expected a number of at least 0", mass.mass));
  mass.place = read_place(table);
  const auto region = region_if_given(table);
  read_inertia(table, mass);
  const bool turns = table.holds("inertia");
  if (region) {
    mass.region = *region;
    if (mass.place.is_line() || !mass.place.marker.empty())
      refuse(table, mass.place.is_line() ? (table.holds("curve") ? "curve" : "line") : "point",
             "given together with a choice of surface; give one of them, or at = [x, y, z] for the centre of a rigid "
             "body that is joined to the surface");
    mass.centre = mass.place.at;
    mass.place = {};
    mass.rigid = mass.centre.has_value() || turns;
    const auto spread = table.text("spread");
    if (spread && *spread != "average" && *spread != "rigid")
      refuse(table, "spread",
             fmt::format("found \"{}\", expected \"average\" (the body moves with the average motion of the region, "
                         "which deforms) or \"rigid\" (the region moves as a rigid body with it)",
                         *spread));
    mass.holds_region = spread && *spread == "rigid";
    if (mass.holds_region) mass.rigid = true;
  } else {
    if (!mass.place.given()) refuse(table, "region", how_to_choose);
    if (table.holds("spread")) refuse(table, "spread", "only a body that is joined to a choice of surface has it");
    if (turns)
      refuse(table, "inertia", "a line or a point does not turn a body with it; join the body to a choice of surface");
  }
  if (mass.mass == 0 && mass.inertia.isZero())
    refuse(table, "mass", "neither mass nor inertia is above 0; nothing is added");
  return mass;
}

} // namespace

std::vector<Spring> read_springs(io::SettingsTable& root) {
  std::vector<Spring> springs;
  for (io::SettingsTable& table : root.tables("spring")) springs.push_back(read_spring(table, springs.size() + 1));
  return springs;
}

std::vector<AddedMass> read_masses(io::SettingsTable& root) {
  std::vector<AddedMass> masses;
  for (io::SettingsTable& table : root.tables("added_mass")) masses.push_back(read_mass(table, masses.size() + 1));
  return masses;
}

std::vector<io::TableKeys> attached_keys() {
  std::vector<io::TableKeys> keys{{"spring",
                                   {"name", "body", "stiffness", "normal_stiffness", "tangential_stiffness", "rotation",
                                    "rotate_axis_angle", "axial"}},
                                  {"spring.to", {"body"}},
                                  {"added_mass", {"name", "body", "mass", "inertia", "spread"}}};
  for (const char* table : {"spring", "spring.to", "added_mass"}) {
    for (const auto& more : region_keys(table)) keys.push_back(more);
    for (const auto& more : place_keys(table)) keys.push_back(more);
  }
  return keys;
}

} // namespace iga::solve
