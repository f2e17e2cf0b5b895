#include "preprocessor/surface/surface_sheets.hpp"

#include "format/model/disjoint_sets.hpp"
#include "preprocessor/surface/surface_fill.hpp"
#include "preprocessor/surface/surface_shells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace iga::prep {

namespace {

using Index = std::size_t;

/// A lid with more than this share of an open shell's area is no repair: the shell is a sheet.
constexpr double largest_lid = 0.5;

/// Walls are looked for among so many patches only: each is tried.
constexpr Index most_walls_tried = 64;

/// Facets joined across edges of two facets.
struct Patch {
  std::vector<Index> facets;
  double area = 0;
  bool free_edges = false; ///< some edges belong to no other facet
  bool seams = false;      ///< some edges join it to others
  bool helps = true;       ///< every border edge is odd, and even without the patch
};

std::vector<Patch> find_patches(const TriangleMesh& mesh) {
  const EdgeTable edges = make_edge_table(mesh.triangles);
  std::vector<std::int32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (Index e = 0; e < edges.num_edges(); ++e)
    if (const auto uses = edges.edge(e); uses.size() == 2) join_sets(parent, uses[0].triangle, uses[1].triangle);
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  std::vector<Patch> patches;
  const auto patch_of = [&](std::int32_t t) {
    std::int32_t& n = number[static_cast<Index>(find_root(parent, t))];
    if (n < 0) {
      n = static_cast<std::int32_t>(patches.size());
      patches.emplace_back();
    }
    return static_cast<Index>(n);
  };
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    Patch& p = patches[patch_of(static_cast<std::int32_t>(t))];
    p.facets.push_back(t);
    p.area += 0.5 * norm(area_vector(mesh, t));
  }
  for (Index e = 0; e < edges.num_edges(); ++e) {
    const auto uses = edges.edge(e);
    if (uses.size() == 2) continue;
    for (const EdgeUse& use : uses) {
      const Index p = patch_of(use.triangle);
      const auto own =
          std::count_if(uses.begin(), uses.end(), [&](const EdgeUse& u) { return patch_of(u.triangle) == p; });
      (uses.size() == 1 ? patches[p].free_edges : patches[p].seams) = true;
      if (uses.size() % 2 == 0 || own % 2 == 0) patches[p].helps = false;
    }
  }
  return patches;
}

std::vector<bool> all_but(Index num_facets, const std::vector<Index>& facets) {
  std::vector<bool> keep(num_facets, true);
  for (Index t : facets) keep[t] = false;
  return keep;
}

void drop(Surface& surface, const std::vector<Index>& facets, DroppedSheets& out) {
  if (out.sheets++ == 0) out.where = corner(surface.mesh, facets.front(), 0);
  out.facets += static_cast<std::int64_t>(facets.size());
  for (Index t : facets) out.area += 0.5 * norm(area_vector(surface.mesh, t));
  keep_triangles(surface, all_but(surface.mesh.triangles.size(), facets));
}

/// Fins, smallest first: what a fin parted joins again when it goes.
void drop_fins(Surface& surface, DroppedSheets& out) {
  for (;;) {
    std::vector<Patch> patches = find_patches(surface.mesh);
    const Patch* smallest = nullptr;
    for (const Patch& p : patches)
      if (p.free_edges && p.seams && p.helps && (smallest == nullptr || p.area < smallest->area)) smallest = &p;
    if (smallest == nullptr) return;
    drop(surface, smallest->facets, out);
  }
}

/// The wall whose removal closes the surface and leaves the largest volume.
void drop_wall(Surface& surface, DroppedSheets& out) {
  const std::vector<Patch> patches = find_patches(surface.mesh);
  if (patches.size() > most_walls_tried) return;
  const Patch* best = nullptr;
  double largest = 0;
  for (const Patch& p : patches) {
    if (p.free_edges || !p.seams || !p.helps) continue;
    Surface trial = surface;
    keep_triangles(trial, all_but(trial.mesh.triangles.size(), p.facets));
    if (trial.mesh.triangles.empty() || !orient_facets(trial).orientable ||
        !is_closed_chain(make_edge_table(trial.mesh.triangles)))
      continue;
    const double volume = std::abs(volume_moments(trial.mesh).volume);
    if (volume <= largest) continue;
    largest = volume;
    best = &p;
  }
  if (best != nullptr) drop(surface, best->facets, out);
}

bool is_open(const TriangleMesh& mesh, const std::vector<std::int32_t>& facets) {
  std::vector<Triangle> own;
  for (std::int32_t f : facets) own.push_back(mesh.triangles[static_cast<Index>(f)]);
  return !is_closed_chain(make_edge_table(own));
}

/// Open shells beside closed ones that are no body with a hole.
void drop_open_shells(Surface& surface, DroppedSheets& out) {
  const Shells shells = find_shells(surface.mesh);
  std::vector<Index> sheets;
  for (Index s = 0; s < shells.count(); ++s) {
    if (!is_open(surface.mesh, shells.facets[s])) continue;
    std::vector<bool> keep(surface.mesh.triangles.size(), false);
    for (std::int32_t f : shells.facets[s]) keep[static_cast<Index>(f)] = true;
    Surface alone = surface;
    keep_triangles(alone, keep);
    if (fill_holes(alone).area > largest_lid * shells.area[s]) sheets.push_back(s);
  }
  if (sheets.size() == shells.count()) return;
  std::vector<Index> facets;
  for (Index s : sheets) facets.insert(facets.end(), shells.facets[s].begin(), shells.facets[s].end());
  if (facets.empty()) return;
  drop(surface, facets, out);
  out.sheets += static_cast<std::int64_t>(sheets.size()) - 1;
}

} // namespace

DroppedSheets drop_free_sheets(Surface& surface) {
  DroppedSheets out;
  const auto is_whole = [&] {
    return find_edge_defects(surface.mesh, make_edge_table(surface.mesh.triangles)).open == 0;
  };
  if (is_whole()) return out;
  drop_fins(surface, out);
  if (!is_whole()) drop_wall(surface, out);
  if (!is_whole()) drop_open_shells(surface, out);
  if (out.sheets > 0) orient_facets(surface);
  return out;
}

} // namespace iga::prep
