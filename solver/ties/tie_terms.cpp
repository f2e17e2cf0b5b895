#include "format/model/vec3.hpp"
#include "solver/base/in_order.hpp"
#include "solver/supports/support_rows.hpp"
#include "solver/ties/tie.hpp"

#include <algorithm>
#include <numeric>

namespace iga::solve {

namespace {

using Eigen::Index;

// Triangles of at most this share of a span in every direction have one point in a side's region.
constexpr double small_triangle = 0.2;
// Points of a pair that are worked on at a time.
constexpr std::size_t chunk = 512;

// Adds the points [first, last) of one triangle, or their mean where the triangle is small beside a span.
void add_triangle(const SplineGrid& grid, const TiePair& pair, std::size_t s, std::size_t first, std::size_t last,
                  SurfaceRegion& region) {
  const double* u = pair.parameters[s].data();
  Point3 low{u[3 * first], u[3 * first + 1], u[3 * first + 2]}, high = low, moment{};
  double area = 0;
  for (std::size_t q = first; q < last; ++q) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], u[3 * q + d]);
      high[d] = std::max(high[d], u[3 * q + d]);
      moment[d] += pair.weights[q] * u[3 * q + d];
    }
    area += pair.weights[q];
  }
  const Point3 h = grid.span_size();
  bool small = true;
  for (std::size_t d = 0; d < 3; ++d) small = small && high[d] - low[d] <= small_triangle * h[d];
  if (small) {
    for (const double m : moment) region.parameters.push_back(m / area);
    region.weights.push_back(area);
    region.normals.push_back(pair.normals[first]);
    return;
  }
  region.parameters.insert(region.parameters.end(), u + 3 * first, u + 3 * last);
  for (std::size_t q = first; q < last; ++q) {
    region.weights.push_back(pair.weights[q]);
    region.normals.push_back(pair.normals[q]);
  }
}

