// What helps where a part is too thin for its spans.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <string>
#include <vector>

namespace iga::solve {

/// "its walls are about 0.1 thick, its spans measure …; igaprep --span-size … puts two spans across them"; empty where
/// a wall holds two spans.
/// @param spans  active spans of the part, positions in model.cells.span; empty: all
std::string span_advice(const TrimmedModel& model, const std::vector<std::int64_t>& spans = {});

} // namespace iga::solve
