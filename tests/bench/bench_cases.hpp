// The parts and grids that speed is measured on, and what their stages hand to one another.
#pragma once

#include "format/model/trimmed_model.hpp"
#include "preprocessor/quadrature/build_quadrature.hpp"
#include "preprocessor/trim/make_grid.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace iga::bench {

/// One part in one grid. Stages run when they are first asked for and are kept.
class BenchCase {
 public:
  using MakeOptions = std::function<prep::GridOptions(const TriangleMesh&)>;
  BenchCase(std::string name, std::filesystem::path part, MakeOptions options)
      : name_(std::move(name)), part_(std::move(part)), options_(std::move(options)) {}

  const std::string& name() const { return name_; }
  const TriangleMesh& mesh();
  const SplineGrid& grid(int degree);
  const prep::Trimming& trimming(int degree);
  /// Gauss rules inside, moment fitting of the same degree on trimmed spans.
  const IntegrationPoints& points(int degree);
  /// What igaprep would write: for the solver's kernels.
  TrimmedModel model(int degree);
  /// Touched numbers of at most `limit` trimmed spans, evenly chosen; ascending.
  std::vector<std::size_t> trimmed_spans(int degree, std::size_t limit);

 private:
  struct Stages {
    SplineGrid grid;
    prep::Trimming trimming;
    IntegrationPoints points;
  };
  Stages& stages(int degree);

  std::string name_;
  std::filesystem::path part_;
  MakeOptions options_;
  TriangleMesh mesh_;
  std::map<int, Stages> stages_;
};

/// @param parts  folder of the sample parts (target sample_parts)
/// @param shared folder of parts made by others; cases without their file are left out
/// @throws std::runtime_error where a sample part is missing
std::vector<BenchCase> bench_cases(const std::filesystem::path& parts, const std::filesystem::path& shared);

} // namespace iga::bench
