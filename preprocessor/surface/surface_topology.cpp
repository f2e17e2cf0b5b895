#include "preprocessor/surface/surface_topology.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace iga::prep {

EdgeTable make_edge_table(std::span<const Triangle> triangles) {
  // Counting sort by the smaller vertex; the short rows are sorted by the larger one. Triangles come in order.
  std::int32_t last = -1;
  for (const Triangle& v : triangles) last = std::max({last, v[0], v[1], v[2]});
  std::vector<std::size_t> row(static_cast<std::size_t>(last) + 2, 0);
  const auto each_use = [&](auto&& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const Triangle& v = triangles[t];
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t a = v[i], b = v[(i + 1) % 3];
        visit(EdgeUse{std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
      }
    }
  };
  each_use([&](const EdgeUse& u) { ++row[static_cast<std::size_t>(u.lo) + 1]; });
  std::partial_sum(row.begin(), row.end(), row.begin());
  EdgeTable table;
  table.uses.resize(row.back());
  std::vector<std::size_t> next(row.begin(), row.end() - 1);
  each_use([&](const EdgeUse& u) { table.uses[next[static_cast<std::size_t>(u.lo)]++] = u; });
  for (std::size_t v = 0; v + 1 < row.size(); ++v) {
    const auto first = table.uses.begin() + static_cast<std::ptrdiff_t>(row[v]);
    const auto end = table.uses.begin() + static_cast<std::ptrdiff_t>(row[v + 1]);
    std::sort(first, end, [](const EdgeUse& a, const EdgeUse& b) {
      return std::tie(a.hi, a.triangle) < std::tie(b.hi, b.triangle);
    });
    for (auto u = first; u != end; ++u)
      if (u == first || u->hi != (u - 1)->hi) table.offsets.push_back(static_cast<std::size_t>(u - table.uses.begin()));
  }
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
      return plus(a, times(minus(b, a), 0.5));
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

double diagonal(const Box3& box) {
  return norm(minus(box.upper, box.lower));
}

Point3 area_vector(const TriangleMesh& mesh, std::size_t t) {
  const Point3& a = corner(mesh, t, 0);
  return cross(minus(corner(mesh, t, 1), a), minus(corner(mesh, t, 2), a));
}

} // namespace iga::prep
