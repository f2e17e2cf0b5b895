#include "solver/explicit/contact/touch.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/closest_point.hpp"
#include "solver/base/index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

// A vertex this near to an edge or corner (in spans) has no direction of its own: the pseudo-normal gives it.
constexpr double touching = 1e-6;
// Deepest penetration that is seen, as a share of the thickness behind a face: beyond the middle of a wall the other
// side is nearer.
constexpr double seen_share = 0.5;
// Depth that springs do not let pass: this many spans, and so much of the thickness, before nothing is seen any more.
constexpr double limit_spans = 0.5, limit_share = 0.45;
// A vertex within a closed form is pushed out whichever way its faces look: this share of their area stands behind it.
constexpr double least_area_share = 0.1;
// Faces take part in a contact where their normals oppose it by more than 6 degrees beyond square: the side of a block
// has nothing to do with what stands on it, though it is as near to the edges.
constexpr double least_facing = 0.1;
constexpr std::size_t grain = 64; // candidates of a piece

/// Reference area of the faces around a vertex that look against `normal`.
double facing_area(const MovingSurface& s, const SideMask& mask, std::int32_t v, const Point3& normal) {
  double area = 0;
  for (const std::int32_t f : s.mesh().faces_of(v)) {
    if (!mask.face[at(f)]) continue;
    const double against = -dot(s.unit_normal(f), normal);
    if (against > least_facing) area += s.mesh().face_area[at(f)] / 3 * against;
  }
  return area;
}

/// Reference area of all faces around a vertex.
double ring_area(const MovingSurface& s, const SideMask& mask, std::int32_t v) {
  double area = 0;
  for (const std::int32_t f : s.mesh().faces_of(v))
    if (mask.face[at(f)]) area += s.mesh().face_area[at(f)] / 3;
  return area;
}

void add_side(Touch& touch, std::size_t number, const MovingSurface& s, double sign,
              std::span<const std::pair<std::int32_t, double>> weights, const Point3& point) {
  if (s.is_rigid()) {
    touch.rigid = static_cast<std::ptrdiff_t>(s.owner());
    touch.rigid_sign = sign;
    touch.point = point;
    return;
  }
  for (const auto& [v, w] : weights) touch.entries[at(touch.count++)] = {number, v, sign * w};
}

/// The second side of a touch is a rigid form, pushed at `point`.
void add_shape(Touch& touch, const VertexShapeCandidates& pass, const std::vector<MovingSurface>& surfaces,
               const std::vector<RigidState>& rigid, const Point3& point) {
  touch.limit = std::min(limit_spans * surfaces[pass.slave].span_size(),
                         2 * limit_share * bounding_radius(rigid[pass.rigid].body().shape));
  touch.rigid = static_cast<std::ptrdiff_t>(pass.rigid);
  touch.rigid_sign = -1;
  touch.point = point;
}

struct Nearest {
  ClosestOnTriangle on;
  std::int32_t face = -1;
};

/// Unit normals of the chosen faces around a vertex; no more than are looked at.
struct RingNormals {
  std::array<Point3, 16> normal;
  std::size_t count = 0;
  bool oppose(const Point3& n) const {
    for (std::size_t i = 0; i < count; ++i)
      if (dot(normal[i], n) < -least_facing) return true;
    return false;
  }
};

RingNormals ring_normals(const MovingSurface& s, const SideMask& mask, std::int32_t v) {
  RingNormals ring;
  for (const std::int32_t f : s.mesh().faces_of(v)) {
    if (!mask.face[at(f)] || ring.count == ring.normal.size()) continue;
    ring.normal[ring.count++] = s.unit_normal(f);
  }
  return ring;
}

} // namespace

