// Every pair of facets that meet adds its exact intersection to both: a point, a segment, or the outline of what two
// facets in one plane share. A facet is then triangulated with these as constraints. Facets that overlap in one plane
// are triangulated together, so that their common parts become the same triangles.
#include "preprocessor/surface/surface_arrangement.hpp"

#include "format/io/interrupt.hpp"
#include "format/model/disjoint_sets.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace iga::prep {

namespace {

using Index = std::size_t;
using Exact = ExactKernel;
using Fast = CGAL::Exact_predicates_inexact_constructions_kernel;
using Link = std::pair<std::int32_t, std::int32_t>;

struct Number {
  std::int32_t value = -1;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Exact>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Exact>;
using Planar =
    CGAL::Constrained_Delaunay_triangulation_2<Exact, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>,
                                               CGAL::Exact_intersections_tag>;

Fast::Point_3 fast_point(const Point3& x) {
  return {x[0], x[1], x[2]};
}

/// What is inserted into one facet's triangulation.
struct Constraints {
  std::vector<std::int32_t> points;
  std::vector<Link> segments;
};

class Arranger {
 public:
  Arranger(const TriangleMesh& mesh, std::span<const std::int32_t> facets, const std::function<void(double)>& progress)
      : mesh_(mesh), progress_(progress) {
    for (std::int32_t f : facets) {
      const auto t = static_cast<Index>(f);
      if (!CGAL::collinear(fast_corner(t, 0), fast_corner(t, 1), fast_corner(t, 2))) facets_.push_back(f);
    }
    constraints_.resize(facets_.size());
    partner_.resize(facets_.size());
    std::iota(partner_.begin(), partner_.end(), 0);
    number_.assign(mesh.vertices.size(), -1);
  }

  Arrangement run() {
    intersect_all();
    std::vector<std::vector<Index>> groups(facets_.size());
    for (Index i = 0; i < facets_.size(); ++i)
      groups[static_cast<Index>(find_root(partner_, static_cast<std::int32_t>(i)))].push_back(i);
    for (Index i = 0; i < groups.size(); ++i) {
      const auto& group = groups[i];
      if (group.empty()) continue;
      report(0.5, i, groups.size());
      const bool whole =
          group.size() == 1 && constraints_[group[0]].points.empty() && constraints_[group[0]].segments.empty();
      if (whole)
        add_whole(group[0]);
      else
        triangulate(group);
    }
    return std::move(out_);
  }

 private:
  // Half of the work is to intersect pairs, half to triangulate.
  void report(double before, Index done, Index total) const {
    if (progress_) progress_(before + 0.5 * static_cast<double>(done) / static_cast<double>(total));
  }

  Fast::Point_3 fast_corner(Index t, Index i) const { return fast_point(corner(mesh_, t, i)); }
  Fast::Triangle_3 fast_triangle(Index t) const { return {fast_corner(t, 0), fast_corner(t, 1), fast_corner(t, 2)}; }

  const Triangle& vertices(Index i) const { return mesh_.triangles[static_cast<Index>(facets_[i])]; }

  Exact::Triangle_3 exact_triangle(Index i) {
    const Triangle& v = vertices(i);
    const std::int32_t a = vertex(v[0]), b = vertex(v[1]), c = vertex(v[2]); // first: new points move the others
    return {point(a), point(b), point(c)};
  }

  const Exact::Point_3& point(std::int32_t n) const { return out_.points[static_cast<Index>(n)]; }

  std::int32_t number_of(const Exact::Point_3& p) {
    const auto [place, is_new] = known_.try_emplace(p, static_cast<std::int32_t>(out_.points.size()));
    if (is_new) out_.points.push_back(p);
    return place->second;
  }

  std::int32_t vertex(std::int32_t v) {
    std::int32_t& n = number_[static_cast<Index>(v)];
    if (n < 0) {
      const Point3& x = mesh_.vertices[static_cast<Index>(v)];
      n = number_of({x[0], x[1], x[2]});
    }
    return n;
  }

