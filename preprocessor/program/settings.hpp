// Settings of igaprep: as typed (settings file and flags) and, after validation, complete and ready for the stages.
#pragma once

#include "preprocessor/quadrature/quadrature_options.hpp"
#include "preprocessor/surface/prepare_surface.hpp"
#include "preprocessor/trim/make_grid.hpp"
#include "preprocessor/trim/trim.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace iga::prep {

/// What the user typed; absent where nothing was. Names as in the settings file.
struct TypedSettings {
  std::optional<std::filesystem::path> input, output;
  std::optional<double> scale;
  std::optional<std::string> length_unit, title;
  std::optional<double> chord, sew;
  std::optional<bool> merge;
  std::optional<std::string> solid;
  std::optional<bool> repair, wrap, accept_leaks;
  std::optional<double> wrap_alpha, wrap_offset, region_angle;
  std::optional<std::vector<double>> box;          ///< 6
  std::optional<std::vector<std::int64_t>> spans;  ///< 1 or 3
  std::optional<std::vector<double>> span_size;    ///< 1 or 3
  std::optional<std::vector<std::int64_t>> degree; ///< 1 or 3
  std::optional<std::int64_t> margin;
  std::optional<std::vector<double>> rotation;          ///< 9, row-major
  std::optional<std::vector<double>> rotate_axis_angle; ///< 4: axis, degrees
  std::optional<bool> optimise_offset;
  std::optional<double> sliver_tolerance, min_fraction;
  std::optional<std::string> gap_ends; ///< "split" or "glued"
  std::optional<std::string> interior, trimmed, surface_rule;
  std::optional<std::variant<std::string, std::vector<std::int64_t>>> moment_degree; ///< "p", "2p", 1 or 3 numbers
  std::optional<double> tolerance;
  std::optional<bool> rank_bound;
};

/// What only CAD files know.
struct CadSettings {
  std::optional<double> chord; ///< largest distance of facets from the faces, length; default: span size / 1000
  double sew = 0;              ///< gap across which faces without a solid are joined, length; 0: they are refused
  bool merge = false;          ///< one model of all solids
  std::string solid;           ///< name of the one to take; empty: the only one
  bool any() const { return chord || sew > 0 || merge || !solid.empty(); }
};

/// Complete settings; every value is in its range.
struct Settings {
  std::filesystem::path input;
  std::filesystem::path output; ///< a file, or, where it ends with a slash, a folder for one model of each solid
  bool output_is_folder = false;
  double scale = 1;
  std::string length_unit = "unspecified"; ///< a label; CAD files are converted to it
  CadSettings cad;
  std::string title;
  SurfaceOptions surface;
  GridOptions grid;
  bool optimise_offset = false;
  TrimOptions trim;
  QuadratureOptions quadrature;
};

/// Reads a settings file; paths in it are relative to its folder.
/// @throws InputError with the line for an unknown key, a wrong type or bad TOML
TypedSettings read_settings_file(const std::filesystem::path& file);

/// `base` with everything that `over` sets replaced. Where `over` sets one of two values that exclude each other
/// (spans and span_size; the two ways to write a rotation), the other one of `base` is dropped.
TypedSettings override_settings(TypedSettings base, const TypedSettings& over);

/// @throws InputError naming the setting, the value found and what is allowed
Settings validate(const TypedSettings& typed);

/// All settings that affect the data of the file, one "name = value" per line in fixed order, numbers with all their
/// digits: equal texts mean equal files from the same input and producer version.
std::string canonical_text(const Settings& settings);

} // namespace iga::prep
