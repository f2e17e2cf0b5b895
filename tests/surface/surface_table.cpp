// Prints what becomes of surface files: surface_table [--repair] [--wrap] files…
#include "format/model/errors.hpp"
#include "preprocessor/surface/prepare_surface.hpp"

#include <chrono>
#include <cstring>
#include <fmt/format.h>

int main(int argc, char** argv) {
  iga::prep::SurfaceOptions options;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--repair") == 0) {
      options.repair = true;
      continue;
    }
    if (std::strcmp(argv[i], "--wrap") == 0) {
      options.wrap = true;
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    const auto seconds = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    try {
      iga::prep::ReadMesh input = iga::prep::read_mesh(argv[i]);
      const double read = seconds();
      const auto facets = input.mesh.triangles.size();
      const auto out = iga::prep::prepare_surface(std::move(input), options);
      fmt::print("{}: {} → {} facets, {} bodies, {} cavities, volume {:.10g}, read {:.3f} s, all {:.3f} s\n", argv[i],
                 facets, out.mesh.triangles.size(), out.bodies, out.cavities, iga::volume_moments(out.mesh).volume,
                 read, seconds());
      for (const auto& text : out.findings) fmt::print("    {}\n", text);
      for (const auto& text : out.warnings) fmt::print("    warning: {}\n", text);
    } catch (const iga::InputError& e) {
      fmt::print("refused ({:.3f} s): {}\n", seconds(), e.what());
    }
  }
}
