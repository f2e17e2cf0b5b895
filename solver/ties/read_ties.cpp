#include "solver/ties/read_ties.hpp"

#include "solver/base/run_tables.hpp"
#include "solver/supports/read_supports.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr std::array<const char*, 2> sides{"first", "second"};

void read_method(io::SettingsTable& table, Tie& tie) {
  const std::array<std::string, 2> methods{"nitsche", "penalty"};
  tie.method = choose(table, "method", table.text("method").value_or(methods[0]), methods) == 0 ? TieMethod::Nitsche
                                                                                                : TieMethod::Penalty;
  if (table.holds("penalty_factor") && tie.method == TieMethod::Nitsche)
    refuse(table, "penalty_factor", "only method = \"penalty\" takes it; Nitsche's method finds its own");
  tie.penalty_factor = number_from(table, "penalty_factor", tie.penalty_factor, 0, true);
}

Tie read_tie(io::SettingsTable& table, std::size_t number) {
  Tie tie;
  tie.name = table.text("name").value_or(fmt::format("tie {}", number));
  tie.where = place_of(table, "name");
  if (const auto bodies = table.texts("bodies")) {
    if (bodies->size() != 2)
      refuse(table, "bodies", fmt::format("found {} names, expected the names of two bodies", bodies->size()));
    tie.bodies = {(*bodies)[0], (*bodies)[1]};
  }
  for (std::size_t s = 0; s < 2; ++s) {
    if (table.holds(sides[s]) && !tie.bodies)
      refuse(table, sides[s], "a choice of surface belongs to a body; name both: bodies = [\"a\", \"b\"]");
    io::SettingsTable side = table.table(sides[s]);
    tie.choice[s] = region_or_all(side);
  }
  if (table.holds("tolerance")) tie.tolerance = number_from(table, "tolerance", 0, 0);
  read_method(table, tie);
  return tie;
}

} // namespace

std::vector<io::TableKeys> tie_keys() {
  std::vector<io::TableKeys> keys{
      {"ties", {"name", "bodies", "first", "second", "tolerance", "method", "penalty_factor"}}};
  for (const char* side : sides)
    for (const auto& more : region_keys(fmt::format("ties.{}", side))) keys.push_back(more);
  return keys;
}

std::vector<Tie> read_ties(io::SettingsTable& root) {
  std::vector<Tie> ties;
  for (io::SettingsTable& table : root.tables("ties")) ties.push_back(read_tie(table, ties.size() + 1));
  return ties;
}

} // namespace iga::solve
