// The kernel of explicit dynamics: deformation gradients, stresses and internal forces, eight points at a time.
#pragma once

#include "format/model/errors.hpp"
#include "solver/explicit/internal_forces.hpp"
#include "solver/explicit/lane_transpose.hpp"
#include "solver/explicit/law.hpp"
#include "solver/explicit/span_contraction.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace detail {

inline Lanes square_root(const Lanes& x) {
  Lanes y;
  for (std::size_t l = 0; l < lanes; ++l) y[l] = std::sqrt(x[l]);
  return y;
}

/// Extremes and sums over the points of a block of spans.
struct PointExtremes {
  double speed_squared = 0; ///< largest c² (√(1 + ξ²) + ξ)²
  double min_J = std::numeric_limits<double>::infinity();
  double viscous_power = 0;
  std::int64_t inverted = 0;
  std::int32_t speed_span = -1, J_span = -1, inverted_span = -1;
};

/// Stress of eight points from their displacement gradients; their history, and the extremes over one unit of work.
template <class Law> class PointStress {
 public:
  PointStress(const Law& law, const Rotation& R, double dt, double length, Lanes* history, Lanes* F_old)
      : law_(law), R_(R), rotated_(R != identity_rotation), history_(history), F_old_(F_old) {
    in_.dt = dt;
    in_.length = length;
  }

  /// @param H  gradient with respect to the grid's axes; taken over by w P in the same axes
  [[gnu::always_inline]] void operator()(std::int64_t block, const Lanes& weight, TensorLanes& H) {
    TensorLanes& F = in_.F;
    if (rotated_) {
      for (int a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          F(a, static_cast<int>(b)) = H(a, 0) * R_[b][0] + H(a, 1) * R_[b][1] + H(a, 2) * R_[b][2];
    } else {
      F = H;
    }
    for (int a = 0; a < 3; ++a) F(a, a) += 1.0;
    if constexpr (Law::needs_old_F)
      for (int k = 0; k < 9; ++k) {
        in_.F_old.c[k] = F_old_[9 * block + k];
        F_old_[9 * block + k] = F.c[k];
      }
    TensorLanes P;
    LawOutput out;
    law_.stress(in_, history_ + Law::history * block, P, out);
    if (rotated_) {
      for (int a = 0; a < 3; ++a)
        for (std::size_t m = 0; m < 3; ++m)
          H(a, static_cast<int>(m)) = (P(a, 0) * R_[0][m] + P(a, 1) * R_[1][m] + P(a, 2) * R_[2][m]) * weight;
    } else {
      for (int k = 0; k < 9; ++k) H.c[k] = P.c[k] * weight;
    }
    const Lanes& xi = out.damping_ratio;
    const Lanes root = square_root(1 + xi * xi) + xi;
    const Lanes speed = out.wave_speed_squared * root * root;
    speed_ = speed > speed_ ? speed : speed_;
    J_ = out.J < J_ ? out.J : J_;
    viscous_ += weight * out.viscous_power;
    const LaneMask counted = weight > 0;
    inverted_ -= out.inverted & counted;
  }

  /// Ends a unit of work: spans[l] owns lane l.
  void finish(const std::int32_t* spans, PointExtremes& extremes) {
    for (std::size_t l = 0; l < lanes; ++l) {
      if (speed_[l] > extremes.speed_squared) {
        extremes.speed_squared = speed_[l];
        extremes.speed_span = spans[l];
      }
      if (J_[l] < extremes.min_J) {
        extremes.min_J = J_[l];
        extremes.J_span = spans[l];
      }
      if (inverted_[l] > 0 && extremes.inverted_span < 0) extremes.inverted_span = spans[l];
      extremes.inverted += inverted_[l];
    }
    extremes.viscous_power += sum(viscous_);
    speed_ = viscous_ = Lanes{};
    J_ = Lanes{} + std::numeric_limits<double>::infinity();
    inverted_ = LaneMask{};
  }

 private:
  const Law& law_;
  const Rotation R_;
  const bool rotated_;
  LawInput in_;
  Lanes *history_, *F_old_;
  Lanes speed_{}, viscous_{}, J_ = Lanes{} + std::numeric_limits<double>::infinity();
  LaneMask inverted_{};
};

} // namespace detail

