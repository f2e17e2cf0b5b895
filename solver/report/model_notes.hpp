// What a model file says of itself, and what model and material together show: to be read beside every result.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "solver/mechanics/material.hpp"
#include "solver/space/solution_space.hpp"

#include <optional>
#include <string>
#include <vector>

namespace iga::solve {

/// Warnings for the user of a result: those that igaprep left in the model file, and a material that fits no known set
/// of units with the model's length unit.
/// @param material  null where no density was given
std::vector<std::string> model_warnings(const TrimmedModel& model, const ElasticMaterial* material);

/// Of an isotropic material that hardly changes its volume, where nothing is done against locking.
std::optional<std::string> locking_warning(const ElasticMaterial& material, const SplineGrid& grid);

/// A warning where the surface has more bodies than the space has mechanically separate parts: bodies that touch.
std::optional<std::string> joined_bodies_warning(const SolutionSpace& space);

/// What continuous functions at the ends of gaps cost an explicit run; nothing where there are none.
std::optional<std::string> gap_end_note(const TrimmedModel& model);
/// What a run with contact made of the gap ends in so many cells of a model.
std::string glued_gap_ends_note(std::int64_t cells, const TrimmedModel& model);

/// Each text with what it is about in front: "part.h5: …".
std::vector<std::string> prefixed(const std::string& subject, const std::vector<std::string>& texts);

} // namespace iga::solve
