#include "preprocessor/trim/optimise_offset.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/errors.hpp"

#include <algorithm>
#include <exception>
#include <memory>
#include <nlopt.h>

namespace iga::prep {

namespace {

// Together about as many as a 5³ sampling of the offsets would take, which finds higher counts.
constexpr int global_evaluations = 75;
constexpr int local_evaluations = 75;

// (num_spans × (p + 1)): ∫ over the span of each function that lives there / ∫ of that function over the whole grid.
std::vector<double> span_shares(const KnotVector& knots) {
  const auto n = static_cast<std::size_t>(knots.num_spans());
  const auto width = static_cast<std::size_t>(knots.degree() + 1);
  std::vector<double> shares(n * width), whole(static_cast<std::size_t>(knots.num_functions()), 0.0);
  for (std::size_t e = 0; e < n; ++e) {
    integrate_basis(knots, static_cast<std::int64_t>(e), std::span(shares).subspan(e * width, width));
    for (std::size_t a = 0; a < width; ++a) whole[e + a] += shares[e * width + a];
  }
  for (std::size_t e = 0; e < n; ++e)
    for (std::size_t a = 0; a < width; ++a) shares[e * width + a] /= whole[e + a];
  return shares;
}

struct Search {
  const GridFrame& frame;
  const TriangleMesh& mesh;
  const TrimOptions& options;
  const std::function<void(std::int64_t, std::int64_t)>& progress;
  const std::function<bool()>& cancelled;
  nlopt_opt optimiser = nullptr;
  OffsetSearch best;
  std::exception_ptr failure;

  std::int64_t count(const Point3& offset) const {
    const SplineGrid grid = place_grid(frame, offset);
    return light_function_count(grid, trim(grid, mesh, options));
  }
};

// No exception may cross NLopt's C frames: it is kept and thrown again after the search.
double objective(unsigned, const double* x, double*, void* data) {
  auto& search = *static_cast<Search*>(data);
  if (search.failure || search.cancelled()) {
    nlopt_force_stop(search.optimiser);
    return 0;
  }
  try {
    const Point3 offset{x[0], x[1], x[2]};
    const std::int64_t light = search.count(offset);
    if (light < search.best.light_after) {
      search.best.light_after = light;
      search.best.offset = offset;
    }
    search.progress(++search.best.evaluations, global_evaluations + local_evaluations);
    return static_cast<double>(light);
  } catch (...) {
    search.failure = std::current_exception();
    nlopt_force_stop(search.optimiser);
    return 0;
  }
}

// Runs one of NLopt's methods from the best offset so far.
void minimise(Search& search, nlopt_algorithm method, int evaluations) {
  if (search.best.light_after == 0 || search.cancelled()) return;
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> optimiser(nlopt_create(method, 3), nlopt_destroy);
  search.optimiser = optimiser.get();
  nlopt_set_min_objective(search.optimiser, objective, &search);
  nlopt_set_lower_bounds1(search.optimiser, 0.0);
  nlopt_set_upper_bounds1(search.optimiser, 1.0);
  nlopt_set_maxeval(search.optimiser, evaluations);
  nlopt_set_stopval(search.optimiser, 0.5); // no light function left
  Point3 x = search.best.offset;
  for (double& offset : x) offset = std::clamp(offset, 0.0, 1.0);
  double light = 0;
  const nlopt_result result = nlopt_optimize(search.optimiser, x.data(), &light);
  if (search.failure) std::rethrow_exception(search.failure);
  if (result < 0 && result != NLOPT_FORCED_STOP && result != NLOPT_ROUNDOFF_LIMITED)
    throw NumericalError("the search for the grid's offset failed; run without --optimise-offset");
}

} // namespace

std::int64_t light_function_count(const SplineGrid& grid, const Trimming& trimming) {
  std::array<std::vector<double>, 3> shares;
  for (int d = 0; d < 3; ++d) shares[static_cast<std::size_t>(d)] = span_shares(grid.knots(d));
  const auto [pu, pv, pw] = grid.degree();
  const Index3 functions = grid.functions();
  const auto layer_size = static_cast<std::size_t>(functions[0] * functions[1]);
  // Layer k of functions lives in ring[k % (pw + 1)]; it is complete once span layer k is done.
  const auto ring_size = static_cast<std::int64_t>(pw + 1);
  std::vector<std::vector<double>> ring(static_cast<std::size_t>(ring_size), std::vector<double>(layer_size, 0.0));
  std::int64_t light = 0;
  const auto close_layer = [&](std::int64_t k) {
    std::vector<double>& layer = ring[static_cast<std::size_t>(k % ring_size)];
    for (double& mass : layer) {
      if (mass > 0 && mass < light_mass_fraction) ++light;
      mass = 0;
    }
  };

  std::int64_t open = 0; // lowest function layer that is not closed
  for (std::size_t a = 0; a < trimming.active.size(); ++a) {
    const Index3 ijk = grid.span_index(trimming.active[a]);
    for (; open < ijk[2]; ++open) close_layer(open);
    const std::span su = std::span(shares[0]).subspan(static_cast<std::size_t>(ijk[0] * (pu + 1)));
    const std::span sv = std::span(shares[1]).subspan(static_cast<std::size_t>(ijk[1] * (pv + 1)));
    const std::span sw = std::span(shares[2]).subspan(static_cast<std::size_t>(ijk[2] * (pw + 1)));
    for (int c = 0; c <= pw; ++c) {
      std::vector<double>& layer = ring[static_cast<std::size_t>((ijk[2] + c) % ring_size)];
      for (int b = 0; b <= pv; ++b) {
        const double factor = trimming.fraction[a] * sv[static_cast<std::size_t>(b)] * sw[static_cast<std::size_t>(c)];
        const auto row = static_cast<std::size_t>(ijk[0] + functions[0] * (ijk[1] + b));
        for (int i = 0; i <= pu; ++i)
          layer[row + static_cast<std::size_t>(i)] += factor * su[static_cast<std::size_t>(i)];
      }
    }
  }
  for (const std::int64_t end = open + ring_size; open < end; ++open) close_layer(open);
  return light;
}

OffsetSearch optimise_offset(const GridFrame& frame, const TriangleMesh& mesh, const TrimOptions& options,
                             const std::function<void(std::int64_t, std::int64_t)>& progress,
                             const std::function<bool()>& cancelled) {
  Search search{frame, mesh, options, progress, cancelled, nullptr, {}, nullptr};
  search.best.offset = centred_offset(frame);
  search.best.light_before = search.best.light_after = search.count(search.best.offset);

  minimise(search, NLOPT_GN_DIRECT_L, global_evaluations);
  minimise(search, NLOPT_LN_SBPLX, local_evaluations);
  return search.best;
}

} // namespace iga::prep