// The points of one side, cell by cell.
SurfaceRegion region_of(const SplineGrid& grid, const TieSurface& surface, std::size_t s) {
  std::vector<std::size_t> order(surface.pairs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto cell = [&](std::size_t k) { return surface.pairs[k].cell[s]; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return cell(x) < cell(y); });
  SurfaceRegion region;
  region.offsets = {0};
  for (const std::size_t k : order) {
    const TiePair& pair = surface.pairs[k];
    if (region.cells.empty() || region.cells.back() != pair.cell[s]) {
      region.cells.push_back(pair.cell[s]);
      region.offsets.push_back(region.offsets.back());
    }
    for (std::size_t q = 0; q < pair.size(); q += surface.points_per_triangle)
      add_triangle(grid, pair, s, q, q + surface.points_per_triangle, region);
    region.offsets.back() = static_cast<std::int64_t>(region.weights.size());
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
  const double a = beta_of(tie.side[0], pair.cell[0]), b = beta_of(tie.side[1], pair.cell[1]);
  if (!(a > 0) && !(b > 0)) return {};
  if (!(b > 0)) return {0, 0};
  const double first = 1 / (1 + a / b);
  return {a * first, first};
}

/// Some points of a pair, over the nodes of both cells, those of the first body before those of the second.
struct PairRows {
  Eigen::MatrixXd jump;                    ///< (points × nodes): [u] of one component
  std::array<Eigen::MatrixXd, 3> traction; ///< (points × unknowns): components of {t}; empty for the penalty method
  Eigen::MatrixX3d initial; ///< (points × 3): {C ε₀ n}, which the traction lacks; zero where there is none
  Eigen::VectorXd weight;   ///< (points): area
};

PairRows pair_rows(const BodySystem& system, const PreparedTie& tie, const TiePair& pair, const Weights& weights,
                   std::size_t first, std::size_t last) {
  const auto m = static_cast<Index>(last - first);
  std::array<Index, 2> nodes{};
  for (std::size_t s = 0; s < 2; ++s)
    nodes[s] = static_cast<Index>(system[tie.surface.body[s]].space->nodes(pair.cell[s]).size());
  PairRows rows;
  rows.weight = Eigen::Map<const Eigen::VectorXd>(pair.weights.data() + first, m);
  rows.jump.resize(m, nodes[0] + nodes[1]);
  const bool nitsche = tie.surface.tie.method == TieMethod::Nitsche;
  rows.initial.setZero(m, 3);
  if (nitsche)
    for (Eigen::MatrixXd& component : rows.traction) component.resize(m, 3 * (nodes[0] + nodes[1]));
  SpanShapes shapes;
  for (std::size_t s = 0; s < 2; ++s) {
    const SystemBody& body = system[tie.surface.body[s]];
    PointBatch batch;
    batch.cell = pair.cell[s];
    const double* u = pair.parameters[s].data();
    batch.parameters.assign(u + 3 * first, u + 3 * last);
    batch.weights.assign(pair.weights.data() + first, pair.weights.data() + last);
    batch.normals.assign(pair.normals.data() + first, pair.normals.data() + last);
    batch.positions.resize(batch.size()); // nothing is prescribed
    evaluate(*body.space, batch.cell, batch.parameters, Shapes::Values, shapes);
    const Index column = s == 0 ? 0 : nodes[0];
    rows.jump.middleCols(column, nodes[s]) = (s == 0 ? 1 : -1) * shapes.values;
    if (!nitsche) continue;
    const SupportRows side = make_rows(*body.space, body.material, tie.side[s], batch, RowParts::Traction, shapes);
    const double share = s == 0 ? weights.first : 1 - weights.first;
    for (Index d = 0; d < 3; ++d) {
      rows.traction[static_cast<std::size_t>(d)].middleCols(3 * column, 3 * nodes[s]) =
          share * side.traction(Eigen::seqN(d, m, 3), Eigen::all);
      if (side.initial.size() > 0) rows.initial.col(d) += share * side.initial(Eigen::seqN(d, m, 3));
    }
  }
  return rows;
}

template <class Use>
void for_chunks(const BodySystem& system, const PreparedTie& tie, const TiePair& pair, const Weights& weights,
                Use use) {
  for (std::size_t first = 0; first < pair.size(); first += chunk)
    use(first, pair_rows(system, tie, pair, weights, first, std::min(first + chunk, pair.size())));
}

// β M - B - Bᵀ of a pair. A component's jump is the same in all three, so that M is one block of nodes.
Eigen::MatrixXd pair_matrix(const BodySystem& system, const PreparedTie& tie, const TiePair& pair) {
  const Weights weights = weights_of(system, tie, pair);
  Eigen::MatrixXd mass;
  std::array<Eigen::MatrixXd, 3> flux;
  for_chunks(system, tie, pair, weights, [&](std::size_t first, const PairRows& rows) {
    const Eigen::MatrixXd weighted = rows.weight.asDiagonal() * rows.jump;
    if (first == 0) {
      mass.setZero(rows.jump.cols(), rows.jump.cols());
      for (Eigen::MatrixXd& f : flux) f.setZero(3 * rows.jump.cols(), rows.jump.cols());
    }
    mass.noalias() += rows.jump.transpose() * weighted;
    for (std::size_t d = 0; d < 3; ++d)
      if (rows.traction[d].size() > 0) flux[d].noalias() += rows.traction[d].transpose() * weighted;
  });
  const Index n = mass.cols();
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Index d = 0; d < 3; ++d) {
    block(Eigen::seqN(d, n, 3), Eigen::seqN(d, n, 3)) = weights.beta * mass;
    block(Eigen::all, Eigen::seqN(d, n, 3)) -= flux[static_cast<std::size_t>(d)];
    block(Eigen::seqN(d, n, 3), Eigen::all) -= flux[static_cast<std::size_t>(d)].transpose();
  }
  return block;
}

