#include "solver/explicit/contact/moving_surface.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"
#include "solver/explicit/contact/row_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace iga::solve {

namespace {

// Vertices per task: a few microseconds of work.
constexpr std::size_t grain = 128;

} // namespace

MovingSurface::MovingSurface(ContactSurface surface, std::size_t body)
    : owner_(body), name_(std::move(surface.body)), mesh_(make_contact_mesh(surface.mesh, 3 * surface.span_size)),
      region_(std::move(surface.mesh.region)), region_names_(std::move(surface.mesh.region_names)),
      span_size_(surface.span_size), density_(surface.density), rows_(rows_of(surface.S)),
      columns_(transpose(rows_, at(surface.S.cols()))), x_(mesh_.vertices) {
  weight_sum_.assign(rows_.rows(), 0);
  node_reach_.assign(columns_.rows(), 0);
  for (std::size_t v = 0; v < rows_.rows(); ++v) {
    for (auto e = at(rows_.first[v]); e < at(rows_.first[v + 1]); ++e) weight_sum_[v] += std::abs(rows_.value[e]);
    for (auto e = at(rows_.first[v]); e < at(rows_.first[v + 1]); ++e) {
      double& reach = node_reach_[at(rows_.column[e])];
      reach = std::max(reach, weight_sum_[v]);
    }
  }
  for (std::size_t i = 0; i < columns_.rows(); ++i)
    if (columns_.first[i] < columns_.first[i + 1]) nodes_.push_back(static_cast<std::int32_t>(i));
}

MovingSurface::MovingSurface(const MeshShape& shape, std::size_t rigid, double reach)
    : rigid_(true), owner_(rigid), mesh_(make_contact_mesh(shape.mesh, reach)), region_(shape.mesh.region),
      region_names_(shape.mesh.region_names), x_(mesh_.vertices) {
  rows_.first.assign(1, 0);
  columns_.first.assign(1, 0);
  active_columns_.first.assign(1, 0);
}

void MovingSurface::activate(std::vector<std::uint8_t> is_active) {
  active_.clear();
  active_nodes_.clear();
  for (std::size_t v = 0; v < is_active.size(); ++v)
    if (is_active[v]) active_.push_back(static_cast<std::int32_t>(v));
  active_faces_.clear();
  for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
    const Triangle& t = mesh_.triangles[f];
    if (is_active[at(t[0])] && is_active[at(t[1])] && is_active[at(t[2])])
      active_faces_.push_back(static_cast<std::int32_t>(f));
  }
  v_.resize(rigid_ ? 0 : mesh_.vertices.size());
  unit_normal_.resize(mesh_.triangles.size());
  if (rigid_) return;
  SparseRows& T = active_columns_;
  T.first.assign(columns_.rows() + 1, 0);
  const auto each_entry = [&](std::size_t k, auto&& visit) { // of the k-th node
    for (auto e = at(columns_.first[at(nodes_[k])]); e < at(columns_.first[at(nodes_[k]) + 1]); ++e)
      if (is_active[at(columns_.column[e])]) visit(e);
  };
  for_indices(nodes_.size(), grain, [&](std::size_t k) {
    std::int32_t count = 0;
    each_entry(k, [&](std::size_t) { ++count; });
    T.first[at(nodes_[k]) + 1] = count;
  });
  std::partial_sum(T.first.begin(), T.first.end(), T.first.begin());
  T.column.resize(at(T.first.back()));
  T.value.resize(at(T.first.back()));
  for_indices(nodes_.size(), grain, [&](std::size_t k) {
    std::size_t place = at(T.first[at(nodes_[k])]);
    each_entry(k, [&](std::size_t e) {
      T.column[place] = columns_.column[e];
      T.value[place++] = columns_.value[e];
    });
  });
  for (const std::int32_t i : nodes_)
    if (T.first[at(i)] < T.first[at(i) + 1]) active_nodes_.push_back(i);
}

void MovingSurface::move_active(const BodyState& state) {
  const double* const u = state.displacement->data();
  for_indices(active_.size(), grain, [&](std::size_t k) {
    const std::size_t v = at(active_[k]);
    if (!state.velocity) {
      x_[v] = plus(mesh_.vertices[v], combine_row(rows_, v, u));
      return;
    }
    const auto [way, velocity] = combine_row(rows_, v, u, state.velocity->data());
    x_[v] = plus(mesh_.vertices[v], way);
    v_[v] = velocity;
  });
  find_normals();
}

void MovingSurface::find_normals() {
  for_indices(active_faces_.size(), grain, [&](std::size_t k) {
    const Point3 n = normal_now(active_faces_[k]);
    const double length = norm(n);
    unit_normal_[at(active_faces_[k])] = length > 0 ? times(n, 1 / length) : Point3{};
  });
}

void MovingSurface::move_all(const BodyState& state) {
  for_indices(x_.size(), grain, [&](std::size_t v) {
    x_[v] = plus(mesh_.vertices[v], combine_row(rows_, v, state.displacement->data()));
  });
}

void MovingSurface::move_active(const RigidState& state) {
  for_indices(active_.size(), grain,
              [&](std::size_t k) { x_[at(active_[k])] = state.to_space(mesh_.vertices[at(active_[k])]); });
  find_normals();
}

void MovingSurface::move_all(const RigidState& state) {
  for_indices(x_.size(), grain, [&](std::size_t v) { x_[v] = state.to_space(mesh_.vertices[v]); });
}

Point3 MovingSurface::normal_now(std::int32_t face) const {
  const Triangle& t = mesh_.triangles[at(face)];
  return twice_area(x(t[0]), x(t[1]), x(t[2]));
}

Point3 MovingSurface::pseudo_normal(std::int32_t face, int feature) const {
  const auto unit = [&](std::int32_t f) {
    const Point3 n = normal_now(f);
    const double length = norm(n);
    return length > 0 ? times(n, 1 / length) : Point3{};
  };
  if (feature == 0) return unit(face);
  if (feature <= 3) {
    const std::int32_t other = mesh_.neighbour[at(face)][at(feature - 1)];
    return other < 0 ? unit(face) : plus(unit(face), unit(other));
  }
  const std::int32_t v = mesh_.triangles[at(face)][at(feature - 4)];
  Point3 sum{};
  for (const std::int32_t f : mesh_.faces_of(v)) { // weighted by the angle at the vertex
    const Triangle& t = mesh_.triangles[at(f)];
    const std::size_t i = t[0] == v ? 0 : t[1] == v ? 1 : 2;
    const Point3 a = minus(x(t[(i + 1) % 3]), x(v)), b = minus(x(t[(i + 2) % 3]), x(v));
    sum = plus(sum, times(unit(f), std::atan2(norm(cross(a, b)), dot(a, b))));
  }
  return sum;
}

} // namespace iga::solve
