// What a static analysis says on the terminal, for people and for scripts.
#pragma once

#include "format/io/json_text.hpp"
#include "solver/analysis/static_analysis.hpp"

namespace iga::solve {

/// @param grid  of the model
std::string static_text(const StaticSolution& solution, const SplineGrid& grid);
io::JsonObject static_json(const StaticSolution& solution, const SplineGrid& grid);

} // namespace iga::solve