std::optional<Touch> touch_face(const PairSearch& search, std::size_t pass_number, std::size_t candidate,
                                const std::vector<MovingSurface>& surfaces) {
  const VertexFaceCandidates& pass = search.vertex_face()[pass_number];
  const MovingSurface &slave = surfaces[pass.slave], &master = surfaces[pass.master];
  const std::int32_t v = pass.vertex[candidate];
  const Point3& x = slave.x(v);
  Nearest best;
  best.on.distance2 = std::numeric_limits<double>::infinity();
  const RingNormals own_faces = ring_normals(slave, search.mask(pass.slave), v);
  for (std::size_t k = pass.offsets[candidate]; k < pass.offsets[candidate + 1]; ++k) {
    if (!own_faces.oppose(master.unit_normal(pass.faces[k]))) continue;
    const Triangle& t = master.mesh().triangles[at(pass.faces[k])];
    const ClosestOnTriangle on = closest_on_triangle(x, master.x(t[0]), master.x(t[1]), master.x(t[2]));
    if (on.distance2 < best.on.distance2) best = {on, pass.faces[k]};
  }
  if (best.face < 0) return std::nullopt;
  const Point3 away = minus(x, best.on.position);
  const Point3 outward = master.pseudo_normal(best.face, best.on.feature);
  if (!(dot(away, outward) < 0)) return std::nullopt;
  Touch touch;
  touch.depth = std::sqrt(best.on.distance2);
  if (touch.depth > seen_share * master.mesh().thickness[at(best.face)]) return std::nullopt;
  const double h = slave.is_rigid() ? master.span_size() : slave.span_size();
  const bool own_direction = best.on.feature > 0 && touch.depth > touching * h;
  const double wall = master.mesh().thickness[at(best.face)];
  touch.limit = std::min(limit_spans * h, limit_share * wall);
  if (!master.is_rigid() && wall < h) touch.wall = wall;
  touch.normal = own_direction ? times(away, -1 / touch.depth) : times(outward, 1 / norm(outward));
  const Triangle& t = master.mesh().triangles[at(best.face)];
  touch.area = facing_area(slave, search.mask(pass.slave), v, touch.normal);
  // A tool's few corners stand for no more than the face they press on.
  if (slave.is_rigid()) touch.area = std::min(touch.area, master.mesh().face_area[at(best.face)]);
  touch.key = vertex_key(pass_number, v);
  touch.first_sign = pass.slave == search.first() ? 1 : -1;
  const std::pair<std::int32_t, double> own[]{{v, 1.0}};
  const std::pair<std::int32_t, double> other[]{
      {t[0], best.on.weight[0]}, {t[1], best.on.weight[1]}, {t[2], best.on.weight[2]}};
  touch.point = x;
  add_side(touch, pass.slave, slave, 1, own, x);
  add_side(touch, pass.master, master, -1, other, best.on.position);
  touch.area *= pass.share;
  return touch;
}

std::optional<Touch> touch_shape(const PairSearch& search, std::size_t candidate,
                                 const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid) {
  const VertexShapeCandidates& pass = search.vertex_shape()[0];
  const MovingSurface& slave = surfaces[pass.slave];
  const RigidState& body = rigid[pass.rigid];
  const std::int32_t v = pass.vertex[candidate];
  const ShapeDistance distance = distance_to_shape(body.body().shape, body.to_body(slave.x(v)));
  if (!(distance.gap < 0)) return std::nullopt;
  Touch touch;
  touch.key = vertex_key(0, v);
  touch.depth = -distance.gap;
  touch.normal = body.turned(distance.normal);
  touch.area = std::max(facing_area(slave, search.mask(pass.slave), v, touch.normal),
                        least_area_share * ring_area(slave, search.mask(pass.slave), v));
  touch.entries[0] = {pass.slave, v, 1};
  touch.count = 1;
  add_shape(touch, pass, surfaces, rigid, slave.x(v));
  return touch;
}

std::optional<Touch> touch_sphere(const PairSearch& search, std::size_t candidate,
                                  const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid) {
  const VertexShapeCandidates& pass = search.vertex_shape()[0];
  const MovingSurface& slave = surfaces[pass.slave];
  const RigidState& body = rigid[pass.rigid];
  const std::int32_t face = pass.face[candidate];
  const Triangle& t = slave.mesh().triangles[at(face)];
  const Eigen::Vector3d& centre = body.pose().centre;
  const Point3 c{centre[0], centre[1], centre[2]};
  const ClosestOnTriangle on = closest_on_triangle(c, slave.x(t[0]), slave.x(t[1]), slave.x(t[2]));
  if (on.feature > 3) return std::nullopt; // the vertex has its own touch
  if (on.feature > 0 && slave.mesh().neighbour[at(face)][at(on.feature - 1)] > face)
    return std::nullopt; // counts there
  const double radius = std::get<SphereShape>(body.body().shape).radius, distance = std::sqrt(on.distance2);
  Touch touch;
  touch.depth = radius - distance - VertexShapeCandidates::face_offset * slave.span_size();
  if (!(touch.depth > 0) || !(distance > touching * radius)) return std::nullopt;
  touch.key = std::uint64_t{2} << 54 | static_cast<std::uint64_t>(face);
  touch.normal = times(minus(on.position, c), 1 / distance);
  touch.area = slave.mesh().face_area[at(face)] / 3;
  for (std::size_t i = 0; i < 3; ++i) touch.entries[i] = {pass.slave, t[i], on.weight[i]};
  touch.count = 3;
  add_shape(touch, pass, surfaces, rigid, on.position);
  return touch;
}

