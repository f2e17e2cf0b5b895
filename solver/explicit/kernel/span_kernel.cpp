// The kernel of explicit dynamics: deformation gradients, stresses and internal forces, eight points at a time.
#include "solver/base/parallel.hpp"
#include "solver/explicit/kernel/mean_volume.hpp"
#include "solver/explicit/kernel/point_stress.hpp"
#include "solver/explicit/kernel/span_contraction.hpp"
#include "solver/explicit/simd/lane_transpose.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for_each.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

/// Total Lagrangian internal forces of the spans of a body with one law. Memory per point: 32 B of place and weight
/// (less in tensors, nothing worth counting where all spans share one), the law's history, 72 B of F where the law asks
/// for it.
template <class Degrees> class SpanKernel final : public InternalForces {
 public:
  SpanKernel(const SolutionSpace& space, LawAccess law, const KernelOptions& options)
      : law_(std::move(law)), options_(options), grid_(space.model().grid), plan_(make_span_plan(space)),
        degrees_(plan_.degree), num_values_(3 * space.model().functions.number.size()),
        memory_(law_, options_, static_cast<std::size_t>(plan_.num_point_blocks())) {
    const Point3 h = grid_.span_size();
    length_ = std::min({h[0], h[1], h[2]});
    extremes_.resize(plan_.blocks.size());
    waiting_ = std::vector<std::atomic<std::int32_t>>(plan_.blocks.size());
    for (std::size_t b = 0; b < plan_.blocks.size(); ++b)
      if (plan_.num_before[b] == 0) first_blocks_.push_back(static_cast<std::int32_t>(b));
  }

  ForceReport evaluate(const double* u, double dt, double* f) override {
    for_chunks(num_values_, 1 << 13,
               [&](std::size_t, std::size_t first, std::size_t last) { std::fill(f + first, f + last, 0.0); });
    visit_blocks(u, dt, f);
    return report();
  }

  double reference_wave_speed() const override { return law_.wave_speed; }
  const SpanPlan& plan() const override { return plan_; }
  bool sees_mean_volume() const override { return options_.mean_volume; }

  void set_frequency_ratio(double kappa) override { kappa_ = kappa; }

  std::int64_t memory() const override {
    const auto bytes = [](const auto& v) { return v.size() * sizeof(v[0]); };
    std::size_t tensors = 0;
    for (const LaneTensor& t : plan_.tensors)
      tensors += bytes(t.weights) + bytes(t.t[0]) + bytes(t.t[1]) + bytes(t.t[2]);
    return static_cast<std::int64_t>(tensors + bytes(memory_.history) + bytes(memory_.F_old) + bytes(memory_.extra) +
                                     bytes(plan_.own_points) + bytes(plan_.groups) + bytes(plan_.point_spans) +
                                     bytes(plan_.rows) + bytes(plan_.point));
  }

  PointHistory save() const override { return memory_.save(); }
  void load(const PointHistory& saved) override { memory_.load(saved); }

 private:
  using Work = ContractionWork<Degrees>;

  // Each block as soon as those are done that it follows: nobody waits for the last block of a colour.
  void visit_blocks(const double* u, double dt, double* f) {
    if (plan_.blocks.size() == 1) return visit_block(0, u, dt, f);
    const ParallelTime::Section section;
    for (std::size_t b = 0; b < waiting_.size(); ++b) waiting_[b].store(plan_.num_before[b], std::memory_order_relaxed);
    tbb::parallel_for_each(first_blocks_.begin(), first_blocks_.end(),
                           [&](std::int32_t block, tbb::feeder<std::int32_t>& others) {
                             while (block >= 0) {
                               const auto b = static_cast<std::size_t>(block);
                               visit_block(b, u, dt, f);
                               block = -1; // goes on with one that has become free, leaves the rest to others
                               for (const std::int32_t next : plan_.followers[b]) {
                                 if (waiting_[static_cast<std::size_t>(next)].fetch_sub(1) > 1) continue;
                                 if (block < 0)
                                   block = next;
                                 else
                                   others.add(next);
                               }
                             }
                           });
  }

  std::size_t num_rows() const { return static_cast<std::size_t>((degrees_.v + 1) * (degrees_.w + 1)); }
  const std::int64_t* rows_of(std::int32_t span) const {
    return plan_.rows.data() + num_rows() * static_cast<std::size_t>(span);
  }

  void visit_block(std::size_t b, const double* u, double dt, double* f) {
    Work& work = work_.local();
    const WorkBlock& block = plan_.blocks[b];
    PointExtremes extremes;
    PointStress stress(law_, options_, grid_.rotation(), dt, length_, kappa_, memory_);
    for (auto g = block.groups[0]; g < block.groups[1]; ++g)
      visit_group(plan_.groups[static_cast<std::size_t>(g)], u, f, work, stress, extremes);
    for (auto s = block.point_spans[0]; s < block.point_spans[1]; ++s)
      visit_points(plan_.point_spans[static_cast<std::size_t>(s)], u, f, work, stress, extremes);
    extremes_[b] = extremes;
  }

  void visit_group(const SpanGroup& group, const double* u, double* f, Work& work, PointStress& stress,
                   PointExtremes& extremes) {
    const std::size_t size = static_cast<std::size_t>(3 * (degrees_.u + 1)) * num_rows();
    for (std::size_t l = 0; l < lanes; ++l) copy_rows(group.spans[l], u, work.scratch + l * Work::padded);
    for (std::size_t k = 0; k < size; k += lanes) {
      Wide block[lanes];
#pragma GCC unroll 8
      for (std::size_t l = 0; l < lanes; ++l) block[l] = load_wide(work.scratch + l * Work::padded + k);
      transpose(block);
#pragma GCC unroll 8
      for (std::size_t l = 0; l < lanes; ++l) work.u[k + l] = block[l];
    }
    if (group.tensor >= 0) {
      const LaneTensor& tensor = plan_.tensors[static_cast<std::size_t>(group.tensor)];
      Lanes counted{};
      for (std::size_t l = 0; l < static_cast<std::size_t>(group.count); ++l) counted[l] = 1;
      evaluate_tensor(degrees_, polynomials_of(group).of, tensor, group.tensor, work);
      if (options_.mean_volume) [[unlikely]]
        visit_means(tensor, counted, group.first_block, work, stress);
      else
        contract_tensor(degrees_, tensor.count, work, [&](int first, int count, TensorWide* points) {
          for (int q = 0; q < count; ++q)
            stress(group.first_block + first + q,
                   wide(counted) * wide(tensor.weights[static_cast<std::size_t>(first + q)]), points[q]);
        });
    } else if (options_.mean_volume) {
      visit_means(polynomials_of(group).of, own_points(group), work.u, false, group.first_block, work, stress);
    } else {
      contract_points(degrees_, polynomials_of(group).of, own_points(group), work.u, work,
                      [&](std::int64_t b, const OwnPoints& points, TensorWide& H) {
                        stress(group.first_block + b, wide(points.weight), H);
                      });
    }
    stress.finish(group.spans.data(), extremes);
    for (std::size_t k = 0; k < size; k += lanes) {
      Wide block[lanes];
#pragma GCC unroll 8
      for (std::size_t l = 0; l < lanes; ++l) block[l] = work.f[k + l];
      transpose(block);
#pragma GCC unroll 8
      for (std::size_t l = 0; l < lanes; ++l) store_wide(block[l], work.scratch + l * Work::padded + k);
    }
    for (std::size_t l = 0; l < static_cast<std::size_t>(group.count); ++l)
      add_rows(group.spans[l], work.scratch + l * Work::padded, f);
  }

  void visit_points(const PointSpan& span, const double* u, double* f, Work& work, PointStress& stress,
                    PointExtremes& extremes) {
    const std::size_t size = static_cast<std::size_t>(3 * (degrees_.u + 1)) * num_rows();
    copy_rows(span.span, u, work.scratch);
    if (options_.mean_volume)
      visit_means(polynomials_of(span).of, own_points(span), work.scratch, true, span.first_block, work, stress);
    else
      contract_points(degrees_, polynomials_of(span).of, own_points(span), work.scratch, work,
                      [&](std::int64_t b, const OwnPoints& points, TensorWide& H) {
                        stress(span.first_block + b, wide(points.weight), H);
                      });
    std::array<std::int32_t, lanes> owner;
    owner.fill(span.span);
    stress.finish(owner.data(), extremes);
    for (std::size_t k = 0; k < size; k += lanes) {
      Wide block[lanes];
#pragma GCC unroll 8
      for (std::size_t l = 0; l < lanes; ++l) block[l] = work.f[k + l];
      store_wide(lane_sums(block), work.scratch + k);
    }
    add_rows(span.span, work.scratch, f);
  }

  // F-bar of eight spans whose points are one tensor: gradients of all points, then the law, then forces.
  [[gnu::noinline]] void visit_means(const LaneTensor& tensor, const Lanes& counted, std::int64_t first_block,
                                     Work& work, PointStress& stress) {
    MeanVolumeLanes& means = work.means;
    const auto weight = [&](std::size_t q) { return tensor.weights[q]; };
    means.start(static_cast<std::size_t>(tensor.size()), false);
    contract_tensor<Sweep::Gradients>(degrees_, tensor.count, work, [&](int first, int count, TensorWide* points) {
      for (int q = 0; q < count; ++q) {
        const auto b = static_cast<std::size_t>(first + q);
        add_to(means, b, weight(b), points[q], stress);
      }
    });
    evaluate_means(means, static_cast<std::size_t>(tensor.size()), first_block, counted, weight, stress);
    contract_tensor<Sweep::Forces>(degrees_, tensor.count, work, [&](int first, int count, TensorWide* points) {
      for (int q = 0; q < count; ++q) {
        const auto b = static_cast<std::size_t>(first + q);
        stress.to_grid_axes(wide(counted) * wide(weight(b)), means.stress(b), points[q]);
      }
    });
  }

  // The same of points of their own, of eight spans or of one.
  template <class Coefficient>
  [[gnu::noinline]] void visit_means(const SpanPolynomials* const (&polynomials)[3], std::span<const OwnPoints> points,
                                     const Coefficient* u, bool one_cell, std::int64_t first_block, Work& work,
                                     PointStress& stress) {
    MeanVolumeLanes& means = work.means;
    const auto weight = [&](std::size_t b) { return points[b].weight; };
    means.start(points.size(), one_cell);
    contract_points<Sweep::Gradients>(degrees_, polynomials, points, u, work,
                                      [&](std::int64_t b, const OwnPoints& own, TensorWide& H) {
                                        add_to(means, static_cast<std::size_t>(b), own.weight, H, stress);
                                      });
    evaluate_means(means, points.size(), first_block, Lanes{} + 1.0, weight, stress);
    contract_points<Sweep::Forces>(
        degrees_, polynomials, points, u, work, [&](std::int64_t b, const OwnPoints& own, TensorWide& H) {
          stress.to_grid_axes(wide(own.weight), means.stress(static_cast<std::size_t>(b)), H);
        });
  }

  static void add_to(MeanVolumeLanes& means, std::size_t b, const Lanes& weight, TensorWide& H,
                     const PointStress& stress) {
    stress.to_deformation(H);
    TensorLanes F;
    for (int k = 0; k < 9; ++k) store(F.c[k], H.c[k]);
    means.add(b, weight, F);
  }

  template <class Weight>
  static void evaluate_means(MeanVolumeLanes& means, std::size_t blocks, std::int64_t first_block, const Lanes& counted,
                             const Weight& weight, PointStress& stress) {
    means.find_means();
    for (std::size_t b = 0; b < blocks; ++b) {
      TensorLanes P;
      const TensorLanes F = means.scaled(b);
      stress.evaluate_scaled(first_block + static_cast<std::int64_t>(b), wide(counted) * wide(weight(b)), F,
                             means.scale(b), means.J(b), P);
      means.take(b, weight(b), P);
    }
    means.find_mean_stress();
  }

  struct DirectionPolynomials {
    const SpanPolynomials* const of[3];
  };
  template <class Spans> DirectionPolynomials polynomials_of(const Spans& spans) const {
    const SpanPolynomials* const list = plan_.polynomials.data();
    return {{list + spans.polynomials[0], list + spans.polynomials[1], list + spans.polynomials[2]}};
  }
  template <class Spans> std::span<const OwnPoints> own_points(const Spans& spans) const {
    return std::span(plan_.own_points)
        .subspan(static_cast<std::size_t>(spans.first_own), static_cast<std::size_t>(spans.blocks));
  }

  // Coefficients of a span, row after row; in whole registers.
  [[gnu::always_inline]] void copy_rows(std::int32_t span, const double* u, double* to) const {
    const auto line = static_cast<std::size_t>(3 * (degrees_.u + 1));
    const std::int64_t* rows = rows_of(span);
    if (rows[0] < 0) return copy_functions(rows[0], u, to);
    for (std::size_t r = 0; r < num_rows(); ++r, to += line) {
      const double* from = u + 3 * rows[r];
      std::size_t k = 0;
      for (; k + lanes <= line; k += lanes) store_wide(load_wide(from + k), to + k);
      for (; k < line; ++k) to[k] = from[k];
    }
  }
  [[gnu::always_inline]] void add_rows(std::int32_t span, const double* from, double* f) const {
    const auto line = static_cast<std::size_t>(3 * (degrees_.u + 1));
    const std::int64_t* rows = rows_of(span);
    if (rows[0] < 0) return add_functions(rows[0], from, f);
    for (std::size_t r = 0; r < num_rows(); ++r, from += line) {
      double* to = f + 3 * rows[r];
      std::size_t k = 0;
      for (; k + lanes <= line; k += lanes) store_wide(load_wide(to + k) + load_wide(from + k), to + k);
      for (; k < line; ++k) to[k] += from[k];
    }
  }

  // The same one function at a time, where a cell sees copies.
  std::span<const std::int32_t> functions_of(std::int64_t first_row) const {
    const auto local = static_cast<std::size_t>(degrees_.u + 1) * num_rows();
    return std::span(plan_.functions).subspan(local * static_cast<std::size_t>(-1 - first_row), local);
  }
  [[gnu::noinline]] void copy_functions(std::int64_t first_row, const double* u, double* to) const {
    for (const std::int32_t function : functions_of(first_row))
      for (std::ptrdiff_t d = 0; d < 3; ++d) *to++ = u[3 * std::ptrdiff_t{function} + d];
  }
  [[gnu::noinline]] void add_functions(std::int64_t first_row, const double* from, double* f) const {
    for (const std::int32_t function : functions_of(first_row))
      for (std::ptrdiff_t d = 0; d < 3; ++d) f[3 * std::ptrdiff_t{function} + d] += *from++;
  }

  ForceReport report() const {
    PointExtremes all;
    for (const PointExtremes& part : extremes_) all.add(part);
    // A body whose points are all eroded has no stiffness that a step could be too long for, and no volume.
    const bool works = all.J_span >= 0;
    return {works ? law_.wave_speed / std::sqrt(all.speed_squared) : 1,
            all.speed_span,
            works ? all.min_J : 0,
            all.J_span,
            all.viscous_power,
            all.inverted,
            all.inverted_span,
            all.eroded,
            all.eroded_energy};
  }

  LawAccess law_;
  KernelOptions options_;
  SplineGrid grid_;
  SpanPlan plan_;
  Degrees degrees_;
  std::size_t num_values_;
  double length_ = 0, kappa_ = 1;
  PointMemory memory_;
  std::vector<PointExtremes> extremes_;
  std::vector<std::int32_t> first_blocks_;         ///< that follow none
  std::vector<std::atomic<std::int32_t>> waiting_; ///< per block: how many of those before it are not done yet
  tbb::enumerable_thread_specific<Work> work_;
};

} // namespace

std::unique_ptr<InternalForces> make_internal_forces(const SolutionSpace& space, const Law& law,
                                                     const KernelOptions& options) {
  LawAccess own = std::visit([](const auto& l) { return access(l); }, law);
  const auto p = space.model().grid.degree();
  if (p[0] != p[1] || p[1] != p[2]) return std::make_unique<SpanKernel<AnyDegrees>>(space, std::move(own), options);
  switch (p[0]) {
  case 1:
    return std::make_unique<SpanKernel<EqualDegrees<1>>>(space, std::move(own), options);
  case 2:
    return std::make_unique<SpanKernel<EqualDegrees<2>>>(space, std::move(own), options);
  case 3:
    return std::make_unique<SpanKernel<EqualDegrees<3>>>(space, std::move(own), options);
  default:
    return std::make_unique<SpanKernel<EqualDegrees<4>>>(space, std::move(own), options);
  }
}

} // namespace iga::solve
