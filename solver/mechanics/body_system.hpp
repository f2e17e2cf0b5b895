// Several bodies as one system of equations: their nodes follow one another, their unknowns share one frame.
#pragma once

#include "solver/linalg/symmetric_matrix.hpp"
#include "solver/mechanics/material.hpp"

#include <memory>
#include <string>

namespace iga::solve {

/// One body of a system.
struct SystemBody {
  std::string name; ///< empty where the run has one body without a name
  std::shared_ptr<const SolutionSpace> space;
  ElasticMaterial material;
  std::int64_t first_node = 0; ///< its nodes are first_node … first_node + space->num_nodes() - 1 of the system

  Eigen::Index first_unknown() const { return 3 * first_node; }
};

/// Bodies in the order of the run file. Models must outlive their spaces.
class BodySystem {
 public:
  BodySystem() = default;
  /// One body without a name; `space` must outlive the system.
  BodySystem(const SolutionSpace& space, const ElasticMaterial& material);
  void add(std::string name, std::shared_ptr<const SolutionSpace> space, const ElasticMaterial& material);

  std::size_t size() const { return bodies_.size(); }
  const SystemBody& operator[](std::size_t b) const { return bodies_[b]; }
  auto begin() const { return bodies_.begin(); }
  auto end() const { return bodies_.end(); }
  std::int64_t num_nodes() const { return num_nodes_; }
  std::int64_t num_unknowns() const { return 3 * num_nodes_; }
  /// "body 'a': " to open messages; nothing where there is one body.
  std::string prefix(std::size_t b) const;

  /// Its name, nothing where there is one body.
  std::string name_among_several(std::size_t b) const { return size() == 1 ? "" : bodies_[b].name; }

  /// The unknowns of one body among those of all.
  template <class Vector> auto part(Vector&& all, std::size_t b) const {
    return all.segment(bodies_[b].first_unknown(), bodies_[b].space->num_unknowns());
  }
  /// Greville points of all nodes. (num_nodes × 3)
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> node_points() const;
  /// @param coupled  sets of nodes that ties couple (Connectivity)
  std::shared_ptr<const Connectivity> connectivity(std::span<const std::vector<std::int32_t>> coupled) const;

 private:
  std::vector<SystemBody> bodies_;
  std::int64_t num_nodes_ = 0;
};

} // namespace iga::solve
