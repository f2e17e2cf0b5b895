// Lagrange multipliers λ = S(x) n with S from trilinear functions on a coarse box fitted to the region along its
// principal axes: constant stresses are in the space on any surface, so that linear fields are exact, and boxes of at
// least three spans keep the multipliers coarser than the traces of the displacements (inf-sup condition).
#include "format/model/vec3.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/supports/support_rows.hpp"

#include <algorithm>
#include <numeric>

namespace iga::solve {

namespace {

// Multipliers per direction and support: the rank-revealing factorisation is dense.
constexpr Eigen::Index most_rows = 2000;

// A row counts when this share of its squared norm lies outside what the rows before it span.
constexpr double least_share = 1e-2;

// Directions of the normals with less than this share of ∫ n nᵀ are noise of the triangles.
constexpr double least_normal = 1e-10;

// A region this much thinner than long is flat.
constexpr double flat = 1e-6;

/// Trilinear functions on a box of coarse cells; a flat direction has a single constant function.
class CoarseFunctions {
 public:
  CoarseFunctions(const std::vector<PointBatch>& batches, double least_cell) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    double area = 0;
    const auto each = [&](auto&& use) {
      for (const PointBatch& b : batches)
        for (std::size_t q = 0; q < b.size(); ++q) use(vector(b.positions[q]), b.weights[q]);
    };
    each([&](const Eigen::Vector3d& x, double w) { sum += w * x, area += w; });
    centre_ = sum / area;
    each([&](const Eigen::Vector3d& x, double w) { second += w * (x - centre_) * (x - centre_).transpose(); });
    axes_ = symmetric_eigen_3(second).vectors;
    Eigen::Vector3d upper = Eigen::Vector3d::Constant(-1e300);
    lower_ = -upper;
    each([&](const Eigen::Vector3d& x, double) {
      const Eigen::Vector3d y = axes_.transpose() * (x - centre_);
      lower_ = lower_.cwiseMin(y);
      upper = upper.cwiseMax(y);
    });
    extent_ = upper - lower_;
    for (double cell = least_cell;; cell *= 1.25) {
      for (int d = 0; d < 3; ++d) {
        const double whole = std::floor(extent_[d] / cell);
        const bool thin = d == 0 && extent_[d] < 0.5 * cell; // axis 0 is the one of least spread
        cells_[d] = extent_[d] <= flat * extent_.maxCoeff() || thin ? 0 : std::max(1, static_cast<int>(whole));
      }
      if (3 * count() <= most_rows) break;
    }
  }

  Eigen::Index count() const { return (cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1); }

  /// Calls use(function, value) for the functions that do not vanish at x.
  template <class Use> void at(const Point3& x, Use&& use) const {
    const Eigen::Vector3d y = axes_.transpose() * (vector(x) - centre_) - lower_;
    int first[3];
    double share[3];
    for (int d = 0; d < 3; ++d) {
      if (cells_[d] == 0) {
        first[d] = 0, share[d] = 0;
        continue;
      }
      const double t = std::clamp(y[d] / extent_[d], 0.0, 1.0) * cells_[d];
      first[d] = std::min(static_cast<int>(t), cells_[d] - 1);
      share[d] = t - first[d];
    }
    for (int corner = 0; corner < 8; ++corner) {
      double value = 1;
      Eigen::Index number = 0;
      for (int d = 2; d >= 0; --d) {
        const int up = (corner >> d) & 1;
        value *= up ? share[d] : 1 - share[d];
        number = number * (cells_[d] + 1) + std::min(first[d] + up, cells_[d]);
      }
      if (value > 0) use(number, value);
    }
  }

