// A model whose gap ends have continuous functions → the same cells and points with smooth functions everywhere.
#pragma once

#include "format/model/trimmed_model.hpp"

namespace iga {

/// Functions that copies of one B-spline: those whose cells are linked within its support become one again, as igaprep
/// --gap-ends glued has them. Walls then move together around the end of a gap, over about degree + 1 spans.
/// A model without /unknowns stays as it is.
TrimmedModel glue_gap_ends(TrimmedModel model);

} // namespace iga
