#include "solver/explicit/contact/pair_search.hpp"

#include "format/io/settings_reader.hpp"
#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/base/closest_point.hpp"
#include "solver/base/index.hpp"
#include "solver/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <tbb/parallel_sort.h>

namespace iga::solve {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
// Neighbours on one smooth patch, which self-contact skips: nearer in the reference than this many spans ...
constexpr double neighbour_spans = 0.75;
// ... and than this many edges, ...
constexpr double neighbour_edges = 3;
// ... with normals that agree this well. What is farther away may fold onto each other.
constexpr double neighbour_cosine = 0.5;
// Around convex edges and through walls what is nearer than this many spans does not touch.
constexpr double wall_spans = 1.5;

// Faces within the skin are looked at for every vertex: of triangles much finer than spans that would be many.
constexpr double skin_edges = 0.5;
// Faces that look the same way, by this cosine, do not come to oppose each other before the next look.
constexpr double same_way = 0.75;
// Edges take part that come within this many skins of each other: the deepest may be that far apart.
constexpr double edge_reach = 4;
// Pieces of work that the search in one body is cut into.
constexpr std::size_t close_parts = 256;
// Candidates whose sides have moved by more than this share of what they last for are not worth another measurement.
constexpr double worth_keeping = 0.6;

constexpr std::size_t chunk = 1024; // of cheap work on vertices and faces

/// Edge of an equilateral triangle of the mean area.
double typical_edge(const MovingSurface& s) {
  double area = 0;
  for (const double a : s.mesh().face_area) area += a;
  return std::sqrt(4 / std::sqrt(3.0) * area /
                   static_cast<double>(std::max<std::size_t>(s.mesh().face_area.size(), 1)));
}

std::vector<Point3> unit_normals(const MovingSurface& s) {
  std::vector<Point3> normals(s.mesh().triangles.size());
  for_indices(normals.size(), chunk, [&](std::size_t f) {
    normals[f] = s.normal_now(static_cast<std::int32_t>(f));
    if (const double length = norm(normals[f]); length > 0) normals[f] = times(normals[f], 1 / length);
  });
  return normals;
}

SideMask make_mask(const MovingSurface& s, const std::vector<std::string>& regions, const std::string& pair) {
  SideMask mask;
  const auto& names = s.region_names();
  std::vector<std::uint8_t> chosen(names.size(), regions.empty() ? 1 : 0);
  for (const std::string& wanted : regions) {
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
      throw InputError(fmt::format("contact '{}': the surface of '{}' has no region '{}'; it has {}", pair, s.name(),
                                   wanted, fmt::join(names, ", ")));
    chosen[at(found - names.begin())] = 1;
  }
  mask.face.assign(s.mesh().triangles.size(), 1);
  mask.vertex.assign(s.mesh().vertices.size(), 0);
  for (std::size_t f = 0; f < mask.face.size(); ++f) {
    if (!regions.empty()) mask.face[f] = chosen[at(s.region()[f])];
    if (mask.face[f])
      for (const std::int32_t v : s.mesh().triangles[f]) mask.vertex[at(v)] = 1;
  }
  return mask;
}

Box3 box_of(const MovingSurface& s, const Triangle& t) {
  const Point3 &a = s.x(t[0]), &b = s.x(t[1]), &c = s.x(t[2]);
  Box3 box;
  for (std::size_t d = 0; d < 3; ++d) {
    box.lower[d] = std::min({a[d], b[d], c[d]});
    box.upper[d] = std::max({a[d], b[d], c[d]});
  }
  return box;
}

constexpr Box3 empty_box{{inf, inf, inf}, {-inf, -inf, -inf}};

Box3 box_of(const MovingSurface& s) {
  const std::vector<Point3>& x = s.positions();
  std::vector<Box3> parts(num_chunks(x.size(), chunk), empty_box);
  for_chunks(x.size(), chunk, [&](std::size_t c, std::size_t first, std::size_t last) {
    Box3 box = empty_box;
    for (std::size_t v = first; v < last; ++v) box = join(box, {x[v], x[v]});
    parts[c] = box;
  });
  Box3 box = empty_box;
  for (const Box3& part : parts) box = join(box, part);
  return box;
}

std::vector<Box3> face_boxes(const MovingSurface& s) {
  std::vector<Box3> boxes(s.mesh().triangles.size());
  for_indices(boxes.size(), chunk, [&](std::size_t f) { boxes[f] = box_of(s, s.mesh().triangles[f]); });
  return boxes;
}

/// What lies within reach of something, and how near the nearest of all comes.
struct Near {
  std::vector<std::int32_t> numbers; ///< ascending
  double smallest = inf;             ///< gap, length
};
template <class GapOf> Near within(double reach, std::size_t count, const GapOf& gap_of) {
  std::vector<Near> parts(num_chunks(count, chunk));
  for_chunks(count, chunk, [&](std::size_t c, std::size_t first, std::size_t last) {
    Near near;
    for (std::size_t i = first; i < last; ++i) {
      const double gap = gap_of(i);
      near.smallest = std::min(near.smallest, gap);
      if (gap <= reach) near.numbers.push_back(static_cast<std::int32_t>(i));
    }
    parts[c] = std::move(near);
  });
  Near all;
  for (const Near& part : parts) {
    all.smallest = std::min(all.smallest, part.smallest);
    all.numbers.insert(all.numbers.end(), part.numbers.begin(), part.numbers.end());
  }
  return all;
}

double gap_between(const Box3& a, const Box3& b) {
  Point3 gap{};
  for (std::size_t d = 0; d < 3; ++d) gap[d] = std::max({0.0, a.lower[d] - b.upper[d], b.lower[d] - a.upper[d]});
  return norm(gap);
}

/// No two are equal: one order only.
void sort_in_parallel(std::vector<std::pair<std::int32_t, std::int32_t>>& pairs) {
  const ParallelTime::Section section;
  tbb::parallel_sort(pairs.begin(), pairs.end());
}

/// Several threads may mark one vertex.
void mark_vertex(std::int32_t v, std::vector<std::uint8_t>& is_active) {
  std::atomic_ref<std::uint8_t>(is_active[at(v)]).store(1, std::memory_order_relaxed);
}

void mark_ring(const ContactMesh& mesh, std::int32_t v, std::vector<std::uint8_t>& is_active) {
  for (const std::int32_t f : mesh.faces_of(v))
    for (const std::int32_t w : mesh.triangles[at(f)]) mark_vertex(w, is_active);
}

} // namespace

