// Loads of one body that change with time: dead loads by a factor, pressure that follows the deformed surface.
#pragma once

#include "solver/explicit/motion/force_source.hpp"
#include "solver/explicit/motion/time_curve.hpp"
#include "solver/mechanics/loads.hpp"

namespace iga::solve {

struct TimedLoad {
  Load load;
  TimeCurve factor{1.0}; ///< on the load's vector or pressure
  /// Pressure only: it acts on the deformed surface along its normal, t dA = -p J F⁻ᵀ N dA. Otherwise on the reference
  /// surface along its normal there.
  bool follows = false;
};

class TimedLoads : public LoadSource {
 public:
  /// @param space  of the body-th body; must outlive the loads
  /// @throws InputError as assemble_loads, and for a load other than a pressure that is to follow
  TimedLoads(const SolutionSpace& space, std::size_t body, double density, const std::vector<TimedLoad>& loads);

  void add_forces(const StepTimes& times, std::span<const BodyState> bodies) override;
  /// Regions and resultants at factor 1 on the undeformed body.
  const std::vector<LoadReport>& reports() const { return reports_; }

 private:
  struct Dead {
    TimeCurve factor;
    Eigen::VectorXd force;
  };
  struct Follower {
    TimeCurve factor;
    double pressure = 0;
    SurfaceRegion region;
    std::vector<PointBatch> batches; ///< per span of the region
    std::vector<SpanShapes> shapes;
  };
  void add_follower(const Follower& load, double pressure, const BodyState& state) const;

  const SolutionSpace* space_;
  std::size_t body_;
  std::vector<Dead> dead_;
  std::vector<Follower> followers_;
  std::vector<LoadReport> reports_;
};

} // namespace iga::solve
