#include "tests/bench/bench_cases.hpp"

#include "preprocessor/quadrature/surface_quadrature.hpp"
#include "preprocessor/surface/prepare_surface.hpp"
#include "preprocessor/surface/read_mesh.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <stdexcept>

namespace iga::bench {

namespace fs = std::filesystem;

const TriangleMesh& BenchCase::mesh() {
  if (mesh_.triangles.empty()) mesh_ = prep::prepare_surface(prep::read_mesh(part_), {}).mesh;
  return mesh_;
}

BenchCase::Stages& BenchCase::stages(int degree) {
  const auto found = stages_.find(degree);
  if (found != stages_.end()) return found->second;
  prep::GridOptions options = options_(mesh());
  options.degree = {degree, degree, degree};
  Stages& made = stages_[degree];
  made.grid = prep::make_grid(mesh(), options).grid;
  made.trimming = prep::trim(made.grid, mesh(), {});
  return made;
}

const SplineGrid& BenchCase::grid(int degree) {
  return stages(degree).grid;
}

const prep::Trimming& BenchCase::trimming(int degree) {
  return stages(degree).trimming;
}

const IntegrationPoints& BenchCase::points(int degree) {
  Stages& made = stages(degree);
  if (made.points.weights.empty()) {
    prep::QuadratureOptions options;
    options.moment_degree = {degree, degree, degree};
    made.points = prep::build_quadrature(made.grid, made.trimming, options).points;
  }
  return made.points;
}

TrimmedModel BenchCase::model(int degree) {
  prep::Trimming trimmed = this->trimming(degree);
  TrimmedModel model;
  model.grid = grid(degree);
  prep::CellTable cells = prep::split_into_cells(model.grid, {}, trimmed);
  prep::QuadratureOptions options;
  options.moment_degree = {degree, degree, degree};
  model.points = prep::build_quadrature(model.grid, trimmed, options).points;
  model.functions.mass_fraction = prep::mass_fractions(model.grid, trimmed, cells, model.points);
  model.surface = prep::make_embedded_surface(model.grid, mesh(), trimmed);
  prep::place_cells(std::move(trimmed), std::move(cells), model);
  return model;
}

std::vector<std::size_t> BenchCase::trimmed_spans(int degree, std::size_t limit) {
  const prep::Trimming& trimming = stages(degree).trimming;
  std::vector<std::size_t> all;
  for (std::size_t t = 0; t < trimming.pieces.spans.size(); ++t)
    if (trimming.state[static_cast<std::size_t>(trimming.pieces.spans[t])] ==
        static_cast<std::uint8_t>(SpanState::Trimmed))
      all.push_back(t);
  if (all.size() <= limit) return all;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < limit; ++i) chosen.push_back(all[i * all.size() / limit]);
  return chosen;
}

namespace {

BenchCase::MakeOptions in_box(const Point3& A, const Point3& B, std::vector<std::int64_t> spans) {
  return [=](const TriangleMesh&) {
    prep::GridOptions options;
    options.box = {A, B};
    options.spans = spans;
    return options;
  };
}

// Cubic spans, `count` of them along the part's longest side, and the default margin.
BenchCase::MakeOptions along_longest(std::int64_t count) {
  return [=](const TriangleMesh& mesh) {
    const Box3 box = bounding_box(mesh);
    double longest = 0;
    for (std::size_t d = 0; d < 3; ++d) longest = std::max(longest, box.upper[d] - box.lower[d]);
    prep::GridOptions options;
    options.span_size = {longest / static_cast<double>(count)};
    return options;
  };
}

} // namespace

std::vector<BenchCase> bench_cases(const fs::path& parts, const fs::path& shared) {
  std::vector<BenchCase> cases;
  const auto sample = [&](const char* name, const char* file, BenchCase::MakeOptions options) {
    if (!fs::exists(parts / file))
      throw std::runtime_error(fmt::format("{}: no such file; build the target sample_parts", (parts / file).string()));
    cases.emplace_back(name, parts / file, std::move(options));
  };
  const auto other = [&](const char* name, const char* file, BenchCase::MakeOptions options) {
    const fs::path part = shared / "stl/valid" / file;
    if (fs::exists(part)) cases.emplace_back(name, part, std::move(options));
  };
  // The foam part's box, centred in 35 × 19 × 30 spans of 10 mm: two empty spans on every side.
  const Point3 low{-20.7, -21.3, -21.4}, high{329.3, 168.7, 278.6};
  sample("rotated_cube_20", "rotated_cube.stl", in_box({-90, -90, -90}, {90, 90, 90}, {20, 20, 20}));
  sample("foam_35x19x30", "foam_part.stl", in_box(low, high, {35, 19, 30}));
  sample("foam_80", "foam_part.stl", in_box(low, high, {80, 80, 80}));
  other("busted_40", "busted.STL", along_longest(40));
  other("x_carriage_40", "X_Carriage_x1.stl", along_longest(40));
  return cases;
}

} // namespace iga::bench