PairSearch::PairSearch(ContactPair pair, const std::vector<MovingSurface>& surfaces,
                       const std::vector<RigidState>& rigid, const std::vector<std::ptrdiff_t>& tool, double skin)
    : pair_(std::move(pair)), first_(pair_.first.number) {
  const auto is_deformable = [&](std::size_t s) { return s < surfaces.size() && !surfaces[s].is_rigid(); };
  if (pair_.first.kind != ContactSide::Kind::Deformable || !is_deformable(first_))
    throw InputError(fmt::format("contact '{}': the first side must be a deformable body", pair_.name));
  const double h = surfaces[first_].span_size();
  first_mask_ = make_mask(surfaces[first_], pair_.first.regions, pair_.name);
  skin_ = skin * h;
  if (pair_.second.kind == ContactSide::Kind::Rigid) {
    const std::size_t r = pair_.second.number;
    if (r >= rigid.size()) throw InputError(fmt::format("contact '{}': there is no rigid body {}", pair_.name, r));
    if (tool[r] < 0) {
      vertex_shape_.push_back({first_, r, {}, {}});
      return;
    }
    second_ = at(tool[r]);
    second_mask_ = make_mask(surfaces[second_], {}, pair_.name);
    vertex_face_.push_back({first_, second_, 1, false, {}, {}, {}, {}, {}});
    if (pair_.edges) vertex_face_.push_back({second_, first_, 1, true, {}, {}, {}, {}, {}});
  } else {
    second_ = pair_.second.number;
    if (!is_deformable(second_))
      throw InputError(fmt::format("contact '{}': there is no deformable body {}", pair_.name, second_));
    self_ = first_ == second_;
    skin_ = skin * std::min(h, surfaces[second_].span_size());
    second_mask_ = make_mask(surfaces[second_], pair_.second.regions, pair_.name);
    vertex_face_.push_back({first_, second_, 0.5, false, {}, {}, {}, {}, {}});
    if (!self_) vertex_face_.push_back({second_, first_, 0.5, false, {}, {}, {}, {}, {}});
    if (self_) {
      // One pass finds both sides: whoever is named on either side takes part.
      for (std::size_t f = 0; f < first_mask_.face.size(); ++f) first_mask_.face[f] |= second_mask_.face[f];
      for (std::size_t v = 0; v < first_mask_.vertex.size(); ++v) first_mask_.vertex[v] |= second_mask_.vertex[v];
    }
  }
  wall_distance_ = wall_spans * h;
  patch_distance_ = std::min(neighbour_spans * h, neighbour_edges * typical_edge(surfaces[first_]));
  skin_ = std::min(skin_, skin_edges * typical_edge(surfaces[first_]));
  if (!surfaces[second_].is_rigid()) skin_ = std::min(skin_, skin_edges * typical_edge(surfaces[second_]));
  if (pair_.edges) edges_.push_back({first_, second_, {}, {}});
}

