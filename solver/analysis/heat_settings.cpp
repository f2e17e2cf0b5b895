#include "solver/analysis/heat_settings.hpp"

#include "solver/base/run_tables.hpp"
#include "solver/supports/read_supports.hpp"

#include <array>
#include <fmt/format.h>

namespace iga::solve {

namespace {

constexpr const char* how_to_choose =
    "missing; choose surface by region (names or numbers), box, plane, normal, patch, or whole_surface = true";

HeatBoundary read_boundary(io::SettingsTable& table, std::size_t number) {
  HeatBoundary one;
  one.name = table.text("name").value_or(fmt::format("heat {}", number));
  constexpr std::array<std::pair<const char*, HeatKind>, 4> kinds{{{"temperature", HeatKind::Temperature},
                                                                   {"flux", HeatKind::Flux},
                                                                   {"power", HeatKind::Power},
                                                                   {"source", HeatKind::Source}}};
  int given = 0;
  for (const auto& [key, kind] : kinds)
    if (const auto value = table.number(key)) {
      one.kind = kind;
      one.value = *value;
      ++given;
    }
  io::SettingsTable convection = table.table("convection");
  const auto coefficient = convection.number("coefficient"), ambient = convection.number("ambient");
  if (table.holds("convection")) {
    one.kind = HeatKind::Convection;
    ++given;
    if (!coefficient) refuse(convection, "coefficient", "missing; give the film coefficient, power/(area temperature)");
    if (!(*coefficient > 0))
      refuse(convection, "coefficient", fmt::format("found {:g}, expected a number above 0", *coefficient));
    if (!ambient) refuse(convection, "ambient", "missing; give the temperature of the surroundings");
    one.value = *coefficient;
    one.ambient = *ambient;
  }
  if (given != 1)
    refuse(
        table, "temperature",
        fmt::format("{}; give one of temperature, flux, power, convection = {{ coefficient, ambient }}, source in each "
                    "[[heat]]",
                    given == 0 ? "this [[heat]] has no value" : "this [[heat]] has more than one value"));
  const bool whole = table.boolean("whole_surface").value_or(false);
  bool chosen = whole;
  for (const char* key : {"region", "box", "plane", "normal", "patch"}) chosen = chosen || table.holds(key);
  one.region = region_or_all(table);
  if (one.kind == HeatKind::Source && chosen)
    refuse(table, "region", "a source is in the whole body; leave the choice of surface out");
  if (one.kind != HeatKind::Source && !chosen) refuse(table, "region", how_to_choose);
  return one;
}

} // namespace

const char* name_of(HeatKind kind) {
  switch (kind) {
  case HeatKind::Temperature:
    return "temperature";
  case HeatKind::Flux:
  case HeatKind::Power:
    return "flux";
  case HeatKind::Convection:
    return "convection";
  default:
    return "source";
  }
}

std::vector<io::TableKeys> heat_keys() {
  std::vector<io::TableKeys> keys = region_keys("heat");
  keys.push_back({"heat", {"name", "temperature", "flux", "power", "source"}});
  keys.push_back({"heat.convection", {"coefficient", "ambient"}});
  return keys;
}

std::vector<HeatBoundary> read_heat(io::SettingsTable& root) {
  std::vector<HeatBoundary> all;
  for (io::SettingsTable& table : root.tables("heat")) all.push_back(read_boundary(table, all.size() + 1));
  return all;
}

} // namespace iga::solve
