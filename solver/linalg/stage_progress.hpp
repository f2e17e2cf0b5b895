// Stages of an analysis on stderr, where the run has a place for them.
#pragma once

#include "format/io/progress.hpp"
#include "solver/linalg/linear_solver.hpp"

#include <fmt/format.h>

namespace iga::solve {

/// Starts a stage; null shows nothing.
inline void show_stage(io::Progress* progress, const std::string& stage) {
  if (progress) progress->start(stage);
}

/// What a factorisation says once its cost is known, before it begins.
inline std::function<void(const FactorCost&)> show_factorisation(io::Progress* progress) {
  if (!progress) return {};
  return [progress](const FactorCost& cost) {
    progress->start(fmt::format("factorisation ({:.2g} GiB, {:.2g} Gflop)", cost.bytes / (1024.0 * 1024 * 1024),
                                1e-9 * cost.flops));
  };
}

} // namespace iga::solve
