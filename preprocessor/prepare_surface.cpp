#include "preprocessor/prepare_surface.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/surface_crossings.hpp"
#include "preprocessor/surface_regions.hpp"
#include "preprocessor/surface_shells.hpp"
#include "preprocessor/surface_topology.hpp"
#include "preprocessor/surface_weld.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace iga::prep {

namespace {

/// Facets that cross less deep than this times the diagonal only touch: float32 coordinates are no better than 6e-8 of
/// their size, and bodies that touch in an assembly differ by several roundings.
constexpr double touch_tolerance = 1e-6;

/// Volume below this times diagonal³ is none: a plate of 1e-5 of its diagonal has 1e-6.
constexpr double no_volume = 1e-12;

std::string at(const Point3& x) { return fmt::format("{:.6g} {:.6g} {:.6g}", x[0], x[1], x[2]); }

std::string counted(std::int64_t n, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

/// One run over one surface: collects what was found on the way.
class Preparation {
public:
  Preparation(ReadMesh input, const SurfaceOptions& options) : file_(std::move(input.file)), options_(options) {
    surface_.mesh = std::move(input.mesh);
    surface_.normals = std::move(input.facet_normals);
    surface_.normals.resize(surface_.mesh.triangles.size(), Point3{});
    out_.findings = std::move(input.notes);
    size_ = diagonal(bounding_box(surface_.mesh));
  }

  PreparedSurface run() {
    clean();
    judge_closedness();
    judge_shells();
    judge_crossings();
    return finish();
  }

private:
  void found(std::string text) { out_.findings.push_back(std::move(text)); }
  void warn(std::string text) { out_.warnings.push_back(std::move(text)); }
  [[noreturn]] void refuse(const std::string& text) const { throw InputError(fmt::format("{}: {}", file_, text)); }

  /// Repairs that leave the shape as it is.
  void clean() {
    if (!(size_ > 0)) refuse("the surface has no extent: all vertices coincide; export the part again");
    weld_equal_vertices(surface_);
    std::int64_t collapsed = drop_collapsed_facets(surface_);
    if (surface_.mesh.triangles.empty()) refuse("the surface has no area: every facet has two equal vertices; export the part again");
    const std::int64_t facets_before = static_cast<std::int64_t>(surface_.mesh.triangles.size());
    const NearWeld near = weld_near_vertices(surface_);
    if (near.joined > 0)
      found(fmt::format("{} on open edges joined with a neighbour at most {:.3g} away ({:.0e} of the diagonal)",
                        counted(near.joined, "vertex", "vertices"), near.tolerance, near.tolerance / size_));
    collapsed += facets_before - static_cast<std::int64_t>(surface_.mesh.triangles.size());
    if (collapsed > 0) found(fmt::format("{} with coinciding vertices dropped", counted(collapsed, "facet", "facets")));
    drop_duplicates();
    if (const auto needles = count_needle_facets(surface_.mesh); needles > 0)
      found(fmt::format("{} without area kept: the surface would open along them", counted(needles, "facet", "facets")));
    orient();
  }

  void drop_duplicates() {
    const DuplicateFacets twins = drop_duplicate_facets(surface_);
    if (twins.repeated > 0) found(fmt::format("{} dropped", counted(twins.repeated, "duplicate facet", "duplicate facets")));
    if (twins.cancelled > 0)
      found(fmt::format("{} in opposite pairs dropped (walls between touching bodies)",
                        counted(twins.cancelled, "facet", "facets")));
    if (surface_.mesh.triangles.empty()) refuse("the surface encloses nothing: its facets cancel in pairs; export the part as a solid");
  }

  void orient() {
    const Orienting orienting = orient_facets(surface_);
    if (!orienting.orientable)
      refuse(fmt::format("the surface is one-sided near {}: its facets cannot be turned to agree about the outside; "
                         "--wrap makes a closed surface around it", at(orienting.where)));
    if (orienting.turned > 0)
      found(fmt::format("{} turned to agree with the neighbours", counted(orienting.turned, "flipped facet", "flipped facets")));
  }

  void judge_closedness() {
    const EdgeTable edges = make_edge_table(surface_.mesh.triangles);
    const EdgeDefects defects = find_edge_defects(surface_.mesh, edges);
    closed_ = is_closed_chain(edges);
    if (!closed_) {
      const bool open = defects.open > 0;
      const std::string text =
          open ? fmt::format("the surface is open: {} belong to an odd number of facets (first one near {})",
                             counted(defects.open, "edge", "edges"), at(defects.first_open))
               : fmt::format("the facets disagree about the outside at {} (first one near {})",
                             counted(defects.turned, "edge", "edges"), at(defects.first_turned));
      if (!options_.accept_leaks)
        refuse(fmt::format("{}; {}", text,
                           options_.repair ? "--repair could not close it; --wrap makes a closed surface around it"
                                           : "--repair closes holes and gaps, --wrap makes a closed surface around it"));
      warn(text + "; accepted as asked, volumes near it are wrong");
    }
    if (defects.non_manifold > 0)
      found(fmt::format("{} shared by more than two facets (bodies touch there); integrated exactly",
                        counted(defects.non_manifold, "edge", "edges")));
  }

  void judge_shells() {
    shells_ = find_shells(surface_.mesh);
    drop_flat_shells();
    const Nesting nesting = orient_shells(surface_, shells_);
    out_.bodies = nesting.bodies;
    out_.cavities = nesting.cavities;
    if (nesting.whole_turned)
      found("the surface was inside out and was turned round");
    else if (!nesting.turned.empty())
      found(fmt::format("{} turned round", counted(static_cast<std::int64_t>(nesting.turned.size()), "shell was inside out and was",
                                                    "shells were inside out and were")));
    if (!nesting.doubled.empty()) refuse_or_warn_overlap(nesting.doubled);
  }

  /// Shells that enclose nothing (a facet with its back, a folded sheet) add nothing but noise.
  void drop_flat_shells() {
    std::vector<bool> keep(surface_.mesh.triangles.size(), true);
    std::int64_t flat = 0;
    for (std::size_t s = 0; s < shells_.count(); ++s) {
      if (!closed_ || std::abs(shells_.volume[s]) > no_volume * size_ * shells_.area[s]) continue;
      ++flat;
      for (std::int32_t f : shells_.facets[s]) keep[static_cast<std::size_t>(f)] = false;
    }
    if (flat == 0) return;
    if (flat == static_cast<std::int64_t>(shells_.count()))
      refuse(fmt::format("the surface encloses no volume ({} on {:.3g} of area); a solid is needed: export the part as a "
                         "closed body", counted(flat, "flat shell", "flat shells"), surface_area(surface_.mesh)));
    keep_triangles(surface_, keep);
    shells_ = find_shells(surface_.mesh);
    found(fmt::format("{} without volume dropped", counted(flat, "shell", "shells")));
  }

  void refuse_or_warn_overlap(const std::vector<std::int32_t>& doubled) {
    const Box3& box = shells_.box[static_cast<std::size_t>(doubled.front())];
    const Point3 middle = vec::add(box.lower, vec::mul(vec::sub(box.upper, box.lower), 0.5));
    const std::string text = fmt::format("{} inside another body and face outwards like it (first one around {}): their "
                                         "volume would count twice", counted(static_cast<std::int64_t>(doubled.size()), "shell lies", "shells lie"), at(middle));
    if (!options_.accept_leaks)
      refuse(text + "; --repair unites the bodies; turn the shell round if it is meant as a cavity");
    warn(text);
  }

  void judge_crossings() {
    const Crossings crossings = find_crossings(surface_.mesh, shells_, touch_tolerance * size_);
    if (crossings.pairs == 0) return;
    const std::string where = fmt::format("{} cross (up to {:.3g} deep, deepest near {})",
                                          counted(crossings.pairs, "pair of facets", "pairs of facets"), crossings.depth, at(crossings.where));
    if (!crossings.shells.empty() && !options_.accept_leaks)
      refuse(fmt::format("bodies overlap: {}, {} of shells; the overlap would count twice; --repair unites the bodies", where,
                         counted(static_cast<std::int64_t>(crossings.shells.size()), "pair", "pairs")));
    warn(fmt::format("the surface intersects itself: {}; the volume there may count twice; --repair removes it", where));
  }

  PreparedSurface finish() {
    const VolumeMoments moments = volume_moments(surface_.mesh);
    if (!(moments.volume > no_volume * size_ * size_ * size_) && !options_.accept_leaks)
      refuse(fmt::format("the surface encloses no volume ({:.3g}, the box's diagonal is {:.3g}); a closed solid is needed",
                         moments.volume, size_));
    if (options_.region_angle) split_regions(surface_.mesh, *options_.region_angle);
    out_.mesh = std::move(surface_.mesh);
    return std::move(out_);
  }

  std::string file_;
  const SurfaceOptions& options_;
  Surface surface_;
  Shells shells_;
  double size_ = 0;      ///< diagonal of the box as read, length
  bool closed_ = false;
  PreparedSurface out_;
};

} // namespace

PreparedSurface prepare_surface(ReadMesh input, const SurfaceOptions& options) {
  return Preparation(std::move(input), options).run();
}

} // namespace iga::prep
