// Distance to a rigid tool with the derivative of its normal: what Newton's method asks of a contact.
#pragma once

#include "solver/base/bvh.hpp"
#include "solver/explicit/contact/moving_surface.hpp"

#include <Eigen/Core>

#include <memory>

namespace iga::solve {

struct ToolGap {
  double gap = 0;                                    ///< signed, positive outside, length
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(); ///< outward unit normal of the tool at its nearest point: ∂gap/∂x
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();    ///< gap · ∂normal/∂x, finite where the gap closes
};

/// A shape of explicit runs, in its own frame.
class ToolShape {
 public:
  /// @param span_size  of the part, length
  ToolShape(const RigidShape& shape, double span_size);
  ToolGap at(const Eigen::Vector3d& x) const;
  /// Has it no far side that a point could come out of?
  bool is_half_space() const { return std::holds_alternative<PlaneShape>(closed_form_) && !mesh_; }

 private:
  ToolGap at_mesh(const Eigen::Vector3d& x) const;
  bool is_flat(std::int32_t face, int feature) const;

  RigidShape closed_form_; ///< any where there is a mesh
  std::unique_ptr<const MovingSurface> mesh_;
  Bvh faces_;
};

} // namespace iga::solve
