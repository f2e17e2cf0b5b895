#include "solver/report/surface_gap.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/bvh.hpp"
#include "solver/base/closest_point.hpp"

#include <numeric>

namespace iga::solve {

namespace {

// Triangles of each piece of the surface: those connected by vertices.
std::vector<std::vector<std::size_t>> pieces_of(const TriangleMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      auto& up = parent[static_cast<std::size_t>(v)];
      up = parent[static_cast<std::size_t>(up)];
      v = up;
    }
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : {t[1], t[2]}) {
      const auto a = root(t[0]), b = root(v);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  std::vector<std::int32_t> piece(mesh.vertices.size(), -1);
  std::vector<std::vector<std::size_t>> pieces;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& number = piece[static_cast<std::size_t>(root(mesh.triangles[t][0]))];
    if (number < 0) {
      number = static_cast<std::int32_t>(pieces.size());
      pieces.emplace_back();
    }
    pieces[static_cast<std::size_t>(number)].push_back(t);
  }
  return pieces;
}

using Corners = std::array<Point3, 3>;

Corners corners_of(const TriangleMesh& mesh, std::size_t t) {
  Corners x;
  for (std::size_t c = 0; c < 3; ++c) x[c] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][c])];
  return x;
}

Point3 normal_of(const Corners& x) {
  return cross(minus(x[1], x[0]), minus(x[2], x[0]));
}

// Nearest points of two triangles that do not cross: a corner and a triangle, or two edges.
SurfaceGap between(const Corners& a, const Corners& b) {
  SurfaceGap gap{HUGE_VAL, {}, {}};
  const auto take = [&](const Point3& from, const Point3& to) {
    if (const double width = norm(minus(to, from)); width < gap.width) gap = {width, from, to};
  };
  for (std::size_t c = 0; c < 3; ++c) {
    take(a[c], closest_on_triangle(a[c], b[0], b[1], b[2]).position);
    take(closest_on_triangle(b[c], a[0], a[1], a[2]).position, b[c]);
    for (std::size_t d = 0; d < 3; ++d) {
      const Point3 &a1 = a[(c + 1) % 3], &b1 = b[(d + 1) % 3];
      const ClosestOfSegments near = closest_of_segments(a[c], a1, b[d], b1);
      if (!near.interior) continue; // of the lines, not of the edges
      take(plus(a[c], times(minus(a1, a[c]), near.s)), plus(b[d], times(minus(b1, b[d]), near.t)));
    }
  }
  return gap;
}

} // namespace

std::optional<SurfaceGap> narrowest_gap(const TriangleMesh& mesh, double reach) {
  const auto pieces = pieces_of(mesh);
  std::vector<Bvh> trees;
  std::vector<Box3> whole;
  for (const auto& piece : pieces) {
    std::vector<Box3> boxes;
    for (const std::size_t t : piece) {
      const Corners x = corners_of(mesh, t);
      boxes.push_back(join(join({x[0], x[0]}, {x[1], x[1]}), {x[2], x[2]}));
    }
    whole.push_back(std::accumulate(boxes.begin(), boxes.end(), boxes.front(), join));
    trees.emplace_back(boxes);
  }
  std::optional<SurfaceGap> least;
  constexpr int halvings = 10; // short reaches first: they have few pairs
  for (double within = std::ldexp(reach, -halvings); !least && within <= reach; within *= 2)
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (std::size_t j = i + 1; j < pieces.size(); ++j) {
        if (!overlap(grown(whole[i], within), whole[j])) continue;
        trees[i].each_close_pair(
            trees[j], within, [](const Box3&, const Box3&) { return false; },
            [&](std::int32_t k, std::int32_t l) {
              const Corners a = corners_of(mesh, pieces[i][static_cast<std::size_t>(k)]),
                            b = corners_of(mesh, pieces[j][static_cast<std::size_t>(l)]);
              const SurfaceGap gap = between(a, b);
              const Point3 across = minus(gap.to, gap.from);
              if (gap.width > (least ? least->width : within) || dot(across, normal_of(a)) < 0 ||
                  dot(across, normal_of(b)) > 0)
                return;
              least = gap;
            });
      }
  return least;
}

} // namespace iga::solve
