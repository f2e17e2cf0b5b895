#include "solver/nonlinear/finite_body.hpp"

#include "format/model/errors.hpp"
#include "solver/nonlinear/mean_volume.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <tbb/enumerable_thread_specific.h>

namespace iga::solve {

Tangent::Tangent(const std::shared_ptr<const Connectivity>& connectivity, bool is_symmetric)
    : lower(connectivity), symmetric(is_symmetric) {
  if (!symmetric) upper = StiffnessMatrix(connectivity);
}

void Tangent::set_zero() {
  std::fill(lower.values().begin(), lower.values().end(), 0.0);
  std::fill(upper.values().begin(), upper.values().end(), 0.0);
}

void Tangent::add(std::span<const std::int32_t> nodes, const Eigen::MatrixXd& block) {
  if (symmetric) {
    lower.add(nodes, 0.5 * (block + block.transpose()));
  } else {
    lower.add(nodes, block);
    upper.add(nodes, block.transpose());
  }
}

struct FiniteBody::Work {
  SpanShapes shapes;
  SpanPointStorage storage;
  SpanPoints points;
  std::size_t count = 0, nodes = 0;
  Eigen::MatrixXd H;             // (points × 9): ∂u_a/∂X_A in column 3 a + A
  Eigen::MatrixXd P;             // (points × 9)
  Eigen::MatrixXd A;             // (points × 81)
  Eigen::MatrixXd local, forces; // (nodes × 3)
  Eigen::MatrixXd stacked;       // (3 points × nodes)
  Eigen::MatrixXd product, block;
  std::vector<Lanes> history;
  MeanVolume volume; // with F-bar
  MeanVolume::Linear linear;
  // Column i holds ∂N_i/∂X_A of all points, A after A.
  Eigen::Map<const Eigen::MatrixXd> gradients() const {
    return {shapes.gradients.data(), static_cast<Eigen::Index>(3 * count), static_cast<Eigen::Index>(nodes)};
  }
  Eigen::Map<const Eigen::VectorXd> weights() const {
    return {points.weights.data(), static_cast<Eigen::Index>(count)};
  }
  // ∫ T : ∂N_i/∂X of weighted point values T (points × 9): (nodes × 3) in `forces`.
  void integrate(const Eigen::MatrixXd& T) {
    const auto Q = static_cast<Eigen::Index>(count);
    product.resize(3 * Q, 3);
    for (Eigen::Index d = 0; d < 3; ++d)
      for (Eigen::Index c = 0; c < 3; ++c) product.block(d * Q, c, Q, 1) = T.col(3 * c + d);
    forces.noalias() = gradients().transpose() * product;
  }
};

namespace {

double smallest_side(const Point3& h) {
  return std::min({h[0], h[1], h[2]});
}

} // namespace

FiniteBody::FiniteBody(const SolutionSpace& space, const Law& law, std::shared_ptr<const Connectivity> connectivity,
                       Locking locking)
    : space_(&space), law_(law, smallest_side(space.model().grid.span_size())), connectivity_(std::move(connectivity)),
      locking_(locking) {
  SpanPointStorage storage;
  first_block_.push_back(0);
  for (std::int64_t a = 0; a < space.num_cells(); ++a) {
    const std::size_t count = span_points(space, a, storage).weights.size();
    const auto own = cell_weights(space.model(), a); // further points are those of fictitious material
    const std::int64_t first = own.empty() ? 0 : own.data() - space.model().points.weights.data();
    const std::size_t blocks = (count + lanes - 1) / lanes;
    for (std::size_t q = 0; q < lanes * blocks; ++q)
      point_.push_back(q < own.size() && q < count ? first + static_cast<std::int64_t>(q) : -1);
    first_block_.push_back(first_block_.back() + static_cast<std::int64_t>(blocks));
  }
  const auto blocks = static_cast<std::size_t>(first_block_.back());
  const auto per_block = static_cast<std::size_t>(law_.history());
  history_.resize(per_block * blocks);
  for (std::size_t b = 0; b < blocks && per_block > 0; ++b) law_.start(&history_[per_block * b]);
  if (!law_.needs_old_F()) return;
  F_old_.resize(9 * blocks);
  for (std::size_t k = 0; k < F_old_.size(); ++k) F_old_[k] = Lanes{} + (k % 9 % 4 == 0 ? 1.0 : 0.0);
}

// Displacement gradients at the points of a cell.
void FiniteBody::gather(const Eigen::VectorXd& u, std::int64_t a, Work& work) const {
  work.points = span_points(*space_, a, work.storage);
  work.count = work.points.weights.size();
  const auto nodes = space_->nodes(a);
  work.nodes = nodes.size();
  if (work.count == 0) return;
  evaluate(*space_, a, work.points.parameters, Shapes::Gradients, work.shapes);
  const auto Q = static_cast<Eigen::Index>(work.count), n = static_cast<Eigen::Index>(work.nodes);
  work.local.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    work.local.row(i) = u.segment<3>(3 * static_cast<Eigen::Index>(nodes[static_cast<std::size_t>(i)])).transpose();
  work.product.noalias() = work.gradients() * work.local; // (3 points × 3)
  work.H.resize(Q, 9);
  for (Eigen::Index d = 0; d < 3; ++d)
    for (Eigen::Index c = 0; c < 3; ++c) work.H.col(3 * c + d) = work.product.block(d * Q, c, Q, 1);
  if (locking_ == Locking::FBar) work.volume.set(work.points.weights, work.H);
}

// visit(block, first point, number of points, F, F_old), with F as the law sees it: lanes beyond the last point are
// untouched.
template <class Visit> void FiniteBody::for_blocks(std::int64_t a, const Work& work, Visit&& visit) const {
  const std::int64_t first = first_block_[static_cast<std::size_t>(a)],
                     last = first_block_[static_cast<std::size_t>(a) + 1];
  for (std::int64_t b = first; b < last; ++b) {
    const auto q0 = static_cast<std::size_t>(b - first) * lanes;
    const std::size_t count = std::min(lanes, work.count - q0);
    TensorLanes F, F_old;
    for (std::size_t k = 0; k < 9; ++k) {
      F.c[k] = Lanes{} + (k % 4 == 0 ? 1.0 : 0.0);
      F_old.c[k] = F_old_.empty() ? F.c[k] : F_old_[9 * static_cast<std::size_t>(b) + k];
      for (std::size_t l = 0; l < count; ++l) {
        const auto q = static_cast<Eigen::Index>(q0 + l);
        F.c[k][l] += work.H(q, static_cast<Eigen::Index>(k));
        if (locking_ == Locking::FBar) F.c[k][l] *= work.volume.scale(q);
      }
    }
    visit(static_cast<std::size_t>(b), q0, count, F, F_old);
  }
}

PointsReport FiniteBody::add_forces(const Eigen::VectorXd& u, Eigen::VectorXd& f) const {
  tbb::enumerable_thread_specific<Work> works;
  std::vector<PointsReport> reports(static_cast<std::size_t>(space_->num_cells()));
  for_spans(connectivity_->blocks[0], [&](std::int64_t a) {
    Work& work = works.local();
    gather(u, a, work);
    if (work.count == 0) return;
    PointsReport& report = reports[static_cast<std::size_t>(a)];
    const auto per_block = static_cast<std::size_t>(law_.history());
    work.history.resize(per_block + 1);
    const auto Q = static_cast<Eigen::Index>(work.count), n = static_cast<Eigen::Index>(work.nodes);
    work.P.resize(Q, 9);
    for_blocks(
        a, work, [&](std::size_t b, std::size_t q0, std::size_t count, const TensorLanes& F, const TensorLanes& F_old) {
          std::copy_n(history_.begin() + static_cast<std::ptrdiff_t>(per_block * b), per_block, work.history.begin());
          TensorLanes P;
          Lanes J;
          const LaneMask inverted = law_.stress(F, F_old, work.history.data(), P, J);
          for (std::size_t l = 0; l < count; ++l) {
            const auto q = static_cast<Eigen::Index>(q0 + l);
            for (std::size_t k = 0; k < 9; ++k) work.P(q, static_cast<Eigen::Index>(k)) = P.c[k][l];
            report.min_J = std::min(report.min_J, locking_ == Locking::FBar ? work.volume.J(q) : J[l]);
            report.inverted += inverted[l] != 0 ? 1 : 0;
          }
        });
    if (locking_ == Locking::FBar) {
      work.volume.to_stress(work.P);
      // No state of a body: Newton's method takes a shorter step.
      if (work.volume.crushed()) work.P.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    work.P = work.weights().asDiagonal() * work.P;
    work.integrate(work.P);
    const auto nodes = space_->nodes(a);
    for (Eigen::Index i = 0; i < n; ++i)
      f.segment<3>(3 * static_cast<Eigen::Index>(nodes[static_cast<std::size_t>(i)])) += work.forces.row(i).transpose();
  });
  PointsReport all;
  for (std::size_t a = 0; a < reports.size(); ++a) {
    all.inverted += reports[a].inverted;
    if (reports[a].min_J >= all.min_J) continue;
    all.min_J = reports[a].min_J;
    all.min_J_cell = static_cast<std::int64_t>(a);
  }
  return all;
}

void FiniteBody::add_tangent(const Eigen::VectorXd& u, Tangent& A) const {
  tbb::enumerable_thread_specific<Work> works;
  for_spans(connectivity_->blocks[0], [&](std::int64_t a) {
    Work& work = works.local();
    gather(u, a, work);
    if (work.count == 0) return;
    const auto Q = static_cast<Eigen::Index>(work.count), n = static_cast<Eigen::Index>(work.nodes);
    const auto per_block = static_cast<std::size_t>(law_.history());
    work.A.resize(Q, 81);
    work.P.resize(Q, 9);
    work.history.resize(per_block + 1);
    for_blocks(
        a, work, [&](std::size_t b, std::size_t q0, std::size_t count, const TensorLanes& F, const TensorLanes& F_old) {
          TangentLanes tangent;
          law_.tangent(F, F_old, per_block > 0 ? &history_[per_block * b] : nullptr, tangent);
          for (std::size_t k = 0; k < 81; ++k)
            for (std::size_t l = 0; l < count; ++l)
              work.A(static_cast<Eigen::Index>(q0 + l), static_cast<Eigen::Index>(k)) = tangent.c[k][l];
          if (locking_ == Locking::None) return;
          std::copy_n(history_.begin() + static_cast<std::ptrdiff_t>(per_block * b), per_block, work.history.begin());
          TensorLanes P;
          Lanes J;
          law_.stress(F, F_old, work.history.data(), P, J);
          for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t l = 0; l < count; ++l)
              work.P(static_cast<Eigen::Index>(q0 + l), static_cast<Eigen::Index>(k)) = P.c[k][l];
        });
    if (locking_ == Locking::FBar) work.volume.to_tangent(work.P, work.A, work.linear);
    work.A = work.weights().asDiagonal() * work.A;
    const auto G = work.gradients();
    work.stacked.resize(3 * Q, n);
    work.block.resize(3 * n, 3 * n);
    for (int c = 0; c < 3; ++c)
      for (int b = 0; b < (law_.is_symmetric() ? c + 1 : 3); ++b) {
        for (int d = 0; d < 3; ++d) {
          const auto column = [&](int e) { return work.A.col(9 * (3 * c + d) + 3 * b + e).array(); };
          for (Eigen::Index j = 0; j < n; ++j)
            work.stacked.col(j).segment(d * Q, Q) = column(0) * G.col(j).segment(0, Q).array() +
                                                    column(1) * G.col(j).segment(Q, Q).array() +
                                                    column(2) * G.col(j).segment(2 * Q, Q).array();
        }
        work.product.noalias() = G.transpose() * work.stacked;
        for (Eigen::Index j = 0; j < n; ++j)
          for (Eigen::Index i = 0; i < n; ++i) {
            work.block(3 * i + c, 3 * j + b) = work.product(i, j);
            if (law_.is_symmetric()) work.block(3 * j + b, 3 * i + c) = work.product(i, j);
          }
      }
    if (locking_ == Locking::FBar) add_coupling(work);
    A.add(space_->nodes(a), work.block);
  });
}

// What the mean couples over the cell: D = ∫ cof F : ∂F/∂u, and L and R likewise of V and R. Then V dθ gives L Dᵀ / v,
// the mean of the stress D (Rᵀ + c Dᵀ) / v.
void FiniteBody::add_coupling(Work& work) const {
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(work.nodes);
  const auto integral = [&](const Eigen::MatrixXd& T) {
    work.integrate(work.weights().asDiagonal() * T);
    Eigen::VectorXd all(n);
    for (Eigen::Index i = 0; i < work.forces.rows(); ++i) all.segment<3>(3 * i) = work.forces.row(i).transpose();
    return all;
  };
  const Eigen::VectorXd D = integral(work.volume.cofactors()), L = integral(work.linear.V), R = integral(work.linear.R);
  work.block.noalias() += ((L + work.linear.c * D) / work.volume.volume()) * D.transpose();
  work.block.noalias() += (D / work.volume.volume()) * R.transpose();
}

void FiniteBody::keep(const Eigen::VectorXd& u) {
  if (history_.empty() && F_old_.empty()) return;
  const auto per_block = static_cast<std::size_t>(law_.history());
  tbb::enumerable_thread_specific<Work> works;
  tbb::parallel_for(std::int64_t{0}, space_->num_cells(), [&](std::int64_t a) {
    Work& work = works.local();
    gather(u, a, work);
    if (work.count == 0) return;
    for_blocks(a, work, [&](std::size_t b, std::size_t, std::size_t, const TensorLanes& F, const TensorLanes& F_old) {
      TensorLanes P;
      Lanes J;
      law_.stress(F, F_old, per_block > 0 ? &history_[per_block * b] : nullptr, P, J);
      for (std::size_t k = 0; k < 9 && !F_old_.empty(); ++k) F_old_[9 * b + k] = F.c[k];
    });
  });
}

std::vector<double> FiniteBody::scales(const Eigen::VectorXd& u) const {
  std::vector<double> all;
  if (locking_ == Locking::None) return all;
  all.assign(space_->model().points.weights.size(), 1);
  tbb::enumerable_thread_specific<Work> works;
  tbb::parallel_for(std::int64_t{0}, space_->num_cells(), [&](std::int64_t a) {
    Work& work = works.local();
    gather(u, a, work);
    const std::int64_t* point = &point_[lanes * static_cast<std::size_t>(first_block_[static_cast<std::size_t>(a)])];
    for (std::size_t q = 0; q < work.count; ++q)
      if (point[q] >= 0) all[static_cast<std::size_t>(point[q])] = work.volume.scale(static_cast<Eigen::Index>(q));
  });
  return all;
}

namespace {

std::vector<double> numbers(const std::vector<Lanes>& from) {
  std::vector<double> to(lanes * from.size());
  if (!from.empty()) std::memcpy(to.data(), from.data(), from.size() * sizeof(Lanes));
  return to;
}

void restore(const char* name, const std::vector<double>& from, std::vector<Lanes>& to) {
  if (from.size() != lanes * to.size())
    throw InputError(fmt::format("{}: found {} numbers, expected {}; the state is that of another model or law", name,
                                 from.size(), lanes * to.size()));
  if (!to.empty()) std::memcpy(to.data(), from.data(), to.size() * sizeof(Lanes));
}

} // namespace

PointHistory FiniteBody::save() const {
  return {numbers(history_), numbers(F_old_), {}};
}

void FiniteBody::load(const PointHistory& saved) {
  restore("history", saved.history, history_);
  restore("deformation", saved.F_old, F_old_);
}

} // namespace iga::solve