std::vector<std::int32_t> nodes_of(const BodySystem& system, const TieSurface& surface, const TiePair& pair) {
  std::vector<std::int32_t> nodes;
  for (std::size_t s = 0; s < 2; ++s) {
    const SystemBody& body = system[surface.body[s]];
    for (const std::int32_t node : body.space->nodes(pair.cell[s]))
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

std::vector<PreparedTie> prepare_ties(const BodySystem& system, std::vector<TieSurface> surfaces) {
  std::vector<PreparedTie> ties;
  for (TieSurface& surface : surfaces) {
    PreparedTie tie;
    for (std::size_t s = 0; s < 2; ++s)
      tie.side[s].region = region_of(system[surface.body[s]].space->model().grid, surface, s);
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
        tie.surface.pairs.size(), [&](std::size_t k) { return pair_matrix(system, tie, tie.surface.pairs[k]); },
        [&](std::size_t k, const Eigen::MatrixXd& block) {
          K.add(nodes_of(system, tie.surface, tie.surface.pairs[k]), block);
        });
}

namespace {

TieForce force_of(const BodySystem& system, const PreparedTie& tie, const TiePair& pair, const Eigen::VectorXd& u) {
  const auto nodes = nodes_of(system, tie.surface, pair);
  const SplineGrid& grid = system[tie.surface.body[0]].space->model().grid;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> local(static_cast<Index>(nodes.size()), 3);
  for (std::size_t r = 0; r < nodes.size(); ++r)
    local.row(static_cast<Index>(r)) = u.segment<3>(3 * static_cast<Index>(nodes[r])).transpose();
  const Eigen::Map<const Eigen::VectorXd> unknowns(local.data(), local.size());
  const Weights weights = weights_of(system, tie, pair);
  TieForce sum;
  for_chunks(system, tie, pair, weights, [&](std::size_t first, const PairRows& rows) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3> jump = rows.jump * local;
    Eigen::Matrix<double, Eigen::Dynamic, 3> stress = Eigen::MatrixXd::Zero(jump.rows(), 3);
    for (Index d = 0; d < 3; ++d)
      if (const auto& traction = rows.traction[static_cast<std::size_t>(d)]; traction.size() > 0)
        stress.col(d) = traction * unknowns;
    for (Index q = 0; q < jump.rows(); ++q) {
      const double w = rows.weight[q];
      sum.gap_work += w * (stress.row(q) - 0.5 * rows.initial.row(q)).dot(jump.row(q));
      sum.penalty_energy += 0.5 * weights.beta * w * jump.row(q).squaredNorm();
      sum.largest_jump = std::max(sum.largest_jump, jump.row(q).norm());
      const Eigen::RowVector3d t = w * (stress.row(q) - rows.initial.row(q) - weights.beta * jump.row(q));
      const double* at = pair.parameters[0].data() + 3 * (first + static_cast<std::size_t>(q));
      const Point3 f{t[0], t[1], t[2]};
      sum.force = plus(sum.force, f);
      sum.moment = plus(sum.moment, cross(grid.to_position({at[0], at[1], at[2]}), f));
    }
  });
  return sum;
}

} // namespace

Eigen::VectorXd initial_strain_load(const BodySystem& system, std::span<const PreparedTie> ties) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(system.num_unknowns());
  for (const PreparedTie& tie : ties) {
    const auto strained = [&](std::size_t b) { return system[b].material.initial_strain != nullptr; };
    if (tie.surface.tie.method != TieMethod::Nitsche ||
        !(strained(tie.surface.body[0]) || strained(tie.surface.body[1])))
      continue;
    in_order(
        tie.surface.pairs.size(),
        [&](std::size_t k) {
          const TiePair& pair = tie.surface.pairs[k];
          Eigen::MatrixX3d nodal;
          for_chunks(system, tie, pair, weights_of(system, tie, pair), [&](std::size_t first, const PairRows& rows) {
            if (first == 0) nodal.setZero(rows.jump.cols(), 3);
            nodal -= rows.jump.transpose() * (rows.weight.asDiagonal() * rows.initial);
          });
          return nodal;
        },
        [&](std::size_t k, const Eigen::MatrixX3d& nodal) {
          const auto nodes = nodes_of(system, tie.surface, tie.surface.pairs[k]);
          for (std::size_t r = 0; r < nodes.size(); ++r)
            load.segment<3>(3 * Index{nodes[r]}) += nodal.row(static_cast<Index>(r)).transpose();
        });
  }
  return load;
}

std::vector<TieForce> tie_forces(const BodySystem& system, std::span<const PreparedTie> ties,
                                 const Eigen::VectorXd& u) {
  std::vector<TieForce> forces;
  for (const PreparedTie& tie : ties) {
    TieForce sum;
    in_order(
        tie.surface.pairs.size(), [&](std::size_t k) { return force_of(system, tie, tie.surface.pairs[k], u); },
        [&](std::size_t, const TieForce& part) {
          sum.force = plus(sum.force, part.force);
          sum.moment = plus(sum.moment, part.moment);
          sum.gap_work += part.gap_work;
          sum.penalty_energy += part.penalty_energy;
          sum.largest_jump = std::max(sum.largest_jump, part.largest_jump);
        });
    forces.push_back(sum);
  }
  return forces;
}

} // namespace iga::solve
