#include "preprocessor/quadrature/build_quadrature.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"
#include "format/model/span_state.hpp"
#include "preprocessor/interior/interior_rules.hpp"
#include "preprocessor/quadrature/surface_quadrature.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace iga::prep {

void check_options(const QuadratureOptions& options) {
  for (int q : options.moment_degree)
    if (q < 1 || q > max_moment_degree)
      throw InputError(fmt::format("moment degree {} is not supported; choose 1 … {}", q, max_moment_degree));
  if (options.trimmed_rule != "nnls" && options.trimmed_rule != "minimal")
    throw InputError(fmt::format("trimmed rule '{}' is not known; choose nnls or minimal", options.trimmed_rule));
  surface_rule(options.surface_rule);
}

QuadratureResult build_quadrature(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options) {
  check_options(options);
  TrimmedRules rules(grid, trimming, options);
  if (options.trimmed_rule == "minimal") rules.reduce(options);
  rules.secure(options);
  return place_points(grid, trimming, options, std::move(rules));
}

QuadratureResult place_points(const SplineGrid& grid, const Trimming& trimming, const QuadratureOptions& options,
                              TrimmedRules&& rules) {
  constexpr std::size_t spans_per_block = TrimmedRules::spans_per_block;
  const std::size_t num_active = trimming.active.size();
  const InteriorRules interior_rules(grid, trimming, options.interior_rule);
  QuadratureResult result;
  IntegrationPoints& points = result.points;
  points.offsets.resize(num_active + 1, 0);
  points.residual.resize(num_active, 0);
  for (std::size_t b = 0; b < rules.num_blocks(); ++b) {
    const TrimmedRules::Block& block = rules.block(b);
    std::size_t t = 0;
    for (std::size_t a = b * spans_per_block; a < std::min(num_active, (b + 1) * spans_per_block); ++a) {
      const bool interior = is_interior(trimming, a);
      if (!interior) points.residual[a] = block.residual[t];
      points.offsets[a + 1] = points.offsets[a] + (interior ? interior_rules.count(a) : block.count[t++]);
    }
  }
  result.counts = rules.counts();
  result.counts.interior_boxes = interior_rules.num_boxes();
  result.max_residual = num_active ? *std::max_element(points.residual.begin(), points.residual.end()) : 0;

  const Point3 h = grid.span_size();
  const double span_volume = grid.span_volume();
  const auto total = static_cast<std::size_t>(points.offsets.back());
  points.parameters.resize(3 * total);
  points.weights.resize(total);
  tbb::parallel_for(std::size_t{0}, rules.num_blocks(), [&](std::size_t b) {
    const TrimmedRules::Block& block = rules.block(b);
    std::size_t own = 0;
    for (std::size_t a = b * spans_per_block; a < std::min(num_active, (b + 1) * spans_per_block); ++a) {
      const Box3 box = grid.span_box(grid.span_index(trimming.active[a]));
      auto g = static_cast<std::size_t>(points.offsets[a]);
      const auto put = [&](const double* t, double weight) {
        points.weights[g] = span_volume * weight;
        for (std::size_t d = 0; d < 3; ++d)
          points.parameters[3 * g + d] = std::clamp(box.lower[d] + t[d] * h[d], box.lower[d], box.upper[d]);
        ++g;
      };
      if (is_interior(trimming, a)) {
        interior_rules.for_points(a, [&](const Point3& t, double weight) { put(t.data(), weight); });
      } else {
        const auto last = static_cast<std::size_t>(points.offsets[a + 1]);
        while (g < last) {
          put(&block.points[3 * own], block.weights[own]);
          ++own;
        }
      }
    }
    rules.release(b);
  });
  return result;
}

