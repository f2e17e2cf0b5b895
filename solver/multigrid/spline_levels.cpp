#include "solver/multigrid/spline_levels.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/disjoint_sets.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace iga::solve {

namespace {

// Weights of functions without a share are rounding.
constexpr double no_share = 1e-12;
// Coarser levels that keep more than this share of the nodes are not worth their products.
constexpr double hardly_fewer = 0.6;
// Functions along the edge of a block.
constexpr int longest_edge = 4;

// The vector on every other inner knot; the last span may be a single one.
KnotVector every_other(const KnotVector& knots) {
  const auto values = knots.values();
  const auto p = static_cast<std::size_t>(knots.degree()), n = static_cast<std::size_t>(knots.num_spans());
  std::vector<double> kept(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(p) + 1);
  for (std::size_t k = 2; k < n; k += 2) kept.push_back(values[p + k]);
  kept.insert(kept.end(), values.end() - static_cast<std::ptrdiff_t>(p) - 1, values.end());
  return {knots.degree(), std::move(kept)};
}

} // namespace

SplineLevel::SplineLevel(const SolutionSpace& space, std::span<const std::int64_t> held) {
  const TrimmedModel& model = space.model();
  const SplineGrid& grid = model.grid;
  for (std::size_t d = 0; d < 3; ++d) knots_[d] = grid.knots(static_cast<int>(d));
  const std::size_t n = model.num_unknowns();
  coefficient_.resize(n);
  for (std::size_t u = 0; u < n; ++u) {
    const std::int64_t f = model.function_of(u);
    if (f >= 0) {
      const Index3 ijk = grid.function_index(model.functions.number[static_cast<std::size_t>(f)]);
      for (std::size_t d = 0; d < 3; ++d) coefficient_[u][d] = static_cast<std::int32_t>(ijk[d]);
      continue;
    }
    for (std::size_t d = 0; d < 3; ++d) { // its Greville point lies p-ths of its span from below
      const double greville = model.unknowns.parameters[3 * u + d];
      const std::int64_t span = knots_[d].find_span(greville);
      const double low = knots_[d].lower(span), high = knots_[d].upper(span), p = knots_[d].degree();
      const auto k = static_cast<std::int64_t>(std::lround(p * (greville - low) / (high - low)));
      coefficient_[u][d] = static_cast<std::int32_t>(num_functions(d) + (knots_[d].degree() + 1) * span + k);
    }
  }
  node_of_.assign(n, -1);
  for (const std::int64_t u : space.node_unknowns())
    node_of_[static_cast<std::size_t>(u)] = static_cast<std::int32_t>(num_nodes_++);
  const CellUnknowns cell_unknowns(model);
  cell_offsets_.push_back(0);
  for (std::size_t c = 0; c < model.num_cells(); ++c) {
    const Index3 ijk = grid.span_index(model.cells.span[c]);
    cell_span_.push_back(
        {static_cast<std::int32_t>(ijk[0]), static_cast<std::int32_t>(ijk[1]), static_cast<std::int32_t>(ijk[2])});
    const auto seen = cell_unknowns.of(c);
    cell_unknowns_.insert(cell_unknowns_.end(), seen.begin(), seen.end());
    cell_offsets_.push_back(static_cast<std::int64_t>(cell_unknowns_.size()));
  }
  cell_held_.assign(cell_span_.size(), 0);
  for (const std::int64_t c : held) cell_held_[static_cast<std::size_t>(c)] = 1;
  for (std::size_t c = 0; c < cell_held_.size(); ++c)
    if (model.is_at_gap_end(c)) cell_held_[c] = 1; // its many small functions are nearly dependent
}

std::vector<std::vector<std::int32_t>> SplineLevel::held_nodes() const {
  std::vector<std::vector<std::int32_t>> all;
  for (std::size_t c = 0; c < cell_held_.size(); ++c) {
    if (!cell_held_[c]) continue;
    std::vector<std::int32_t> nodes;
    for (auto k = cell_offsets_[c]; k < cell_offsets_[c + 1]; ++k)
      if (const std::int32_t node = node_of(cell_unknowns_[static_cast<std::size_t>(k)]); node >= 0)
        nodes.push_back(node);
    std::sort(nodes.begin(), nodes.end());
    for (std::size_t from = 0; from < nodes.size(); from += most_in_block)
      all.emplace_back(nodes.begin() + static_cast<std::ptrdiff_t>(from),
                       nodes.begin() + static_cast<std::ptrdiff_t>(std::min(nodes.size(), from + most_in_block)));
  }
  return all;
}