std::optional<Touch> touch_edge(const PairSearch& search, std::size_t candidate,
                                const std::vector<MovingSurface>& surfaces) {
  const EdgeCandidates& pass = search.edges()[0];
  const MovingSurface &first = surfaces[pass.first], &second = surfaces[pass.second];
  const auto [i, j] = pass.edges[candidate];
  const SharpEdge &e = first.mesh().sharp_edges[at(i)], &o = second.mesh().sharp_edges[at(j)];
  const ClosestOfSegments near = closest_of_segments(first.x(e.a), first.x(e.b), second.x(o.a), second.x(o.b));
  if (!near.interior) return std::nullopt;
  const Point3 p = plus(times(first.x(e.a), 1 - near.s), times(first.x(e.b), near.s));
  const Point3 q = plus(times(second.x(o.a), 1 - near.t), times(second.x(o.b), near.t));
  Point3 n = cross(minus(first.x(e.b), first.x(e.a)), minus(second.x(o.b), second.x(o.a)));
  n = times(n, 1 / norm(n));
  const Point3 outward = plus(second.unit_normal(o.left), second.unit_normal(o.right));
  if (dot(n, outward) < 0) n = times(n, -1);
  Touch touch;
  touch.depth = -dot(minus(p, q), n);
  const auto limit = [](const MovingSurface& s, const SharpEdge& edge) {
    return seen_share * std::min(s.mesh().thickness[at(edge.left)], s.mesh().thickness[at(edge.right)]);
  };
  if (!(touch.depth > 0) || touch.depth > std::min(limit(first, e), limit(second, o))) return std::nullopt;
  // Each lies within the wedge behind the other's edge.
  for (const std::int32_t f : {o.left, o.right})
    if (!(dot(second.unit_normal(f), n) > 0)) return std::nullopt;
  for (const std::int32_t f : {e.left, e.right})
    if (!(dot(first.unit_normal(f), n) < 0)) return std::nullopt;
  touch.limit = std::min({limit_spans * (first.is_rigid() ? second : first).span_size(),
                          limit_share / seen_share * std::min(limit(first, e), limit(second, o))});
  touch.key = std::uint64_t{3} << 54 | static_cast<std::uint64_t>(i) << 27 | static_cast<std::uint64_t>(j);
  touch.normal = n;
  touch.area = 0.5 * std::min(e.area, o.area);
  const std::pair<std::int32_t, double> own[]{{e.a, 1 - near.s}, {e.b, near.s}};
  const std::pair<std::int32_t, double> other[]{{o.a, 1 - near.t}, {o.b, near.t}};
  touch.point = p;
  add_side(touch, pass.first, first, 1, own, p);
  add_side(touch, pass.second, second, -1, other, q);
  return touch;
}

std::vector<CandidatePiece> candidate_pieces(const PairSearch& search) {
  using Kind = CandidatePiece::Kind;
  std::vector<CandidatePiece> pieces;
  const auto add = [&pieces](Kind kind, std::size_t pass, std::size_t count) {
    for (std::size_t first = 0; first < count; first += grain)
      pieces.push_back({kind, pass, first, std::min(count, first + grain)});
  };
  for (std::size_t p = 0; p < search.vertex_face().size(); ++p)
    add(Kind::Face, p, search.vertex_face()[p].vertex.size());
  for (const auto& pass : search.vertex_shape()) {
    add(Kind::Shape, 0, pass.vertex.size());
    add(Kind::Sphere, 0, pass.face.size());
  }
  for (const auto& pass : search.edges()) add(Kind::Edge, 0, pass.edges.size());
  return pieces;
}

std::optional<Touch> touch_of(const PairSearch& search, const CandidatePiece& piece, std::size_t k,
                              const std::vector<MovingSurface>& surfaces, const std::vector<RigidState>& rigid) {
  switch (piece.kind) {
  case CandidatePiece::Kind::Face:
    return touch_face(search, piece.pass, k, surfaces);
  case CandidatePiece::Kind::Shape:
    return touch_shape(search, k, surfaces, rigid);
  case CandidatePiece::Kind::Sphere:
    return touch_sphere(search, k, surfaces, rigid);
  default:
    return touch_edge(search, k, surfaces);
  }
}

} // namespace iga::solve
