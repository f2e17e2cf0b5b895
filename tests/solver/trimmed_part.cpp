#include "tests/solver/trimmed_part.hpp"

#include "preprocessor/quadrature/build_quadrature.hpp"
#include "preprocessor/quadrature/surface_quadrature.hpp"
#include "preprocessor/trim/trim.hpp"
#include "tests/embed/surfaces.hpp"

namespace iga::test {

TrimmedModel make_part(const TriangleMesh& mesh, const SplineGrid& grid, int moment_degree, const char* interior_rule,
                       bool split_gap_ends, const char* surface_rule) {
  prep::TrimOptions trim_options;
  trim_options.split_gap_ends = split_gap_ends;
  prep::Trimming trimming = prep::trim(grid, mesh, trim_options);
  prep::CellTable cells = prep::split_into_cells(grid, trim_options, trimming);
  const int q = moment_degree > 0 ? moment_degree : grid.degree()[0];
  prep::QuadratureOptions options;
  options.moment_degree = {q, q, q};
  options.interior_rule = interior_rule;
  TrimmedModel model;
  model.grid = grid;
  model.quadrature.moment_degree = options.moment_degree;
  model.quadrature.interior_rule = options.interior_rule;
  model.quadrature.part_volume = volume_moments(mesh).volume;
  prep::QuadratureResult quadrature = prep::build_quadrature(grid, trimming, options);
  model.quadrature.snapped_volume = trimming.snapped_volume;
  model.quadrature.dropped_volume = trimming.dropped_volume;
  model.points = std::move(quadrature.points);
  model.quadrature.max_residual = quadrature.max_residual;
  model.functions.mass_fraction = prep::mass_fractions(grid, trimming, cells, model.points);
  model.quadrature.surface_rule = surface_rule;
  model.surface = prep::make_embedded_surface(grid, mesh, trimming, prep::surface_rule(surface_rule));
  prep::place_cells(std::move(trimming), std::move(cells), model);
  return model;
}

TrimmedModel make_part(const TriangleMesh& mesh, const PartOptions& options) {
  return make_part(mesh, grid_around(mesh, options.span_size, options.degree, options.shift, options.rotation),
                   options.moment_degree, options.interior_rule, options.split_gap_ends, options.surface_rule);
}

} // namespace iga::test