std::size_t PairSearch::num_candidates() const {
  std::size_t n = 0;
  for (const auto& pass : vertex_face_) n += pass.faces.size();
  for (const auto& pass : vertex_shape_) n += pass.vertex.size() + pass.face.size();
  for (const auto& pass : edges_) n += pass.edges.size();
  return n;
}

PairSides PairSearch::sides(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                            const std::vector<RigidState>& rigid) const {
  PairSides sides;
  sides.first = &surfaces[first_];
  sides.first_displacement = bodies[surfaces[first_].owner()].displacement;
  if (second_ != npos) sides.second = &surfaces[second_];
  if (pair_.second.kind == ContactSide::Kind::Rigid)
    sides.rigid = &rigid[pair_.second.number];
  else
    sides.second_displacement = bodies[surfaces[second_].owner()].displacement;
  return sides;
}

bool PairSearch::may_be_stale(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                              const std::vector<RigidState>& rigid) const {
  return !looked_ || motion_.bound(sides(surfaces, bodies, rigid)) > allowance_;
}

bool PairSearch::is_stale(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                          const std::vector<RigidState>& rigid) {
  // Against a closed form a look is as cheap as a measurement.
  if (!looked_ || second_ == npos) return true;
  return motion_.measure(sides(surfaces, bodies, rigid), edge_reach * skin_ + deepest_) > worth_keeping * allowance_;
}

void PairSearch::look(const std::vector<MovingSurface>& surfaces, std::span<const BodyState> bodies,
                      const std::vector<RigidState>& rigid, const DepthOf& depth_of) {
  allowance_ = skin_;
  double reach = 0; // of a tool: how far its surface turns about its centre
  if (pair_.second.kind == ContactSide::Kind::Rigid) {
    const RigidState& body = rigid[pair_.second.number];
    reach = bounding_radius(body.body().shape);
    if (!(reach < inf)) {
      reach = 0;
      const Eigen::Vector3d& centre = body.pose().centre;
      const Point3 c{centre[0], centre[1], centre[2]};
      // A plane's: as far as the first side reaches.
      const Box3 box = box_of(surfaces[first_]);
      Point3 farthest{};
      for (std::size_t d = 0; d < 3; ++d)
        farthest[d] = std::max(std::abs(box.lower[d] - c[d]), std::abs(box.upper[d] - c[d]));
      reach = norm(farthest) + skin_;
    }
  }
  motion_.start(sides(surfaces, bodies, rigid), reach);
  const bool deep_look = first_look_ && !self_;
  // Boxes apart: nothing can touch until the gap is closed.
  const double apart = self_ || second_ == npos ? 0 : gap_between(box_of(surfaces[first_]), box_of(surfaces[second_]));
  for (std::size_t p = 0; p < vertex_face_.size(); ++p) {
    VertexFaceCandidates& pass = vertex_face_[p];
    if (apart > skin_ && !first_look_) {
      pass.vertex.clear();
      pass.faces.clear();
      pass.offsets = {0};
    } else {
      look_at_faces(pass, p, surfaces, depth_of);
    }
  }
  for (auto& pass : edges_) {
    pass.edges.clear();
    if (apart <= skin_) look_at_edges(pass, surfaces);
  }
  if (apart > skin_) allowance_ = apart;
  for (auto& pass : vertex_shape_) look_at_shape(pass, surfaces, rigid);
  first_look_ = false;
  looked_ = !deep_look; // the first look reaches for initial penetrations; the next one is narrower
}

