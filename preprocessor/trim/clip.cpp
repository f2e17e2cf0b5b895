// Slab clipping z → y → x. Each stage clips the polygon it was given to one closed slab at a time, and computes every
// crossing from the ends of the stage's own edge, from the lower end to the upper one: two triangles that share an
// edge, and two slabs that share a plane, get the same bits. (Compiled without fused operations for the same reason.)
#include "preprocessor/trim/clip.hpp"

#include "format/model/errors.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::prep {

namespace {

// A triangle has 3 vertices and each of the three slab clips adds at most two.
constexpr std::size_t max_vertices = 9;

struct Polygon {
  std::array<Point3, max_vertices> v;
  std::size_t n = 0;
  void push(const Point3& p) { v[n++] = p; }
};

struct SlabRange {
  std::int64_t first, last;
};

// Slabs [c, c + 1] of the n that a polygon occupies; one that lies in a plane belongs to the slab above it, in the
// grid's last plane to the last slab.
SlabRange slabs(const Polygon& p, std::size_t d, std::int64_t n) {
  double lo = p.v[0][d], hi = lo;
  for (std::size_t a = 1; a < p.n; ++a) {
    lo = std::min(lo, p.v[a][d]);
    hi = std::max(hi, p.v[a][d]);
  }
  const double first = std::min(std::floor(lo), static_cast<double>(n - 1));
  return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(std::max(first, std::ceil(hi) - 1))};
}

// Point of the edge (low, high) in the plane ξ_d = c, low[d] < c < high[d]. Stays inside the edge's own box.
template <std::size_t d> Point3 crossing(const Point3& low, const Point3& high, double c) {
  const double t = (c - low[d]) / (high[d] - low[d]);
  Point3 x;
  for (std::size_t e = 0; e < 3; ++e) {
    if (e == d) {
      x[e] = c;
      continue;
    }
    const double s = low[e] + t * (high[e] - low[e]);
    x[e] = low[e] <= high[e] ? std::clamp(s, low[e], high[e]) : std::clamp(s, high[e], low[e]);
  }
  return x;
}

// The part of a convex polygon in the closed slab c <= ξ_d <= c + 1.
template <std::size_t d> void clip_to_slab(const Polygon& in, double c, Polygon& out) {
  out.n = 0;
  const double top = c + 1;
  for (std::size_t a = 0; a < in.n; ++a) {
    const Point3& p = in.v[a];
    const Point3& q = in.v[a + 1 == in.n ? 0 : a + 1];
    if (p[d] >= c && p[d] <= top) out.push(p);
    if (p[d] < q[d]) {
      if (p[d] < c && q[d] > c) out.push(crossing<d>(p, q, c));
      if (p[d] < top && q[d] > top) out.push(crossing<d>(p, q, top));
    } else if (q[d] < p[d]) {
      if (q[d] < top && p[d] > top) out.push(crossing<d>(q, p, top));
      if (q[d] < c && p[d] > c) out.push(crossing<d>(q, p, c));
    }
  }
}

/// A triangle, or a block of the slabs of a large one.
struct WorkItem {
  std::int32_t triangle;
  SlabRange z, y;
  std::int64_t num_spans; ///< of its bounding box: a bound on the pieces it can give
};

/// Pieces in the order in which they were cut.
struct PieceBuffer {
  std::vector<std::int64_t> span;
  std::vector<std::int32_t> triangle;
  std::vector<std::uint8_t> size;
  std::vector<Point3> vertices;

  void add(std::int64_t s, std::int32_t t, const Polygon& p) {
    span.push_back(s);
    triangle.push_back(t);
    size.push_back(static_cast<std::uint8_t>(p.n));
    vertices.insert(vertices.end(), p.v.begin(), p.v.begin() + static_cast<std::ptrdiff_t>(p.n));
  }
};

