#include "solver/estimate/residual_estimate.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/estimate/cell_residual.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Test functions: for each direction the leading oscillation and the next one.
constexpr int orders = 2, tests = 3 * orders;
constexpr std::size_t none = 3; // of the directions
int direction_of(Index j) {
  return static_cast<int>(j) / orders;
}

// A trimmed cell's correction reaches into its neighbours: it has at least this share of a span to store its energy in.
constexpr double least_share = 0.25;

Rotation transposed(const Rotation& R) {
  Rotation T{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) T[r][c] = R[c][r];
  return T;
}

// Integrals of the tests against derivatives of the monomials: what multiplies a cell's fields.
struct Moments {
  MatrixXd value;  // (tests × monomials): ∫ w_j φ dV
  MatrixXd second; // (6 tests × monomials); row 6 j + v: ∫ w_j ∂²_v φ dV
};

class Residuals {
 public:
  explicit Residuals(const ResidualProblem& problem)
      : problem_(problem), space_(*problem.space), model_(space_.model()), grid_(model_.grid), monomials_(grid_),
        C_(turned(*problem.material, transposed(grid_.rotation())).C), fields_(problem.unknowns.cols()) {
    const auto p = grid_.degree();
    const Point3 h = grid_.span_size();
    for (std::size_t d = 0; d < 3; ++d)
      for (int n = 1; n <= orders; ++n) {
        oscillations_.emplace_back(p[d] + n);
        Eigen::Matrix3d acoustic;
        for (int k = 0; k < 3; ++k)
          for (int l = 0; l < 3; ++l) acoustic(k, l) = C_(voigt_place[k][d], voigt_place[l][d]);
        const double scale = oscillations_.back().slope_squared() / (h[d] * h[d]) * grid_.span_volume();
        softness_.push_back((acoustic * scale).inverse());
      }
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i)
        for (int l = 0; l < 3; ++l)
          for (int m = 0; m < 3; ++m) {
            const double c = C_(voigt_place[k][i], voigt_place[l][m]);
            divergence_(k, voigt_place[i][m] + 6 * l) += c;
            traction_(k, 3 * i + m + 9 * l) = c;
          }
    whole_ = whole_span();
  }

  MatrixXd energies() {
    const auto cells = static_cast<Index>(model_.num_cells());
    MatrixXd energy(cells, fields_);
    std::vector<MatrixXd> loaded = loaded_residuals();
    add_jumps(loaded);
    tbb::enumerable_thread_specific<SpanShapes> shapes;
    tbb::parallel_for(Index{0}, cells, [&](Index a) {
      const CellFields fields = monomials_.fields(space_, a, problem_.unknowns, shapes.local());
      MatrixXd r = inside(model_.is_interior(static_cast<std::size_t>(a)) ? whole_ : of_points(a), fields, a);
      if (!surface_parameters(model_, a).empty()) {
        r -= on_surface(surface_moments(a), fields);
        if (problem_.material->initial_strain) r.colwise() += initial_on_surface(a);
      }
      if (loaded[static_cast<std::size_t>(a)].size() > 0) r += loaded[static_cast<std::size_t>(a)];
      energy.row(a) = energy_of(a, r);
    });
    return energy;
  }

 private:
  // w_q w_j(ξ_q); (points × tests)
  MatrixXd weighted_tests(const Eigen::MatrixX3d& xi, std::span<const double> weights) const {
    MatrixXd W(xi.rows(), tests);
    for (Index j = 0; j < tests; ++j)
      for (Index q = 0; q < xi.rows(); ++q)
        W(q, j) = weights[static_cast<std::size_t>(q)] *
                  oscillations_[static_cast<std::size_t>(j)].value(xi(q, direction_of(j)));
    return W;
  }

  // Rows of Σ_q W(q, j) table(q, part · monomials + n), `parts` for each test.
  MatrixXd summed(const MatrixXd& W, const MatrixXd& table) const {
    const Index n = monomials_.size(), parts = table.cols() / n;
    const MatrixXd sums = W.transpose() * table;
    MatrixXd rows(W.cols() * parts, n);
    for (Index j = 0; j < W.cols(); ++j)
      for (Index part = 0; part < parts; ++part) rows.row(parts * j + part) = sums.block(j, part * n, 1, n);
    return rows;
  }

  Moments of_volume(const Eigen::MatrixX3d& xi, std::span<const double> weights) const {
    const MatrixXd W = weighted_tests(xi, weights);
    return {summed(W, monomials_.values(xi)), summed(W, monomials_.second_derivatives(xi))};
  }

  Moments whole_span() const {
    const CubeRule cube = test_rule(grid_.span_volume(), none);
    return of_volume(cube.points, cube.weights);
  }

  // Gauss points that are exact for tests against derivatives of the fields: of whole spans, or of their faces across a
  // direction, where that coordinate is left open. The weights add up to the size.
  CubeRule test_rule(double size, std::size_t across) const {
    auto n = grid_.degree();
    for (std::size_t d = 0; d < 3; ++d) n[d] = d == across ? 1 : n[d] + orders;
    CubeRule rule = cube_rule(n);
    for (double& weight : rule.weights) weight *= size;
    return rule;
  }

  Index3 span_of(Index a) const { return grid_.span_index(model_.cells.span[static_cast<std::size_t>(a)]); }

  Moments of_points(Index a) const {
    return of_volume(monomials_.local(span_of(a), cell_parameters(model_, a)), cell_weights(model_, a));
  }

  // (9 tests × monomials); row 9 j + 3 i + m: ∫ w_j n_i ∂_m φ dA
  MatrixXd surface_moments(Index a) const {
    const SurfacePoints& surface = model_.surface.quadrature;
    const auto first = static_cast<std::size_t>(surface.offsets[static_cast<std::size_t>(a)]),
               last = static_cast<std::size_t>(surface.offsets[static_cast<std::size_t>(a) + 1]);
    const Eigen::MatrixX3d xi = monomials_.local(span_of(a), surface_parameters(model_, a));
    Eigen::MatrixX3d along(xi.rows(), 3);
    for (Index q = 0; q < xi.rows(); ++q) {
      const double* normal = &surface.normals[3 * (first + static_cast<std::size_t>(q))];
      along.row(q) = as_vector(grid_.along_axes({normal[0], normal[1], normal[2]})).transpose();
    }
    return surface_moments(xi, std::span(surface.weights).subspan(first, last - first), along);
  }

  MatrixXd surface_moments(const Eigen::MatrixX3d& xi, std::span<const double> weights,
                           const Eigen::MatrixX3d& normals) const {
    const MatrixXd W = weighted_tests(xi, weights);
    MatrixXd by_normal(xi.rows(), 3 * tests); // column 3 j + i
    for (Index j = 0; j < tests; ++j)
      for (Index i = 0; i < 3; ++i) by_normal.col(3 * j + i) = W.col(j).cwiseProduct(normals.col(i));
    return summed(by_normal, monomials_.gradients(xi));
  }

  // ∫ (div σ + λ ρ u + b) · w_j e_k dV in row 3 j + k; (3 tests × fields)
  MatrixXd inside(const Moments& moments, const CellFields& fields, Index a) const {
    const MatrixXd value = moments.value * fields, second = moments.second * fields;
    const MatrixXd forces = given_forces(a), given = forces.size() > 0 ? MatrixXd(moments.value * forces) : MatrixXd();
    MatrixXd r(3 * tests, fields_);
    for (Index f = 0; f < fields_; ++f) {
      const double inertia = problem_.lambda[f] * problem_.material->density;
      for (Index j = 0; j < tests; ++j)
        r.block<3, 1>(3 * j, f) = divergence_ * second.block<6, 3>(6 * j, 3 * f).reshaped() +
                                  inertia * value.block<1, 3>(j, 3 * f).transpose();
      if (given.size() > 0) r.col(f) += given.transpose().reshaped();
    }
    return r;
  }

  // b - div (C ε₀) of a cell as polynomials, in the grid's axes: (monomials × 3); empty where nothing is given.
  MatrixXd given_forces(Index a) const {
    if (!problem_.body_force && !problem_.material->initial_strain) return {};
    const std::vector<double> u = monomials_.node_parameters(span_of(a));
    const Index n = monomials_.size();
    Eigen::MatrixX3d forces = Eigen::MatrixX3d::Zero(n, 3);
    if (problem_.body_force)
      for (Index q = 0; q < n; ++q) {
        const double* at = &u[3 * static_cast<std::size_t>(q)];
        forces.row(q) =
            as_vector(grid_.along_axes(problem_.body_force(grid_.to_position({at[0], at[1], at[2]})))).transpose();
      }
    if (problem_.material->initial_strain) {
      const Strains stress = monomials_.through(initial_stress(a, u));
      const MatrixXd gradients = monomials_.gradients(monomials_.nodes());
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) forces.col(k) -= gradients.middleCols(i * n, n) * stress.col(voigt_place[k][i]);
    }
    return monomials_.through(forces);
  }

  // C ε₀ at points of a cell, in the grid's axes.
  Strains initial_stress(Index a, std::span<const double> parameters) const {
    Strains stress = problem_.material->initial_strain->at(a, parameters) * problem_.material->C;
    const Eigen::Matrix3d R = rotation();
    for (Index q = 0; q < stress.rows(); ++q) {
      const Eigen::Matrix3d along = R.transpose() * tensor(stress.row(q)) * R;
      for (int k = 0; k < 3; ++k)
        for (int i = k; i < 3; ++i) stress(q, voigt_place[k][i]) = along(k, i);
    }
    return stress;
  }

  static Eigen::Matrix3d tensor(const Eigen::Matrix<double, 1, 6>& stress) {
    Eigen::Matrix3d s;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) s(k, i) = stress[voigt_place[k][i]];
    return s;
  }

  // ∫ (C ε₀ n) · w_j e_k dA over the surface of a cell, in row 3 j + k: (3 tests).
  Eigen::VectorXd initial_on_surface(Index a) const {
    const SurfacePoints& surface = model_.surface.quadrature;
    const auto first = static_cast<std::size_t>(surface.offsets[static_cast<std::size_t>(a)]);
    const auto parameters = surface_parameters(model_, a);
    const MatrixXd W = weighted_tests(monomials_.local(span_of(a), parameters),
                                      std::span(surface.weights).subspan(first, parameters.size() / 3));
    const Strains stress = initial_stress(a, parameters);
    Eigen::MatrixX3d traction(W.rows(), 3);
    for (Index q = 0; q < W.rows(); ++q) {
      const double* n = &surface.normals[3 * (first + static_cast<std::size_t>(q))];
      traction.row(q) = (tensor(stress.row(q)) * as_vector(grid_.along_axes({n[0], n[1], n[2]}))).transpose();
    }
    return MatrixXd(traction.transpose() * W).reshaped();
  }

  // ∫ σ n · w_j e_k dA likewise.
  MatrixXd on_surface(const MatrixXd& moments, const CellFields& fields) const {
    const MatrixXd slopes = moments * fields;
    MatrixXd r(3 * tests, fields_);
    for (Index f = 0; f < fields_; ++f)
      for (Index j = 0; j < tests; ++j)
        r.block<3, 1>(3 * j, f) = traction_ * slopes.block<9, 3>(9 * j, 3 * f).reshaped();
    return r;
  }

  Eigen::RowVectorXd energy_of(Index a, const MatrixXd& r) const {
    const double filled = std::max(model_.cells.volume_fraction[static_cast<std::size_t>(a)], least_share);
    Eigen::RowVectorXd energy = Eigen::RowVectorXd::Zero(fields_);
    for (Index j = 0; j < tests; ++j) {
      const auto part = r.middleRows<3>(3 * j);
      energy += part.cwiseProduct(softness_[static_cast<std::size_t>(j)] * part).colwise().sum() / filled;
    }
    return energy;
  }

  // Beside the end of a gap fields are continuous, not smooth, from cell to cell: half the jump of their traction
  // counts for either one. How much of a face is solid is not in the model; as much as in the emptier of its two cells
  // is taken.
  void add_jumps(std::vector<MatrixXd>& residuals) const {
    SpanShapes shapes;
    for (std::size_t link = 0; link < model_.links.size(); ++link) {
      const auto [a, b] = model_.links[link];
      if (!space_.is_bernstein(a) && !space_.is_bernstein(b)) continue;
      const Index3 lower = span_of(a), upper = span_of(b);
      std::size_t d = 0;
      while (lower[d] == upper[d]) ++d;
      const double filled = std::min(model_.cells.volume_fraction[static_cast<std::size_t>(a)],
                                     model_.cells.volume_fraction[static_cast<std::size_t>(b)]);
      CubeRule face = test_rule(0.5 * filled * grid_.span_volume() / grid_.span_size()[d], d);
      Eigen::MatrixX3d normals = Eigen::MatrixX3d::Zero(face.points.rows(), 3);
      normals.col(static_cast<Index>(d)).setOnes();
      const auto traction = [&](std::int32_t cell, double side) {
        face.points.col(static_cast<Index>(d)).setConstant(side);
        return on_surface(surface_moments(face.points, face.weights, normals),
                          monomials_.fields(space_, cell, problem_.unknowns, shapes));
      };
      const MatrixXd jump = traction(a, 1) - traction(b, 0);
      for (const std::int32_t cell : {a, b}) {
        MatrixXd& r = residuals[static_cast<std::size_t>(cell)];
        if (r.size() == 0) r.setZero(3 * tests, fields_);
        r -= jump;
      }
    }
  }

  // What regions that bear traction add: Σ w t · w_j, by cell; empty elsewhere.
  std::vector<MatrixXd> loaded_residuals() const {
    std::vector<MatrixXd> all(model_.num_cells());
    SpanShapes shapes;
    for (const LoadedRegion& loaded : problem_.loaded)
      for (std::size_t s = 0; s < loaded.region->cells.size(); ++s) {
        const PointBatch batch = gather(model_, *loaded.region, s);
        MatrixXd& r = all[static_cast<std::size_t>(batch.cell)];
        if (r.size() == 0) r.setZero(3 * tests, fields_);
        add_traction(batch, loaded.traction, shapes, r);
      }
    return all;
  }

  void add_traction(const PointBatch& batch, const BorneTraction& traction, SpanShapes& shapes, MatrixXd& r) const {
    const Eigen::MatrixX3d xi = monomials_.local(span_of(batch.cell), batch.parameters);
    const MatrixXd W = weighted_tests(xi, batch.weights), gradients = monomials_.gradients(xi);
    const CellFields fields = monomials_.fields(space_, batch.cell, problem_.unknowns, shapes);
    const Index n = monomials_.size();
    Strains initial = Strains::Zero(xi.rows(), 6);
    if (problem_.material->initial_strain) initial = initial_stress(batch.cell, batch.parameters);
    for (Index q = 0; q < xi.rows(); ++q) {
      const Point3& normal = batch.normals[static_cast<std::size_t>(q)];
      const Eigen::Vector3d along = as_vector(grid_.along_axes(normal));
      Eigen::Matrix3Xd by(3, fields.cols()); // row m: ∂_m u
      for (Index m = 0; m < 3; ++m) by.row(m) = gradients.block(q, m * n, 1, n) * fields;
      for (Index f = 0; f < fields_; ++f) {
        Eigen::Matrix<double, 9, 3> slopes; // n_i ∂_m u_l
        for (Index i = 0; i < 3; ++i) slopes.middleRows<3>(3 * i) = along[i] * by.middleCols<3>(3 * f);
        const Eigen::Vector3d own = traction_ * slopes.reshaped() - tensor(initial.row(q)) * along;
        const Eigen::Vector3d borne = traction(batch.positions[static_cast<std::size_t>(q)], normal, rotation() * own);
        const Eigen::Vector3d t = rotation().transpose() * borne;
        for (Index j = 0; j < tests; ++j) r.block<3, 1>(3 * j, f) += W(q, j) * t;
      }
    }
  }

  Eigen::Matrix3d rotation() const {
    Eigen::Matrix3d R;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) R(static_cast<Index>(r), static_cast<Index>(c)) = grid_.rotation()[r][c];
    return R;
  }

  const ResidualProblem& problem_;
  const SolutionSpace& space_;
  const TrimmedModel& model_;
  const SplineGrid& grid_;
  CellMonomials monomials_;
  VoigtMatrix C_; // in the grid's axes
  Index fields_;
  std::vector<Oscillation> oscillations_; // (tests)
  std::vector<Eigen::Matrix3d> softness_; // (tests): A⁻¹ on a whole span
  /// ∂_i σ_ki from second derivatives (column v + 6 l: of u_l), σ_ki n_i from n_i ∂_m u_l (column 3 i + m + 9 l).
  Eigen::Matrix<double, 3, 18> divergence_ = Eigen::Matrix<double, 3, 18>::Zero();
  Eigen::Matrix<double, 3, 27> traction_;
  Moments whole_;
};

} // namespace

MatrixXd residual_energy(const ResidualProblem& problem) {
  return Residuals(problem).energies();
}

} // namespace iga::solve
