#include "preprocessor/connectivity/gap_ends.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/disjoint_sets.hpp"
#include "format/model/errors.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace iga::prep {

namespace {

/// Pieces by span and by link.
class Neighbourhood {
 public:
  Neighbourhood(const SplineGrid& grid, const std::vector<std::int64_t>& active, const PieceGraph& graph)
      : grid_(grid), active_(active), graph_(graph), active_of_(static_cast<std::size_t>(grid.num_spans()), -1),
        span_of_(static_cast<std::size_t>(graph.first.back())),
        first_(static_cast<std::size_t>(graph.first.back()) + 1, 0) {
    for (std::size_t a = 0; a < active.size(); ++a) {
      active_of_[static_cast<std::size_t>(active[a])] = static_cast<std::int32_t>(a);
      for (auto q = graph.first[a]; q < graph.first[a + 1]; ++q)
        span_of_[static_cast<std::size_t>(q)] = static_cast<std::int32_t>(a);
    }
    for (const PieceLink& link : graph.links) {
      ++first_[static_cast<std::size_t>(link.low) + 1];
      ++first_[static_cast<std::size_t>(link.high) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    linked_.resize(2 * graph.links.size());
    std::vector<std::int64_t> next(first_.begin(), first_.end() - 1);
    for (const PieceLink& link : graph.links) {
      linked_[static_cast<std::size_t>(next[static_cast<std::size_t>(link.low)]++)] = link.high;
      linked_[static_cast<std::size_t>(next[static_cast<std::size_t>(link.high)]++)] = link.low;
    }
  }

  std::size_t num_pieces() const { return span_of_.size(); }
  Index3 span(std::int32_t piece) const {
    return grid_.span_index(active_[static_cast<std::size_t>(span_of_[static_cast<std::size_t>(piece)])]);
  }
  std::span<const std::int32_t> linked(std::int32_t piece) const {
    const auto q = static_cast<std::size_t>(piece);
    return std::span(linked_).subspan(static_cast<std::size_t>(first_[q]),
                                      static_cast<std::size_t>(first_[q + 1] - first_[q]));
  }
  /// Pieces of the spans first … last, ascending in each span.
  void pieces_in(const Index3& first, const Index3& last, std::vector<std::int32_t>& pieces) const {
    pieces.clear();
    const Index3 n = grid_.spans();
    for (auto k = std::max<std::int64_t>(first[2], 0); k <= std::min(last[2], n[2] - 1); ++k)
      for (auto j = std::max<std::int64_t>(first[1], 0); j <= std::min(last[1], n[1] - 1); ++j)
        for (auto i = std::max<std::int64_t>(first[0], 0); i <= std::min(last[0], n[0] - 1); ++i) {
          const std::int32_t a = active_of_[static_cast<std::size_t>(grid_.span_number({i, j, k}))];
          if (a < 0) continue;
          for (auto q = graph_.first[static_cast<std::size_t>(a)]; q < graph_.first[static_cast<std::size_t>(a) + 1];
               ++q)
            pieces.push_back(static_cast<std::int32_t>(q));
        }
  }
  /// Number of the component of each of a few pieces under the links among them, from 0; returns how many there are.
  std::int32_t components(const std::vector<std::int32_t>& pieces, std::vector<std::int32_t>& component) const {
    component.assign(pieces.size(), -1);
    std::int32_t count = 0;
    std::vector<std::size_t> open;
    for (std::size_t seed = 0; seed < pieces.size(); ++seed) {
      if (component[seed] >= 0) continue;
      component[seed] = count;
      open.assign(1, seed);
      while (!open.empty()) {
        const std::size_t x = open.back();
        open.pop_back();
        for (const std::int32_t y : linked(pieces[x]))
          for (std::size_t z = 0; z < pieces.size(); ++z)
            if (pieces[z] == y && component[z] < 0) {
              component[z] = count;
              open.push_back(z);
            }
      }
      ++count;
    }
    return count;
  }
  /// Can one get from a to b by at most `steps` links?
  bool within_steps(std::int32_t a, std::int32_t b, std::int64_t steps) const {
    std::vector<std::int32_t> seen{a}, ring{a}, next;
    for (; steps >= 0 && !ring.empty(); --steps) {
      if (std::find(ring.begin(), ring.end(), b) != ring.end()) return true;
      next.clear();
      for (const std::int32_t x : ring)
        for (const std::int32_t y : linked(x))
          if (std::find(seen.begin(), seen.end(), y) == seen.end()) {
            seen.push_back(y);
            next.push_back(y);
          }
      ring.swap(next);
    }
    return false;
  }

 private:
  const SplineGrid& grid_;
  const std::vector<std::int64_t>& active_;
  const PieceGraph& graph_;
  std::vector<std::int32_t> active_of_; // (num_spans), -1 without material
  std::vector<std::int32_t> span_of_;   // (num_pieces); active span
  std::vector<std::int64_t> first_;     // (num_pieces + 1)
  std::vector<std::int32_t> linked_;
};

std::size_t local_size(const SplineGrid& grid) {
  const auto p = grid.degree();
  return static_cast<std::size_t>((p[0] + 1) * (p[1] + 1) * (p[2] + 1));
}

/// Two pieces about one vertex with a gap between them, whether it is more than one span deep, and the functions that
/// both see.
struct GluedPair {
  std::int32_t a, b;
  bool deep;
  std::vector<std::int32_t> shared;
  friend bool operator<(const GluedPair& x, const GluedPair& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); }
  friend bool operator==(const GluedPair& x, const GluedPair& y) { return x.a == y.a && x.b == y.b; }
};

/// Functions that two pieces both see, in ascending order.
std::vector<std::int32_t> shared_functions(const FunctionCopies& copies, std::size_t local, std::int32_t a,
                                           std::int32_t b) {
  const auto sorted = [&](std::int32_t piece) {
    const auto first = copies.of_piece.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(piece) * local);
    std::vector<std::int32_t> functions(first, first + static_cast<std::ptrdiff_t>(local));
    std::sort(functions.begin(), functions.end());
    return functions;
  };
  const auto x = sorted(a), y = sorted(b);
  std::vector<std::int32_t> both;
  std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
  return both;
}

std::vector<GluedPair> find_glued_pairs(const SplineGrid& grid, const Neighbourhood& near,
                                        const FunctionCopies& copies) {
  const Index3 n = grid.spans();
  const std::size_t local = local_size(grid);
  tbb::enumerable_thread_specific<std::vector<GluedPair>> found;
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, (n[1] + 1) * (n[2] + 1)), [&](const auto& rows) {
    std::vector<GluedPair>& pairs = found.local();
    std::vector<std::int32_t> pieces, component;
    for (auto row = rows.begin(); row != rows.end(); ++row)
      for (std::int64_t i = 0; i <= n[0]; ++i) {
        const std::int64_t j = row % (n[1] + 1), k = row / (n[1] + 1);
        near.pieces_in({i - 1, j - 1, k - 1}, {i, j, k}, pieces);
        if (pieces.size() < 2 || near.components(pieces, component) < 2) continue;
        for (std::size_t x = 0; x < pieces.size(); ++x)
          for (std::size_t y = x + 1; y < pieces.size(); ++y) {
            if (component[x] == component[y]) continue;
            const std::int32_t a = std::min(pieces[x], pieces[y]), b = std::max(pieces[x], pieces[y]);
            std::vector<std::int32_t> shared = shared_functions(copies, local, a, b);
            if (shared.empty()) continue;
            const Index3 s = near.span(a), t = near.span(b);
            std::int64_t across = 0;
            for (std::size_t d = 0; d < 3; ++d) across += std::abs(s[d] - t[d]);
            pairs.push_back({a, b, !near.within_steps(a, b, across + 2), std::move(shared)});
          }
      }
  });
  std::vector<GluedPair> all;
  for (const auto& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

} // namespace

