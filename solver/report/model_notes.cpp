#include "solver/report/model_notes.hpp"

#include "format/model/vec3.hpp"
#include "solver/mechanics/incompressible.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/mechanics/unit_check.hpp"
#include "solver/report/surface_gap.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

std::vector<std::string> model_warnings(const TrimmedModel& model, const ElasticMaterial* material) {
  std::vector<std::string> warnings = model.provenance.warnings;
  if (material)
    if (const auto warning = unit_warning(model.length_unit, modulus_of(*material), material->density))
      warnings.push_back(*warning);
  return warnings;
}

std::optional<std::string> locking_warning(const ElasticMaterial& material, const SplineGrid& grid) {
  if (!is_nearly_incompressible(material)) return std::nullopt;
  const double lambda = material.C(0, 1), mu = material.C(3, 3);
  // Cook's membrane with eight spans along it: solver/nonlinear/README.md.
  return fmt::format(
      "Poisson's ratio {:.6g} is near 0.5, and splines of degree {} are too stiff for material that hardly "
      "changes its volume (a part eight spans long in bending, at 0.49, 0.499, 0.4999: by 3, 7, 11 % at "
      "degree 2, by 2, 3, 4 % at degree 3); take smaller spans, degree 3, or igasolve nonlinear with "
      "law = \"neo-hookean\" and locking = \"fbar\"",
      lambda / (2 * (lambda + mu)), std::ranges::min(grid.degree()));
}

std::optional<std::string> joined_bodies_warning(const SolutionSpace& space) {
  const TrimmedModel& model = space.model();
  const Eigen::Index found = separate_bodies(space).count;
  if (model.surface.bodies <= found) return std::nullopt;
  const std::string text = fmt::format("the surface has {} bodies, this model joins them into {}: bodies that touch "
                                       "move together",
                                       model.surface.bodies, found);
  const Point3 h = model.grid.span_size();
  const auto gap = narrowest_gap(model.surface.mesh, norm(h));
  if (!gap) return text;
  return text +
         fmt::format("; the narrowest gap is {:.3g} wide, near ({:.6g})", gap->width, fmt::join(gap->from, ", "));
}

std::optional<std::string> gap_end_note(const TrimmedModel& model) {
  const std::int64_t cells = count_cells(model).gap_end_cells;
  if (cells == 0) return std::nullopt;
  return fmt::format(
      "{} cells at the ends of gaps have functions that are continuous, not smooth, across faces: the time "
      "step is 2 to 5 times shorter than without, and more where these cells are crushed; igaprep "
      "--gap-ends glued makes a model without them, which is stiffer there",
      cells);
}

std::string glued_gap_ends_note(std::int64_t cells, const TrimmedModel& model) {
  const std::array<int, 3> p = model.grid.degree();
  return fmt::format(
      "walls are too stiff around the ends of gaps in {} cells, over about {} spans: runs with contact share "
      "functions there, as igaprep --gap-ends glued does; compare the results of two span sizes",
      cells, *std::max_element(p.begin(), p.end()) + 1);
}

std::vector<std::string> prefixed(const std::string& subject, const std::vector<std::string>& texts) {
  std::vector<std::string> out;
  for (const std::string& text : texts) out.push_back(fmt::format("{}: {}", subject, text));
  return out;
}

} // namespace iga::solve
