#include "format/model/vec3.hpp"
#include "solver/base/in_order.hpp"
#include "solver/supports/support_rows.hpp"
#include "solver/ties/tie.hpp"

#include <algorithm>
#include <numeric>

namespace iga::solve {

namespace {

using Eigen::Index;

// The points of one side, cell by cell.
SurfaceRegion region_of(const TieSurface& surface, std::size_t s) {
  std::vector<std::size_t> order(surface.pairs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto cell = [&](std::size_t k) { return surface.pairs[k].side[s].cell; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return cell(x) < cell(y); });
  SurfaceRegion region;
  region.offsets = {0};
  for (const std::size_t k : order) {
    const PointBatch& batch = surface.pairs[k].side[s];
    if (region.cells.empty() || region.cells.back() != batch.cell) {
      region.cells.push_back(batch.cell);
      region.offsets.push_back(region.offsets.back());
    }
    region.parameters.insert(region.parameters.end(), batch.parameters.begin(), batch.parameters.end());
    region.weights.insert(region.weights.end(), batch.weights.begin(), batch.weights.end());
    region.normals.insert(region.normals.end(), batch.normals.begin(), batch.normals.end());
    region.offsets.back() += static_cast<std::int64_t>(batch.size());
  }
  return region;
}

/// β of a pair of cells and the share γ of the first body's stress; the second one has the rest.
struct Weights {
  double beta = 0, first = 0.5;
};

double beta_of(const PreparedSupport& side, std::int64_t cell) {
  const auto& cells = side.region.cells;
  return side.beta[static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin())];
}

Weights weights_of(const BodySystem& system, const PreparedTie& tie, const TiePair& pair) {
  if (tie.surface.tie.method == TieMethod::Penalty) {
    double softest = std::numeric_limits<double>::infinity();
    for (const std::size_t b : tie.surface.body)
      softest = std::min(softest, effective_modulus(system[b].material) /
                                      std::cbrt(system[b].space->model().grid.span_volume()));
    return {tie.surface.tie.penalty_factor * softest, 0.5};
  }
  const double a = beta_of(tie.side[0], pair.side[0].cell), b = beta_of(tie.side[1], pair.side[1].cell);
  if (!(a > 0) && !(b > 0)) return {};
  if (!(b > 0)) return {0, 0};
  const double first = 1 / (1 + a / b);
  return {a * first, first};
}

/// Rows of a pair over the unknowns of both cells, those of the first body before those of the second.
struct PairRows {
  Eigen::MatrixXd jump, traction; ///< (3 points × unknowns): [u] and {t}
  Eigen::VectorXd weight;         ///< (3 points): area
  Weights weights;
};

PairRows pair_rows(const BodySystem& system, const PreparedTie& tie, const TiePair& pair) {
  const bool nitsche = tie.surface.tie.method == TieMethod::Nitsche;
  PairRows rows;
  rows.weights = weights_of(system, tie, pair);
  Index column = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    const SystemBody& body = system[tie.surface.body[s]];
    SpanShapes shapes;
    const SupportRows side = make_rows(*body.space, body.material, tie.side[s], pair.side[s],
                                       nitsche ? RowParts::Both : RowParts::Trace, shapes);
    rows.weight = side.weight;
    rows.jump.conservativeResize(side.trace.rows(), column + side.trace.cols());
    rows.jump.rightCols(side.trace.cols()) = (s == 0 ? 1 : -1) * side.trace;
    rows.traction.conservativeResize(side.trace.rows(), column + side.trace.cols());
    if (nitsche)
      rows.traction.rightCols(side.trace.cols()) =
          (s == 0 ? rows.weights.first : 1 - rows.weights.first) * side.traction;
    else
      rows.traction.rightCols(side.trace.cols()).setZero();
    column += side.trace.cols();
  }
  return rows;
}