std::vector<std::uint8_t> find_gap_ends(const SplineGrid& grid, const std::vector<std::int64_t>& active,
                                        const PieceGraph& graph, const FunctionCopies& copies) {
  const auto p = grid.degree();
  std::vector<std::uint8_t> own(static_cast<std::size_t>(graph.first.back()), 0);
  if (std::max({p[0], p[1], p[2]}) < 2) return own; // B-splines of degree 1 are Bernstein functions
  const Neighbourhood near(grid, active, graph);
  const std::vector<GluedPair> pairs = find_glued_pairs(grid, near, copies);
  const std::size_t local = local_size(grid);
  std::vector<std::int32_t> glued;
  for (const GluedPair& pair : pairs)
    if (pair.deep) glued.insert(glued.end(), pair.shared.begin(), pair.shared.end());
  std::sort(glued.begin(), glued.end());
  glued.erase(std::unique(glued.begin(), glued.end()), glued.end());
  if (glued.empty()) return own;
  const auto is_glued = [&](std::int32_t f) { return std::binary_search(glued.begin(), glued.end(), f); };
  std::vector<std::int32_t> beside;
  for (const GluedPair& pair : pairs) {
    if (std::none_of(pair.shared.begin(), pair.shared.end(), is_glued)) continue;
    for (const std::int32_t piece : {pair.a, pair.b}) {
      if (!own[static_cast<std::size_t>(piece)]) beside.push_back(piece);
      own[static_cast<std::size_t>(piece)] = 1;
    }
  }
  for (const std::int32_t piece : beside)
    for (const std::int32_t q : near.linked(piece)) {
      const auto first = copies.of_piece.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(q) * local);
      if (std::any_of(first, first + static_cast<std::ptrdiff_t>(local), is_glued))
        own[static_cast<std::size_t>(q)] = 1;
    }
  return own;
}

