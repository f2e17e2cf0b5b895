#include "preprocessor/surface_untangle.hpp"

#include "preprocessor/surface_exact_mesh.hpp"
#include "preprocessor/surface_weld.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tbb/parallel_for.h>

namespace iga::prep {

namespace {

using Index = std::size_t;

/// Facets on the same three vertices: one stands for all, with the winding number's jump across it.
struct Sheet {
  Index facet = 0; ///< its outside is where the facet's normal points
  int jump = 0;    ///< inside less outside, > 0
  std::vector<std::int32_t> members;
};

std::vector<Sheet> make_sheets(const TriangleMesh& mesh) {
  std::map<Triangle, std::vector<std::int32_t>> groups;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    Triangle key = mesh.triangles[t];
    std::sort(key.begin(), key.end());
    groups[key].push_back(static_cast<std::int32_t>(t));
  }
  std::vector<Sheet> out;
  for (auto& [key, members] : groups) {
    const auto runs_up = [&, k = key](std::int32_t f) {
      const Triangle& t = mesh.triangles[static_cast<Index>(f)];
      const auto first = static_cast<Index>(std::find(t.begin(), t.end(), k[0]) - t.begin());
      return t[(first + 1) % 3] == k[1];
    };
    const auto up = std::count_if(members.begin(), members.end(), runs_up);
    const auto jump = 2 * up - static_cast<std::ptrdiff_t>(members.size());
    if (jump == 0) continue;
    const auto one =
        std::find_if(members.begin(), members.end(), [&](std::int32_t f) { return runs_up(f) == (jump > 0); });
    out.push_back({static_cast<Index>(*one), static_cast<int>(std::abs(jump)), members});
  }
  return out;
}

/// Whether the sheet parts winding number ≤ 0 from ≥ 1. On the sheet the others' solid angles sum to the mean of both
/// sides.
bool is_boundary(const TriangleMesh& mesh, const std::vector<std::int32_t>& all, const Sheet& sheet) {
  std::vector<std::int32_t> others;
  others.reserve(all.size());
  std::set_difference(all.begin(), all.end(), sheet.members.begin(), sheet.members.end(), std::back_inserter(others));
  Point3 x{};
  for (Index i = 0; i < 3; ++i) x = plus(x, times(corner(mesh, sheet.facet, i), 1.0 / 3));
  const double outside = std::round(winding_number(mesh, others, x) - 0.5 * sheet.jump);
  return outside < 0.5 && outside + sheet.jump > 0.5;
}

/// Sheets joined across edges with two sheets; they share one answer, given by the largest facet.
std::vector<bool> choose(const TriangleMesh& mesh, const std::vector<Sheet>& sheets) {
  std::vector<Triangle> triangles;
  for (const Sheet& s : sheets) triangles.push_back(mesh.triangles[s.facet]);
  const EdgeTable edges = make_edge_table(triangles);
  std::vector<Index> parent(sheets.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index s) {
    while (parent[s] != s) s = parent[s] = parent[parent[s]];
    return s;
  };
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() != 2 || edge_balance(uses) != 0) continue;
    const Index a = static_cast<Index>(uses[0].triangle), b = static_cast<Index>(uses[1].triangle);
    if (sheets[a].jump != sheets[b].jump) continue;
    parent[std::max(root(a), root(b))] = std::min(root(a), root(b));
  }
  const auto size = [&](Index s) { return norm(area_vector(mesh, sheets[s].facet)); };
  std::vector<Index> largest(sheets.size());
  std::iota(largest.begin(), largest.end(), Index{0});
  for (Index s = 0; s < sheets.size(); ++s)
    if (size(s) > size(largest[root(s)])) largest[root(s)] = s;
  std::vector<std::int32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<char> kept(sheets.size(), 0);
  tbb::parallel_for(Index{0}, sheets.size(), [&](Index s) {
    if (parent[s] == s) kept[s] = is_boundary(mesh, all, sheets[largest[s]]) ? 1 : 0;
  });
  std::vector<bool> out(sheets.size());
  for (Index s = 0; s < sheets.size(); ++s) out[s] = kept[root(s)] != 0;
  return out;
}

} // namespace

bool untangle_shells(Surface& surface, const Shells& shells, std::span<const std::int32_t> tangled) {
  Surface result = surface;
  std::vector<bool> keep(surface.mesh.triangles.size(), true);
  std::vector<Surface> pieces;
  for (std::int32_t s : tangled) {
    const auto& facets = shells.facets[static_cast<Index>(s)];
    for (std::int32_t f : facets) keep[static_cast<Index>(f)] = false;
    ExactMesh mesh;
    if (!to_exact_mesh(surface.mesh, facets, mesh)) return false;
    try {
      CGAL::Polygon_mesh_processing::experimental::autorefine(mesh, CGAL::parameters::visitor(RegionKeeper{}));
    } catch (const std::exception&) {
      return false;
    }
    Surface piece;
    append_exact_mesh(mesh, piece);
    weld_equal_vertices(piece);
    drop_collapsed_facets(piece);
    const std::vector<Sheet> sheets = make_sheets(piece.mesh);
    const std::vector<bool> chosen = choose(piece.mesh, sheets);
    std::vector<bool> stays(piece.mesh.triangles.size(), false);
    for (Index i = 0; i < sheets.size(); ++i) stays[sheets[i].facet] = chosen[i];
    keep_triangles(piece, stays);
    if (piece.mesh.triangles.empty() || !is_closed_chain(make_edge_table(piece.mesh.triangles))) return false;
    pieces.push_back(std::move(piece));
  }
  keep_triangles(result, keep);
  for (const Surface& piece : pieces) {
    const auto offset = static_cast<std::int32_t>(result.mesh.vertices.size());
    result.mesh.vertices.insert(result.mesh.vertices.end(), piece.mesh.vertices.begin(), piece.mesh.vertices.end());
    for (const Triangle& t : piece.mesh.triangles)
      result.mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    result.mesh.region.insert(result.mesh.region.end(), piece.mesh.region.begin(), piece.mesh.region.end());
    result.normals.insert(result.normals.end(), piece.normals.begin(), piece.normals.end());
  }
  surface = std::move(result);
  return true;
}

} // namespace iga::prep
