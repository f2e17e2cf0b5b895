// Which build of the programs this is.
#pragma once

namespace iga {

/// Version, commit and, for sources that were changed since, a hash of them: "0.1.0+g1a2b3c4d.dirty.5e6f7a8b"; see
/// scripts/cmake/Version.cmake. Two builds with the same text were made from the same sources.
const char* program_version();

} // namespace iga