std::vector<std::array<std::int32_t, 3>> SplineLevel::node_places() const {
  std::vector<std::array<std::int32_t, 3>> places;
  for (std::size_t u = 0; u < coefficient_.size(); ++u) {
    if (node_of_[u] < 0) continue;
    places.push_back(coefficient_[u]);
    for (std::size_t d = 0; d < 3; ++d) {
      std::int32_t& place = places.back()[d];
      const std::int32_t p = knots_[d].degree(), bernstein = place - num_functions(d);
      if (bernstein >= 0) place = bernstein / (p + 1) + bernstein % (p + 1); // from the span's first function on
    }
  }
  return places;
}

// The coefficient of a B-spline or a Bernstein function is the blossom of the coarse spline at knots of its own, on any
// span of its support: bspline_basis.hpp.
std::vector<SplineLevel::Row> SplineLevel::rows(std::size_t d, const KnotVector& coarse) const {
  const KnotVector& fine = knots_[d];
  const int p = fine.degree();
  const auto width = static_cast<std::size_t>(p);
  const std::int64_t n = fine.num_functions();
  std::vector<Row> all(static_cast<std::size_t>(n + (p + 1) * fine.num_spans()));
  for (std::int64_t id = 0; id < static_cast<std::int64_t>(all.size()); ++id) {
    std::array<double, max_degree> arguments{};
    std::int64_t span = 0;
    if (id < n) {
      for (std::size_t k = 0; k < width; ++k) arguments[k] = fine.values()[static_cast<std::size_t>(id) + 1 + k];
      span = std::clamp<std::int64_t>(id - p / 2, 0, fine.num_spans() - 1);
    } else {
      span = (id - n) / (p + 1);
      const auto upper = static_cast<std::size_t>((id - n) % (p + 1));
      std::fill_n(arguments.begin(), width, fine.lower(span));
      std::fill_n(arguments.begin(), upper, fine.upper(span));
    }
    const std::int64_t e = coarse.find_span(0.5 * (fine.lower(span) + fine.upper(span)));
    std::array<double, max_degree + 1> weights{};
    blossom_weights(coarse, e, std::span(arguments).first(width), std::span(weights).first(width + 1));
    std::size_t from = 0, to = width + 1;
    while (std::abs(weights[from]) < no_share) ++from;
    while (std::abs(weights[to - 1]) < no_share) --to;
    Row& row = all[static_cast<std::size_t>(id)];
    row.first = static_cast<std::int32_t>(e + static_cast<std::int64_t>(from));
    row.count = static_cast<std::int32_t>(to - from);
    std::copy(weights.begin() + static_cast<std::ptrdiff_t>(from), weights.begin() + static_cast<std::ptrdiff_t>(to),
              row.weights.begin());
  }
  return all;
}

