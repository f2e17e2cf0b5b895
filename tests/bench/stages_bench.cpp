#include "tests/bench/measurements.hpp"

#include "format/io/trimmed_model_io.hpp"
#include "preprocessor/connectivity/line_winding.hpp"
#include "preprocessor/quadrature/surface_quadrature.hpp"

#include <memory>
#include <unistd.h>

namespace iga::bench {

namespace {

constexpr int degree = 2; // these stages hardly depend on it

template <class T> std::int64_t bytes(const std::vector<T>& values) {
  return static_cast<std::int64_t>(values.size() * sizeof(T));
}

// What the file holds of arrays, before compression.
std::int64_t array_bytes(const TrimmedModel& m) {
  const SurfacePoints& s = m.surface.quadrature;
  return bytes(m.state) + bytes(m.cells.span) + bytes(m.cells.volume_fraction) + bytes(m.points.offsets) +
         bytes(m.points.parameters) + bytes(m.points.weights) + bytes(m.points.residual) + bytes(m.functions.number) +
         bytes(m.functions.mass_fraction) + bytes(s.offsets) + bytes(s.parameters) + bytes(s.weights) +
         bytes(s.normals) + bytes(s.triangle) + 24 * m.grid.num_functions();
}

} // namespace

void measure_stages(BenchCase& part) {
  const auto name = [&](const char* stage) { return std::string(stage) + "/" + part.name(); };
  measure(name("clip"), "pieces", [&part] {
    part.grid(degree);
    return [&part] { return prep::clip_to_spans(part.grid(degree), part.mesh()).num_pieces(); };
  });
  measure(name("trim"), "pieces", [&part] {
    part.grid(degree);
    return [&part] { return prep::trim(part.grid(degree), part.mesh(), {}).pieces.num_pieces(); };
  });
  measure(name("winding"), "crossings", [&part] {
    part.trimming(degree);
    return [&part] {
      const double depth = prep::TrimOptions{}.sliver_tolerance;
      return prep::check_winding(part.grid(degree), part.mesh(), part.trimming(degree), depth).num_crossings;
    };
  });
  measure(name("function_mass"), "points", [&part] {
    part.points(degree);
    return [&part] {
      const IntegrationPoints& points = part.points(degree);
      benchmark::DoNotOptimize(prep::function_mass(part.grid(degree), part.trimming(degree), points));
      return static_cast<std::int64_t>(points.weights.size());
    };
  });
  measure(name("surface_points"), "points", [&part] {
    part.trimming(degree);
    return [&part] {
      const auto surface = prep::make_embedded_surface(part.grid(degree), part.mesh(), part.trimming(degree));
      return static_cast<std::int64_t>(surface.quadrature.weights.size());
    };
  });
  measure(name("write"), "bytes", [&part] {
    const auto model = std::make_shared<TrimmedModel>(part.model(degree));
    const auto file = std::filesystem::temp_directory_path() / ("iga_bench_" + std::to_string(getpid()) + ".h5");
    return [model, file] {
      io::write_model(file, *model);
      std::filesystem::remove(file);
      return array_bytes(*model);
    };
  });
}

} // namespace iga::bench
