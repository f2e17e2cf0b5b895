// Nitsche's parameter from local eigenproblems. For every span c that a support touches,
//   Λ_c = max over u of ∫_Γc |t(u)|² / Σ_{e in patch(c)} E_e(u) / m_e,    E_e = ∫_e ε : C : ε,
// where the patch is the span itself or the span and neighbours, and m_e counts the patches that share span e. Summed
// over all spans of all supports, ∫ |t|² / Λ_c is then at most the energy of the whole part, so that β_c = 2 Λ_c makes
// K - B - Bᵀ + β M_Γ positive definite on any cut (Griebel & Schweitzer 2003; Embar, Dolbow, Harari 2010).
#include "solver/base/dense_algebra.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

namespace iga::solve {

namespace {

// Added to the energy scaled to a unit diagonal: rigid motions, which have neither energy nor traction, drop out (their
// traction is rounding, 1e-15), while a motion with traction and no energy shows as a very large eigenvalue.
constexpr double kernel_shift = 1e-12;

// Eigenvalues in units of p² max(C) / h; a full span gives 1 … 5. Above `healthy` a second span is taken, above
// `tolerable` (a large β costs digits, not accuracy) all neighbours, and `unbounded` means traction without energy.
constexpr double healthy = 10, tolerable = 30, unbounded = 1e6;

constexpr int power_steps = 20;

/// One span of one support.
struct Piece {
  PreparedSupport* prepared = nullptr;
  std::size_t s = 0;
  std::vector<std::int64_t> patch; ///< active spans, ascending
  double eigenvalue = 0;           ///< with all m_e = 1
};

class LocalProblem {
 public:
  LocalProblem(const SolutionSpace& space, const ElasticMaterial& material) : space_(space), material_(material) {}

  /// @param share  1 / m_e for each span of the patch
  double largest_eigenvalue(const Piece& piece, const std::vector<double>& share) const {
    const std::vector<std::int32_t> nodes = nodes_of(piece.patch);
    const auto n = 3 * static_cast<Eigen::Index>(nodes.size());
    Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(n, n), block;
    SpanShapes shapes;
    for (std::size_t k = 0; k < piece.patch.size(); ++k) {
      span_stiffness(space_, piece.patch[k], material_, shapes, block);
      scatter(positions(nodes, piece.patch[k]), share[k], block, energy);
    }
    const PointBatch batch = gather(space_.model(), piece.prepared->region, piece.s);
    const SupportRows rows = make_rows(space_, material_, *piece.prepared, batch, RowParts::Traction, shapes);
    const auto place = positions(nodes, batch.cell);
    Eigen::MatrixXd traction = Eigen::MatrixXd::Zero(n, rows.weight.size()); // transposed, √weight included
    for (std::size_t r = 0; r < place.size(); ++r)
      traction.middleRows(3 * place[r], 3) = rows.traction.middleCols(3 * static_cast<Eigen::Index>(r), 3).transpose() *
                                             rows.weight.cwiseSqrt().asDiagonal();
    return generalised(energy, traction);
  }

