// make_parts: writes the sample parts as STL files. Deterministic: the same command gives the same bytes.
#include "samples/parts.hpp"
#include "samples/write_stl.hpp"

#include <CGAL/Random.h>
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace {

using namespace iga;
using namespace iga::samples;

void write_part(const Part& part, const PartOptions& options, bool ascii, const std::filesystem::path& folder) {
  const StlKind kind = ascii ? StlKind::Ascii : part.kind;
  CGAL::get_default_random() = CGAL::Random(0); // CGAL's triangulations draw from it: no part depends on those before
  const TriangleMesh mesh = as_stored(part.make(options), kind);
  require_sound(mesh, part.name);
  const VolumeMoments moments = volume_moments(mesh);
  write_stl(mesh, part.name, kind, folder / (part.name + ".stl"));
  fmt::print("{:<18} {:>6} triangles  volume {:.17g}  area {:.17g}\n", part.name, mesh.triangles.size(), moments.volume,
             surface_area(mesh));
}

int run(int argc, char** argv) {
  std::filesystem::path folder;
  std::vector<std::string> only;
  PartOptions options;
  bool ascii = false, list = false;
  CLI::App app{"Writes the sample parts as STL files, after checking that each is a sound solid."};
  app.add_option("folder", folder, "Where to write <part>.stl; made where it is missing");
  app.add_option("--only", only, "Names of the parts to write (default: all)");
  app.add_option("--theta", options.theta, "Trimmed cube: mm that it stays behind its grid on every side")
      ->check(CLI::Range(0.0, 59.0))
      ->capture_default_str();
  app.add_option("--refinement", options.refinement, "Spheres: 20 * 4^n triangles")
      ->check(CLI::Range(0, 8))
      ->capture_default_str();
  app.add_flag("--ascii", ascii, "Write every part as text with 17 digits");
  app.add_flag("--list", list, "Print the parts' names and what they are");
  CLI11_PARSE(app, argc, argv);

  if (list) {
    for (const Part& part : parts()) fmt::print("{:<18} {}\n", part.name, part.what);
    return 0;
  }
  if (folder.empty()) throw std::runtime_error("no folder given; see make_parts --help");
  for (const std::string& name : only)
    if (std::ranges::none_of(parts(), [&](const Part& part) { return part.name == name; }))
      throw std::runtime_error(fmt::format("no part is called '{}'; make_parts --list names them", name));
  std::filesystem::create_directories(folder);
  for (const Part& part : parts())
    if (only.empty() || std::ranges::find(only, part.name) != only.end()) write_part(part, options, ascii, folder);
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "make_parts: {}\n", error.what());
    return 2;
  }
}
