#include "preprocessor/surface_topology.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace iga::prep {

namespace vec {
double norm(const Point3& a) { return std::sqrt(dot(a, a)); }
} // namespace vec

EdgeTable make_edge_table(std::span<const Triangle> triangles) {
  EdgeTable table;
  table.uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& v = triangles[t];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t a = v[i], b = v[(i + 1) % 3];
      table.uses.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
    }
  }
  std::sort(table.uses.begin(), table.uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::tie(a.lo, a.hi, a.triangle) < std::tie(b.lo, b.hi, b.triangle);
  });
  for (std::size_t i = 0; i < table.uses.size(); ++i)
    if (i == 0 || table.uses[i].lo != table.uses[i - 1].lo || table.uses[i].hi != table.uses[i - 1].hi)
      table.offsets.push_back(i);
  table.offsets.push_back(table.uses.size());
  return table;
}

int edge_balance(std::span<const EdgeUse> uses) {
  int sum = 0;
  for (const EdgeUse& u : uses) sum += u.forward ? 1 : -1;
  return sum;
}

EdgeDefects find_edge_defects(const TriangleMesh& mesh, const EdgeTable& edges) {
  EdgeDefects out;
  for (std::size_t e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    const auto middle = [&] {
      const Point3& a = mesh.vertices[static_cast<std::size_t>(uses[0].lo)];
      const Point3& b = mesh.vertices[static_cast<std::size_t>(uses[0].hi)];
      return vec::add(a, vec::mul(vec::sub(b, a), 0.5));
    };
    if (uses.size() > 2) ++out.non_manifold;
    if (uses.size() % 2 == 1) {
      if (out.open++ == 0) out.first_open = middle();
    } else if (edge_balance(uses) != 0) {
      if (out.turned++ == 0) out.first_turned = middle();
    }
  }
  return out;
}

bool is_closed_chain(const EdgeTable& edges) {
  for (std::size_t e = 0; e < edges.num_edges(); ++e)
    if (edge_balance(edges.edge(e)) != 0) return false;
  return true;
}

void keep_triangles(Surface& surface, const std::vector<bool>& keep) {
  TriangleMesh& mesh = surface.mesh;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (keep[t]) {
      mesh.triangles[kept] = mesh.triangles[t];
      mesh.region[kept] = mesh.region[t];
      surface.normals[kept] = surface.normals[t];
      ++kept;
    }
  mesh.triangles.resize(kept);
  mesh.region.resize(kept);
  surface.normals.resize(kept);
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);
  for (const Triangle& t : mesh.triangles)
    for (std::int32_t v : t) number[static_cast<std::size_t>(v)] = 0;
  std::int32_t used = 0;
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] == 0) {
      mesh.vertices[static_cast<std::size_t>(used)] = mesh.vertices[v];
      number[v] = used++;
    }
  mesh.vertices.resize(static_cast<std::size_t>(used));
  for (Triangle& t : mesh.triangles)
    for (std::int32_t& v : t) v = number[static_cast<std::size_t>(v)];
}

void turn_triangle(Surface& surface, std::size_t t) {
  std::swap(surface.mesh.triangles[t][1], surface.mesh.triangles[t][2]);
}

double diagonal(const Box3& box) { return vec::norm(vec::sub(box.upper, box.lower)); }

Point3 area_vector(const TriangleMesh& mesh, std::size_t t) {
  const Point3& a = corner(mesh, t, 0);
  return vec::cross(vec::sub(corner(mesh, t, 1), a), vec::sub(corner(mesh, t, 2), a));
}

} // namespace iga::prep