std::vector<double> mass_fractions(const SplineGrid& grid, const Trimming& trimming, const CellTable& cells,
                                   const IntegrationPoints& points) {
  const std::array<int, 3> p = grid.degree();
  const Index3 n = grid.functions();
  const Index3 spans = grid.spans();

  // Sums by function in the order of the cells, whatever the number of threads.
  struct Entry {
    std::int32_t function;
    double mass;
  };
  const std::size_t num_active = trimming.active.size();
  const std::size_t block_size = 512;
  std::vector<std::vector<Entry>> parts((num_active + block_size - 1) / block_size);
  const auto before = [](const Entry& x, const Entry& y) { return x.function < y.function; };
  const auto add_equal = [](std::vector<Entry>& entries) {
    std::size_t last = 0;
    for (std::size_t e = 1; e < entries.size(); ++e) {
      if (entries[e].function == entries[last].function)
        entries[last].mass += entries[e].mass;
      else
        entries[++last] = entries[e];
    }
    if (!entries.empty()) entries.resize(last + 1);
  };
  const auto local_size = static_cast<std::size_t>((p[0] + 1) * (p[1] + 1) * (p[2] + 1));
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t b) {
    std::vector<double> mass(local_size);
    std::array<std::array<double, max_degree + 1>, 3> N;
    for (std::size_t a = b * block_size; a < std::min(num_active, (b + 1) * block_size); ++a) {
      const Index3 ijk = grid.span_index(trimming.active[a]);
      std::fill(mass.begin(), mass.end(), 0.0);
      const auto accumulate = [&](double weight) {
        std::size_t f = 0;
        for (int z = 0; z <= p[2]; ++z)
          for (int y = 0; y <= p[1]; ++y)
            for (int x = 0; x <= p[0]; ++x)
              mass[f++] += weight * N[0][static_cast<std::size_t>(x)] * N[1][static_cast<std::size_t>(y)] *
                           N[2][static_cast<std::size_t>(z)];
      };
      if (is_interior(trimming, a)) {
        for (std::size_t d = 0; d < 3; ++d)
          integrate_basis(grid.knots(static_cast<int>(d)), ijk[d],
                          std::span(N[d]).first(static_cast<std::size_t>(p[d] + 1)));
        accumulate(1);
      } else {
        for (auto g = static_cast<std::size_t>(points.offsets[a]); g < static_cast<std::size_t>(points.offsets[a + 1]);
             ++g) {
          for (std::size_t d = 0; d < 3; ++d)
            evaluate_basis(grid.knots(static_cast<int>(d)), ijk[d], points.parameters[3 * g + d],
                           std::span(N[d]).first(static_cast<std::size_t>(p[d] + 1)));
          accumulate(points.weights[g]);
        }
      }
      for (std::size_t f = 0; f < local_size; ++f) parts[b].push_back({cells.functions[a * local_size + f], mass[f]});
    }
    std::stable_sort(parts[b].begin(), parts[b].end(), before);
    add_equal(parts[b]);
  });
  // Neighbours are merged two by two, so that the order of the sums does not depend on the number of threads.
  for (std::size_t step = 1; step < parts.size(); step *= 2)
    tbb::parallel_for(std::size_t{0}, (parts.size() - 1) / (2 * step) + 1, [&](std::size_t pair) {
      const std::size_t left = 2 * step * pair, right = left + step;
      if (right >= parts.size()) return;
      std::vector<Entry> both(parts[left].size() + parts[right].size());
      std::merge(parts[left].begin(), parts[left].end(), parts[right].begin(), parts[right].end(), both.begin(),
                 before);
      add_equal(both);
      parts[left] = std::move(both);
      parts[right] = {};
    });
  const std::vector<Entry> all = parts.empty() ? std::vector<Entry>() : std::move(parts.front());

  // ∫ N over the whole grid is the product of the three univariate integrals.
  std::array<std::vector<double>, 3> whole;
  for (std::size_t d = 0; d < 3; ++d) {
    const KnotVector& knots = grid.knots(static_cast<int>(d));
    whole[d].assign(static_cast<std::size_t>(n[d]), 0.0);
    std::array<double, max_degree + 1> integrals{};
    for (std::int64_t e = 0; e < spans[d]; ++e) {
      integrate_basis(knots, e, std::span(integrals).first(static_cast<std::size_t>(p[d] + 1)));
      for (int a = 0; a <= p[d]; ++a)
        whole[d][static_cast<std::size_t>(e + a)] += integrals[static_cast<std::size_t>(a)];
    }
  }
  std::vector<double> result;
  result.reserve(all.size());
  for (const Entry& entry : all) {
    const Index3 ijk = grid.function_index(cells.function[static_cast<std::size_t>(entry.function)]);
    const double full = whole[0][static_cast<std::size_t>(ijk[0])] * whole[1][static_cast<std::size_t>(ijk[1])] *
                        whole[2][static_cast<std::size_t>(ijk[2])];
    result.push_back(std::min(1.0, entry.mass / full));
  }
  return result;
}

namespace {

// Mass fractions of the unknowns, from those of the functions: (n_u).
std::vector<double> unknown_mass_fractions(const SplineGrid& grid, const CellTable& cells,
                                           const std::vector<double>& mass_fraction) {
  const Unknowns& u = cells.unknowns.rows;
  std::vector<double> mass(u.function.size(), 0);
  for (std::size_t f = 0; f + 1 < u.offsets.size(); ++f) {
    const double own = mass_fraction[f] * grid.integral(grid.function_index(cells.function[f]));
    for (auto t = static_cast<std::size_t>(u.offsets[f]); t < static_cast<std::size_t>(u.offsets[f + 1]); ++t)
      mass[static_cast<std::size_t>(u.terms[t])] += u.weights[t] * own;
  }
  // Inexact rules and differences of large factors may leave nothing of a tiny share.
  constexpr double least = 1e-15;
  for (std::size_t k = 0; k < mass.size(); ++k) mass[k] = std::clamp(mass[k] / cells.unknowns.full[k], least, 1.0);
  return mass;
}

} // namespace

void place_cells(Trimming&& trimming, CellTable&& cells, TrimmedModel& model) {
  model.cells.state.resize(trimming.active.size());
  for (std::size_t c = 0; c < trimming.active.size(); ++c)
    model.cells.state[c] = trimming.state[static_cast<std::size_t>(trimming.active[c])];
  model.state = std::move(trimming.state);
  model.cells.span = std::move(trimming.active);
  model.cells.volume_fraction = std::move(trimming.fraction);
  model.cells.functions = std::move(cells.functions);
  std::vector<double> fractions;
  if (!model.functions.mass_fraction.empty())
    fractions = unknown_mass_fractions(model.grid, cells, model.functions.mass_fraction);
  model.functions.number = std::move(cells.function);
  model.unknowns = std::move(cells.unknowns.rows);
  model.unknowns.mass_fraction = std::move(fractions);
  model.links.cells.reserve(2 * trimming.links.size());
  for (const PieceLink& link : trimming.links) {
    model.links.cells.push_back(link.low);
    model.links.cells.push_back(link.high);
  }
}

} // namespace iga::prep
