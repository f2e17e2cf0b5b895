#include "preprocessor/program/part_source.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "preprocessor/cad/cad_format.hpp"
#include "preprocessor/cad/run_cad_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>

namespace iga::prep {

namespace {

constexpr double chord_per_span = 1e-3;
// Facets whose volume differs by more than this from that of the exact faces are warned of.
constexpr double warned_volume_share = 5e-3;

CadOptions cad_options(const Settings& s) {
  CadOptions options;
  options.scale = s.scale;
  if (s.length_unit != "unspecified") options.length_unit = s.length_unit;
  options.sew = s.cad.sew;
  options.merge = s.cad.merge;
  options.overlaps = s.output_is_folder;
  const GridOptions& grid = s.grid;
  if (s.cad.chord) {
    options.chord = *s.cad.chord;
    return options;
  }
  // The sides of the part are not known yet: a share of its longest one then, as of a cube.
  const bool known = grid.box || !grid.span_size.empty();
  const Point3 sides = grid.box ? minus((*grid.box)[1], (*grid.box)[0]) : Point3{1, 1, 1};
  const Point3 h = wanted_size(grid, sides);
  (known ? options.chord : options.chord_share) = chord_per_span * *std::min_element(h.begin(), h.end());
  return options;
}

std::vector<std::string> names_of(const CadModel& cad) {
  std::vector<std::string> names;
  for (const CadSolid& solid : cad.solids) names.push_back(fmt::format("\"{}\"", solid.name));
  return names;
}

std::string signed_per_cent(double found, double exact) {
  return fmt::format("{:+.2g} %", 100 * (found / exact - 1));
}

} // namespace

bool is_cad_file(const std::filesystem::path& file) {
  std::array<char, 512> bytes{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), bytes.size());
  return cad_format({bytes.data(), static_cast<std::size_t>(stream.gcount())}, file).has_value();
}

CadModel read_cad_file(const Settings& settings, const std::function<bool()>& stop) {
  return run_cad_reader(settings.input, cad_options(settings), stop);
}

CadModel list_cad_file(const Settings& settings, const std::function<bool()>& stop) {
  CadOptions options = cad_options(settings);
  options.tessellate = options.overlaps = false;
  return run_cad_reader(settings.input, options, stop);
}

const CadSolid& choose_solid(const CadModel& cad, const Settings& s) {
  if (!s.cad.solid.empty()) {
    const auto found = std::find_if(cad.solids.begin(), cad.solids.end(),
                                    [&](const CadSolid& solid) { return solid.name == s.cad.solid; });
    if (found == cad.solids.end())
      throw InputError(fmt::format("solid = \"{}\": {} holds no such solid; it holds {}", s.cad.solid, s.input.string(),
                                   fmt::join(names_of(cad), ", ")));
    return *found;
  }
  const CadSolid& only = cad.solids.front();
  if (cad.solids.size() == 1 && only.places.size() == 1) return only;
  std::size_t places = 0;
  for (const CadSolid& solid : cad.solids) places += solid.places.size();
  throw InputError(
      fmt::format("{}: the file holds {} solids ({}{}); choose one with --solid NAME, write one model for each "
                  "(igaprep FILE -o folder/), or unite those that touch and are of one material with --merge",
                  s.input.string(), places, fmt::join(names_of(cad), ", "),
                  places > cad.solids.size() ? ", some at several places" : ""));
}

Part part_of(const CadModel& cad, const CadSolid& solid, const std::filesystem::path& file) {
  Part part;
  part.read.mesh = solid.mesh;
  part.read.format = cad.solids.size() > 1 ? fmt::format("{}, solid \"{}\"", cad.format, solid.name) : cad.format;
  part.read.file = file.string();
  part.read.sha256 = cad.sha256;
  part.length_unit = cad.length_unit;
  part.findings = cad.findings;
  part.warnings = cad.warnings;
  const std::string unit = cad.length_unit == "unspecified" ? "" : " " + cad.length_unit;
  if (cad.file_unit != cad.length_unit && cad.file_unit != "unspecified")
    part.findings.push_back(fmt::format("converted from {} to {}", cad.file_unit, cad.length_unit));
  const double volume = volume_moments(solid.mesh).volume;
  part.findings.push_back(fmt::format("{} faces tessellated to a chord of {:.3g}{} (largest distance found {:.2g}): "
                                      "volume {}, area {} against the exact "
                                      "{:.8g} and {:.8g}",
                                      solid.faces.size(), solid.chord, unit, solid.deviation,
                                      signed_per_cent(volume, solid.volume),
                                      signed_per_cent(surface_area(solid.mesh), solid.area), solid.volume, solid.area));
  if (std::abs(volume / solid.volume - 1) > warned_volume_share)
    part.warnings.push_back(fmt::format("the facets hold {} of the exact volume ({:.6g} instead of {:.6g}): a smaller "
                                        "--chord than {:.3g} follows the faces more closely",
                                        signed_per_cent(volume, solid.volume), volume, solid.volume,
                                        std::min(solid.chord, solid.deviation)));
  for (const CadOverlap& overlap : cad.overlaps)
    for (const CadPlace& place : solid.places)
      if (place.name == overlap.first || place.name == overlap.second)
        part.warnings.push_back(
            fmt::format("\"{}\" and \"{}\" share a volume of {:.4g}: both models hold that material", overlap.first,
                        overlap.second, overlap.volume));
  part.curves.offsets = {0};
  for (const CadEdge& edge : solid.edges) {
    if (edge.points.size() < 2) continue;
    part.curves.names.push_back(edge.name);
    part.curves.points.insert(part.curves.points.end(), edge.points.begin(), edge.points.end());
    part.curves.offsets.push_back(static_cast<std::int64_t>(part.curves.points.size()));
  }
  if (part.curves.names.empty()) part.curves.offsets.clear();
  for (const CadVertex& vertex : solid.vertices) {
    part.markers.names.push_back(vertex.name);
    part.markers.positions.push_back(vertex.position);
  }
  return part;
}

} // namespace iga::prep