namespace {

using Matrix = std::vector<double>; // (p + 1)², row-major

/// Bernstein coefficients on a span from those of its B-splines, and back.
struct Extraction {
  Matrix to_bernstein, to_splines;
  Extraction(const KnotVector& knots, std::int64_t span) {
    const auto p = static_cast<std::size_t>(knots.degree());
    to_bernstein.resize((p + 1) * (p + 1));
    to_splines.resize((p + 1) * (p + 1));
    for (std::size_t k = 0; k <= p; ++k) {
      bernstein_weights(knots, span, static_cast<int>(k), std::span(to_bernstein).subspan(k * (p + 1), p + 1));
      const auto inner = knots.values().subspan(static_cast<std::size_t>(span) + k + 1, p);
      bernstein_blossom_weights(knots.lower(span), knots.upper(span), inner,
                                std::span(to_splines).subspan(k * (p + 1), p + 1));
    }
  }
};

/// Smallest entry of a row of factors that is not rounding.
constexpr double no_factor = 1e-13;

class Separator {
 public:
  Separator(const SplineGrid& grid, const std::vector<std::int64_t>& active, const PieceGraph& graph,
            const std::vector<std::uint8_t>& own, FunctionCopies& copies)
      : grid_(grid), near_(grid, active, graph), own_(own), copies_(copies), local_(local_size(grid)) {
    for (std::size_t d = 0; d < 3; ++d) width_[d] = static_cast<std::size_t>(grid.degree()[d]) + 1;
  }

  GapEndUnknowns run() {
    take_smooth();
    for (std::size_t q = 0; q < own_.size(); ++q)
      if (own_[q]) make_bernstein(static_cast<std::int32_t>(q));
    number_bernstein();
    for (std::size_t q = 0; q < own_.size(); ++q)
      if (own_[q]) rows_.push_back(make_rows(static_cast<std::int32_t>(q)));
    measure();
    renumber();
    return std::move(out_);
  }

 private:
  using Row = std::map<std::int32_t, double>; // unknown, factor

  /// A Bernstein function's copy: an unknown, or one that follows the smooth functions of a piece.
  struct Bernstein {
    std::int64_t lattice;
    std::int32_t unknown = -1, follows = -1;
  };

  Unknowns& rows() { return out_.rows; }
  std::int64_t lattice_extent(std::size_t d) const {
    return grid_.spans()[d] * static_cast<std::int64_t>(width_[d] - 1) + 1;
  }
  std::array<std::size_t, 3> of_entry(std::size_t e) const {
    return {e % width_[0], e / width_[0] % width_[1], e / (width_[0] * width_[1])};
  }
  std::int64_t lattice_number(const Index3& i) const {
    return i[0] + lattice_extent(0) * (i[1] + lattice_extent(1) * i[2]);
  }
  Index3 lattice_index(std::int64_t number) const {
    const std::int64_t n_u = lattice_extent(0), n_v = lattice_extent(1);
    return {number % n_u, number / n_u % n_v, number / (n_u * n_v)};
  }
  std::int64_t lattice_of(const Index3& span, std::size_t entry) const {
    const auto k = of_entry(entry);
    Index3 index;
    for (std::size_t d = 0; d < 3; ++d)
      index[d] = span[d] * static_cast<std::int64_t>(width_[d] - 1) + static_cast<std::int64_t>(k[d]);
    return lattice_number(index);
  }
  std::int32_t function(std::int32_t piece, std::size_t entry) const {
    return copies_.of_piece[static_cast<std::size_t>(piece) * local_ + entry];
  }
  const Extraction& extraction(std::size_t d, std::int64_t span) {
    const auto found = extractions_[d].find(span);
    if (found != extractions_[d].end()) return found->second;
    return extractions_[d].emplace(span, Extraction(grid_.knots(static_cast<int>(d)), span)).first->second;
  }