SplineLevel SplineLevel::coarsen(Transfer& transfer) const {
  SplineLevel coarse;
  std::array<std::vector<Row>, 3> row;
  std::array<std::vector<std::int32_t>, 3> coarse_span; // by span of this level
  for (std::size_t d = 0; d < 3; ++d) {
    coarse.knots_[d] = every_other(knots_[d]);
    row[d] = rows(d, coarse.knots_[d]);
    for (std::int64_t s = 0; s < knots_[d].num_spans(); ++s)
      coarse_span[d].push_back(
          static_cast<std::int32_t>(coarse.knots_[d].find_span(0.5 * (knots_[d].lower(s) + knots_[d].upper(s)))));
  }

  // A *share* is an unknown's term of one coarse B-spline; shares of one B-spline that meet in a cell are one copy.
  struct Share {
    std::array<std::int32_t, 3> function;
    double weight;
  };
  const auto n = coefficient_.size();
  std::vector<std::int64_t> first_share{0};
  std::vector<Share> shares;
  for (std::size_t u = 0; u < n; ++u) {
    const Row *x = &row[0][static_cast<std::size_t>(coefficient_[u][0])],
              *y = &row[1][static_cast<std::size_t>(coefficient_[u][1])],
              *z = &row[2][static_cast<std::size_t>(coefficient_[u][2])];
    for (std::int32_t c = 0; c < z->count; ++c)
      for (std::int32_t b = 0; b < y->count; ++b)
        for (std::int32_t a = 0; a < x->count; ++a)
          shares.push_back({{x->first + a, y->first + b, z->first + c},
                            x->weights[static_cast<std::size_t>(a)] * y->weights[static_cast<std::size_t>(b)] *
                                z->weights[static_cast<std::size_t>(c)]});
    first_share.push_back(static_cast<std::int64_t>(shares.size()));
  }
  std::vector<std::int32_t> copy = lone_sets(shares.size());
  std::array<std::int32_t, 3> width;
  for (std::size_t d = 0; d < 3; ++d) width[d] = knots_[d].degree() + 1;
  const auto local_count = static_cast<std::size_t>(width[0] * width[1] * width[2]);
  const auto cells = cell_span_.size();
  std::vector<std::int32_t> seen(cells * local_count, -1); // a share of each coarse B-spline on each cell
  for (std::size_t c = 0; c < cells; ++c) {
    std::int32_t* const local = seen.data() + c * local_count;
    for (std::int64_t k = cell_offsets_[c]; k < cell_offsets_[c + 1]; ++k) {
      const auto u = static_cast<std::size_t>(cell_unknowns_[static_cast<std::size_t>(k)]);
      for (std::int64_t s = first_share[u]; s < first_share[u + 1]; ++s) {
        const auto& function = shares[static_cast<std::size_t>(s)].function;
        std::array<std::int32_t, 3> at;
        bool inside = true; // Bernstein functions at the end of a span have shares of the next one too
        for (std::size_t d = 0; d < 3; ++d) {
          at[d] = function[d] - coarse_span[d][static_cast<std::size_t>(cell_span_[c][d])];
          inside = inside && at[d] >= 0 && at[d] < width[d];
        }
        if (!inside) continue;
        std::int32_t& first = local[at[0] + width[0] * (at[1] + width[1] * at[2])];
        if (first < 0)
          first = static_cast<std::int32_t>(s);
        else
          join_sets(copy, first, static_cast<std::int32_t>(s));
      }
    }
  }

  // Copies in the order of their B-splines, then of their first shares.
  std::vector<std::int32_t> roots;
  for (std::size_t s = 0; s < shares.size(); ++s)
    if (copy[s] == static_cast<std::int32_t>(s)) roots.push_back(static_cast<std::int32_t>(s));
  const auto key = [&](std::int32_t s) {
    const auto& f = shares[static_cast<std::size_t>(s)].function;
    return std::array<std::int32_t, 4>{f[2], f[1], f[0], s};
  };
  std::sort(roots.begin(), roots.end(), [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  std::vector<std::int32_t> number(shares.size(), -1); // of a root
  for (std::size_t k = 0; k < roots.size(); ++k)
    number[static_cast<std::size_t>(roots[k])] = static_cast<std::int32_t>(k);
  const auto number_of = [&](std::int32_t share) { return number[static_cast<std::size_t>(find_root(copy, share))]; };
  for (const std::int32_t root : roots) coarse.coefficient_.push_back(shares[static_cast<std::size_t>(root)].function);
  coarse.node_of_.assign(roots.size(), -1);
  for (std::size_t u = 0; u < n; ++u)
    for (std::int64_t s = first_share[u]; node_of_[u] >= 0 && s < first_share[u + 1]; ++s)
      coarse.node_of_[static_cast<std::size_t>(number_of(static_cast<std::int32_t>(s)))] = 0;
  for (std::int32_t& node : coarse.node_of_)
    if (node == 0) node = static_cast<std::int32_t>(coarse.num_nodes_++);

  transfer = {};
  transfer.num_coarse = coarse.num_nodes_;
  transfer.offsets.push_back(0);
  std::vector<std::pair<std::int32_t, double>> terms;
  for (std::size_t u = 0; u < n; ++u) {
    if (node_of_[u] < 0) continue; // nodes are numbered in the order of the unknowns
    terms.clear();
    for (std::int64_t s = first_share[u]; s < first_share[u + 1]; ++s)
      terms.emplace_back(coarse.node_of_[static_cast<std::size_t>(number_of(static_cast<std::int32_t>(s)))],
                         shares[static_cast<std::size_t>(s)].weight);
    std::sort(terms.begin(), terms.end());
    for (const auto& [node, weight] : terms) {
      transfer.nodes.push_back(node);
      transfer.weights.push_back(weight);
    }
    transfer.offsets.push_back(static_cast<std::int64_t>(transfer.nodes.size()));
  }

  // Cells of one coarse span that see the same copies are one.
  struct Cell {
    std::array<std::int32_t, 3> span;
    std::vector<std::int32_t> local;
    char held;
  };
  std::vector<Cell> merged;
  for (std::size_t c = 0; c < cells; ++c) {
    std::array<std::int32_t, 3> span; // slowest direction first: the order of the numbers
    for (std::size_t d = 0; d < 3; ++d) span[2 - d] = coarse_span[d][static_cast<std::size_t>(cell_span_[c][d])];
    std::vector<std::int32_t> local;
    for (std::size_t k = 0; k < local_count; ++k)
      if (const std::int32_t share = seen[c * local_count + k]; share >= 0) local.push_back(number_of(share));
    merged.push_back({span, std::move(local), cell_held_[c]});
  }
  std::sort(merged.begin(), merged.end(),
            [](const Cell& a, const Cell& b) { return std::tie(a.span, a.local) < std::tie(b.span, b.local); });
  coarse.cell_offsets_.push_back(0);
  for (std::size_t c = 0; c < merged.size(); ++c) {
    const auto& [span, local, held] = merged[c];
    if (c > 0 && span == merged[c - 1].span && local == merged[c - 1].local) {
      coarse.cell_held_.back() = static_cast<char>(coarse.cell_held_.back() | held);
      continue;
    }
    coarse.cell_held_.push_back(held);
    coarse.cell_span_.push_back({span[2], span[1], span[0]});
    coarse.cell_unknowns_.insert(coarse.cell_unknowns_.end(), local.begin(), local.end());
    coarse.cell_offsets_.push_back(static_cast<std::int64_t>(coarse.cell_unknowns_.size()));
  }
  return coarse;
}

namespace {

NodeBlocks node_blocks(std::span<const SplineLevel> bodies) {
  std::vector<std::pair<std::array<std::int32_t, 4>, std::int32_t>> order; // block, node
  std::int32_t first = 0, edge = 1;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (int d = 0; d < 3; ++d) edge = std::clamp(bodies[b].knots(d).degree() + 1, edge, longest_edge);
    for (const auto& [i, j, k] : bodies[b].node_places())
      order.push_back({{static_cast<std::int32_t>(b), k / edge, j / edge, i / edge}, first++});
  }
  std::sort(order.begin(), order.end());
  const auto most = static_cast<std::int64_t>(edge) * edge * edge * 3 / 2; // copies and Bernstein functions may be many
  NodeBlocks blocks;
  blocks.offsets.push_back(0);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto length = static_cast<std::int64_t>(blocks.nodes.size()) - blocks.offsets.back();
    if (k > 0 && (order[k].first != order[k - 1].first || length == most))
      blocks.offsets.push_back(static_cast<std::int64_t>(blocks.nodes.size()));
    blocks.nodes.push_back(order[k].second);
  }
  blocks.offsets.push_back(static_cast<std::int64_t>(blocks.nodes.size()));
  first = 0;
  for (const SplineLevel& body : bodies) {
    for (const auto& nodes : body.held_nodes()) {
      for (const std::int32_t node : nodes) blocks.nodes.push_back(first + node);
      blocks.offsets.push_back(static_cast<std::int64_t>(blocks.nodes.size()));
    }
    first += static_cast<std::int32_t>(body.num_nodes());
  }
  return blocks;
}

} // namespace

