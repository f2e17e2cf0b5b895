#include "solver/analysis/response_settings.hpp"

#include "solver/base/run_tables.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

std::optional<double> number_above(io::SettingsTable& table, const char* key, double least, bool open) {
  if (!table.holds(key)) return std::nullopt;
  return number_from(table, key, 0, least, open);
}

// Frequencies or times.
std::vector<double> list_from(io::SettingsTable& table, const char* key, const char* what) {
  std::vector<double> values = table.number_list(key).value_or(std::vector<double>{});
  for (const double value : values)
    if (!(value >= 0)) refuse(table, key, fmt::format("found {:g}, expected {} of at least 0", value, what));
  return values;
}

int points_from(io::SettingsTable& table, int otherwise) {
  const auto points = table.integer("points").value_or(otherwise);
  if (points < 2 || points > 1'000'000) refuse(table, "points", fmt::format("found {}, expected 2 … 1000000", points));
  return static_cast<int>(points);
}

void need_density(io::SettingsTable& table, const std::optional<NumberCurve>& psd) {
  if (!psd) return;
  for (std::size_t k = 0; k < psd->x.size(); ++k) {
    if (!(psd->y[k] >= 0)) refuse(table, "psd", fmt::format("found a density of {:g}, expected 0 or more", psd->y[k]));
    if (!psd->is_constant() && !(psd->x[k] > 0))
      refuse(table, "psd",
             fmt::format("found the frequency {:g}, expected frequencies above 0: lines are straight over their "
                         "logarithms",
                         psd->x[k]));
  }
}

Variation read_variation(io::SettingsTable& table, const char* key) {
  Variation v;
  v.where = table.where(key);
  v.spectrum = read_number_curve(table, "spectrum");
  if (v.spectrum && !v.spectrum->is_constant() && v.spectrum->x.front() < 0)
    refuse(table, "spectrum", fmt::format("found the frequency {:g}, expected 0 or more", v.spectrum->x.front()));
  v.phase = table.number("phase").value_or(0);
  v.psd = read_number_curve(table, "psd");
  need_density(table, v.psd);
  v.history = read_number_curve(table, "history");
  if (v.history && v.history->x.front() < 0)
    refuse(table, "history", fmt::format("found the time {:g}, expected 0 or more", v.history->x.front()));
  return v;
}

std::optional<BaseMotion> read_base(io::SettingsTable& root) {
  io::SettingsTable table = root.table("base");
  BaseMotion base;
  const auto direction = read_vector(table, "direction");
  base.acceleration = read_variation(table, "direction");
  const std::optional<std::string> unit = table.text("unit");
  base.gravity = number_above(table, "gravity", 0, true);
  if (!direction) {
    if (base.acceleration.given() || unit || base.gravity)
      refuse(table, "direction", "missing; give the direction in which all supports move, as in [0, 0, 1]");
    return std::nullopt;
  }
  base.direction = unit_vector(table, "direction", *direction);
  if (unit && *unit != "g")
    refuse(table, "unit",
           fmt::format("found \"{}\", expected \"g\", or none for accelerations in length/time² of the model's units",
                       *unit));
  base.in_g = unit.has_value();
  if (base.gravity && !base.in_g)
    refuse(table, "gravity", "only accelerations in g need it; add unit = \"g\" or leave it out");
  return base;
}

DampingSettings read_damping(io::SettingsTable& root) {
  DampingSettings damping;
  io::SettingsTable table = root.table("damping");
  damping.where = table.where("ratio");
  const char* first = nullptr;
  for (const char* key : {"ratio", "modes", "table", "rayleigh", "structural"}) {
    if (!table.holds(key)) continue;
    if (first) refuse(table, key, fmt::format("given together with {}; give one of them", first));
    first = key;
  }
  damping.given = first != nullptr;
  const auto check = [&](const char* key, double ratio) {
    if (!(ratio >= 0 && ratio < 1))
      refuse(table, key, fmt::format("found {:g}, expected a share of critical damping, 0 … 1", ratio));
  };
  damping.ratio = table.number("ratio").value_or(0);
  check("ratio", damping.ratio);
  if (auto ratios = table.number_list("modes")) damping.mode_ratios = std::move(*ratios);
  if (table.holds("modes") && damping.mode_ratios.empty())
    refuse(table, "modes", "the list is empty; give a ratio for each elastic mode, the last one for all others");
  for (const double ratio : damping.mode_ratios) check("modes", ratio);
  damping.table = read_number_curve(table, "table");
  if (damping.table)
    for (const double ratio : damping.table->y) check("table", ratio);
  if (const auto rayleigh = table.numbers("rayleigh", {2})) {
    damping.alpha = (*rayleigh)[0];
    damping.beta = (*rayleigh)[1];
    if (!(damping.alpha >= 0 && damping.beta >= 0))
      refuse(table, "rayleigh", "found a negative number, expected [alpha, beta] of C = alpha M + beta K");
  }
  damping.structural = number_from(table, "structural", 0, 0);
  return damping;
}

} // namespace

ResponseSettings read_response_settings(io::SettingsTable& root) {
  ResponseSettings s;
  s.residual_vectors = root.table("response").boolean("residual_vectors").value_or(true);
  s.damping = read_damping(root);
  s.base = read_base(root);
  for (io::SettingsTable& load : root.tables("load")) s.loads.push_back(read_variation(load, "name"));

  const auto range = [](io::SettingsTable& table, auto& to) {
    to.from = number_above(table, "from", 0, false);
    to.to = number_above(table, "to", 0, true);
    if (to.from && to.to && !(*to.from < *to.to))
      refuse(table, "to", fmt::format("found {:g}, expected more than from = {:g}", *to.to, *to.from));
    to.points = points_from(table, to.points);
  };
  io::SettingsTable harmonic = root.table("harmonic");
  range(harmonic, s.harmonic);
  s.harmonic.frequencies = list_from(harmonic, "frequencies", "frequencies");
  s.harmonic.fields = list_from(harmonic, "fields", "frequencies");
  io::SettingsTable random = root.table("random");
  range(random, s.random);
  io::SettingsTable transient = root.table("transient");
  s.transient.end = number_above(transient, "end", 0, true).value_or(0);
  s.transient.step = number_above(transient, "step", 0, true).value_or(s.transient.end / 1000);
  s.transient.fields = list_from(transient, "fields", "times");
  constexpr double most = 2e5; // rows that nobody would read
  if (s.transient.end > most * s.transient.step)
    refuse(transient, "step",
           fmt::format("{:.3g} outputs until the end are more than {:g}; choose a longer step",
                       s.transient.end / s.transient.step, most));
  for (const double time : s.transient.fields)
    if (time > s.transient.end)
      refuse(transient, "fields", fmt::format("found {:g}, expected times until the end, {:g}", time, s.transient.end));
  return s;
}

std::vector<io::TableKeys> response_keys() {
  const std::vector<std::string> variation{"spectrum", "phase", "psd", "history"};
  std::vector<std::string> base{"direction", "unit", "gravity"};
  base.insert(base.end(), variation.begin(), variation.end());
  return {{"load", variation},
          {"base", base},
          {"damping", {"ratio", "modes", "table", "rayleigh", "structural"}},
          {"response", {"residual_vectors"}},
          {"harmonic", {"from", "to", "points", "frequencies", "fields"}},
          {"random", {"from", "to", "points"}},
          {"transient", {"end", "step", "fields"}}};
}

} // namespace iga::solve
