// Points of the model as Eigen's vectors, and back.
#pragma once

#include "format/model/types.hpp"

#include <Eigen/Core>

namespace iga::solve {

inline Eigen::Vector3d as_vector(const Point3& x) {
  return {x[0], x[1], x[2]};
}

inline Point3 as_point(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

} // namespace iga::solve
