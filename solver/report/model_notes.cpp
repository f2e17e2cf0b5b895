#include "solver/report/model_notes.hpp"

#include "format/model/vec3.hpp"
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

std::optional<std::string> joined_bodies_warning(const SolutionSpace& space) {
  const TrimmedModel& model = space.model();
  const Eigen::Index found = separate_bodies(space).count;
  if (model.surface.bodies <= found) return std::nullopt;
  const auto& degree = model.grid.degree();
  const Point3 h = model.grid.span_size();
  std::string text = fmt::format("the surface has {} bodies, this model joins them into {}: functions of degree {} act "
                                 "across gaps up to {} spans wide, and bodies that share one move together",
                                 model.surface.bodies, found, fmt::join(degree, " "),
                                 *std::max_element(degree.begin(), degree.end()) + 1);
  double reach = 0;
  for (std::size_t d = 0; d < 3; ++d) reach = std::hypot(reach, (degree[d] + 1) * h[d]);
  const auto gap = narrowest_gap(model.surface.mesh, reach);
  if (!gap) return text + "; smaller spans keep them apart";
  if (!(gap->width > 0))
    return text +
           fmt::format("; they touch at ({:.6g}), where no span size keeps them apart", fmt::join(gap->from, ", "));
  // Across p + 1 spans along one axis of the grid no function reaches.
  double fits = 0;
  const Point3 across = model.grid.along_axes(minus(gap->to, gap->from));
  for (std::size_t d = 0; d < 3; ++d) fits = std::max(fits, std::abs(across[d]) / (degree[d] + 1));
  return text +
         fmt::format("; the narrowest gap is {:.4g} wide, near ({:.6g}): spans of at most {:.3g} keep them apart "
                     "(now {:.4g})",
                     gap->width, fmt::join(gap->from, ", "), fits, fmt::join(h, " × "));
}

std::vector<std::string> prefixed(const std::string& subject, const std::vector<std::string>& texts) {
  std::vector<std::string> out;
  for (const std::string& text : texts) out.push_back(fmt::format("{}: {}", subject, text));
  return out;
}

} // namespace iga::solve
