#include "solver/mechanics/material_table.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "solver/mechanics/unit_check.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

/// samples/materials.toml as it was when the program was built (material_table_text.cpp.in).
extern const char* const built_in_materials;

namespace {

constexpr std::array<UnitSystem, 3> unit_systems{{{"t-mm-s", "mm", 1e3, 1e-3, 1, "MPa", "t/mm³"},
                                                  {"kg-mm-ms", "mm", 1, 1e-3, 1e-3, "GPa", "kg/mm³"},
                                                  {"SI", "m", 1, 1, 1, "Pa", "kg/m³"}}};

std::vector<std::string> system_names(std::string_view length) {
  std::vector<std::string> names;
  for (const UnitSystem& system : unit_systems)
    if (length.empty() || system.length == length) names.emplace_back(system.name);
  return names;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

double need_number(io::SettingsTable& table, const char* key) {
  const auto value = table.number(key);
  if (!value)
    throw InputError(fmt::format("{}: missing; every material has E (Pa), nu and rho (kg/m³)", table.where(key)));
  return *value;
}

// Names of the tables of a file, in the alphabet's order.
std::vector<std::string> table_names(const io::SettingsTable& root) {
  std::vector<std::string> names;
  for (const io::SettingsEntry& entry : root.entries()) {
    const std::string name = entry.path.substr(0, entry.path.rfind('.'));
    if (entry.path.find('.') == std::string::npos)
      throw InputError(
          fmt::format("{}: stands outside of a material; write [name of the material] above its E, nu and rho",
                      root.where(entry.path)));
    if (names.empty() || names.back() != name) names.push_back(name);
  }
  return names;
}

} // namespace

const UnitSystem& choose_units(const std::optional<std::string>& wish, std::string_view length_unit,
                               const std::string& model) {
  if (wish && std::none_of(unit_systems.begin(), unit_systems.end(), [&](const auto& s) { return s.name == *wish; })) {
    const auto near = io::nearest_name(*wish, system_names(""));
    throw InputError(fmt::format("unit_system: found \"{}\", expected one of {}{}", *wish,
                                 fmt::join(system_names(""), ", "),
                                 near ? fmt::format("; did you mean {}?", *near) : ""));
  }
  if (length_unit == "unspecified")
    throw InputError(
        fmt::format("{}: the model has no length unit, so that no material's numbers can be given in its units; "
                    "make it with igaprep --length-unit mm (or m), or give E, nu and rho as numbers in any "
                    "consistent set of units",
                    model));
  const std::string_view length = common_length_name(length_unit);
  for (const UnitSystem& system : unit_systems) {
    if (wish ? system.name != *wish : system.length != length) continue;
    if (system.length == length) return system;
    const auto fitting = system_names(length);
    throw InputError(fmt::format("unit_system: \"{}\" has lengths in {}, but the length unit of {} is \"{}\"; {}",
                                 *wish, system.length, model, length_unit,
                                 fitting.empty() ? "give E, nu and rho as numbers and leave unit_system out"
                                                 : fmt::format("choose {}", fmt::join(fitting, " or "))));
  }
  throw InputError(
      fmt::format("{}: named materials are known in the units {}, none of which has lengths in \"{}\"; give E, "
                  "nu and rho as numbers, or make the model in mm or m",
                  model, fmt::join(system_names(""), ", "), length_unit));
}

NamedMaterial find_material(const std::string& name, const std::optional<std::filesystem::path>& file) {
  io::SettingsTable root =
      file ? io::SettingsTable::read(*file) : io::SettingsTable::parse(built_in_materials, "samples/materials.toml");
  std::vector<std::string> titles = table_names(root), known;
  std::optional<NamedMaterial> found;
  for (const std::string& title : titles) {
    io::SettingsTable table = root.table(title);
    const NamedMaterial material{title,
                                 table.text("source").value_or(""),
                                 need_number(table, "E"),
                                 need_number(table, "nu"),
                                 need_number(table, "rho"),
                                 table.number("expansion"),
                                 table.number("conductivity"),
                                 table.number("yield")};
    if (material.conductivity && !(*material.conductivity > 0))
      throw InputError(
          fmt::format("{}: found {:g}, expected W/(m K) above 0", table.where("conductivity"), *material.conductivity));
    // From glass ceramics (-1e-6) to rubbers and waxes: beyond, it is given per something else than a kelvin.
    if (material.expansion && std::abs(*material.expansion) > 1e-3)
      throw InputError(
          fmt::format("{}: found {:g}, expected 1/K (steel: 12e-6)", table.where("expansion"), *material.expansion));
    std::vector<std::string> names = table.texts("aliases").value_or(std::vector<std::string>{});
    names.insert(names.begin(), title);
    try {
      isotropic(material.E, material.nu, material.rho);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", table.where("E"), error.what()));
    }
    if (material.yield && !(*material.yield > 0 && *material.yield < material.E))
      throw InputError(fmt::format("{}: found {}, expected a stress in Pa above 0 and below E", table.where("yield"),
                                   *material.yield));
    if (const auto warning = unit_warning("m", material.E, material.rho))
      throw InputError(fmt::format("{}: E is in Pa and rho in kg/m³ here; {}", table.where("E"), *warning));
    if (std::any_of(names.begin(), names.end(), [&](const auto& other) { return lower(other) == lower(name); }))
      found = material;
    known.insert(known.end(), names.begin(), names.end());
  }
  root.refuse_unknown_keys();
  if (found) return *found;
  for (std::string& word : known) word = lower(word);
  const auto near = io::nearest_name(lower(name), known);
  throw InputError(fmt::format(
      "material: there is no \"{}\" in {}{}; there are {} (and other names of these); or give E, nu and rho as numbers",
      name, file ? file->string() : "the table of materials", near ? fmt::format("; did you mean \"{}\"", *near) : "",
      fmt::join(titles, ", ")));
}

std::optional<double> mass_in_kg(const MaterialWords& words, double volume) {
  return words.units && words.rho ? std::optional(*words.rho * volume * words.units->kg) : std::nullopt;
}

std::string material_text(const MaterialWords& words, double volume) {
  const auto unit = [&](std::string_view label) { return words.units ? fmt::format(" {}", label) : std::string(); };
  std::vector<std::string> numbers;
  if (words.E) numbers.push_back(fmt::format("E = {:.6g}{}", *words.E, unit(words.units ? words.units->stress : "")));
  if (words.nu) numbers.push_back(fmt::format("nu = {:.6g}", *words.nu));
  if (!words.E && !words.conductivity) numbers.emplace_back("stiffness matrix C as given");
  if (words.rho)
    numbers.push_back(fmt::format("rho = {:.6g}{}", *words.rho, unit(words.units ? words.units->density : "")));
  if (words.yield)
    numbers.push_back(fmt::format("yield = {:.6g}{}", *words.yield, unit(words.units ? words.units->stress : "")));
  std::string text =
      fmt::format("{}{}{}{}", words.name, words.name.empty() ? "" : ": ", fmt::join(numbers, ", "),
                  words.units ? fmt::format("; units {}", words.units->name) : "; in the units of model and run file");
  if (!words.source.empty()) text += fmt::format("; from {}", words.source);
  if (const auto mass = mass_in_kg(words, volume)) text += fmt::format("\nthe part has a mass of {:.4g} kg", *mass);
  return text;
}

} // namespace iga::solve
