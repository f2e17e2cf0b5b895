#include "preprocessor/reduce/point_relocation.hpp"

#include <Eigen/LU>
#include <nlopt.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace iga::prep {

namespace {

// Points keep this distance from the surface, or half of what they start with where that is less.
constexpr double margin = 1e-6;
// A weight must stay above this share of the mean weight.
constexpr double smallest_weight = 1e-6;
// Of the trace of J Jᵀ: keeps the factorisation alive on dependent moments.
constexpr double regularisation = 1e-14;
// A linearisation serves on while it brings the residual down to this share in every step.
constexpr double fast = 0.2;
constexpr int most_iterations = 12;
constexpr int most_halvings = 4;
// In the metric of nearness a coordinate's unit is this many clearances, at most half the box.
constexpr double clearances = 4;
constexpr int most_evaluations = 300;

double mean_weight(const PointSet& points) {
  return std::accumulate(points.w.begin(), points.w.end(), 0.0) / static_cast<double>(points.size());
}

Point3 place(const PointSet& points, std::size_t k) {
  return {points.x[3 * k], points.x[3 * k + 1], points.x[3 * k + 2]};
}

Eigen::Index index(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

} // namespace

void MovingPoints::drop(std::size_t j) {
  const auto at = static_cast<std::ptrdiff_t>(j);
  x.erase(x.begin() + 3 * at, x.begin() + 3 * at + 3);
  w.erase(w.begin() + at);
  clear.erase(clear.begin() + at);
  least.erase(least.begin() + at);
}

MovingPoints PointRelocator::measured(const PointSet& points) {
  MovingPoints moving{points, {}, {}};
  for (std::size_t k = 0; k < points.size(); ++k) {
    moving.clear.push_back(interior_->clearance(place(points, k)));
    moving.least.push_back(std::min(margin, 0.5 * moving.clear.back()));
  }
  return moving;
}

bool PointRelocator::holds(const PointSet& points) const {
  for (std::size_t k = 0; k < points.size(); ++k)
    if (!interior_->holds(place(points, k))) return false;
  return true;
}

bool PointRelocator::linearise(const MovingPoints& points, Metric metric, Linearisation& at) {
  at.scale.resize(points.size());
  const double mean = mean_weight(points);
  for (std::size_t k = 0; k < points.size(); ++k)
    at.scale[k] = metric == Metric::Even
                      ? UnknownScale{mean, 0.5}
                      : UnknownScale{points.w[k], std::min(0.5, clearances * std::max(0.0, points.clear[k]))};
  equations_.jacobian(points, at.scale, at.J);
  const Eigen::Index m = equations_.num_moments();
  at.gram.setZero(m, m);
  at.gram.selfadjointView<Eigen::Lower>().rankUpdate(at.J);
  at.gram.diagonal().array() += regularisation * at.gram.trace() / static_cast<double>(m);
  at.factor.compute(at.gram);
  return at.factor.info() == Eigen::Success;
}

// Without the columns J_j of a point, (J Jᵀ - J_j J_jᵀ)⁻¹ follows from (J Jᵀ)⁻¹ = (L Lᵀ)⁻¹ by Woodbury's formula with
// Y_j = L⁻¹ J_j and the small matrix I - Y_jᵀ Y_j.
bool PointRelocator::rank(const MovingPoints& points, Metric metric, std::vector<double>& cost) {
  metric_ = metric;
  if (!linearise(points, metric, ranked_)) return false;
  const Eigen::Index c = equations_.unknowns();
  whitened_ = ranked_.J;
  ranked_.factor.matrixL().solveInPlace(whitened_);
  cost.resize(points.size());
  for (std::size_t j = 0; j < points.size(); ++j) {
    const auto own = whitened_.middleCols(index(j) * c, c);
    Eigen::Matrix4d rest = Eigen::Matrix4d::Identity();
    rest.topLeftCorner(c, c).noalias() -= own.transpose() * own;
    const Eigen::Vector4d first = rest.partialPivLu().solve(Eigen::Vector4d::Unit(0) - rest.col(0));
    const double share = points.w[j] / ranked_.scale[j].weight;
    cost[j] = share * share * std::abs(first[0]);
    if (!std::isfinite(cost[j])) cost[j] = std::numeric_limits<double>::max();
  }
  return true;
}

bool PointRelocator::relocate_without(const MovingPoints& ranked, std::span<const std::size_t> removed, double target,
                                      MovingPoints& kept) {
  kept = ranked;
  for (std::size_t i = removed.size(); i-- > 0;) kept.drop(removed[i]);
  return reduced_steps(removed, target, kept) || relocate(kept, metric_, target);
}

// Steps with the linearisation of the ranking, as long as it serves.
bool PointRelocator::reduced_steps(std::span<const std::size_t> removed, double target, MovingPoints& points) {
  const Eigen::Index c = equations_.unknowns(), columns = c * index(removed.size());
  Eigen::MatrixXd out(equations_.num_moments(), columns);
  for (std::size_t i = 0; i < removed.size(); ++i)
    out.middleCols(index(i) * c, c) = whitened_.middleCols(index(removed[i]) * c, c);
  const Eigen::PartialPivLU<Eigen::MatrixXd> rest(Eigen::MatrixXd::Identity(columns, columns) - out.transpose() * out);
  std::vector<UnknownScale> scale;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < ranked_.scale.size(); ++k)
    if (!std::binary_search(removed.begin(), removed.end(), k)) {
      kept.push_back(k);
      scale.push_back(ranked_.scale[k]);
    }
  Eigen::VectorXd v, step(c * index(kept.size()));
  equations_.residual(points, r_);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (reached() <= target) return true;
    v = -r_;
    ranked_.factor.matrixL().solveInPlace(v);
    v += out * rest.solve(out.transpose() * v);
    for (std::size_t k = 0; k < kept.size(); ++k)
      step.segment(index(k) * c, c).noalias() = whitened_.middleCols(index(kept[k]) * c, c).transpose() * v;
    if (move(points, scale, step) != Move::Fast) break;
  }
  return reached() <= target;
}