  /// Whether the two facets meet elsewhere than in what they share as a mesh; decided without constructions.
  bool meet_beyond_shared(Index i, Index j) const {
    const Triangle &a = vertices(i), &b = vertices(j);
    const auto s = static_cast<Index>(facets_[i]), t = static_cast<Index>(facets_[j]);
    std::array<std::int32_t, 3> only_a{}, only_b{};
    Index own_a = 0, own_b = 0;
    for (std::int32_t v : a)
      if (std::find(b.begin(), b.end(), v) == b.end()) only_a[own_a++] = v;
    for (std::int32_t v : b)
      if (std::find(a.begin(), a.end(), v) == a.end()) only_b[own_b++] = v;
    const auto x = [&](std::int32_t v) { return fast_point(mesh_.vertices[static_cast<Index>(v)]); };
    if (own_a == 3) return CGAL::do_intersect(fast_triangle(s), fast_triangle(t));
    if (own_a == 2)
      return CGAL::do_intersect(Fast::Segment_3(x(only_a[0]), x(only_a[1])), fast_triangle(t)) ||
             CGAL::do_intersect(Fast::Segment_3(x(only_b[0]), x(only_b[1])), fast_triangle(s));
    if (own_a == 1) return CGAL::coplanar(x(a[0]), x(a[1]), x(a[2]), x(only_b[0]));
    return true;
  }

  void intersect_all() {
    using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;
    std::vector<Box> boxes;
    for (Index i = 0; i < facets_.size(); ++i)
      boxes.emplace_back(fast_triangle(static_cast<Index>(facets_[i])).bbox(), static_cast<std::int32_t>(i));
    std::vector<Link> pairs;
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
      const std::int32_t i = std::min(a.info(), b.info()), j = std::max(a.info(), b.info());
      if (meet_beyond_shared(static_cast<Index>(i), static_cast<Index>(j))) pairs.emplace_back(i, j);
    });
    std::sort(pairs.begin(), pairs.end());
    for (Index k = 0; k < pairs.size(); ++k) {
      io::stop_if_interrupted();
      report(0, k, pairs.size());
      intersect(static_cast<Index>(pairs[k].first), static_cast<Index>(pairs[k].second));
    }
  }