// Nothing to cut along one axis: hand the polygon on as it is.
template <std::size_t d, class Next>
void for_each_slab(const Polygon& in, SlabRange range, std::int64_t n, Next&& next) {
  const SlabRange own = slabs(in, d, n);
  if (own.first == own.last) {
    if (range.first <= own.first && own.first <= range.last) next(own.first, in);
    return;
  }
  Polygon part;
  for (std::int64_t c = std::max(own.first, range.first); c <= std::min(own.last, range.last); ++c) {
    clip_to_slab<d>(in, static_cast<double>(c), part);
    if (part.n >= 3) next(c, part);
  }
}

void clip_item(const WorkItem& item, const Polygon& triangle, const Index3& n, PieceBuffer& out) {
  constexpr SlabRange all{INT64_MIN, INT64_MAX};
  for_each_slab<2>(triangle, item.z, n[2], [&](std::int64_t k, const Polygon& in_z) {
    for_each_slab<1>(in_z, item.y, n[1], [&](std::int64_t j, const Polygon& in_zy) {
      for_each_slab<0>(in_zy, all, n[0], [&](std::int64_t i, const Polygon& piece) {
        out.add(i + n[0] * (j + n[1] * k), item.triangle, piece);
      });
    });
  });
}

Polygon as_polygon(const TriangleMesh& mesh, const std::vector<Point3>& xi, std::size_t t) {
  Polygon p;
  for (std::size_t a = 0; a < 3; ++a) p.push(xi[static_cast<std::size_t>(mesh.triangles[t][a])]);
  return p;
}

// Work is shared in blocks of about this many spans; larger triangles are cut up.
constexpr std::int64_t spans_per_block = 16384;

// The block of slabs that starts at `first`. The outermost blocks have no end: rounding can put a part of a triangle
// that ends in a grid plane into the plane itself, and with it into the slab beyond the triangle's last one.
SlabRange block_of(SlabRange all, std::int64_t first, std::int64_t width) {
  const std::int64_t last = first + width - 1;
  return {first == all.first ? INT64_MIN : first, last >= all.last ? INT64_MAX : last};
}

std::vector<WorkItem> make_items(const TriangleMesh& mesh, const std::vector<Point3>& xi, const Index3& n) {
  std::vector<WorkItem> items;
  items.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Polygon p = as_polygon(mesh, xi, t);
    const SlabRange x = slabs(p, 0, n[0]), y = slabs(p, 1, n[1]), z = slabs(p, 2, n[2]);
    const std::int64_t nx = x.last - x.first + 1, ny = y.last - y.first + 1, nz = z.last - z.first + 1;
    const std::int64_t dz = std::clamp<std::int64_t>(spans_per_block / (nx * ny), 1, nz);
    const std::int64_t dy = dz > 1 ? ny : std::clamp<std::int64_t>(spans_per_block / nx, 1, ny);
    for (std::int64_t k = z.first; k <= z.last; k += dz)
      for (std::int64_t j = y.first; j <= y.last; j += dy)
        items.push_back({static_cast<std::int32_t>(t), block_of(z, k, dz), block_of(y, j, dy), nx * dy * dz});
  }
  return items;
}

// First items of the blocks, and the end.
std::vector<std::size_t> make_blocks(const std::vector<WorkItem>& items) {
  std::vector<std::size_t> first{0};
  std::int64_t spans = 0;
  for (std::size_t q = 0; q < items.size(); ++q) {
    spans += items[q].num_spans + 8; // a triangle costs something even where it is not cut
    if (spans < spans_per_block && q + 1 < items.size()) continue;
    first.push_back(q + 1);
    spans = 0;
  }
  return first;
}

struct PieceKey {
  std::int64_t span;
  std::int32_t block;
  std::int32_t piece;
  friend bool operator<(const PieceKey& a, const PieceKey& b) {
    if (a.span != b.span) return a.span < b.span;
    return a.block != b.block ? a.block < b.block : a.piece < b.piece;
  }
};

