#include "preprocessor/surface/prepare_surface.hpp"

#include "format/model/errors.hpp"
#include "preprocessor/surface/surface_crossings.hpp"
#include "preprocessor/surface/surface_fill.hpp"
#include "preprocessor/surface/surface_junctions.hpp"
#include "preprocessor/surface/surface_regions.hpp"
#include "preprocessor/surface/surface_sheets.hpp"
#include "preprocessor/surface/surface_shells.hpp"
#include "preprocessor/surface/surface_stitch.hpp"
#include "preprocessor/surface/surface_topology.hpp"
#include "preprocessor/surface/surface_union.hpp"
#include "preprocessor/surface/surface_weld.hpp"
#include "preprocessor/surface/surface_wrap.hpp"

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

/// Fifth powers of the diagonal (second moments) must neither overflow nor vanish, with room for sums and squares.
constexpr double least_size = 1e-30, largest_size = 1e30;

std::string at(const Point3& x) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", x[0], x[1], x[2]);
}

std::string counted(std::int64_t n, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

// The diagonal of a tiny box underflows to zero; that box still has an extent.
bool has_no_extent(const Box3& box) {
  return box.lower == box.upper;
}

/// One run over one surface: collects what was found on the way.
class Preparation {
 public:
  Preparation(ReadMesh input, const SurfaceOptions& options) : file_(std::move(input.file)), options_(options) {
    surface_.mesh = std::move(input.mesh);
    surface_.normals = std::move(input.facet_normals);
    surface_.normals.resize(surface_.mesh.triangles.size(), Point3{});
    out_.findings = std::move(input.notes);
    is_point_ = has_no_extent(bounding_box(surface_.mesh));
    weld_equal_vertices(surface_);
    collapsed_ = drop_collapsed_facets(surface_);
    // Facets without size may lie anywhere, so they go before the size is taken.
    if (!surface_.mesh.triangles.empty()) size_ = diagonal(bounding_box(surface_.mesh));
  }

  PreparedSurface run() {
    clean();
    if (options_.repair) {
      drop_sheets();
      close();
    }
    judge_closedness();
    judge_shells();
    judge_crossings();
    return finish();
  }

  /// A surface around this one instead of it, because of `reason`.
  PreparedSurface run_wrapped(const std::string& reason) {
    judge_size();
    const double alpha = options_.wrap_alpha.value_or(size_ / 50);
    const double offset = options_.wrap_offset.value_or(alpha / 30);
    if (!(alpha > 0) || !(offset > 0))
      refuse(fmt::format("wrap alpha is {} and offset {}; both must be positive lengths", alpha, offset));
    const double area = surface_area(surface_.mesh);
    surface_.mesh = wrap_surface(surface_.mesh, alpha, offset);
    // An open surface whose hole lets the wrap in is wrapped from both sides: twice the area, hardly any volume.
    const double volume = volume_moments(surface_.mesh).volume;
    if (surface_area(surface_.mesh) > 1.5 * area && volume < alpha * area)
      refuse(fmt::format(
          "wrapping gave only a skin around the facets (volume {:.4g}): a hole is wider than alpha = {:.4g}; {}a "
          "--wrap-alpha larger than the hole bridges it",
          volume, alpha, options_.repair ? "" : "--repair fills holes, "));
    surface_.normals.assign(surface_.mesh.triangles.size(), Point3{});
    found(fmt::format("not usable as it is ({})", reason));
    out_.shape_changed = out_.wrapped = true;
    judge_closedness();
    judge_shells();
    found(fmt::format(
        "wrapped: a closed surface around all facets with alpha {:.4g} and offset {:.4g} replaces the surface; "
        "it lies outside by about the offset, bridges gaps below alpha and rounds inner corners; volume {:.8g}",
        alpha, offset, volume));
    warn(fmt::format("the shape was approximated by wrapping, hollows without an opening wider than {:.4g} are filled: "
                     "compare the volume, {:.8g}, with the part's{}",
                     alpha, volume,
                     options_.repair ? ""
                                     : "; --repair, which was not tried, changes less (with both, the surface is "
                                       "wrapped only where --repair fails)"));
    return finish();
  }

 private:
  void found(std::string text) { out_.findings.push_back(std::move(text)); }
  void warn(std::string text) { out_.warnings.push_back(std::move(text)); }
  [[noreturn]] void refuse(const std::string& text) const { throw InputError(fmt::format("{}: {}", file_, text)); }

  /// What neither a repair nor wrapping can mend.
  void judge_size() const {
    if (is_point_) refuse("the surface has no extent: all vertices coincide; export the part again");
    if (surface_.mesh.triangles.empty())
      refuse("the surface has no area: every facet has two equal vertices; export the part again");
    if (!has_area(surface_.mesh))
      refuse("the surface has no area: the corners of every facet lie on a line; export the part again");
    if (!(size_ >= least_size && size_ <= largest_size))
      refuse(
          fmt::format("the box's diagonal is {:.3g}; lengths from {:.0e} to {:.0e} can be integrated: choose another "
                      "unit (--scale)",
                      size_, least_size, largest_size));
  }

  /// Repairs that leave the shape as it is.
  void clean() {
    judge_size();
    const std::int64_t facets_before = static_cast<std::int64_t>(surface_.mesh.triangles.size());
    const NearWeld near = weld_near_vertices(surface_);
    if (near.joined > 0)
      found(fmt::format("{} on open edges joined with a neighbour at most {:.3g} away ({:.0e} of the diagonal)",
                        counted(near.joined, "vertex", "vertices"), near.tolerance, near.tolerance / size_));
    const std::int64_t collapsed =
        collapsed_ + facets_before - static_cast<std::int64_t>(surface_.mesh.triangles.size());
    if (collapsed > 0) found(fmt::format("{} with coinciding vertices dropped", counted(collapsed, "facet", "facets")));
    join_junctions();
    drop_duplicates();
    if (const auto needles = count_needle_facets(surface_.mesh); needles > 0)
      found(
          fmt::format("{} without area kept: the surface would open along them", counted(needles, "facet", "facets")));
    orient();
  }

  /// Splits edges at junctions where that closes the surface: elsewhere the open edges are cracks or holes, and other
  /// repairs need them as they are.
  void join_junctions() {
    if (!has_open_edges(surface_.mesh)) return;
    Surface trial = surface_;
    const std::int64_t split = split_at_junctions(trial, touch_tolerance * size_);
    if (split == 0 || has_open_edges(trial.mesh)) return;
    surface_ = std::move(trial);
    found(fmt::format("{} split where vertices of a neighbour lie on an open edge",
                      counted(split, "facet was", "facets were")));
  }

  static bool has_open_edges(const TriangleMesh& mesh) {
    return find_edge_defects(mesh, make_edge_table(mesh.triangles)).open > 0;
  }

  void drop_duplicates() {
    const DuplicateFacets twins = drop_duplicate_facets(surface_);
    if (twins.repeated > 0)
      found(fmt::format("{} dropped", counted(twins.repeated, "duplicate facet", "duplicate facets")));
    if (twins.cancelled > 0)
      found(fmt::format("{} in opposite pairs dropped (walls between touching bodies)",
                        counted(twins.cancelled, "facet", "facets")));
    if (surface_.mesh.triangles.empty())
      refuse("the surface encloses nothing: its facets cancel in pairs; export the part as a solid");
  }

  void orient() {
    const Orienting orienting = orient_facets(surface_);
    if (!orienting.orientable)
      refuse(fmt::format("the surface is one-sided near {}: its facets cannot be turned to agree about the outside; "
                         "--wrap makes a closed surface around it",
                         at(orienting.where)));
    if (orienting.turned > 0)
      found(fmt::format("{} turned to agree with the neighbours",
                        counted(orienting.turned, "flipped facet", "flipped facets")));
  }

  /// Facets that bound no material would keep the surface open.
  void drop_sheets() {
    constexpr double much_dropped = 0.02;
    const double area = surface_area(surface_.mesh);
    const DroppedSheets dropped = drop_free_sheets(surface_);
    if (dropped.sheets == 0) return;
    out_.shape_changed = true;
    const std::string text =
        fmt::format("{} without material on one side dropped ({} of {:.4g} area, the first near {})",
                    counted(dropped.sheets, "sheet or wall", "sheets or walls"),
                    counted(dropped.facets, "facet", "facets"), dropped.area, at(dropped.where));
    found(text);
    if (dropped.area > much_dropped * area) warn(text + "; compare the volume with the part's");
  }

  /// Closes cracks and holes: narrow cracks first, wide ones only where that does not make a solid.
  void close() {
    if (is_closed_chain(make_edge_table(surface_.mesh.triangles))) return;
    struct Attempt {
      double max_gap;   ///< of cracks, in diagonals
      double max_ratio; ///< crack over edge length
    };
    for (const Attempt& attempt : {Attempt{1e-4, 0.05}, Attempt{1e-2, 0.5}})
      if (try_to_close(attempt.max_gap * size_, attempt.max_ratio)) return;
  }

  bool try_to_close(double max_gap, double max_ratio) {
    // More new surface than this share of the old one, or facets that only cancel, is guessing and not repair.
    constexpr double max_filled = 0.5, max_cancelled = 0.01, much_filled = 0.02;
    Surface trial = surface_;
    const double area = surface_area(trial.mesh);
    const Stitching stitching = stitch_open_edges(trial, max_gap, max_ratio);
    drop_duplicate_facets(trial);
    const Orienting first = orient_facets(trial);
    if (!first.orientable) return false;
    const Filling filling = fill_holes(trial);
    const double closed_area = surface_area(trial.mesh);
    drop_duplicate_facets(trial);
    const Orienting second = orient_facets(trial);
    if (!second.orientable || trial.mesh.triangles.empty() || !is_closed_chain(make_edge_table(trial.mesh.triangles)))
      return false;
    const Shells shells = find_shells(trial.mesh);
    double flat = closed_area - surface_area(trial.mesh);
    for (std::size_t s = 0; s < shells.count(); ++s)
      if (is_flat(shells, s)) flat += shells.area[s];
    if (filling.area > max_filled * area || flat > max_cancelled * area) return false;

    surface_ = std::move(trial);
    out_.shape_changed = true;
    if (stitching.joined > 0)
      found(fmt::format("cracks closed: {} on open edges joined, gaps up to {:.3g} ({:.1e} of the diagonal)",
                        counted(stitching.joined, "vertex", "vertices"), stitching.widest, stitching.widest / size_));
    if (const auto turned = first.turned + second.turned; turned > 0)
      found(fmt::format("{} turned to agree with the neighbours", counted(turned, "flipped facet", "flipped facets")));
    if (filling.holes > 0)
      found(fmt::format(
          "{} filled with {} of {:.4g} area ({:.2g} % of the surface; the first near {}); region \"repaired\"",
          counted(filling.holes, "hole", "holes"), counted(filling.facets, "facet", "facets"), filling.area,
          100 * filling.area / area, at(filling.where)));
    if (filling.area > much_filled * area)
      warn(fmt::format("{:.2g} % of the surface was missing and is guessed: compare the volume with the part's",
                       100 * filling.area / area));
    return true;
  }

  void judge_closedness() {
    const EdgeTable edges = make_edge_table(surface_.mesh.triangles);
    const EdgeDefects defects = find_edge_defects(surface_.mesh, edges);
    closed_ = is_closed_chain(edges);
    out_.open = !closed_;
    if (!closed_) {
      const bool open = defects.open > 0;
      const std::string text =
          open ? fmt::format("the surface is open: {} belong to an odd number of facets (first one near {})",
                             counted(defects.open, "edge", "edges"), at(defects.first_open))
               : fmt::format("the facets disagree about the outside at {} (first one near {})",
                             counted(defects.turned, "edge", "edges"), at(defects.first_turned));
      if (!options_.accept_leaks)
        refuse(fmt::format("{}; {}", text,
                           out_.wrapped ? "wrapping did not close it: mend the part where it was made"
                           : options_.repair
                               ? "--repair could not close it; as the last resort --wrap makes a closed surface around "
                                 "it, which only approximates the part"
                               : "--repair closes holes and gaps and drops free sheets"));
      warn(text + "; accepted as asked, volumes near it are wrong");
    }
    if (defects.non_manifold > 0)
      found(fmt::format("{} shared by more than two facets (bodies touch there); integrated exactly",
                        counted(defects.non_manifold, "edge", "edges")));
  }

  void judge_shells() {
    shells_ = find_shells(surface_.mesh);
    drop_flat_shells();
    const Nesting nesting = orient_shells(surface_, shells_, 2 * touch_tolerance * size_);
    out_.bodies = nesting.bodies;
    out_.cavities = nesting.cavities;
    if (nesting.whole_turned)
      found("the surface was inside out and was turned round");
    else if (!nesting.turned.empty())
      found(fmt::format("{} turned round", counted(static_cast<std::int64_t>(nesting.turned.size()),
                                                   "shell was inside out and was", "shells were inside out and were")));
    if (!nesting.doubled.empty()) judge_doubled(nesting.doubled);
  }

  /// A shell that encloses nothing beyond rounding.
  bool is_flat(const Shells& shells, std::size_t s) const {
    return !(std::abs(shells.volume[s]) > no_volume * size_ * shells.area[s]);
  }

  /// A shell thinner than rounding that lies within the box of a thicker one: dust between touching bodies.
  bool is_dust(std::size_t s) const {
    const auto thickness = [&](std::size_t i) { return 2 * std::abs(shells_.volume[i]) / shells_.area[i]; };
    if (thickness(s) > touch_tolerance * size_) return false;
    for (std::size_t o = 0; o < shells_.count(); ++o)
      if (thickness(o) > touch_tolerance * size_ &&
          box_contains(shells_.box[o], shells_.box[s], touch_tolerance * size_))
        return true;
    return false;
  }

  /// Shells that enclose nothing (a facet with its back, a folded sheet) add nothing but noise.
  void drop_flat_shells() {
    if (!closed_) return;
    std::vector<bool> keep(surface_.mesh.triangles.size(), true);
    std::int64_t flat = 0;
    double volume = 0;
    for (std::size_t s = 0; s < shells_.count(); ++s) {
      if (!is_flat(shells_, s) && !is_dust(s)) continue;
      ++flat;
      volume += std::abs(shells_.volume[s]);
      for (std::int32_t f : shells_.facets[s]) keep[static_cast<std::size_t>(f)] = false;
    }
    if (flat == 0) return;
    if (flat == static_cast<std::int64_t>(shells_.count()))
      refuse(fmt::format(
          "the surface encloses no volume ({} of {:.3g} area); a solid is needed: export the part as a closed "
          "body",
          counted(flat, "flat shell", "flat shells"), surface_area(surface_.mesh)));
    keep_triangles(surface_, keep);
    shells_ = find_shells(surface_.mesh);
    found(fmt::format("{} without thickness dropped (volume {:.2g} in all)", counted(flat, "shell", "shells"), volume));
  }

  /// Bodies inside bodies: the union takes them up where repairs are allowed.
  void judge_doubled(const std::vector<std::int32_t>& doubled) {
    if (options_.repair) {
      doubled_ = doubled;
      return;
    }
    const Box3& box = shells_.box[static_cast<std::size_t>(doubled.front())];
    const Point3 middle = plus(box.lower, times(minus(box.upper, box.lower), 0.5));
    const std::string text =
        fmt::format("{} outwards inside another body (first one around {}): its volume would count twice",
                    counted(static_cast<std::int64_t>(doubled.size()), "shell faces", "shells face"), at(middle));
    if (!options_.accept_leaks)
      refuse(text + "; --repair unites the bodies; turn the shell round where it is meant as a cavity");
    warn(text);
  }

  void count_bodies() {
    out_.cavities =
        static_cast<int>(std::count_if(shells_.volume.begin(), shells_.volume.end(), [](double v) { return v < 0; }));
    out_.bodies = static_cast<int>(shells_.count()) - out_.cavities;
  }

  void judge_crossings() {
    Crossings crossings = find_crossings(surface_.mesh, shells_, touch_tolerance * size_);
    add_hidden_overlaps(crossings);
    std::string failure;
    if (options_.repair && (crossings.pairs > 0 || !crossings.shells.empty() || !doubled_.empty())) {
      failure = unite(crossings);
      // The union is exact: what is left to look for is what rounding its vertices may have done.
      if (failure.empty()) crossings = find_crossings(surface_.mesh, shells_, touch_tolerance * size_);
    }
    if (crossings.pairs == 0 && crossings.shells.empty() && failure.empty()) return;
    std::string where =
        counted(static_cast<std::int64_t>(crossings.shells.size()), "pair of shells", "pairs of shells");
    if (crossings.pairs > 0)
      where += fmt::format(", {} (up to {:.3g} deep, deepest near {})",
                           counted(crossings.pairs, "pair of facets crosses", "pairs of facets cross"), crossings.depth,
                           at(crossings.where));
    const std::string advice =
        options_.repair ? fmt::format("--repair could not remove this ({}); mend the part where it was made, or, "
                                      "as the last resort, take --wrap, which only approximates the part",
                                      failure.empty() ? "facets still cross" : failure)
                        : "--repair keeps what is enclosed at least once";
    if ((!crossings.shells.empty() || !failure.empty()) && !options_.accept_leaks)
      refuse(fmt::format("bodies overlap or share part of their faces: {}; volume would count twice or walls would "
                         "stand without material; {}",
                         where, advice));
    warn(fmt::format("the surface crosses itself: {}; the volume there may count twice; {}", where, advice));
  }

  /// Facets of the shells that cross themselves or others or lie in another body, and of all shells beside them.
  std::vector<std::int32_t> facets_to_unite(const Crossings& crossings) const {
    std::vector<bool> marked(shells_.count(), false);
    const auto mark = [&](std::int32_t s) { marked[static_cast<std::size_t>(s)] = true; };
    for (const auto& [a, b] : crossings.facets) {
      mark(shells_.shell[static_cast<std::size_t>(a)]);
      mark(shells_.shell[static_cast<std::size_t>(b)]);
    }
    for (const auto& [a, b] : crossings.shells) {
      mark(a);
      mark(b);
    }
    for (std::int32_t s : doubled_) mark(s);
    const auto meet = [&](std::size_t a, std::size_t b) {
      for (std::size_t d = 0; d < 3; ++d)
        if (shells_.box[a].lower[d] > shells_.box[b].upper[d] || shells_.box[b].lower[d] > shells_.box[a].upper[d])
          return false;
      return true;
    };
    std::vector<std::int32_t> facets;
    for (std::size_t s = 0; s < shells_.count(); ++s) {
      bool in = marked[s];
      for (std::size_t o = 0; o < shells_.count() && !in; ++o) in = marked[o] && meet(s, o);
      if (in) facets.insert(facets.end(), shells_.facets[s].begin(), shells_.facets[s].end());
    }
    std::sort(facets.begin(), facets.end());
    return facets;
  }

  void after_rebuild() {
    weld_equal_vertices(surface_);
    drop_collapsed_facets(surface_);
    drop_duplicate_facets(surface_);
    shells_ = find_shells(surface_.mesh);
    out_.shape_changed = true;
    drop_flat_shells();
    count_bodies();
  }

  /// Overlaps without a crossing in the open, such as a box pushed into another along shared facet edges: a shell with
  /// facets inside and outside of another. Adds to `crossings.shells`.
  void add_hidden_overlaps(Crossings& crossings) const {
    for (const auto& [a, b] : crossings.touching) {
      if (std::binary_search(crossings.shells.begin(), crossings.shells.end(), std::pair(a, b))) continue;
      const double depth = 2 * touch_tolerance * size_;
      if (!reaches_in_and_out(surface_.mesh, shells_, a, b, depth) &&
          !reaches_in_and_out(surface_.mesh, shells_, b, a, depth))
        continue;
      crossings.shells.insert(std::upper_bound(crossings.shells.begin(), crossings.shells.end(), std::pair(a, b)),
                              {a, b});
    }
  }

  /// @return why it failed, empty on success
  std::string unite(const Crossings& crossings) {
    if (!closed_) return "the surface is open";
    const double before = volume_moments(surface_.mesh).volume;
    const std::size_t shells = shells_.count();
    constexpr std::int64_t steps = 1000;
    const auto progress = [&](double share) {
      if (options_.progress) options_.progress(static_cast<std::int64_t>(share * steps), steps);
    };
    const Uniting uniting = unite_by_winding(surface_, facets_to_unite(crossings), progress);
    if (!uniting.failure.empty()) return uniting.failure;
    after_rebuild();
    found(
        fmt::format("overlaps and self-intersections removed: {} cut, what is enclosed at least once stays; {} became "
                    "{}, volume {:.8g} became {:.8g}",
                    counted(uniting.cut_facets, "facet was", "facets were"),
                    counted(static_cast<std::int64_t>(shells), "shell", "shells"), shells_.count(), before,
                    volume_moments(surface_.mesh).volume));
    return {};
  }

  PreparedSurface finish() {
    const VolumeMoments moments = volume_moments(surface_.mesh);
    if (!(moments.volume > no_volume * size_ * size_ * size_) && !options_.accept_leaks)
      refuse(
          fmt::format("the surface encloses no volume ({:.3g}, the box's diagonal is {:.3g}); a closed solid is needed",
                      moments.volume, size_));
    if (options_.region_angle) split_regions(surface_.mesh, *options_.region_angle);
    out_.mesh = std::move(surface_.mesh);
    return std::move(out_);
  }

  std::string file_;
  const SurfaceOptions& options_;
  Surface surface_;
  Shells shells_;
  std::vector<std::int32_t> doubled_; ///< shells that face outwards inside another body
  double size_ = 0;                   ///< diagonal of the box of all facets with size as read, length
  bool is_point_ = false;             ///< all vertices as read coincide
  std::int64_t collapsed_ = 0;        ///< facets without size that were dropped first
  bool closed_ = false;
  PreparedSurface out_;
};

} // namespace

PreparedSurface prepare_surface(ReadMesh input, const SurfaceOptions& options) {
  if (!options.wrap) return Preparation(std::move(input), options).run();
  try {
    return Preparation(input, options).run();
  } catch (const InputError& reason) {
    return wrap_around(std::move(input), options, reason.what());
  }
}

PreparedSurface wrap_around(ReadMesh input, const SurfaceOptions& options, const std::string& reason) {
  return Preparation(std::move(input), options).run_wrapped(reason);
}

} // namespace iga::prep
