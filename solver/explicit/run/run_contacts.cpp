// [[contacts]] and [contact] of a run file.
#include "solver/explicit/run/run_parts.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

ContactSide side_by_name(const io::SettingsTable& table, const char* key, const std::string& name,
                         const ExplicitRun& run) {
  std::vector<std::string> known;
  for (const BodyRun& body : run.bodies) known.push_back(body.body.name);
  for (const RigidRun& rigid : run.rigid) known.push_back(rigid.body.name);
  const std::size_t n = choose(table, key, name, known);
  if (n < run.bodies.size()) return {ContactSide::Kind::Deformable, n, {}};
  return {ContactSide::Kind::Rigid, n - run.bodies.size(), {}};
}

FrictionLaw read_friction(io::SettingsTable& table) {
  FrictionLaw law;
  law.static_coefficient = number_from(table, "friction", 0, 0);
  law.dynamic_coefficient = number_from(table, "friction_dynamic", law.static_coefficient, 0);
  law.decay = number_from(table, "friction_decay", 0, 0);
  if (law.dynamic_coefficient > law.static_coefficient)
    refuse(table, "friction_dynamic",
           fmt::format("found {:g}, expected no more than the static coefficient {:g}", law.dynamic_coefficient,
                       law.static_coefficient));
  return law;
}

ContactRun read_contact(io::SettingsTable& table, ExplicitRun& run) {
  ContactRun contact;
  ContactPair& pair = contact.pair;
  pair.where = place_of(table, "bodies");
  const auto names = table.texts("bodies");
  const auto self = table.text("self");
  if (self.has_value() == names.has_value())
    refuse(table, "bodies", "give either bodies = [\"first\", \"second\"] or self = \"body\" in each [[contacts]]");
  if (self) {
    pair.first = pair.second = side_by_name(table, "self", *self, run);
    if (pair.first.kind == ContactSide::Kind::Rigid)
      refuse(table, "self", fmt::format("'{}' is rigid and cannot touch itself", *self));
  } else {
    if (names->size() != 2) refuse(table, "bodies", fmt::format("found {} names, expected two", names->size()));
    pair.first = side_by_name(table, "bodies", (*names)[0], run);
    pair.second = side_by_name(table, "bodies", (*names)[1], run);
    if (pair.first.kind == ContactSide::Kind::Rigid && pair.second.kind == ContactSide::Kind::Rigid)
      refuse(table, "bodies", "both are rigid; one side of a contact deforms");
  }
  pair.first.regions = table.texts("first_regions").value_or(std::vector<std::string>{});
  pair.second.regions = table.texts("second_regions").value_or(std::vector<std::string>{});
  for (const auto& [key, side] : {std::pair("first_regions", &pair.first), std::pair("second_regions", &pair.second)})
    if (side->kind == ContactSide::Kind::Rigid && !side->regions.empty())
      refuse(table, key, "a rigid body has no regions; leave it out");
  contact.swapped = pair.first.kind == ContactSide::Kind::Rigid;
  if (contact.swapped) std::swap(pair.first, pair.second);
  pair.name = read_name(table, "name", self ? *self + " self" : (*names)[0] + "-" + (*names)[1]);
  pair.friction = read_friction(table);
  pair.stiffness = number_from(table, "stiffness", pair.stiffness, 0, true);
  pair.damping = number_from(table, "damping", pair.damping, 0);
  pair.edges = table.boolean("edges").value_or(pair.edges);
  return contact;
}

} // namespace

void read_contacts(io::SettingsTable& root, ExplicitRun& run) {
  io::SettingsTable all = root.table("contact");
  run.contact.skin = number_from(all, "skin", run.contact.skin, 0, true);
  for (io::SettingsTable& table : root.tables("contacts")) {
    run.contacts.push_back(read_contact(table, run));
    for (std::size_t c = 0; c + 1 < run.contacts.size(); ++c)
      if (run.contacts[c].pair.name == run.contacts.back().pair.name)
        refuse(table, "name",
               fmt::format("there is another contact '{}'; give each a name", run.contacts[c].pair.name));
  }
}

} // namespace iga::solve