bool PairSearch::are_neighbours(const ContactMesh& mesh, std::int32_t vertex, std::int32_t face) const {
  const Triangle& t = mesh.triangles[at(face)];
  if (t[0] == vertex || t[1] == vertex || t[2] == vertex) return true;
  Point3 middle{};
  for (const std::int32_t v : t) middle = plus(middle, times(mesh.vertices[at(v)], 1.0 / 3));
  const Point3 way = minus(middle, mesh.vertices[at(vertex)]);
  const double distance2 = dot(way, way);
  if (distance2 >= wall_distance_ * wall_distance_) return false;
  const Point3 &own = mesh.vertex_normal[at(vertex)], &other = mesh.face_normal[at(face)];
  if (dot(own, other) > neighbour_cosine) return distance2 < patch_distance_ * patch_distance_;
  // Each behind the other, as around a convex edge or on the two sides of a wall: material is between them.
  return dot(way, own) <= 0 && dot(way, other) >= 0;
}

void PairSearch::look_at_faces(VertexFaceCandidates& pass, std::size_t number,
                               const std::vector<MovingSurface>& surfaces, const DepthOf& depth_of) {
  const MovingSurface &slave = surfaces[pass.slave], &master = surfaces[pass.master];
  const SideMask &vertices = mask(pass.slave), &faces = mask(pass.master);
  const std::vector<Box3> boxes = face_boxes(master);
  if (self_) {
    look_at_own_faces(pass, boxes, master, depth_of);
    return;
  }
  if (first_look_) pass.tree = Bvh(boxes);
  pass.tree.refit(boxes);
  // A face that a vertex enters was within the skin of it; what lies next to the entered one within twice that.
  double first_reach = 0;
  if (first_look_)
    for (const double thickness : master.mesh().thickness) first_reach = std::max(first_reach, 0.5 * thickness);
  std::vector<std::vector<std::int32_t>> found(slave.mesh().vertices.size());
  for_indices(found.size(), 64, [&](std::size_t i) {
    if (!vertices.vertex[i] || (pass.sharp_only && !slave.mesh().is_sharp[i])) return;
    const auto v = static_cast<std::int32_t>(i);
    const Point3& x = slave.x(v);
    const double reach = 2 * skin_ + std::max(first_reach, depth_of(number, v));
    pass.tree.each_overlap(grown({x, x}, reach), [&](std::int32_t f) {
      if (!faces.face[at(f)]) return;
      const Triangle& t = master.mesh().triangles[at(f)];
      if (closest_on_triangle(x, master.x(t[0]), master.x(t[1]), master.x(t[2])).distance2 <= reach * reach)
        found[i].push_back(f);
    });
    std::sort(found[i].begin(), found[i].end());
  });
  pass.vertex.clear();
  pass.faces.clear();
  pass.offsets = {0};
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].empty()) continue;
    pass.vertex.push_back(static_cast<std::int32_t>(i));
    pass.faces.insert(pass.faces.end(), found[i].begin(), found[i].end());
    pass.offsets.push_back(pass.faces.size());
  }
}

