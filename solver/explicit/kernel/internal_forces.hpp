// Internal forces of one body: what the time integration sees of span kernel and material law.
#pragma once

#include "solver/explicit/kernel/span_plan.hpp"
#include "solver/explicit/laws/laws.hpp"

#include <memory>

namespace iga::solve {

/// What the kernel does besides asking the law.
struct KernelOptions {
  bool erode_inverted = false; ///< points that invert are taken out for good
  double erosion_J = 0;        ///< so are those whose det F falls below this; 0: none
  bool mean_volume = false;    ///< F-bar: the law sees one volume ratio per cell

  bool erodes() const { return erode_inverted || erosion_J > 0; }
};

/// What one evaluation found besides the forces. Spans are active spans, -1 for none. All numbers are the same for any
/// number of threads.
struct ForceReport {
  /// The time step of the undeformed body may be used times this: min over points of c_0 / c, the reduction by viscous
  /// stress included; c from the law's tangent in the metric of the reference.
  double step_factor = 1;
  std::int32_t step_span = -1;
  double min_J = 1; ///< smallest det F of the points that are left; 0 where all are eroded
  std::int32_t min_J_span = -1;
  double viscous_power = 0;        ///< of damping stresses, energy/time
  std::int64_t inverted = 0;       ///< points whose law was not evaluated at their own J
  std::int32_t inverted_span = -1; ///< the first of them
  std::int64_t eroded = 0;         ///< points taken out in this evaluation
  double eroded_energy = 0;        ///< that they held
};

/// All that the points remember, as plain numbers: enough to go on bit for bit.
struct PointHistory {
  std::vector<double> history; ///< (blocks × history of the law × 8)
  std::vector<double> F_old;   ///< (blocks × 9 × 8), or empty
  std::vector<double> extra;   ///< of erosion; or empty
};

class InternalForces {
 public:
  virtual ~InternalForces() = default;
  /// f = f_int(u), and the points' history moves on by dt. u and f: (3 n_f) over the model's active functions,
  /// component fastest, in the part's frame; f_int opposes the deformation it comes from (M a = f_ext - f_int).
  /// @param dt  since the last evaluation; 0 in the first one
  virtual ForceReport evaluate(const double* u, double dt, double* f) = 0;
  /// Speed of the fastest wave in the undeformed body.
  virtual double reference_wave_speed() const = 0;
  /// κ = ω_max length / (2 c) of the undeformed body, 1 at first: what viscous stress costs in the time step depends on
  /// it, see LawOutput::damping_ratio.
  virtual void set_frequency_ratio(double kappa) = 0;
  virtual const SpanPlan& plan() const = 0;
  virtual bool sees_mean_volume() const = 0; ///< KernelOptions::mean_volume
  /// Memory of points, tables and plan, bytes.
  virtual std::int64_t memory() const = 0;
  virtual PointHistory save() const = 0;
  /// @throws InputError where it is not that of this body
  virtual void load(const PointHistory& history) = 0;
};

/// The kernel of a law for the degrees of a model; the model must outlive it.
std::unique_ptr<InternalForces> make_internal_forces(const SolutionSpace& space, const Law& law,
                                                     const KernelOptions& options = {});

} // namespace iga::solve
