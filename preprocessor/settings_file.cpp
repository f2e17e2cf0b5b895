// prep.toml → TypedSettings. The keys are the flags' names with underscores.
#include "preprocessor/settings.hpp"

#include "format/io/settings_reader.hpp"

namespace iga::prep {

TypedSettings read_settings_file(const std::filesystem::path& file) {
  io::SettingsTable root = io::SettingsTable::read(file);
  TypedSettings s;
  s.input = root.path("input");
  s.output = root.path("output");
  s.scale = root.number("scale");
  s.length_unit = root.text("length_unit");
  s.title = root.text("title");

  io::SettingsTable surface = root.table("surface");
  s.repair = surface.boolean("repair");
  s.wrap = surface.boolean("wrap");
  s.wrap_alpha = surface.number("wrap_alpha");
  s.wrap_offset = surface.number("wrap_offset");
  s.region_angle = surface.number("region_angle");
  s.accept_leaks = surface.boolean("accept_leaks");

  io::SettingsTable grid = root.table("grid");
  s.box = grid.numbers("box", {6});
  s.spans = grid.integers("spans", {1, 3});
  s.span_size = grid.numbers("span_size", {1, 3});
  s.degree = grid.integers("degree", {1, 3});
  s.margin = grid.integer("margin");
  s.rotation = grid.numbers("rotation", {9});
  s.rotate_axis_angle = grid.numbers("rotate_axis_angle", {4});
  s.optimise_offset = grid.boolean("optimise_offset");

  io::SettingsTable trim = root.table("trim");
  s.sliver_tolerance = trim.number("sliver_tolerance");
  s.min_fraction = trim.number("min_fraction");

  io::SettingsTable quadrature = root.table("quadrature");
  s.interior = quadrature.text("interior");
  s.trimmed = quadrature.text("trimmed");
  if (quadrature.holds_text("moment_degree"))
    s.moment_degree = *quadrature.text("moment_degree");
  else if (const auto degrees = quadrature.integers("moment_degree", {1, 3}))
    s.moment_degree = *degrees;
  s.tolerance = quadrature.number("tolerance");
  s.rank_bound = quadrature.boolean("rank_bound");

  root.refuse_unknown_keys();
  return s;
}

} // namespace iga::prep