bool PointRelocator::relocate(MovingPoints& points, Metric metric, double target) {
  equations_.residual(points, r_);
  Eigen::VectorXd v, step;
  bool serves = false; // the linearisation at hand
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (reached() <= target) return true;
    if (!serves && !linearise(points, metric, own_)) return false;
    v = own_.factor.solve(-r_);
    step.noalias() = own_.J.transpose() * v;
    const Move moved = move(points, own_.scale, step);
    if (moved == Move::Refused && !serves) return false;
    serves = moved == Move::Fast;
  }
  return reached() <= target;
}

PointRelocator::Move PointRelocator::move(MovingPoints& points, std::span<const UnknownScale> scale,
                                          const Eigen::VectorXd& step) {
  const double norm = r_.norm(), lightest = smallest_weight * mean_weight(points);
  const Eigen::Index c = equations_.unknowns();
  double alpha = 1;
  for (int halving = 0; halving <= most_halvings; ++halving, alpha *= 0.5) {
    trial_ = points;
    bool feasible = true;
    for (std::size_t k = 0; feasible && k < points.size(); ++k) {
      trial_.w[k] += alpha * scale[k].weight * step[index(k) * c];
      feasible = trial_.w[k] > lightest;
    }
    for (std::size_t k = 0; feasible && k < points.size(); ++k) {
      const double* own = step.data() + index(k) * c + 1;
      double moved = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        const double e = equations_.moves(d) ? alpha * scale[k].place * *own++ : 0;
        trial_.x[3 * k + d] += e;
        moved += e * e;
      }
      trial_.clear[k] -= std::sqrt(moved);
      if (moved > 0 && trial_.clear[k] < points.least[k]) {
        trial_.clear[k] = interior_->clearance(place(trial_, k), place(points, k));
        feasible = trial_.clear[k] >= points.least[k];
      }
    }
    if (!feasible) continue;
    equations_.residual(trial_, trial_r_);
    const double now = trial_r_.norm();
    if (now < (1 - 0.25 * alpha) * norm) {
      std::swap(points, trial_);
      r_.swap(trial_r_);
      return now < fast * norm ? Move::Fast : Move::Slow;
    }
  }
  return Move::Refused;
}

bool PointRelocator::relocate_bounded(MovingPoints& points, double target) {
  const PointSet start = points;
  const double mean = mean_weight(points);
  own_.scale.assign(points.size(), {mean, 1});
  std::vector<double> z, lower, upper;
  const auto add = [&](double value, double low, double high) {
    z.push_back(value);
    lower.push_back(std::min(low, value));
    upper.push_back(std::max(high, value));
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    add(points.w[k] / mean, 1e-3, std::numeric_limits<double>::infinity());
    for (std::size_t d = 0; d < 3; ++d)
      if (equations_.moves(d)) add(points.x[3 * k + d], margin, 1 - margin);
  }
  struct Problem {
    PointRelocator* self;
    MovingPoints* points;
    double mean;
    void take(const std::vector<double>& unknowns) const {
      const double* next = unknowns.data();
      for (std::size_t k = 0; k < points->size(); ++k) {
        points->w[k] = mean * *next++;
        for (std::size_t d = 0; d < 3; ++d)
          if (self->equations_.moves(d)) points->x[3 * k + d] = *next++;
      }
    }
  } problem{this, &points, mean};
  nlopt::opt descent(nlopt::LD_LBFGS, static_cast<unsigned>(z.size()));
  descent.set_lower_bounds(lower);
  descent.set_upper_bounds(upper);
  descent.set_maxeval(most_evaluations);
  const double enough = target * equations_.norm();
  descent.set_stopval(enough * enough);
  descent.set_min_objective(
      [](const std::vector<double>& unknowns, std::vector<double>& gradient, void* data) {
        const Problem& p = *static_cast<Problem*>(data);
        p.take(unknowns);
        p.self->equations_.residual(*p.points, p.self->r_);
        if (!gradient.empty()) {
          p.self->equations_.jacobian(*p.points, p.self->own_.scale, p.self->own_.J);
          Eigen::Map<Eigen::VectorXd>(gradient.data(), index(gradient.size())).noalias() =
              2 * p.self->own_.J.transpose() * p.self->r_;
        }
        return p.self->r_.squaredNorm();
      },
      &problem);
  try {
    double squared = 0;
    descent.optimize(z, squared);
  } catch (const std::exception&) {
    // Rounding stopped the descent: what it reached is judged like anything else.
  }
  problem.take(z);
  for (std::size_t k = 0; k < points.size(); ++k) {
    points.clear[k] = interior_->clearance(place(points, k), place(start, k));
    if (points.clear[k] < points.least[k]) return false;
  }
  return relocate(points, Metric::Even, target);
}

} // namespace iga::prep
