// A triangulated side of contact in motion: the surface of a deformable body or a rigid tool.
#pragma once

#include "solver/base/bvh.hpp"
#include "solver/explicit/contact/contact_mesh.hpp"
#include "solver/explicit/contact/contact_surface.hpp"
#include "solver/explicit/contact/rigid_body.hpp"

namespace iga::solve {

class MovingSurface {
 public:
  MovingSurface(ContactSurface surface, std::size_t body);
  /// @param reach  how far thickness is looked for, length
  MovingSurface(const MeshShape& shape, std::size_t rigid, double reach);

  bool is_rigid() const { return rigid_; }
  std::size_t owner() const { return owner_; } ///< number of the deformable or rigid body
  const ContactMesh& mesh() const { return mesh_; }
  const std::vector<std::int32_t>& region() const { return region_; }
  const std::vector<std::string>& region_names() const { return region_names_; }
  const std::string& name() const { return name_; }
  double span_size() const { return span_size_; }
  double density() const { return density_; }
  /// Rows S_v of the vertices and their transpose; no rows for a tool.
  const SparseRows& rows() const { return rows_; }
  const SparseRows& columns() const { return columns_; }
  /// Columns of the active vertices alone.
  const SparseRows& active_columns() const { return active_columns_; }
  /// Σ_i |S_vi|: 1 without extension.
  double weight_sum(std::int32_t v) const { return weight_sum_[static_cast<std::size_t>(v)]; }
  /// Largest weight_sum of the vertices that hang on a node; (num_nodes).
  double reach_of_node(std::int32_t i) const { return node_reach_[static_cast<std::size_t>(i)]; }
  /// Nodes that move the surface, ascending.
  const std::vector<std::int32_t>& nodes() const { return nodes_; }

  /// Which vertices are kept up to date, and the nodes they hang on.
  void activate(std::vector<std::uint8_t> is_active);
  const std::vector<std::int32_t>& active() const { return active_; }
  const std::vector<std::int32_t>& active_nodes() const { return active_nodes_; }

  /// Positions of the active vertices, or of all. Parallel.
  void move_active(const BodyState& state);
  void move_all(const BodyState& state);
  void move_active(const RigidState& state);
  void move_all(const RigidState& state);

  const Point3& x(std::int32_t v) const { return x_[static_cast<std::size_t>(v)]; }
  const std::vector<Point3>& positions() const { return x_; }
  /// Of an active vertex of a deformable body at the last move_active, where that had a velocity.
  const Point3& v(std::int32_t vertex) const { return v_[static_cast<std::size_t>(vertex)]; }
  /// Unit normal at the last move_active of a face whose corners are active; zero where it has no area.
  const Point3& unit_normal(std::int32_t face) const { return unit_normal_[static_cast<std::size_t>(face)]; }
  /// Twice the area times the normal, where the corners are up to date.
  Point3 normal_now(std::int32_t face) const;
  /// Direction that tells outside from inside at a feature of a face (closest_on_triangle): Bærentzen & Aanæs (2005).
  Point3 pseudo_normal(std::int32_t face, int feature) const;

 private:
  bool rigid_ = false;
  std::size_t owner_ = 0;
  std::string name_;
  ContactMesh mesh_;
  std::vector<std::int32_t> region_;
  std::vector<std::string> region_names_;
  double span_size_ = 0, density_ = 0;
  SparseRows rows_, columns_, active_columns_;
  std::vector<double> weight_sum_, node_reach_;
  void find_normals();

  std::vector<std::int32_t> nodes_, active_, active_nodes_, active_faces_;
  std::vector<Point3> x_, v_, unit_normal_;
};

} // namespace iga::solve