  // Unknowns of the functions that pieces without functions of their own see.
  void take_smooth() {
    unknown_of_.assign(copies_.number.size(), -1);
    for (std::size_t q = 0; q < own_.size(); ++q)
      for (std::size_t e = 0; !own_[q] && e < local_; ++e)
        unknown_of_[static_cast<std::size_t>(function(static_cast<std::int32_t>(q), e))] = 0;
    for (std::size_t f = 0; f < unknown_of_.size(); ++f)
      if (unknown_of_[f] == 0) {
        unknown_of_[f] = static_cast<std::int32_t>(smooth_.size());
        smooth_.push_back(static_cast<std::int32_t>(f));
      }
  }

  // The copies of all Bernstein functions that a piece sees, where they are not there yet.
  void make_bernstein(std::int32_t piece) {
    const Index3 span = near_.span(piece);
    std::vector<std::int32_t> star, component, copy;
    for (std::size_t e = 0; e < local_; ++e) {
      const std::int64_t lattice = lattice_of(span, e);
      if (bernstein_of_.count({lattice, piece})) continue;
      const Index3 index = lattice_index(lattice);
      Index3 first, last;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto p = static_cast<std::int64_t>(width_[d] - 1);
        first[d] = index[d] % p == 0 ? index[d] / p - 1 : index[d] / p;
        last[d] = index[d] / p;
      }
      near_.pieces_in(first, last, star);
      const std::int32_t count = near_.components(star, component);
      copy.assign(static_cast<std::size_t>(count), -1);
      for (std::size_t x = 0; x < star.size(); ++x)
        if (own_[static_cast<std::size_t>(star[x])] && copy[static_cast<std::size_t>(component[x])] < 0) {
          copy[static_cast<std::size_t>(component[x])] = static_cast<std::int32_t>(bernstein_.size());
          bernstein_.push_back({lattice});
        }
      for (std::size_t x = 0; x < star.size(); ++x) {
        const std::int32_t b = copy[static_cast<std::size_t>(component[x])];
        if (b < 0) continue;
        if (own_[static_cast<std::size_t>(star[x])])
          bernstein_of_[{lattice, star[x]}] = b;
        else if (auto& follows = bernstein_[static_cast<std::size_t>(b)].follows; follows < 0)
          follows = star[x];
      }
    }
  }