void PairSearch::look_at_own_faces(VertexFaceCandidates& pass, const std::vector<Box3>& boxes,
                                   const MovingSurface& surface, const DepthOf& depth_of) {
  const ContactMesh& mesh = surface.mesh();
  const std::vector<Point3> normals = unit_normals(surface);
  std::vector<Box3> directions(normals.size());
  for_indices(normals.size(), chunk, [&](std::size_t f) { directions[f] = {normals[f], normals[f]}; });
  if (first_look_) pass.tree = Bvh(boxes);
  pass.tree.refit(boxes, directions);
  // Vertices look the way of any of their faces.
  std::vector<Box3> places(mesh.vertices.size()), ways(mesh.vertices.size());
  for_indices(places.size(), chunk, [&](std::size_t v) {
    const auto number = static_cast<std::int32_t>(v);
    places[v] = {surface.x(number), surface.x(number)};
    Box3 way = empty_box;
    for (const std::int32_t f : mesh.faces_of(number)) way = join(way, {normals[at(f)], normals[at(f)]});
    ways[v] = way;
  });
  if (first_look_) pass.vertex_tree = Bvh(places);
  pass.vertex_tree.refit(places, ways);
  const double reach = 2 * skin_;
  deepest_ = 0; // of vertices that touch: they were candidates
  for (const std::int32_t v : pass.vertex) deepest_ = std::max(deepest_, depth_of(0, v));
  const auto may_oppose = [&](std::int32_t v, const Point3& normal) {
    for (const std::int32_t f : mesh.faces_of(v))
      if (dot(normals[at(f)], normal) <= same_way) return true;
    return false;
  };
  const auto look_same_way = [](const Box3& a, const Box3& b) { // do all of them?
    double least = 0;
    for (std::size_t d = 0; d < 3; ++d)
      least += std::min(
          {a.lower[d] * b.lower[d], a.lower[d] * b.upper[d], a.upper[d] * b.lower[d], a.upper[d] * b.upper[d]});
    return least > same_way;
  };
  const double apart = reach + deepest_;
  const auto parts = pass.vertex_tree.close_parts(pass.tree, apart, look_same_way, close_parts);
  using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>; // of vertex and face
  std::vector<Pairs> of_part(parts.size());
  for_indices(parts.size(), 1, [&](std::size_t p) {
    pass.vertex_tree.each_close_pair(parts[p], pass.tree, apart, look_same_way, [&](std::int32_t v, std::int32_t f) {
      if (!first_mask_.vertex[at(v)] || !first_mask_.face[at(f)]) return;
      if (!may_oppose(v, normals[at(f)]) || are_neighbours(mesh, v, f)) return;
      const Triangle& t = mesh.triangles[at(f)];
      const double d2 = closest_on_triangle(surface.x(v), surface.x(t[0]), surface.x(t[1]), surface.x(t[2])).distance2;
      if (d2 <= reach * reach || std::sqrt(d2) <= reach + depth_of(0, v)) of_part[p].emplace_back(v, f);
    });
  });
  Pairs found;
  for (const Pairs& pairs : of_part) found.insert(found.end(), pairs.begin(), pairs.end());
  sort_in_parallel(found);
  pass.vertex.clear();
  pass.faces.clear();
  pass.offsets = {0};
  for (const auto& [v, f] : found) {
    if (pass.vertex.empty() || pass.vertex.back() != v) {
      pass.vertex.push_back(v);
      pass.offsets.push_back(pass.offsets.back());
    }
    pass.faces.push_back(f);
    ++pass.offsets.back();
  }
}

void PairSearch::look_at_shape(VertexShapeCandidates& pass, const std::vector<MovingSurface>& surfaces,
                               const std::vector<RigidState>& rigid) {
  const MovingSurface& slave = surfaces[pass.slave];
  const RigidState& body = rigid[pass.rigid];
  const SideMask& chosen = mask(pass.slave);
  Near vertices = within(skin_, slave.mesh().vertices.size(), [&](std::size_t v) {
    if (!chosen.vertex[v]) return inf;
    return distance_to_shape(body.body().shape, body.to_body(slave.positions()[v])).gap;
  });
  pass.vertex = std::move(vertices.numbers);
  double smallest = vertices.smallest;
  pass.face.clear();
  if (const auto* sphere = std::get_if<SphereShape>(&body.body().shape)) {
    const Eigen::Vector3d& c = body.pose().centre;
    const double offset = VertexShapeCandidates::face_offset * slave.span_size();
    Near faces = within(skin_, slave.mesh().triangles.size(), [&](std::size_t f) {
      if (!chosen.face[f]) return inf;
      const Triangle& t = slave.mesh().triangles[f];
      const double distance2 =
          closest_on_triangle({c[0], c[1], c[2]}, slave.x(t[0]), slave.x(t[1]), slave.x(t[2])).distance2;
      return std::sqrt(distance2) - sphere->radius + offset;
    });
    pass.face = std::move(faces.numbers);
    smallest = std::min(smallest, faces.smallest);
  }
  if (smallest > skin_) allowance_ = smallest;
}

