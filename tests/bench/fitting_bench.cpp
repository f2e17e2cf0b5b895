#include "tests/bench/measurements.hpp"

#include "preprocessor/fit/moment_fitting.hpp"

#include <array>
#include <memory>

namespace iga::bench {

namespace {

using prep::LocalSurface;

constexpr std::size_t spans_measured = 400; // evenly chosen; the rates hardly change beyond
constexpr double tolerance = 1e-11;         // that the moment fitting asks of NNLS

/// The trimmed spans of a part with what their moments need.
struct Spans {
  const SplineGrid& grid;
  const prep::Trimming& trimming;
  std::array<int, 3> degree;
  prep::FarMoments far;
  std::vector<std::size_t> touched;
  std::vector<LocalSurface> surfaces;

  Spans(BenchCase& part, int p)
      : grid(part.grid(p)), trimming(part.trimming(p)), degree{p, p, p}, far(grid, trimming, degree),
        touched(part.trimmed_spans(p, spans_measured)), surfaces(touched.size()) {
    for (std::size_t s = 0; s < touched.size(); ++s)
      prep::gather_local_surface(grid, trimming, touched[s], surfaces[s]);
  }
  std::int64_t size() const { return static_cast<std::int64_t>(touched.size()); }
  std::size_t num_moments() const {
    return static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1));
  }
  std::vector<double> moments(std::size_t s) const {
    std::vector<double> out(num_moments());
    prep::span_moments(surfaces[s], far.find(touched[s]), degree, out.data());
    return out;
  }
  // As the first set of the moment fitting: the same lattice of lines both ways, along the axis that shows most.
  void candidates(std::size_t s, prep::LineCaster& caster, std::vector<double>& points) const {
    points.clear();
    prep::PieceInterior interior;
    interior.attach(surfaces[s]);
    caster.attach(surfaces[s], interior);
    const std::vector<double>& lines = prep::gauss_legendre(degree[0] + 2).nodes;
    caster.append_candidates(caster.main_axis(), lines, lines, degree[0] + 2, 2, points);
  }
};

/// Right-hand side and columns of one span's fit.
struct Problem {
  std::vector<double> b, columns;
};

Problem make_problem(const Spans& spans, std::size_t s) {
  prep::LineCaster caster;
  std::vector<double> points;
  spans.candidates(s, caster, points);
  Problem problem{spans.moments(s), {}};
  const int p = spans.degree[0];
  std::array<std::array<double, prep::max_moment_degree + 1>, 3> P{};
  for (std::size_t g = 0; g < points.size(); g += 3) {
    for (std::size_t d = 0; d < 3; ++d) prep::legendre(points[g + d], p, P[d].data());
    for (std::size_t c = 0; c <= static_cast<std::size_t>(p); ++c)
      for (std::size_t b = 0; b <= static_cast<std::size_t>(p); ++b)
        for (std::size_t a = 0; a <= static_cast<std::size_t>(p); ++a)
          problem.columns.push_back(P[0][a] * P[1][b] * P[2][c]);
  }
  return problem;
}

} // namespace

void measure_fitting(BenchCase& part, int degree) {
  const auto name = [&](const char* kernel) {
    return std::string(kernel) + "/" + part.name() + "/p" + std::to_string(degree);
  };
  measure(name("span_moments"), "spans", [&part, degree]() -> Work {
    const auto spans = std::make_shared<Spans>(part, degree);
    return [spans] {
      LocalSurface surface;
      std::vector<double> moments(spans->num_moments());
      for (const std::size_t t : spans->touched) {
        prep::gather_local_surface(spans->grid, spans->trimming, t, surface);
        prep::span_moments(surface, spans->far.find(t), spans->degree, moments.data());
        benchmark::DoNotOptimize(moments.data());
      }
      return spans->size();
    };
  });
  measure(name("candidates"), "spans", [&part, degree]() -> Work {
    const auto spans = std::make_shared<Spans>(part, degree);
    return [spans, caster = prep::LineCaster(), points = std::vector<double>()]() mutable {
      for (std::size_t s = 0; s < spans->touched.size(); ++s) {
        spans->candidates(s, caster, points);
        benchmark::DoNotOptimize(points.data());
      }
      return spans->size();
    };
  });
  measure(name("nnls"), "spans", [&part, degree]() -> Work {
    const Spans spans(part, degree);
    std::vector<Problem> problems;
    for (std::size_t s = 0; s < spans.touched.size(); ++s) problems.push_back(make_problem(spans, s));
    return [problems = std::move(problems), nnls = prep::Nnls()]() mutable {
      for (const Problem& problem : problems) {
        const std::size_t m = problem.b.size();
        nnls.start(problem.b);
        nnls.add_columns(problem.columns, problem.columns.size() / m);
        benchmark::DoNotOptimize(nnls.solve(tolerance, 3 * static_cast<int>(m)));
      }
      return static_cast<std::int64_t>(problems.size());
    };
  });
  measure(name("fit"), "spans", [&part, degree]() -> Work {
    const auto spans = std::make_shared<Spans>(part, degree);
    const auto fitter = std::make_shared<prep::MomentFitter>(spans->grid, spans->trimming, spans->far, spans->degree,
                                                             prep::QuadratureOptions{}.tolerance);
    return [spans, fitter] {
      for (const std::size_t t : spans->touched) benchmark::DoNotOptimize(fitter->fit(t).residual);
      return spans->size();
    };
  });
}

} // namespace iga::bench
