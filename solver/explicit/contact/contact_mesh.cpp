#include "solver/explicit/contact/contact_mesh.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/bvh.hpp"
#include "solver/base/index.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <tbb/parallel_for.h>

namespace iga::solve {

namespace {

// Faces whose normals differ by more meet in a sharp edge: 30 degrees.
constexpr double sharp_cosine = 0.866;

Point3 unit_or_zero(const Point3& v) {
  const double length = norm(v);
  return length > 0 ? times(v, 1 / length) : Point3{};
}

void measure(ContactMesh& m) {
  m.vertex_area.assign(m.vertices.size(), 0);
  m.vertex_normal.assign(m.vertices.size(), {});
  m.face_offsets.assign(m.vertices.size() + 1, 0);
  for (const Triangle& t : m.triangles) {
    const Point3 n = twice_area(m.vertices[at(t[0])], m.vertices[at(t[1])], m.vertices[at(t[2])]);
    m.face_area.push_back(0.5 * norm(n));
    m.face_normal.push_back(unit_or_zero(n));
    for (const std::int32_t v : t) {
      m.vertex_area[at(v)] += m.face_area.back() / 3;
      m.vertex_normal[at(v)] = plus(m.vertex_normal[at(v)], n);
      ++m.face_offsets[at(v) + 1];
    }
  }
  for (Point3& n : m.vertex_normal) n = unit_or_zero(n);
  std::partial_sum(m.face_offsets.begin(), m.face_offsets.end(), m.face_offsets.begin());
  m.faces.resize(3 * m.triangles.size());
  std::vector<std::int32_t> next(m.face_offsets.begin(), m.face_offsets.end() - 1);
  for (std::size_t f = 0; f < m.triangles.size(); ++f)
    for (const std::int32_t v : m.triangles[f]) m.faces[at(next[at(v)]++)] = static_cast<std::int32_t>(f);
}

void connect(ContactMesh& m) {
  m.neighbour.assign(m.triangles.size(), {-1, -1, -1});
  m.is_sharp.assign(m.vertices.size(), 0);
  // Directed edges (a, b) of a face meet (b, a) of its neighbour; where more than two faces meet the first ones pair.
  struct Half {
    std::int32_t low, high, face, side;
    bool forward;
  };
  std::vector<Half> halves;
  for (std::size_t f = 0; f < m.triangles.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t a = m.triangles[f][i], b = m.triangles[f][(i + 1) % 3];
      halves.push_back(
          {std::min(a, b), std::max(a, b), static_cast<std::int32_t>(f), static_cast<std::int32_t>(i), a < b});
    }
  std::sort(halves.begin(), halves.end(), [](const Half& p, const Half& q) {
    return std::tie(p.low, p.high, p.face, p.side) < std::tie(q.low, q.high, q.face, q.side);
  });
  const auto same_edge = [](const Half& p, const Half& q) { return p.low == q.low && p.high == q.high; };
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const Half& p = halves[i];
    if (m.neighbour[at(p.face)][at(p.side)] >= 0) continue;
    for (std::size_t j = i + 1; j < halves.size() && same_edge(p, halves[j]); ++j) {
      const Half& q = halves[j];
      if (q.forward == p.forward || m.neighbour[at(q.face)][at(q.side)] >= 0) continue;
      m.neighbour[at(p.face)][at(p.side)] = q.face;
      m.neighbour[at(q.face)][at(q.side)] = p.face;
      const Triangle& t = m.triangles[at(q.face)];
      const std::int32_t apex = t[(at(q.side) + 2) % 3];
      const Point3 across = minus(m.vertices[at(apex)], m.vertices[at(p.low)]);
      const bool convex = dot(across, m.face_normal[at(p.face)]) < 0;
      if (convex && dot(m.face_normal[at(p.face)], m.face_normal[at(q.face)]) < sharp_cosine) {
        m.sharp_edges.push_back(
            {p.low, p.high, p.face, q.face, (m.face_area[at(p.face)] + m.face_area[at(q.face)]) / 3});
        m.is_sharp[at(p.low)] = m.is_sharp[at(p.high)] = 1;
      }
      break;
    }
  }
}

// Distance along a ray to a triangle, or `reach`: Möller & Trumbore (1997).
double hit(const Point3& origin, const Point3& direction, const Point3& a, const Point3& b, const Point3& c,
           double reach) {
  const Point3 ab = minus(b, a), ac = minus(c, a), p = cross(direction, ac);
  const double det = dot(ab, p);
  if (det == 0) return reach;
  const Point3 s = minus(origin, a);
  const double u = dot(s, p) / det;
  const Point3 q = cross(s, ab);
  const double v = dot(direction, q) / det, t = dot(ac, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? std::min(t, reach) : reach;
}

void look_through(ContactMesh& m, double reach) {
  std::vector<Box3> boxes(m.triangles.size());
  for (std::size_t f = 0; f < boxes.size(); ++f) {
    const Point3 &a = m.vertices[at(m.triangles[f][0])], &b = m.vertices[at(m.triangles[f][1])],
                 &c = m.vertices[at(m.triangles[f][2])];
    for (std::size_t d = 0; d < 3; ++d)
      boxes[f].lower[d] = std::min({a[d], b[d], c[d]}), boxes[f].upper[d] = std::max({a[d], b[d], c[d]});
  }
  const Bvh tree(boxes);
  m.thickness.assign(m.triangles.size(), reach);
  tbb::parallel_for(std::size_t{0}, m.triangles.size(), [&](std::size_t f) {
    const Triangle& t = m.triangles[f];
    Point3 middle{};
    for (const std::int32_t v : t) middle = plus(middle, times(m.vertices[at(v)], 1.0 / 3));
    const Point3 inward = times(m.face_normal[f], -1);
    tree.each_on_segment(middle, plus(middle, times(inward, reach)), [&](std::int32_t g) {
      if (at(g) == f || dot(m.face_normal[at(g)], inward) <= 0) return;
      const Triangle& o = m.triangles[at(g)];
      m.thickness[f] = std::min(
          m.thickness[f], hit(middle, inward, m.vertices[at(o[0])], m.vertices[at(o[1])], m.vertices[at(o[2])], reach));
    });
  });
}

} // namespace

ContactMesh make_contact_mesh(const TriangleMesh& mesh, double reach) {
  ContactMesh m;
  m.vertices = mesh.vertices;
  m.triangles = mesh.triangles;
  measure(m);
  connect(m);
  look_through(m, reach);
  return m;
}

TriangleMesh merge_equal_vertices(const TriangleMesh& mesh) {
  TriangleMesh merged;
  merged.region_names = mesh.region_names;
  std::map<Point3, std::int32_t> known;
  std::vector<std::int32_t> number;
  for (const Point3& x : mesh.vertices) {
    const auto [entry, is_new] = known.try_emplace(x, static_cast<std::int32_t>(merged.vertices.size()));
    if (is_new) merged.vertices.push_back(x);
    number.push_back(entry->second);
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    Triangle t = mesh.triangles[f];
    for (std::int32_t& v : t) v = number[at(v)];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    merged.triangles.push_back(t);
    merged.region.push_back(mesh.region.empty() ? 0 : mesh.region[f]);
  }
  return merged;
}

} // namespace iga::solve