void PairSearch::look_at_edges(EdgeCandidates& pass, const std::vector<MovingSurface>& surfaces) const {
  const MovingSurface &first = surfaces[pass.first], &second = surfaces[pass.second];
  const auto &own = first.mesh().sharp_edges, &others = second.mesh().sharp_edges;
  const auto box = [](const MovingSurface& s, const SharpEdge& e) {
    Box3 b;
    for (std::size_t d = 0; d < 3; ++d) {
      b.lower[d] = std::min(s.x(e.a)[d], s.x(e.b)[d]);
      b.upper[d] = std::max(s.x(e.a)[d], s.x(e.b)[d]);
    }
    return b;
  };
  std::vector<Box3> boxes(others.size());
  for_indices(boxes.size(), chunk, [&](std::size_t j) { boxes[j] = box(second, others[j]); });
  if (pass.tree.empty()) pass.tree = Bvh(boxes);
  pass.tree.refit(boxes);
  const SideMask &mask_first = mask(pass.first), &mask_second = mask(pass.second);
  using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;
  constexpr std::size_t grain = 64;
  std::vector<Pairs> parts(num_chunks(own.size(), grain));
  const auto look_at = [&](std::size_t i, Pairs& found) {
    const SharpEdge& e = own[i];
    if (!mask_first.face[at(e.left)] && !mask_first.face[at(e.right)]) return;
    const auto begin = static_cast<std::ptrdiff_t>(found.size());
    // Edges that touch lie as deep in each other as the faces beside them.
    pass.tree.each_overlap(grown(box(first, e), edge_reach * skin_), [&](std::int32_t j) {
      const SharpEdge& o = others[at(j)];
      if (!mask_second.face[at(o.left)] && !mask_second.face[at(o.right)]) return;
      if (self_) {
        if (at(j) <= i || o.a == e.a || o.a == e.b || o.b == e.a || o.b == e.b) return;
        if (are_neighbours(first.mesh(), e.a, o.left) || are_neighbours(first.mesh(), e.b, o.right)) return;
      }
      found.emplace_back(static_cast<std::int32_t>(i), j);
    });
    std::sort(found.begin() + begin, found.end());
  };
  for_chunks(own.size(), grain, [&](std::size_t c, std::size_t first_edge, std::size_t last_edge) {
    for (std::size_t i = first_edge; i < last_edge; ++i) look_at(i, parts[c]);
  });
  for (const Pairs& part : parts) pass.edges.insert(pass.edges.end(), part.begin(), part.end());
}

void PairSearch::mark(const std::vector<MovingSurface>& surfaces,
                      std::vector<std::vector<std::uint8_t>>& is_active) const {
  for (const auto& pass : vertex_shape_) {
    const ContactMesh& slave = surfaces[pass.slave].mesh();
    for_indices(pass.vertex.size(), chunk,
                [&](std::size_t k) { mark_ring(slave, pass.vertex[k], is_active[pass.slave]); });
    for_indices(pass.face.size(), chunk, [&](std::size_t k) {
      for (const std::int32_t v : slave.triangles[at(pass.face[k])]) mark_vertex(v, is_active[pass.slave]);
    });
  }
  for (const auto& pass : vertex_face_) {
    const ContactMesh &slave = surfaces[pass.slave].mesh(), &master = surfaces[pass.master].mesh();
    for_indices(pass.vertex.size(), chunk,
                [&](std::size_t k) { mark_ring(slave, pass.vertex[k], is_active[pass.slave]); });
    for_indices(pass.faces.size(), chunk, [&](std::size_t k) {
      for (const std::int32_t v : master.triangles[at(pass.faces[k])]) mark_ring(master, v, is_active[pass.master]);
    });
  }
  for (const auto& pass : edges_)
    for (const auto& [i, j] : pass.edges) {
      const auto ring = [&](std::size_t s, std::int32_t number) {
        const SharpEdge& e = surfaces[s].mesh().sharp_edges[at(number)];
        mark_ring(surfaces[s].mesh(), e.a, is_active[s]);
        mark_ring(surfaces[s].mesh(), e.b, is_active[s]);
      };
      ring(pass.first, i);
      ring(pass.second, j);
    }
}

} // namespace iga::solve