 private:
  static Eigen::Vector3d vector(const Point3& x) { return {x[0], x[1], x[2]}; }
  Eigen::Vector3d centre_, lower_, extent_;
  Eigen::Matrix3d axes_;
  std::array<int, 3> cells_{};
};

/// Rows ∫ m N dA for the multipliers m of one direction, over columns (nodes, or unknowns where the direction turns
/// with the surface), with ∫ m u_D.
struct Rows {
  RowMatrix matrix;
  Eigen::MatrixXd values;  ///< (rows × right-hand sides)
  Eigen::Index forced = 0; ///< the first rows stand for constant stresses: they are kept
};

// Orthogonal directions that the normals take, weighted by f: columns, at least one.
Eigen::MatrixXd normal_directions(const Eigen::Matrix3d& spread) {
  const SymmetricEigen3 eigen = symmetric_eigen_3(spread);
  Eigen::Index first = 0;
  while (first < 2 && eigen.values[first] <= least_normal * spread.trace()) ++first;
  return eigen.vectors.rightCols(3 - first);
}

/// The multipliers' scalar factors at a point: first those of constant stresses, then function by function.
class Multipliers {
 public:
  Multipliers(const CoarseFunctions& functions, const std::vector<PointBatch>& batches, bool along_normal)
      : functions_(functions), along_normal_(along_normal) {
    const auto count = static_cast<std::size_t>(functions.count());
    std::vector<Eigen::Matrix3d> spread(count, Eigen::Matrix3d::Zero());
    Eigen::Matrix3d whole = Eigen::Matrix3d::Zero();
    for (const PointBatch& b : batches)
      for (std::size_t q = 0; q < b.size(); ++q) {
        const Eigen::Matrix3d nn = b.weights[q] * as_vector(b.normals[q]) * as_vector(b.normals[q]).transpose();
        whole += nn;
        functions.at(b.positions[q],
                     [&](Eigen::Index k, double f) { spread[static_cast<std::size_t>(k)] += f * f * nn; });
      }
    constant_ = normal_directions(whole);
    first_.push_back(forced());
    for (const Eigen::Matrix3d& m : spread) {
      directions_.push_back(m.trace() > 0 ? normal_directions(m) : Eigen::MatrixXd(3, 0));
      first_.push_back(first_.back() + (along_normal ? (m.trace() > 0) : directions_.back().cols()));
    }
  }
  Eigen::Index forced() const { return along_normal_ ? 1 : constant_.cols(); }
  Eigen::Index count() const { return first_.back(); }

  template <class Use> void at(const Point3& x, const Point3& normal, Use&& use) const {
    const Eigen::Vector3d n = as_vector(normal);
    if (along_normal_) {
      use(Eigen::Index{0}, 1.0);
      functions_.at(x, [&](Eigen::Index k, double f) { use(first_[static_cast<std::size_t>(k)], f); });
      return;
    }
    for (Eigen::Index j = 0; j < constant_.cols(); ++j) use(j, constant_.col(j).dot(n));
    functions_.at(x, [&](Eigen::Index k, double f) {
      const Eigen::MatrixXd& directions = directions_[static_cast<std::size_t>(k)];
      for (Eigen::Index j = 0; j < directions.cols(); ++j)
        use(first_[static_cast<std::size_t>(k)] + j, f * directions.col(j).dot(n));
    });
  }

