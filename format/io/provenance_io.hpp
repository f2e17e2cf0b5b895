// The /provenance group, the same in models and results.
#pragma once

#include "format/io/h5_file.hpp"
#include "format/model/trimmed_model.hpp"

namespace iga::io {

void write_provenance(H5Writer& file, const Provenance& provenance);

/// Provenance is for people and for reuse: a foreign producer may leave out any part of it. @throws FormatError
Provenance read_provenance(const H5Reader& file);

} // namespace iga::io