 private:
  std::vector<std::int32_t> nodes_of(const std::vector<std::int64_t>& patch) const {
    std::vector<std::int32_t> nodes;
    for (const std::int64_t a : patch) nodes.insert(nodes.end(), space_.nodes(a).begin(), space_.nodes(a).end());
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }
  std::vector<Eigen::Index> positions(const std::vector<std::int32_t>& nodes, std::int64_t a) const {
    std::vector<Eigen::Index> place;
    for (const std::int32_t node : space_.nodes(a))
      place.push_back(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
    return place;
  }
  // Lower triangles; positions ascend with the nodes.
  static void scatter(const std::vector<Eigen::Index>& place, double factor, const Eigen::MatrixXd& block,
                      Eigen::MatrixXd& sum) {
    for (std::size_t c = 0; c < place.size(); ++c)
      for (std::size_t r = c; r < place.size(); ++r)
        sum.block<3, 3>(3 * place[r], 3 * place[c]) +=
            factor * block.block<3, 3>(3 * static_cast<Eigen::Index>(r), 3 * static_cast<Eigen::Index>(c));
  }
  // Largest eigenvalue of G Gᵀ by power iteration: a few per cent too small at most, where β = 2 Λ leaves a factor of
  // two.
  static double largest_square(const Eigen::MatrixXd& G) {
    Eigen::Index widest = 0;
    G.colwise().squaredNorm().maxCoeff(&widest);
    Eigen::VectorXd x = G.transpose() * G.col(widest);
    double eigenvalue = 0;
    for (int step = 0; step < power_steps && x.norm() > 0; ++step) {
      x.normalize();
      x = (G.transpose() * (G * x)).eval();
      eigenvalue = x.norm();
    }
    return eigenvalue;
  }
  // Largest eigenvalue of traction tractionᵀ x = Λ energy x.
  static double generalised(Eigen::MatrixXd& energy, Eigen::MatrixXd& traction) {
    const double largest = energy.diagonal().maxCoeff();
    if (!(largest > 0)) return std::numeric_limits<double>::max(); // no quadrature point in the whole patch
    Eigen::VectorXd scale = energy.diagonal();
    for (double& s : scale) s = 1 / std::sqrt(s > 0 ? s : largest);
    energy = (scale.asDiagonal() * energy * scale.asDiagonal()).eval();
    energy.diagonal().array() += kernel_shift;
    traction = (scale.asDiagonal() * traction).eval();
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(energy);
    if (factor.info() != Eigen::Success) return std::numeric_limits<double>::max();
    factor.matrixL().solveInPlace(traction);
    return largest_square(traction);
  }

  const SolutionSpace& space_;
  const ElasticMaterial& material_;
};

/// Patches around a span, from small to large.
class Patches {
 public:
  explicit Patches(const TrimmedModel& model) : model_(model) {}

  std::vector<std::int64_t> with_best_face_neighbour(std::int64_t a) const {
    std::int64_t best = -1;
    for (std::size_t d = 0; d < 3; ++d)
      for (const int step : {-1, 1}) {
        Index3 ijk = index(a);
        ijk[d] += step;
        const std::int64_t b = cell_near(a, ijk);
        if (b >= 0 && (best < 0 || fraction(b) > fraction(best))) best = b;
      }
    std::vector<std::int64_t> patch{a};
    if (best >= 0) patch.push_back(best);
    std::sort(patch.begin(), patch.end());
    return patch;
  }
  /// The fullest of the eight blocks of 2 × 2 × 2 spans around the span.
  std::vector<std::int64_t> best_block_of_eight(std::int64_t a) const {
    std::vector<std::int64_t> best;
    double most = -1;
    for (int octant = 0; octant < 8; ++octant) {
      std::vector<std::int64_t> patch;
      double filled = 0;
      for (int corner = 0; corner < 8; ++corner) {
        Index3 ijk = index(a);
        for (std::size_t d = 0; d < 3; ++d) ijk[d] += ((corner >> d) & 1) * (((octant >> d) & 1) ? 1 : -1);
        const std::int64_t b = cell_near(a, ijk);
        if (b < 0) continue;
        patch.push_back(b);
        filled += fraction(b);
      }
      if (filled <= most) continue;
      most = filled;
      best = std::move(patch);
    }
    std::sort(best.begin(), best.end());
    return best;
  }
  std::vector<std::int64_t> within(std::int64_t a, std::int64_t reach) const {
    std::vector<std::int64_t> patch;
    const Index3 centre = index(a);
    for (std::int64_t k = -reach; k <= reach; ++k)
      for (std::int64_t j = -reach; j <= reach; ++j)
        for (std::int64_t i = -reach; i <= reach; ++i)
          if (const std::int64_t b = cell_near(a, {centre[0] + i, centre[1] + j, centre[2] + k}); b >= 0)
            patch.push_back(b);
    return patch;
  }