 private:
  const CoarseFunctions& functions_;
  bool along_normal_;
  Eigen::MatrixXd constant_;
  std::vector<Eigen::MatrixXd> directions_;
  std::vector<Eigen::Index> first_;
};

// Rows that no combination of other rows replaces, by pivoted Cholesky on the rows' correlations (unit diagonal); the
// norm is that of the traces: columns weighted by 1 / ∫ |N| dA.
std::vector<Eigen::Index> independent_rows(const Rows& rows, const Eigen::VectorXd& column_weight) {
  const RowMatrix scaled = rows.matrix * column_weight.cwiseSqrt().cwiseInverse().asDiagonal();
  Eigen::MatrixXd gram = Eigen::MatrixXd(scaled * RowMatrix(scaled.transpose()));
  const Eigen::VectorXd norm = gram.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = norm.unaryExpr([](double v) { return v > 0 ? 1 / v : 0.0; });
  gram = (inverse.asDiagonal() * gram * inverse.asDiagonal()).eval();
  std::vector<Eigen::Index> kept;
  Eigen::VectorXd left = gram.diagonal();
  Eigen::MatrixXd factor(gram.rows(), 0);
  std::vector<Eigen::VectorXd> columns;
  while (static_cast<Eigen::Index>(columns.size()) < gram.rows()) {
    Eigen::Index pivot = 0;
    const auto step = static_cast<Eigen::Index>(columns.size());
    if (step < rows.forced) {
      pivot = step;
      if (!(left[pivot] > 0)) break;
    } else if (left.maxCoeff(&pivot) < least_share) {
      break;
    }
    Eigen::VectorXd column = gram.col(pivot);
    for (const Eigen::VectorXd& c : columns) column -= c[pivot] * c;
    column /= std::sqrt(column[pivot]);
    left -= column.cwiseAbs2();
    for (const Eigen::Index k : kept) left[k] = 0;
    left[pivot] = 0;
    kept.push_back(pivot);
    columns.push_back(std::move(column));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

} // namespace

ConstraintRows lagrange_rows(const SolutionSpace& space, const ElasticMaterial& material,
                             const PreparedSupport& prepared) {
  const Support& support = prepared.support;
  const SplineGrid& grid = space.model().grid;
  const auto degrees = grid.degree();
  const Point3 h = grid.span_size();
  const int p = *std::max_element(degrees.begin(), degrees.end());
  std::vector<PointBatch> batches;
  for (std::size_t s = 0; s < prepared.region.cells.size(); ++s)
    batches.push_back(gather(space.model(), prepared.region, s));
  const CoarseFunctions functions(batches, std::max(3, p + 1) * *std::max_element(h.begin(), h.end()));
  const Multipliers multipliers(functions, batches, support.along_normal);

  // Columns: nodes, one direction at a time afterwards; unknowns where the direction turns with the normal.
  const Eigen::Index per_node = support.along_normal ? 3 : 1;
  const FixedDirections any = fixed_directions(prepared, {0, 0, 1}, {});
  Rows rows;
  rows.forced = multipliers.forced();
  rows.values = Eigen::MatrixXd::Zero(multipliers.count(), any.count);
  Eigen::VectorXd column_weight = Eigen::VectorXd::Zero(per_node * space.num_nodes());
  std::vector<Eigen::Triplet<double>> entries;
  SpanShapes shapes;
  for (const PointBatch& b : batches) {
    const auto nodes = space.nodes(b.cell);
    evaluate(space, b.cell, b.parameters, Shapes::Values, shapes);
    std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> local; // few multipliers reach a span
    const auto row_of = [&](Eigen::Index m) -> Eigen::VectorXd& {
      for (auto& [number, row] : local)
        if (number == m) return row;
      return local.emplace_back(m, Eigen::VectorXd::Zero(per_node * static_cast<Eigen::Index>(nodes.size()))).second;
    };
    for (std::size_t q = 0; q < b.size(); ++q) {
      const auto values = shapes.values.row(static_cast<Eigen::Index>(q));
      const FixedDirections fixed = fixed_directions(prepared, b.normals[q], b.positions[q]);
      multipliers.at(b.positions[q], b.normals[q], [&](Eigen::Index m, double factor) {
        Eigen::VectorXd& row = row_of(m);
        for (Eigen::Index i = 0; i < values.size(); ++i)
          for (Eigen::Index c = 0; c < per_node; ++c)
            row[per_node * i + c] +=
                b.weights[q] * factor * values[i] * (per_node == 3 ? b.normals[q][static_cast<std::size_t>(c)] : 1.0);
        for (int d = 0; d < fixed.count; ++d)
          rows.values(m, d) += b.weights[q] * factor * fixed.prescribed[static_cast<std::size_t>(d)];
      });
      for (Eigen::Index i = 0; i < values.size(); ++i)
        for (Eigen::Index c = 0; c < per_node; ++c)
          column_weight[per_node * nodes[static_cast<std::size_t>(i)] + c] += b.weights[q] * std::abs(values[i]);
    }
    for (const auto& [m, row] : local)
      for (std::size_t r = 0; r < nodes.size(); ++r)
        for (Eigen::Index c = 0; c < per_node; ++c)
          entries.emplace_back(static_cast<int>(m), static_cast<int>(per_node * nodes[r] + c),
                               row[per_node * static_cast<Eigen::Index>(r) + c]);
  }
  rows.matrix.resize(multipliers.count(), per_node * space.num_nodes());
  rows.matrix.setFromTriplets(entries.begin(), entries.end());
  for (double& w : column_weight)
    if (!(w > 0)) w = 1; // no entry in such a column

  ConstraintRows result;
  const double scale = effective_modulus(material) * std::cbrt(grid.span_volume());
  for (const Eigen::Index m : independent_rows(rows, column_weight)) {
    const double factor = scale / rows.matrix.row(m).norm();
    for (int d = 0; d < any.count; ++d) {
      const auto row = static_cast<int>(result.values.size());
      for (RowMatrix::InnerIterator it(rows.matrix, m); it; ++it) {
        if (support.along_normal) {
          result.entries.emplace_back(row, static_cast<int>(it.col()), factor * it.value());
          continue;
        }
        const Point3& e = any.direction[static_cast<std::size_t>(d)];
        for (int c = 0; c < 3; ++c)
          if (e[static_cast<std::size_t>(c)] != 0)
            result.entries.emplace_back(row, 3 * static_cast<int>(it.col()) + c,
                                        factor * it.value() * e[static_cast<std::size_t>(c)]);
      }
      result.values.push_back(factor * rows.values(m, d));
    }
  }
  return result;
}

} // namespace iga::solve
