// [material] of a run file of `igasolve explicit` → a material law.
#pragma once

#include "solver/explicit/laws/laws.hpp"

#include <optional>
#include <string>
#include <vector>

namespace iga::io {
class SettingsTable;
}

namespace iga::solve {

struct MaterialSettings {
  Law law;
  InversionPolicy inversion;         ///< what the kernel does with LawOutput::inverted; the law knows it too
  std::string name;                  ///< as written: "neo-hookean", …
  std::vector<std::string> warnings; ///< to be printed once
};

/// Keys of all laws, for SettingsTable::expect_only.
std::vector<std::string> material_keys();

/// What a law takes where its table does not give it: E, nu, rho of a material by name, in the model's units.
struct MaterialDefaults {
  std::optional<double> E, nu, rho;
};

/// Reads a table such as [material] or [bodies.material]; solver/explicit/laws/README.md lists its keys. A key of
/// another law is refused here, one that no law has by the root table.
/// @throws InputError "file:line: key: found this, expected that"
MaterialSettings read_material(io::SettingsTable& table, const std::optional<MaterialDefaults>& named = std::nullopt);

} // namespace iga::solve