std::vector<std::int32_t> nodes_of(const BodySystem& system, const TieSurface& surface, const TiePair& pair) {
  std::vector<std::int32_t> nodes;
  for (std::size_t s = 0; s < 2; ++s) {
    const SystemBody& body = system[surface.body[s]];
    for (const std::int32_t node : body.space->nodes(pair.side[s].cell))
      nodes.push_back(static_cast<std::int32_t>(body.first_node) + node);
  }
  return nodes;
}

} // namespace

std::vector<std::vector<std::int32_t>> coupled_nodes(const BodySystem& system, std::span<const TieSurface> ties) {
  std::vector<std::vector<std::int32_t>> sets;
  for (const TieSurface& surface : ties)
    for (const TiePair& pair : surface.pairs) sets.push_back(nodes_of(system, surface, pair));
  return sets;
}

std::vector<PreparedTie> prepare_ties(std::vector<TieSurface> surfaces) {
  std::vector<PreparedTie> ties;
  for (TieSurface& surface : surfaces) {
    PreparedTie tie;
    for (std::size_t s = 0; s < 2; ++s) tie.side[s].region = region_of(surface, s);
    tie.surface = std::move(surface);
    ties.push_back(std::move(tie));
  }
  return ties;
}

std::vector<PreparedSupport*> nitsche_sides(std::span<PreparedTie> ties, std::size_t body) {
  std::vector<PreparedSupport*> sides;
  for (PreparedTie& tie : ties)
    for (std::size_t s = 0; s < 2; ++s)
      if (tie.surface.tie.method == TieMethod::Nitsche && tie.surface.body[s] == body) sides.push_back(&tie.side[s]);
  return sides;
}

void add_ties(const BodySystem& system, std::span<const PreparedTie> ties, StiffnessMatrix& K) {
  for (const PreparedTie& tie : ties)
    in_order(
        tie.surface.pairs.size(),
        [&](std::size_t k) -> Eigen::MatrixXd {
          const PairRows rows = pair_rows(system, tie, tie.surface.pairs[k]);
          const Eigen::MatrixXd weighted = rows.weight.asDiagonal() * rows.jump;
          const Eigen::MatrixXd flux = rows.traction.transpose() * weighted;
          return rows.weights.beta * (rows.jump.transpose() * weighted) - flux - flux.transpose();
        },
        [&](std::size_t k, const Eigen::MatrixXd& block) {
          K.add(nodes_of(system, tie.surface, tie.surface.pairs[k]), block);
        });
}

std::vector<TieForce> tie_forces(const BodySystem& system, std::span<const PreparedTie> ties,
                                 const Eigen::VectorXd& u) {
  std::vector<TieForce> forces;
  for (const PreparedTie& tie : ties) {
    TieForce sum;
    for (const TiePair& pair : tie.surface.pairs) {
      const PairRows rows = pair_rows(system, tie, pair);
      const auto nodes = nodes_of(system, tie.surface, pair);
      Eigen::VectorXd local(3 * static_cast<Index>(nodes.size()));
      for (std::size_t r = 0; r < nodes.size(); ++r)
        local.segment<3>(3 * static_cast<Index>(r)) = u.segment<3>(3 * static_cast<Index>(nodes[r]));
      const Eigen::VectorXd jump = rows.jump * local, stress = rows.traction * local;
      const Eigen::VectorXd traction = rows.weight.cwiseProduct(stress - rows.weights.beta * jump);
      sum.gap_work += rows.weight.dot(stress.cwiseProduct(jump));
      sum.penalty_energy += 0.5 * rows.weights.beta * rows.weight.dot(jump.cwiseAbs2());
      for (std::size_t q = 0; q < pair.side[0].size(); ++q) {
        const auto row = 3 * static_cast<Index>(q);
        const Point3 f{traction[row], traction[row + 1], traction[row + 2]};
        sum.force = plus(sum.force, f);
        sum.moment = plus(sum.moment, cross(pair.side[0].positions[q], f));
        sum.largest_jump = std::max(sum.largest_jump, jump.segment<3>(row).norm());
      }
    }
    forces.push_back(sum);
  }
  return forces;
}

} // namespace iga::solve