  void intersect(Index i, Index j) {
    const auto common = CGAL::intersection(exact_triangle(i), exact_triangle(j));
    if (!common) return;
    if (const auto* p = boost::get<Exact::Point_3>(&*common)) {
      const std::int32_t n = number_of(*p);
      for (Index k : {i, j})
        if (!is_corner(k, n)) constraints_[k].points.push_back(n);
    } else if (const auto* segment = boost::get<Exact::Segment_3>(&*common)) {
      const Link link{number_of(segment->source()), number_of(segment->target())};
      for (Index k : {i, j})
        if (!is_corner(k, link.first) || !is_corner(k, link.second)) constraints_[k].segments.push_back(link);
    } else {
      // Overlap in one plane: the facets' own edges cut each other in the common triangulation.
      join_sets(partner_, static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    }
  }

  bool is_corner(Index i, std::int32_t n) {
    const Triangle& v = vertices(i);
    return std::any_of(v.begin(), v.end(), [&](std::int32_t w) { return vertex(w) == n; });
  }

  void add(std::int32_t a, std::int32_t b, std::int32_t c, Index i) {
    out_.triangles.push_back({a, b, c});
    out_.facet.push_back(facets_[i]);
  }

  void add_whole(Index i) {
    const Triangle& v = vertices(i);
    add(vertex(v[0]), vertex(v[1]), vertex(v[2]), i);
  }

  /// Facets in one plane, seen along the axis closest to its normal. @pre not empty
  void triangulate(const std::vector<Index>& group) {
    io::stop_if_interrupted();
    const Point3 n = area_vector(mesh_, static_cast<Index>(facets_[group[0]]));
    const Exact::Triangle_3 first = exact_triangle(group[0]);
    const Exact::Vector_3 normal = CGAL::cross_product(first[1] - first[0], first[2] - first[0]);
    int drop = 0;
    for (int d = 1; d < 3; ++d)
      if (std::abs(n[static_cast<Index>(d)]) > std::abs(n[static_cast<Index>(drop)])) drop = d;
    while (normal[drop] == 0) drop = (drop + 1) % 3; // an area that underflowed
    const int u = (drop + 1) % 3, v = (drop + 2) % 3;
    const auto flat = [&](const Exact::Point_3& p) { return Exact::Point_2(p[u], p[v]); };

    Planar planar;
    std::map<std::int32_t, Planar::Vertex_handle> placed;
    const auto place = [&](std::int32_t number) {
      const auto [at, is_new] = placed.try_emplace(number);
      if (is_new) {
        at->second = planar.insert(flat(point(number)));
        at->second->info().value = number;
      }
      return at->second;
    };
    std::set<Link> links;
    const auto link = [&](std::int32_t a, std::int32_t b) { links.emplace(std::min(a, b), std::max(a, b)); };
    for (Index i : group) {
      const Triangle& t = vertices(i);
      for (Index e = 0; e < 3; ++e) link(vertex(t[e]), vertex(t[(e + 1) % 3]));
      for (std::int32_t p : constraints_[i].points) place(p);
      for (const auto& [a, b] : constraints_[i].segments) link(a, b);
    }
    for (const auto& [a, b] : links) {
      place(a);
      place(b);
    }
    for (const auto& [a, b] : links) planar.insert_constraint(place(a), place(b));

    const auto lifted = [&](const Exact::Point_2& q) {
      std::array<Exact::FT, 3> x;
      x[static_cast<Index>(u)] = q[0];
      x[static_cast<Index>(v)] = q[1];
      x[static_cast<Index>(drop)] =
          first[0][drop] - (normal[u] * (q[0] - first[0][u]) + normal[v] * (q[1] - first[0][v])) / normal[drop];
      return Exact::Point_3(x[0], x[1], x[2]);
    };
    for (auto w : planar.finite_vertex_handles())
      if (w->info().value < 0) w->info().value = number_of(lifted(w->point()));

    struct Outline {
      Index facet;
      std::array<Exact::Point_2, 3> p;
      bool forward;
    };
    std::vector<Outline> outlines;
    for (Index i : group) {
      const Exact::Triangle_3 t = exact_triangle(i);
      Outline o{i, {flat(t[0]), flat(t[1]), flat(t[2])}, true};
      o.forward = CGAL::orientation(o.p[0], o.p[1], o.p[2]) == CGAL::LEFT_TURN;
      if (!o.forward) std::swap(o.p[1], o.p[2]);
      outlines.push_back(std::move(o));
    }
    for (auto f : planar.finite_face_handles()) {
      const std::int32_t a = f->vertex(0)->info().value, b = f->vertex(1)->info().value, c = f->vertex(2)->info().value;
      const Exact::Point_2 middle = CGAL::centroid(f->vertex(0)->point(), f->vertex(1)->point(), f->vertex(2)->point());
      for (const Outline& o : outlines) {
        bool inside = true;
        for (Index e = 0; e < 3 && inside && group.size() > 1; ++e)
          inside = CGAL::orientation(o.p[e], o.p[(e + 1) % 3], middle) == CGAL::LEFT_TURN;
        if (!inside) continue;
        if (o.forward)
          add(a, b, c, o.facet);
        else
          add(a, c, b, o.facet);
      }
    }
    out_.cut_facets += static_cast<std::int64_t>(group.size());
  }

  const TriangleMesh& mesh_;
  const std::function<void(double)>& progress_;
  std::vector<std::int32_t> facets_;     ///< those with area
  std::vector<Constraints> constraints_; ///< by facet
  std::vector<std::int32_t> partner_;    ///< facets that overlap in one plane, as disjoint sets
  std::vector<std::int32_t> number_;     ///< of each vertex of the mesh among the points, −1 before its first use
  std::map<Exact::Point_3, std::int32_t, Exact::Less_xyz_3> known_;
  Arrangement out_;
};

} // namespace

Arrangement arrange_facets(const TriangleMesh& mesh, std::span<const std::int32_t> facets,
                           const std::function<void(double share)>& progress) {
  return Arranger(mesh, facets, progress).run();
}

} // namespace iga::prep
