#include "solver/nonlinear/tool_shape.hpp"

#include "solver/base/closest_point.hpp"
#include "solver/base/eigen_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace iga::solve {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Edges and corners between faces whose normals agree to this much are none.
constexpr double flat = 1e-9;

Matrix3d across(const Vector3d& n) {
  return Matrix3d::Identity() - n * n.transpose();
}

} // namespace

ToolShape::ToolShape(const RigidShape& shape, double span_size) {
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
    mesh_ = std::make_unique<const MovingSurface>(*mesh, 0, span_size);
    std::vector<Box3> boxes;
    for (const Triangle& t : mesh_->mesh().triangles)
      boxes.push_back(bounding_box(std::array{mesh_->x(t[0]), mesh_->x(t[1]), mesh_->x(t[2])}));
    faces_ = Bvh(boxes);
  } else {
    closed_form_ = shape;
  }
}

ToolGap ToolShape::at(const Vector3d& x) const {
  if (mesh_) return at_mesh(x);
  const ShapeDistance distance = distance_to_shape(closed_form_, as_point(x));
  ToolGap found{distance.gap, as_vector(distance.normal), Matrix3d::Zero()};
  if (std::holds_alternative<SphereShape>(closed_form_)) {
    const double r = x.norm();
    if (r > 0) found.bend = found.gap / r * across(found.normal);
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&closed_form_)) {
    const Vector3d axis = as_vector(cylinder->axis);
    const double r = (x - axis * axis.dot(x)).norm();
    const bool on_side = std::abs(axis.dot(found.normal)) < flat;
    if (on_side && r > 0) found.bend = found.gap / r * (across(found.normal) - axis * axis.transpose());
  }
  return found;
}

bool ToolShape::is_flat(std::int32_t face, int feature) const {
  const ContactMesh& mesh = mesh_->mesh();
  const auto at = [](auto i) { return static_cast<std::size_t>(i); };
  const Vector3d n = as_vector(mesh.face_normal[at(face)]);
  const auto agrees = [&](std::int32_t other) { return n.dot(as_vector(mesh.face_normal[at(other)])) > 1 - flat; };
  if (feature <= 3) {
    const std::int32_t other = mesh.neighbour[at(face)][at(feature - 1)];
    return other < 0 || agrees(other);
  }
  const auto around = mesh.faces_of(mesh.triangles[at(face)][at(feature - 4)]);
  return std::all_of(around.begin(), around.end(), agrees);
}

ToolGap ToolShape::at_mesh(const Vector3d& x) const {
  const ContactMesh& mesh = mesh_->mesh();
  ClosestOnTriangle nearest;
  nearest.distance2 = std::numeric_limits<double>::infinity();
  std::int32_t face = 0;
  faces_.least_distance2(as_point(x), [&](std::int32_t item) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(item)];
    const ClosestOnTriangle found = closest_on_triangle(as_point(x), mesh_->x(t[0]), mesh_->x(t[1]), mesh_->x(t[2]));
    if (found.distance2 < nearest.distance2) {
      nearest = found;
      face = item;
    }
    return found.distance2;
  });
  const Vector3d way = x - as_vector(nearest.position);
  const int feature = nearest.feature > 0 && is_flat(face, nearest.feature) ? 0 : nearest.feature;
  const Vector3d outside = as_vector(mesh_->pseudo_normal(face, feature)).normalized();
  const double distance = way.norm();
  if (feature == 0) return {way.dot(outside), outside, Matrix3d::Zero()};
  const double gap = way.dot(outside) < 0 ? -distance : distance;
  constexpr double tiny = 1e-12; // of the tool's coordinates: the direction of so short a way is noise
  const Vector3d n = distance > tiny * (1 + x.norm()) ? Vector3d(way / gap) : outside;
  Matrix3d bend = across(n);
  if (feature <= 3) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(face)];
    const auto corner = [&](int k) { return as_vector(mesh_->x(t[static_cast<std::size_t>(k % 3)])); };
    const Vector3d edge = (corner(feature) - corner(feature - 1)).normalized();
    bend -= edge * edge.transpose();
  }
  return {gap, n, bend};
}

} // namespace iga::solve