SplineHierarchy spline_hierarchy(const BodySystem& system, std::int64_t few,
                                 std::span<const std::vector<std::int64_t>> held) {
  std::vector<SplineLevel> levels;
  for (std::size_t b = 0; b < system.size(); ++b)
    levels.emplace_back(*system[b].space, held.empty() ? std::span<const std::int64_t>() : std::span(held[b]));
  SplineHierarchy all;
  for (std::int64_t nodes = system.num_nodes(); nodes > few;) {
    NodeBlocks blocks = node_blocks(levels);
    Transfer joined;
    joined.offsets.push_back(0);
    for (SplineLevel& level : levels) {
      Transfer one;
      level = level.coarsen(one);
      for (std::size_t k = 1; k < one.offsets.size(); ++k)
        joined.offsets.push_back(static_cast<std::int64_t>(joined.nodes.size()) + one.offsets[k]);
      for (const std::int32_t node : one.nodes)
        joined.nodes.push_back(static_cast<std::int32_t>(joined.num_coarse) + node);
      joined.weights.insert(joined.weights.end(), one.weights.begin(), one.weights.end());
      joined.num_coarse += one.num_coarse;
    }
    if (static_cast<double>(joined.num_coarse) > hardly_fewer * static_cast<double>(nodes)) break;
    nodes = joined.num_coarse;
    all.transfers.push_back(std::move(joined));
    all.blocks.push_back(std::move(blocks));
  }
  return all;
}

} // namespace iga::solve