 private:
  Index3 index(std::int64_t a) const { return model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(a)]); }
  double fraction(std::int64_t a) const { return model_.cells.volume_fraction[static_cast<std::size_t>(a)]; }
  // Cell of a span that shares most functions with cell a, -1 where the span holds none.
  std::int64_t cell_near(std::int64_t a, const Index3& ijk) const {
    const Index3 count = model_.grid.spans();
    for (std::size_t d = 0; d < 3; ++d)
      if (ijk[d] < 0 || ijk[d] >= count[d]) return -1;
    const std::int64_t number = model_.grid.span_number(ijk);
    if (number == model_.cells.span[static_cast<std::size_t>(a)]) return a;
    const auto [first, last] = model_.cells_of(number);
    if (first == last) return -1;
    const auto own = model_.functions_of(static_cast<std::size_t>(a));
    std::size_t best = first;
    std::ptrdiff_t most = -1;
    for (std::size_t c = first; c < last && last - first > 1; ++c) {
      const auto shared = std::count_if(own.begin(), own.end(), [&](std::int32_t f) {
        const auto other = model_.functions_of(c);
        return std::binary_search(other.begin(), other.end(), f);
      });
      if (shared <= most) continue;
      most = shared;
      best = c;
    }
    return static_cast<std::int64_t>(best);
  }
  const TrimmedModel& model_;
};

// The smallest patch whose eigenvalue will do, else the one with the smallest eigenvalue; large patches cost much.
void choose_patch(const LocalProblem& local, const Patches& patches, double unit, std::int64_t reach, Piece& piece) {
  const std::int64_t a = piece.prepared->region.cells[piece.s];
  const auto attempt = [&](std::vector<std::int64_t> patch) {
    Piece candidate{piece.prepared, piece.s, std::move(patch), 0};
    candidate.eigenvalue = local.largest_eigenvalue(candidate, std::vector<double>(candidate.patch.size(), 1.0));
    if (piece.patch.empty() || candidate.eigenvalue < piece.eigenvalue) piece = std::move(candidate);
  };
  attempt({a});
  if (piece.eigenvalue > healthy * unit) attempt(patches.with_best_face_neighbour(a));
  if (piece.eigenvalue > tolerable * unit) attempt(patches.best_block_of_eight(a));
  if (piece.eigenvalue > tolerable * unit) attempt(patches.within(a, 1));
  for (std::int64_t r = 2; r <= reach && piece.eigenvalue > unbounded * unit; ++r) attempt(patches.within(a, r));
}

} // namespace

void nitsche_parameters(const SolutionSpace& space, const ElasticMaterial& material,
                        std::span<PreparedSupport* const> prepared) {
  const SplineGrid& grid = space.model().grid;
  const auto degrees = grid.degree();
  const int p = *std::max_element(degrees.begin(), degrees.end());
  const Point3 h = grid.span_size();
  const double unit = p * p * symmetric_eigenvalues(material.C).maxCoeff() / *std::min_element(h.begin(), h.end());
  std::vector<Piece> pieces;
  for (PreparedSupport* const support : prepared) {
    support->beta.assign(support->region.cells.size(), 0);
    for (std::size_t s = 0; s < support->region.cells.size(); ++s) pieces.push_back({support, s, {}, 0});
  }
  const LocalProblem local(space, material);
  const Patches patches(space.model());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
    // A function that reaches the span has its whole support within p spans of it.
    choose_patch(local, patches, unit, p, pieces[k]);
  });
  std::map<std::int64_t, int> sharing;
  for (const Piece& piece : pieces)
    for (const std::int64_t e : piece.patch) ++sharing[e];
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t k) {
    const Piece& piece = pieces[k];
    std::vector<double> share;
    for (const std::int64_t e : piece.patch) share.push_back(1.0 / sharing.at(e));
    const bool uniform = std::all_of(share.begin(), share.end(), [&](double m) { return m == share[0]; });
    piece.prepared->beta[piece.s] =
        2 * (uniform ? piece.eigenvalue / share[0] : local.largest_eigenvalue(piece, share));
  });
}

} // namespace iga::solve
