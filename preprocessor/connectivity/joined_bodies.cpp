#include "preprocessor/connectivity/joined_bodies.hpp"

#include "format/model/span_state.hpp"
#include "format/model/vec3.hpp"
#include "preprocessor/base/disjoint_sets.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <unordered_map>

namespace iga::prep {

namespace {

std::vector<std::int32_t> own_sets(std::size_t count) {
  std::vector<std::int32_t> parent(count);
  std::iota(parent.begin(), parent.end(), 0);
  return parent;
}

// A piece in the lower plane of a span without material bounds the span below.
void move_to_material(std::span<const Point3> polygon, Index3& ijk) {
  for (std::size_t d = 0; d < 3; ++d) {
    const auto plane = static_cast<double>(ijk[d]);
    if (ijk[d] > 0 && std::all_of(polygon.begin(), polygon.end(), [&](const Point3& v) { return v[d] == plane; }))
      --ijk[d];
  }
}

} // namespace

JoinedBodies find_joined_bodies(const SplineGrid& grid, const TriangleMesh& mesh, const Trimming& trimming) {
  const SurfacePieces& pieces = trimming.pieces;
  std::vector<std::int32_t> shell = own_sets(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    join_sets(shell, t[0], t[1]);
    join_sets(shell, t[0], t[2]);
  }
  // Signed volumes relative to a vertex of the shell itself: a cavity's is negative.
  std::unordered_map<std::int32_t, double> volume;
  for (const Triangle& t : mesh.triangles) {
    const std::int32_t root = find_root(shell, t[0]);
    const Point3& origin = mesh.vertices[static_cast<std::size_t>(root)];
    const auto from = [&](std::size_t a) { return minus(mesh.vertices[static_cast<std::size_t>(t[a])], origin); };
    volume[root] += dot(from(0), cross(from(1), from(2)));
  }
  JoinedBodies out;
  for (const auto& [root, v] : volume) out.bodies += v > 0;
  out.groups = out.bodies;
  if (out.bodies < 2) return out;

  std::vector<std::int32_t> group = own_sets(mesh.vertices.size());
  std::unordered_map<std::int64_t, std::int32_t> first; // body that a function meets first
  const auto p = grid.degree();
  const auto join_functions = [&](const Index3& ijk, std::int32_t body) {
    for (int c = 0; c <= p[2]; ++c)
      for (int b = 0; b <= p[1]; ++b)
        for (int a = 0; a <= p[0]; ++a) {
          const auto [entry, added] =
              first.try_emplace(grid.function_number({ijk[0] + a, ijk[1] + b, ijk[2] + c}), body);
          if (!added) join_sets(group, entry->second, body);
        }
  };
  std::set<std::pair<std::int64_t, std::int32_t>> seen; // span, body
  for (std::size_t s = 0; s < pieces.spans.size(); ++s)
    for (std::int64_t q = pieces.offsets[s]; q < pieces.offsets[s + 1]; ++q) {
      const auto triangle = static_cast<std::size_t>(pieces.triangle[static_cast<std::size_t>(q)]);
      const std::int32_t body = find_root(shell, mesh.triangles[triangle][0]);
      if (volume[body] <= 0) continue;
      Index3 ijk = grid.span_index(pieces.spans[s]);
      if (trimming.state[static_cast<std::size_t>(pieces.spans[s])] == static_cast<std::uint8_t>(SpanState::Exterior))
        move_to_material(pieces.polygon(q), ijk);
      if (seen.insert({grid.span_number(ijk), body}).second) join_functions(ijk, body);
    }
  out.groups = 0;
  for (const auto& [root, v] : volume) out.groups += v > 0 && find_root(group, root) == root;
  return out;
}

} // namespace iga::prep