  // Unknowns of those that follow nothing, in the order of their lattice.
  void number_bernstein() {
    std::vector<std::size_t> order;
    for (std::size_t b = 0; b < bernstein_.size(); ++b)
      if (bernstein_[b].follows < 0) order.push_back(b);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t x, std::size_t y) { return bernstein_[x].lattice < bernstein_[y].lattice; });
    if (smooth_.size() + order.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
      throw InputError("the model has more unknowns than 2^31; choose larger spans");
    for (std::size_t k = 0; k < order.size(); ++k)
      bernstein_[order[k]].unknown = static_cast<std::int32_t>(smooth_.size() + k);
    rows().function.assign(smooth_.begin(), smooth_.end());
    rows().function.resize(smooth_.size() + order.size(), -1);
    for (const std::int32_t f : smooth_) {
      const Index3 i = grid_.function_index(copies_.number[static_cast<std::size_t>(f)]);
      for (std::size_t d = 0; d < 3; ++d) rows().parameters.push_back(grid_.knots(static_cast<int>(d)).greville(i[d]));
    }
    for (const std::size_t b : order) {
      const Index3 index = lattice_index(bernstein_[b].lattice);
      for (std::size_t d = 0; d < 3; ++d) {
        const auto p = static_cast<std::int64_t>(width_[d] - 1);
        const std::int64_t span = std::min(index[d] / p, grid_.spans()[d] - 1);
        const KnotVector& knots = grid_.knots(static_cast<int>(d));
        const double t = static_cast<double>(index[d] - span * p) / static_cast<double>(p);
        rows().parameters.push_back((1 - t) * knots.lower(span) + t * knots.upper(span));
      }
    }
  }

  // A Bernstein function's coefficient from the unknowns.
  Row bernstein_row(const Bernstein& b) {
    if (b.follows < 0) return {{b.unknown, 1.0}};
    const Index3 span = near_.span(b.follows);
    const Index3 index = lattice_index(b.lattice);
    const double* factors[3];
    for (std::size_t d = 0; d < 3; ++d) {
      const auto k = static_cast<std::size_t>(index[d] - span[d] * static_cast<std::int64_t>(width_[d] - 1));
      factors[d] = extraction(d, span[d]).to_bernstein.data() + k * width_[d];
    }
    Row row;
    for (std::size_t e = 0; e < local_; ++e) {
      const auto k = of_entry(e);
      const double factor = factors[0][k[0]] * factors[1][k[1]] * factors[2][k[2]];
      if (std::abs(factor) > no_factor) row[unknown_of_[static_cast<std::size_t>(function(b.follows, e))]] += factor;
    }
    return row;
  }

  // The coefficients of a piece's own B-splines from the unknowns.
  std::vector<Row> make_rows(std::int32_t piece) {
    const Index3 span = near_.span(piece);
    std::vector<Row> bernstein(local_), rows(local_);
    for (std::size_t e = 0; e < local_; ++e)
      bernstein[e] =
          bernstein_row(bernstein_[static_cast<std::size_t>(bernstein_of_.at({lattice_of(span, e), piece}))]);
    const Matrix* back[3];
    for (std::size_t d = 0; d < 3; ++d) back[d] = &extraction(d, span[d]).to_splines;
    for (std::size_t f = 0; f < local_; ++f) {
      const auto i = of_entry(f);
      for (std::size_t e = 0; e < local_; ++e) {
        const auto k = of_entry(e);
        double factor = 1;
        for (std::size_t d = 0; d < 3; ++d) factor *= (*back[d])[i[d] * width_[d] + k[d]];
        if (std::abs(factor) <= no_factor) continue;
        for (const auto& [unknown, weight] : bernstein[e]) rows[f][unknown] += factor * weight;
      }
      std::erase_if(rows[f], [](const auto& term) { return std::abs(term.second) <= no_factor; });
    }
    return rows;
  }

  // ∫ of each unknown's function over all spans of its support: of a B-spline over those where it is one, and what
  // follows from it in the chosen pieces. Pieces of one span count once, by the most that one of them sees.
  void measure() {
    out_.full.assign(rows().function.size(), 0);
    for (std::size_t u = 0; u < smooth_.size(); ++u)
      out_.full[u] = grid_.integral(grid_.function_index(copies_.number[static_cast<std::size_t>(smooth_[u])]));
    const Point3 h = grid_.span_size();
    for (const Bernstein& b : bernstein_) {
      if (b.unknown < 0) continue;
      const Index3 index = lattice_index(b.lattice);
      double product = 1;
      for (std::size_t d = 0; d < 3; ++d) {
        const bool shared = index[d] % static_cast<std::int64_t>(width_[d] - 1) == 0 && index[d] != 0 &&
                            index[d] != lattice_extent(d) - 1;
        product *= (shared ? 2 : 1) * h[d] / static_cast<double>(width_[d]);
      }
      out_.full[static_cast<std::size_t>(b.unknown)] = product;
    }
    std::map<std::pair<std::int64_t, std::int32_t>, std::pair<double, double>> by_span; // span, unknown: less, more
    std::size_t place = 0;
    for (std::size_t q = 0; q < own_.size(); ++q) {
      if (!own_[q]) continue;
      const auto& own_rows = rows_[place++];
      const Index3 span = near_.span(static_cast<std::int32_t>(q));
      const std::int64_t number = grid_.span_number(span);
      std::map<std::int32_t, double> more;
      std::array<std::array<double, max_degree + 1>, 3> integrals;
      for (std::size_t d = 0; d < 3; ++d)
        integrate_basis(grid_.knots(static_cast<int>(d)), span[d], std::span(integrals[d]).first(width_[d]));
      for (std::size_t e = 0; e < local_; ++e) {
        const auto k = of_entry(e);
        const double whole = integrals[0][k[0]] * integrals[1][k[1]] * integrals[2][k[2]];
        const std::int32_t smooth = unknown_of_[static_cast<std::size_t>(function(static_cast<std::int32_t>(q), e))];
        if (smooth >= 0 && !seen_by_others(span, smooth_[static_cast<std::size_t>(smooth)]))
          by_span[{number, smooth}].first = whole;
        for (const auto& [unknown, factor] : own_rows[e])
          if (static_cast<std::size_t>(unknown) < smooth_.size()) more[unknown] += factor * whole;
      }
      for (const auto& [unknown, value] : more) {
        double& most = by_span[{number, unknown}].second;
        most = std::max(most, value);
      }
    }
    for (const auto& [key, value] : by_span)
      out_.full[static_cast<std::size_t>(key.second)] += value.second - value.first;
  }

  // Does a piece of a span that has no functions of its own see a function?
  bool seen_by_others(const Index3& span, std::int32_t f) const {
    std::vector<std::int32_t> pieces;
    near_.pieces_in(span, span, pieces);
    for (const std::int32_t q : pieces)
      for (std::size_t e = 0; !own_[static_cast<std::size_t>(q)] && e < local_; ++e)
        if (function(q, e) == f) return true;
    return false;
  }

  // Functions anew: smooth ones that are still seen and the pieces' own, by number, smooth ones first.
  void renumber() {
    struct Entry {
      std::int64_t number;
      std::int32_t smooth;  // old function, or -1
      std::size_t place, e; // of an own one: chosen piece and entry
    };
    std::vector<Entry> entries;
    for (const std::int32_t f : smooth_) entries.push_back({copies_.number[static_cast<std::size_t>(f)], f, 0, 0});
    std::vector<std::size_t> chosen;
    for (std::size_t q = 0; q < own_.size(); ++q)
      if (own_[q]) {
        for (std::size_t e = 0; e < local_; ++e)
          entries.push_back({copies_.number[static_cast<std::size_t>(function(static_cast<std::int32_t>(q), e))], -1,
                             chosen.size(), e});
        chosen.push_back(q);
      }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& x, const Entry& y) { return x.number < y.number; });
    std::vector<std::int32_t> new_smooth(copies_.number.size(), -1);
    std::vector<std::int32_t> new_own(chosen.size() * local_);
    std::vector<std::int64_t> number;
    rows().offsets.push_back(0);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const Entry& entry = entries[k];
      number.push_back(entry.number);
      if (entry.smooth >= 0) {
        new_smooth[static_cast<std::size_t>(entry.smooth)] = static_cast<std::int32_t>(k);
        rows().terms.push_back(unknown_of_[static_cast<std::size_t>(entry.smooth)]);
        rows().weights.push_back(1);
      } else {
        new_own[entry.place * local_ + entry.e] = static_cast<std::int32_t>(k);
        for (const auto& [unknown, factor] : rows_[entry.place][entry.e]) {
          rows().terms.push_back(unknown);
          rows().weights.push_back(factor);
        }
      }
      rows().offsets.push_back(static_cast<std::int64_t>(rows().terms.size()));
    }
    for (std::size_t u = 0; u < smooth_.size(); ++u)
      rows().function[u] = new_smooth[static_cast<std::size_t>(smooth_[u])];
    for (std::size_t q = 0; q < own_.size(); ++q)
      for (std::size_t e = 0; !own_[q] && e < local_; ++e) {
        auto& f = copies_.of_piece[q * local_ + e];
        f = new_smooth[static_cast<std::size_t>(f)];
      }
    for (std::size_t c = 0; c < chosen.size(); ++c)
      std::copy_n(new_own.begin() + static_cast<std::ptrdiff_t>(c * local_), local_,
                  copies_.of_piece.begin() + static_cast<std::ptrdiff_t>(chosen[c] * local_));
    copies_.number = std::move(number);
  }

  const SplineGrid& grid_;
  const Neighbourhood near_;
  const std::vector<std::uint8_t>& own_;
  FunctionCopies& copies_;
  std::size_t local_;
  std::array<std::size_t, 3> width_{};
  std::array<std::map<std::int64_t, Extraction>, 3> extractions_;
  std::vector<std::int32_t> unknown_of_, smooth_; // unknown of each old function, or -1; functions of smooth unknowns
  std::vector<Bernstein> bernstein_;
  std::map<std::pair<std::int64_t, std::int32_t>, std::int32_t> bernstein_of_; // lattice, piece: entry of bernstein_
  std::vector<std::vector<Row>> rows_;                                         // of each chosen piece
  GapEndUnknowns out_;
};

} // namespace

GapEndUnknowns separate_gap_ends(const SplineGrid& grid, const std::vector<std::int64_t>& active,
                                 const PieceGraph& graph, const std::vector<std::uint8_t>& own,
                                 FunctionCopies& copies) {
  if (std::find(own.begin(), own.end(), 1) == own.end()) return {};
  return Separator(grid, active, graph, own, copies).run();
}

} // namespace iga::prep
