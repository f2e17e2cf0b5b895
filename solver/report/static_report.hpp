// What a static analysis says on the terminal, for people and for scripts.
#pragma once

#include "format/io/json_text.hpp"
#include "solver/analysis/static_analysis.hpp"

namespace iga::solve {

/// @param system  that was solved: bodies are named where there are several
std::string static_text(const StaticSolution& solution, const BodySystem& system);
io::JsonObject static_json(const StaticSolution& solution, const BodySystem& system);

/// Which of several load cases has the largest displacement and the largest von Mises stress.
struct CaseEnvelope {
  std::size_t displacement = 0, von_mises = 0;
};
/// @pre there is one
CaseEnvelope envelope_of(std::span<const StaticSolution> cases);
std::string envelope_text(std::span<const StaticSolution> cases, const BodySystem& system);

} // namespace iga::solve