// Joins the blocks' pieces, sorted by span; within a span in the order of the triangles.
SurfacePieces join(const std::vector<PieceBuffer>& blocks) {
  std::vector<std::size_t> first(blocks.size() + 1, 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) first[b + 1] = first[b] + blocks[b].span.size();
  std::vector<PieceKey> keys(first.back());
  std::vector<std::vector<std::int64_t>> starts(blocks.size()); // first vertex of each piece of a block
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    std::int64_t vertex = 0;
    starts[b].resize(blocks[b].span.size());
    for (std::size_t q = 0; q < blocks[b].span.size(); ++q) {
      keys[first[b] + q] = {blocks[b].span[q], static_cast<std::int32_t>(b), static_cast<std::int32_t>(q)};
      starts[b][q] = vertex;
      vertex += blocks[b].size[q];
    }
  });
  tbb::parallel_sort(keys.begin(), keys.end());

  SurfacePieces out;
  out.triangle.resize(keys.size());
  out.vertex_offsets.resize(keys.size() + 1);
  out.vertex_offsets[0] = 0;
  const tbb::blocked_range<std::size_t> all(0, keys.size(), 4096);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t q = range.begin(); q != range.end(); ++q) {
      const auto& block = blocks[static_cast<std::size_t>(keys[q].block)];
      const auto piece = static_cast<std::size_t>(keys[q].piece);
      out.triangle[q] = block.triangle[piece];
      out.vertex_offsets[q + 1] = block.size[piece];
    }
  });
  for (std::size_t q = 0; q < keys.size(); ++q) {
    out.vertex_offsets[q + 1] += out.vertex_offsets[q];
    if (q == 0 || keys[q].span != keys[q - 1].span) {
      out.spans.push_back(keys[q].span);
      out.offsets.push_back(static_cast<std::int64_t>(q));
    }
  }
  out.offsets.push_back(static_cast<std::int64_t>(keys.size()));
  out.vertices.resize(static_cast<std::size_t>(out.vertex_offsets.back()));
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::size_t q = range.begin(); q != range.end(); ++q) {
      const auto b = static_cast<std::size_t>(keys[q].block);
      const auto piece = static_cast<std::size_t>(keys[q].piece);
      std::copy_n(blocks[b].vertices.begin() + starts[b][piece], blocks[b].size[piece],
                  out.vertices.begin() + out.vertex_offsets[q]);
    }
  });
  return out;
}

} // namespace

std::vector<Point3> to_span_units(const SplineGrid& grid, const TriangleMesh& mesh) {
  const Point3 A = grid.A(), h = grid.span_size();
  const Index3 n = grid.spans();
  std::vector<Point3> xi(mesh.vertices.size());
  for (std::size_t v = 0; v < xi.size(); ++v) {
    const Point3 u = grid.to_parameter(mesh.vertices[v]);
    for (std::size_t d = 0; d < 3; ++d) {
      xi[v][d] = (u[d] - A[d]) / h[d];
      if (!(xi[v][d] >= 0 && xi[v][d] <= static_cast<double>(n[d])))
        throw InputError(
            fmt::format("the part sticks out of the grid's box: vertex {} at ({:.9g}, {:.9g}, {:.9g}) lies "
                        "outside [{:.9g}, {:.9g}] along grid axis {}; enlarge the box",
                        v, mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2], A[d], grid.B()[d], "uvw"[d]));
    }
  }
  return xi;
}

SurfacePieces clip_to_spans(const SplineGrid& grid, const TriangleMesh& mesh) {
  const std::vector<Point3> xi = to_span_units(grid, mesh);
  const Index3 n = grid.spans();
  const std::vector<WorkItem> items = make_items(mesh, xi, n);
  const std::vector<std::size_t> first = make_blocks(items);
  std::vector<PieceBuffer> blocks(first.size() - 1);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    for (std::size_t q = first[b]; q < first[b + 1]; ++q)
      clip_item(items[q], as_polygon(mesh, xi, static_cast<std::size_t>(items[q].triangle)), n, blocks[b]);
  });
  return join(blocks);
}

} // namespace iga::prep