/// Total Lagrangian internal forces of the spans of a body with one law. Memory per point: 32 B of place and weight in
/// trimmed spans (none in interior ones), the law's history, 72 B of F where the law asks for it.
template <class Law, class Degrees> class SpanKernel final : public InternalForces {
 public:
  SpanKernel(const SolutionSpace& space, const Law& law)
      : law_(law), grid_(space.model().grid), plan_(make_span_plan(space)), degrees_(plan_.degree),
        num_values_(3 * space.model().active_functions.size()) {
    const Point3 h = grid_.span_size();
    length_ = std::min({h[0], h[1], h[2]});
    const auto blocks = static_cast<std::size_t>(plan_.num_point_blocks());
    history_.resize(static_cast<std::size_t>(Law::history) * blocks);
    if constexpr (Law::history > 0)
      for (std::size_t b = 0; b < blocks; ++b) law_.start(history_.data() + static_cast<std::size_t>(Law::history) * b);
    if constexpr (Law::needs_old_F) {
      F_old_.resize(9 * blocks);
      for (std::size_t k = 0; k < F_old_.size(); ++k) F_old_[k] = Lanes{} + (k % 9 % 4 == 0 ? 1.0 : 0.0);
    }
    extremes_.resize(plan_.blocks.size());
  }

  ForceReport evaluate(const double* u, double dt, double* f) override {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, num_values_, 1 << 14),
                      [&](const auto& range) { std::fill(f + range.begin(), f + range.end(), 0.0); });
    for (std::size_t c = 0; c + 1 < plan_.colour_offsets.size(); ++c)
      tbb::parallel_for(
          tbb::blocked_range<std::int64_t>(plan_.colour_offsets[c], plan_.colour_offsets[c + 1], 1),
          [&](const auto& range) {
            for (std::int64_t b = range.begin(); b < range.end(); ++b)
              visit_block(static_cast<std::size_t>(b), u, dt, f);
          },
          tbb::simple_partitioner());
    return report();
  }

  double reference_wave_speed() const override { return law_.reference_wave_speed(); }
  const SpanPlan& plan() const override { return plan_; }

  std::int64_t memory() const override {
    const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
    return static_cast<std::int64_t>(bytes(history_) + bytes(F_old_) + bytes(plan_.own_points) + bytes(plan_.groups) +
                                     bytes(plan_.point_spans) + bytes(plan_.rows) + bytes(plan_.point));
  }

  PointHistory save() const override {
    PointHistory saved;
    const auto copy = [](const std::vector<Lanes>& from, std::vector<double>& to) {
      to.resize(lanes * from.size());
      for (std::size_t k = 0; k < from.size(); ++k) store_lanes(from[k], to.data() + lanes * k);
    };
    copy(history_, saved.history);
    copy(F_old_, saved.F_old);
    return saved;
  }

  void load(const PointHistory& saved) override {
    const auto copy = [](const std::vector<double>& from, std::vector<Lanes>& to) {
      if (from.size() != lanes * to.size())
        throw InputError("the saved state of the points has another size than the model and its material ask for; "
                         "restart with the files that the run began with");
      for (std::size_t k = 0; k < to.size(); ++k) to[k] = load_lanes(from.data() + lanes * k);
    };
    copy(saved.history, history_);
    copy(saved.F_old, F_old_);
  }

 private:
  using Work = ContractionWork<Degrees>;

  std::size_t num_rows() const { return static_cast<std::size_t>((degrees_.v + 1) * (degrees_.w + 1)); }
  const std::int64_t* rows_of(std::int32_t span) const {
    return plan_.rows.data() + num_rows() * static_cast<std::size_t>(span);
  }

  void visit_block(std::size_t b, const double* u, double dt, double* f) {
    Work& work = work_.local();
    const WorkBlock& block = plan_.blocks[b];
    detail::PointExtremes extremes;
    detail::PointStress<Law> stress(law_, grid_.rotation(), dt, length_, history_.data(), F_old_.data());
    for (auto g = block.groups[0]; g < block.groups[1]; ++g)
      visit_group(plan_.groups[static_cast<std::size_t>(g)], u, f, work, stress, extremes);
    for (auto s = block.point_spans[0]; s < block.point_spans[1]; ++s)
      visit_points(plan_.point_spans[static_cast<std::size_t>(s)], u, f, work, stress, extremes);
    extremes_[b] = extremes;
  }

  void visit_group(const SpanGroup& group, const double* u, double* f, Work& work, detail::PointStress<Law>& stress,
                   detail::PointExtremes& extremes) {
    const auto line = static_cast<std::size_t>(3 * (degrees_.u + 1));
    const std::size_t size = line * num_rows();
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::int64_t* rows = rows_of(group.spans[l]);
      double* to = work.scratch + l * Work::padded;
      for (std::size_t r = 0; r < num_rows(); ++r) std::copy_n(u + 3 * rows[r], line, to + r * line);
    }
    for (std::size_t k = 0; k < size; k += lanes) {
      Lanes block[lanes];
      for (std::size_t l = 0; l < lanes; ++l) block[l] = load_lanes(work.scratch + l * Work::padded + k);
      transpose(block);
      for (std::size_t l = 0; l < lanes; ++l) work.u[k + l] = block[l];
    }
    Lanes counted{};
    for (std::size_t l = 0; l < static_cast<std::size_t>(group.count); ++l) counted[l] = 1;
    const TensorTable& table = plan_.tables[static_cast<std::size_t>(group.table)];
    contract_table(degrees_, table, work, [&](int first, int count, TensorLanes* points) {
      for (int q = 0; q < count; ++q)
        stress(group.first_block + first + q, counted * table.weights[static_cast<std::size_t>(first + q)], points[q]);
    });
    stress.finish(group.spans.data(), extremes);
    for (std::size_t k = 0; k < size; k += lanes) {
      Lanes block[lanes];
      for (std::size_t l = 0; l < lanes; ++l) block[l] = work.f[k + l];
      transpose(block);
      for (std::size_t l = 0; l < lanes; ++l) store_lanes(block[l], work.scratch + l * Work::padded + k);
    }
    for (std::size_t l = 0; l < static_cast<std::size_t>(group.count); ++l)
      add_rows(group.spans[l], work.scratch + l * Work::padded, f);
  }

  void visit_points(const PointSpan& span, const double* u, double* f, Work& work, detail::PointStress<Law>& stress,
                    detail::PointExtremes& extremes) {
    const auto line = static_cast<std::size_t>(3 * (degrees_.u + 1));
    const std::size_t size = line * num_rows();
    const std::int64_t* rows = rows_of(span.span);
    for (std::size_t r = 0; r < num_rows(); ++r) std::copy_n(u + 3 * rows[r], line, work.scratch + r * line);
    const SpanPolynomials* const polynomials[3] = {polynomials_of(span, 0), polynomials_of(span, 1),
                                                   polynomials_of(span, 2)};
    const auto own = std::span(plan_.own_points)
                         .subspan(static_cast<std::size_t>(span.first_own), static_cast<std::size_t>(span.blocks));
    contract_points(degrees_, polynomials, own, work.scratch, work,
                    [&](std::int64_t b, const OwnPoints& points, TensorLanes& H) {
                      stress(span.first_block + b, points.weight, H);
                    });
    std::array<std::int32_t, lanes> owner;
    owner.fill(span.span);
    stress.finish(owner.data(), extremes);
    for (std::size_t k = 0; k < size; k += lanes) {
      Lanes block[lanes];
      for (std::size_t l = 0; l < lanes; ++l) block[l] = work.f[k + l];
      store_lanes(lane_sums(block), work.scratch + k);
    }
    add_rows(span.span, work.scratch, f);
  }

  const SpanPolynomials* polynomials_of(const PointSpan& span, std::size_t d) const {
    return &plan_.polynomials[static_cast<std::size_t>(span.polynomials[d])];
  }

  [[gnu::always_inline]] void add_rows(std::int32_t span, const double* from, double* f) const {
    const auto line = static_cast<std::size_t>(3 * (degrees_.u + 1));
    const std::int64_t* rows = rows_of(span);
    for (std::size_t r = 0; r < num_rows(); ++r) {
      double* to = f + 3 * rows[r];
      for (std::size_t k = 0; k < line; ++k) to[k] += from[r * line + k];
    }
  }

  ForceReport report() const {
    detail::PointExtremes all;
    for (const detail::PointExtremes& part : extremes_) {
      if (part.speed_squared > all.speed_squared) {
        all.speed_squared = part.speed_squared;
        all.speed_span = part.speed_span;
      }
      if (part.min_J < all.min_J) {
        all.min_J = part.min_J;
        all.J_span = part.J_span;
      }
      if (part.inverted_span >= 0 && all.inverted_span < 0) all.inverted_span = part.inverted_span;
      all.inverted += part.inverted;
      all.viscous_power += part.viscous_power;
    }
    return {law_.reference_wave_speed() / std::sqrt(all.speed_squared),
            all.speed_span,
            all.min_J,
            all.J_span,
            all.viscous_power,
            all.inverted,
            all.inverted_span};
  }

  Law law_;
  SplineGrid grid_;
  SpanPlan plan_;
  Degrees degrees_;
  std::size_t num_values_;
  double length_ = 0;
  std::vector<Lanes> history_; // (blocks × Law::history)
  std::vector<Lanes> F_old_;   // (blocks × 9)
  std::vector<detail::PointExtremes> extremes_;
  tbb::enumerable_thread_specific<Work> work_;
};

/// The kernel of a law for the degrees of a model. The space (its model) must outlive it.
template <class Law> std::unique_ptr<InternalForces> make_internal_forces(const SolutionSpace& space, const Law& law) {
  const auto p = space.model().grid.degree();
  if (p[0] != p[1] || p[1] != p[2]) return std::make_unique<SpanKernel<Law, AnyDegrees>>(space, law);
  switch (p[0]) {
  case 1:
    return std::make_unique<SpanKernel<Law, EqualDegrees<1>>>(space, law);
  case 2:
    return std::make_unique<SpanKernel<Law, EqualDegrees<2>>>(space, law);
  case 3:
    return std::make_unique<SpanKernel<Law, EqualDegrees<3>>>(space, law);
  default:
    return std::make_unique<SpanKernel<Law, EqualDegrees<4>>>(space, law);
  }
}

} // namespace iga::solve
