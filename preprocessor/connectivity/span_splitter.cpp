// On every face a sweep along its first axis cuts the face into trapezoids between traces; trapezoids that share a
// side, and stretches of the span's edges, are joined, so that regions need no order of loops. Compiled without fused
// operations, as the clipping: both spans at a face must see the same bits.
#include "preprocessor/connectivity/span_splitter.hpp"

#include "format/model/disjoint_sets.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace iga::prep {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

bool on_face(const Point3& v, std::size_t face) {
  return v[face / 2] == static_cast<double>(face % 2);
}

std::array<std::size_t, 2> axes_of(std::size_t face) {
  const std::size_t d = face / 2;
  return {d == 0 ? 1U : 0U, d == 2 ? 1U : 2U};
}

// Are the face's axes, ascending, right-handed for one who looks at it from outside the span?
bool right_handed(std::size_t face) {
  return (face / 2 != 1) == (face % 2 == 1);
}

double height(const FaceTrace& t, double x) {
  if (x == t.x0) return t.y0;
  if (x == t.x1) return t.y1;
  const long double s = (static_cast<long double>(x) - t.x0) / (static_cast<long double>(t.x1) - t.x0);
  return static_cast<double>(t.y0 + s * (static_cast<long double>(t.y1) - t.y0));
}

// A trace that runs to the right has the solid above it.
bool solid_above(const FaceTrace& t) {
  return t.x0 < t.x1;
}

std::size_t interval_at(const std::vector<double>& ends, double x) {
  const auto above = std::upper_bound(ends.begin(), ends.end(), x) - ends.begin();
  return static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(ends.size()) - 2));
}

} // namespace

std::int32_t SpanSplitter::add_node() {
  parent_.push_back(static_cast<std::int32_t>(parent_.size()));
  void_.push_back(0);
  return parent_.back();
}

std::int32_t SpanSplitter::root(std::int32_t node) {
  return find_root(parent_, node);
}

void SpanSplitter::join(std::int32_t a, std::int32_t b) {
  join_sets(parent_, a, b);
}

// The edge of a face that runs along one of its axes, at the lower or upper end of the other.
std::size_t SpanSplitter::edge_at(std::size_t face, std::size_t along, bool upper) const {
  const std::size_t d = face / 2, other = 3 - d - along;
  const std::size_t low_axis = std::min(d, other);
  const std::size_t face_bit = face % 2, other_bit = upper ? 1 : 0;
  return 4 * along + (low_axis == d ? face_bit + 2 * other_bit : other_bit + 2 * face_bit);
}

std::int32_t SpanSplitter::edge_node(std::size_t edge, std::size_t interval, std::size_t face) const {
  const std::size_t low_axis = edge / 4 == 0 ? 1 : 0;
  return first_edge_node_[edge] + static_cast<std::int32_t>(2 * interval + (face / 2 == low_axis ? 0 : 1));
}

void SpanSplitter::split(std::size_t touched) {
  touched_ = touched;
  reliable_ = true;
  num_pieces_ = 0;
  for (auto& list : traces_) list.clear();
  for (auto& list : edge_stretches_) list.clear();
  for (auto& list : trapezoids_) list.clear();
  for (auto& list : ends_) list.assign({0.0, 1.0});
  along_edge_.clear();
  load(touched);
  join_polygons();
  if (!reliable_) return;
  add_edge_nodes();
  for (std::size_t face = 0; face < 6; ++face) sweep(face);
  collect();
}

void SpanSplitter::load(std::size_t touched) {
  const SurfacePieces& pieces = trimming_->pieces;
  const Index3 ijk = grid_->span_index(pieces.spans[touched]);
  vertices_.clear();
  first_vertex_.assign(1, 0);
  in_face_.clear();
  covered_.fill(false);
  parent_.clear();
  void_.clear();
  for (std::int64_t q = pieces.offsets[touched]; q < pieces.offsets[touched + 1]; ++q) {
    std::array<bool, 6> flat{true, true, true, true, true, true};
    for (const Point3& xi : pieces.polygon(q)) {
      Point3 v;
      for (std::size_t d = 0; d < 3; ++d) {
        v[d] = xi[d] - static_cast<double>(ijk[d]) + 0.0; // never -0
        flat[2 * d] = flat[2 * d] && v[d] == 0;
        flat[2 * d + 1] = flat[2 * d + 1] && v[d] == 1;
      }
      vertices_.push_back(v);
    }
    first_vertex_.push_back(vertices_.size());
    in_face_.push_back(std::find(flat.begin(), flat.end(), true) != flat.end());
    for (std::size_t f = 0; f < 6; ++f) covered_[f] = covered_[f] || flat[f];
    add_node();
  }
  order_.resize(vertices_.size());
  std::iota(order_.begin(), order_.end(), 0);
  const auto at = [&](std::int32_t v) -> const Point3& { return vertices_[static_cast<std::size_t>(v)]; };
  std::sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) { return at(a) < at(b); });
  vertex_.resize(vertices_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const auto v = static_cast<std::size_t>(order_[i]);
    const bool same = i > 0 && at(order_[i]) == at(order_[i - 1]);
    vertex_[v] = same ? vertex_[static_cast<std::size_t>(order_[i - 1])] : order_[i];
  }
}

// Across shared edges. What is left without a partner is a trace.
void SpanSplitter::join_polygons() {
  edges_.clear();
  for (std::size_t q = 0; q + 1 < first_vertex_.size(); ++q) {
    if (in_face_[q]) continue;
    const std::size_t first = first_vertex_[q], last = first_vertex_[q + 1];
    for (std::size_t k = first; k < last; ++k) {
      const std::int32_t a = vertex_[k], b = vertex_[k + 1 == last ? first : k + 1];
      if (a != b) edges_.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(q), a < b ? 1 : -1});
    }
  }
  std::sort(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) {
    if (x.low != y.low) return x.low < y.low;
    return x.high != y.high ? x.high < y.high : x.polygon < y.polygon;
  });
  for (std::size_t i = 0; i < edges_.size();) {
    int net = 0;
    std::size_t end = i;
    for (; end < edges_.size() && edges_[end].low == edges_[i].low && edges_[end].high == edges_[i].high; ++end) {
      join(edges_[i].polygon, edges_[end].polygon);
      net += edges_[end].sign;
    }
    if (net > 0) add_trace(edges_[i].low, edges_[i].high, edges_[i].polygon);
    if (net < 0) add_trace(edges_[i].high, edges_[i].low, edges_[i].polygon);
    if (std::abs(net) > 1) reliable_ = false;
    i = end;
  }
}

// An edge of a polygon, anticlockwise seen from outside the solid: seen from outside the span, the solid's region on
// the face lies on its right.
void SpanSplitter::add_trace(std::int32_t from, std::int32_t to, std::int32_t polygon) {
  const Point3 &a = vertices_[static_cast<std::size_t>(from)], &b = vertices_[static_cast<std::size_t>(to)];
  std::array<std::size_t, 3> faces{};
  std::size_t count = 0;
  for (std::size_t face = 0; face < 6; ++face)
    if (on_face(a, face) && on_face(b, face)) faces[count++] = face;
  if (count == 0) {
    reliable_ = false; // an open edge inside the span
    return;
  }
  for (const Point3* v : {&a, &b}) // an end on an edge of the span divides it
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t e = axis == 0 ? 1 : 0, f = axis == 2 ? 1 : 2;
      const bool on_edge = ((*v)[e] == 0 || (*v)[e] == 1) && ((*v)[f] == 0 || (*v)[f] == 1);
      if (!on_edge) continue;
      ends_[4 * axis + ((*v)[e] == 1 ? 1U : 0U) + ((*v)[f] == 1 ? 2U : 0U)].push_back((*v)[axis]);
    }
  if (count == 1) {
    const auto [e, f] = axes_of(faces[0]);
    const Point3& start = right_handed(faces[0]) ? b : a;
    const Point3& stop = right_handed(faces[0]) ? a : b;
    traces_[faces[0]].push_back({start[e], start[f], stop[e], stop[f], polygon});
    return;
  }
  const auto outward = [](std::size_t face) {
    Point3 n{};
    n[face / 2] = face % 2 == 0 ? -1 : 1;
    return n;
  };
  const Point3 left = cross(outward(faces[0]), minus(a, b));
  const std::size_t face = dot(left, outward(faces[1])) < 0 ? faces[0] : faces[1];
  const std::size_t axis = 3 - faces[0] / 2 - faces[1] / 2;
  const std::size_t low = std::min(faces[0], faces[1]), high = std::max(faces[0], faces[1]);
  along_edge_.push_back(
      {4 * axis + low % 2 + 2 * (high % 2), face, std::min(a[axis], b[axis]), std::max(a[axis], b[axis]), polygon});
}

// Two nodes for every stretch of an edge, one for each face at it; joined where no trace runs between them.
void SpanSplitter::add_edge_nodes() {
  for (std::size_t edge = 0; edge < 12; ++edge) {
    auto& ends = ends_[edge];
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    first_edge_node_[edge] = static_cast<std::int32_t>(parent_.size());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const std::int32_t low = add_node(), high = add_node();
      const double middle = 0.5 * (ends[i] + ends[i + 1]);
      bool blocked = false;
      for (const AlongEdge& t : along_edge_) {
        if (t.edge != edge || middle < t.from || middle > t.to) continue;
        blocked = true;
        const std::int32_t solid = edge_node(edge, i, t.face);
        join(solid, t.polygon);
        void_[static_cast<std::size_t>(solid == low ? high : low)] = 1;
      }
      if (!blocked) join(low, high);
    }
  }
}

void SpanSplitter::sweep(std::size_t face) {
  const auto [e, f] = axes_of(face);
  const std::size_t bottom = edge_at(face, e, false), top = edge_at(face, e, true);
  std::vector<double> xs;
  std::vector<FaceTrace> sloped, upright;
  for (const FaceTrace& t : traces_[face]) {
    xs.push_back(t.x0);
    xs.push_back(t.x1);
    (t.x0 == t.x1 ? upright : sloped).push_back(t);
  }
  xs.insert(xs.end(), ends_[bottom].begin(), ends_[bottom].end());
  xs.insert(xs.end(), ends_[top].begin(), ends_[top].end());
  std::sort(xs.begin(), xs.end());
  xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
  const auto first_x = [](const FaceTrace& t) { return std::min(t.x0, t.x1); };
  const auto last_x = [](const FaceTrace& t) { return std::max(t.x0, t.x1); };
  const auto low_y = [](const FaceTrace& t) { return std::min(t.y0, t.y1); };
  std::stable_sort(sloped.begin(), sloped.end(), [&](auto& s, auto& t) { return first_x(s) < first_x(t); });
  std::stable_sort(upright.begin(), upright.end(),
                   [&](auto& s, auto& t) { return s.x0 != t.x0 ? s.x0 < t.x0 : low_y(s) < low_y(t); });

  std::vector<FaceTrace> active, at_x;
  std::vector<Trapezoid> left, column;
  std::size_t next = 0, next_upright = 0;
  for (std::size_t s = 0; s + 1 < xs.size(); ++s) {
    const double x0 = xs[s], x1 = xs[s + 1], middle = 0.5 * (x0 + x1);
    std::erase_if(active, [&](const FaceTrace& t) { return last_x(t) <= x0; });
    for (; next < sloped.size() && first_x(sloped[next]) <= x0; ++next) active.push_back(sloped[next]);
    std::stable_sort(active.begin(), active.end(), [&](const FaceTrace& a, const FaceTrace& b) {
      const double ya = height(a, middle), yb = height(b, middle);
      if (ya != yb) return ya < yb;
      return height(a, x0) + height(a, x1) < height(b, x0) + height(b, x1);
    });
    column.clear();
    for (std::size_t k = 0; k <= active.size(); ++k) {
      Trapezoid z{x0, x1, 0, 0, 1, 1, add_node()};
      const FaceTrace* below = k > 0 ? &active[k - 1] : nullptr;
      const FaceTrace* above = k < active.size() ? &active[k] : nullptr;
      if (below) {
        z.low0 = height(*below, x0);
        z.low1 = height(*below, x1);
      }
      if (above) {
        z.high0 = height(*above, x0);
        z.high1 = height(*above, x1);
      }
      column.push_back(z);
      if (z.high0 <= z.low0 && z.high1 <= z.low1) continue; // between traces on top of each other
      const auto bound = [&](const FaceTrace& t, bool solid) {
        if (solid)
          join(z.node, t.piece);
        else
          void_[static_cast<std::size_t>(z.node)] = 1;
      };
      if (below)
        bound(*below, solid_above(*below));
      else
        join(z.node, edge_node(bottom, interval_at(ends_[bottom], middle), face));
      if (above)
        bound(*above, !solid_above(*above));
      else
        join(z.node, edge_node(top, interval_at(ends_[top], middle), face));
    }
    if (s == 0) {
      join_edge(face, edge_at(face, f, false), column, true);
    } else {
      at_x.clear();
      for (; next_upright < upright.size() && upright[next_upright].x0 < x0; ++next_upright) {
      }
      for (; next_upright < upright.size() && upright[next_upright].x0 == x0; ++next_upright)
        at_x.push_back(upright[next_upright]);
      join_sides(left, column, at_x);
    }
    trapezoids_[face].insert(trapezoids_[face].end(), column.begin(), column.end());
    left.swap(column);
  }
  join_edge(face, edge_at(face, f, true), left, false);
}

// Trapezoids on either side of an abscissa, joined where they share more than upright traces.
void SpanSplitter::join_sides(const std::vector<Trapezoid>& left, const std::vector<Trapezoid>& right,
                              const std::vector<FaceTrace>& upright) {
  std::size_t l = 0, r = 0;
  while (l < left.size() && r < right.size()) {
    const double low = std::max(left[l].low1, right[r].low0), high = std::min(left[l].high1, right[r].high0);
    if (low < high) {
      double covered = low;
      bool open = false;
      for (const FaceTrace& t : upright) {
        const double from = std::min(t.y0, t.y1), to = std::max(t.y0, t.y1);
        if (!(from < high && to > low)) continue;
        open = open || from > covered;
        covered = std::max(covered, to);
        const bool solid_left = t.y0 < t.y1;
        join(solid_left ? left[l].node : right[r].node, t.piece);
        void_[static_cast<std::size_t>(solid_left ? right[r].node : left[l].node)] = 1;
      }
      if (open || covered < high) join(left[l].node, right[r].node);
    }
    if (left[l].high1 < right[r].high0)
      ++l;
    else
      ++r;
  }
}

void SpanSplitter::join_edge(std::size_t face, std::size_t edge, const std::vector<Trapezoid>& column, bool at_start) {
  const auto& ends = ends_[edge];
  for (const Trapezoid& z : column) {
    const double low = at_start ? z.low0 : z.low1, high = at_start ? z.high0 : z.high1;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      if (std::max(low, ends[i]) < std::min(high, ends[i + 1])) join(z.node, edge_node(edge, i, face));
  }
}

// Numbers the pieces and hands their numbers to polygons, traces and regions.
void SpanSplitter::collect() {
  const std::size_t num_polygons = first_vertex_.size() - 1, num_nodes = parent_.size();
  struct Kind {
    bool sheet = false, region = false, is_void = false;
    double volume = 0, magnitude = 0;
  };
  std::vector<Kind> kind(num_nodes);
  const auto kind_of = [&](std::int32_t node) -> Kind& { return kind[static_cast<std::size_t>(root(node))]; };
  for (std::size_t q = 0; q < num_polygons; ++q) {
    if (in_face_[q]) continue;
    Kind& k = kind_of(static_cast<std::int32_t>(q));
    k.sheet = true;
    for (std::size_t v = first_vertex_[q] + 1; v + 1 < first_vertex_[q + 1]; ++v) {
      const double six = dot(vertices_[first_vertex_[q]], cross(vertices_[v], vertices_[v + 1]));
      k.volume += six / 6;
      k.magnitude += std::abs(six) / 6;
    }
  }
  bool crossed = !along_edge_.empty();
  for (std::size_t face = 0; face < 6; ++face) {
    crossed = crossed || !traces_[face].empty();
    for (const Trapezoid& z : trapezoids_[face]) kind_of(z.node).region = true;
  }
  for (std::size_t n = 0; n < num_nodes; ++n)
    if (void_[n]) kind_of(static_cast<std::int32_t>(n)).is_void = true;
  if (!crossed) { // the span's faces are one region: the rest of the volume tells which
    double closed = 0;
    for (const Kind& k : kind) closed += k.sheet ? k.volume : 0;
    kind_of(trapezoids_[0].front().node).is_void = trimming_->touched_fraction[touched_] - closed < 0.5;
  }

  piece_of_root_.assign(num_nodes, -1);
  bool cavities = false;
  const auto number = [&](std::int32_t node) {
    const auto r = static_cast<std::size_t>(root(node));
    const Kind& k = kind[r];
    if (piece_of_root_[r] >= 0) return;
    if (k.region) {
      if (k.is_void) {
        reliable_ = reliable_ && !k.sheet;
        return;
      }
      reliable_ = reliable_ && (k.sheet || !crossed);
    } else if (!(k.volume > 16 * epsilon * k.magnitude)) {
      cavities = true;
      return;
    }
    piece_of_root_[r] = num_pieces_++;
  };
  for (std::size_t q = 0; q < num_polygons; ++q)
    if (!in_face_[q]) number(static_cast<std::int32_t>(q));
  for (const auto& list : trapezoids_)
    for (const Trapezoid& z : list)
      if (z.high0 > z.low0 || z.high1 > z.low1) number(z.node);
  if (!reliable_) return;

  polygon_piece_.assign(num_polygons, -1);
  const auto piece_of = [&](std::int32_t node) { return piece_of_root_[static_cast<std::size_t>(root(node))]; };
  for (std::size_t q = 0; q < num_polygons; ++q)
    if (!in_face_[q]) polygon_piece_[q] = piece_of(static_cast<std::int32_t>(q));
  if (cavities) place_cavities();
  faces_.assign(6 * static_cast<std::size_t>(num_pieces_), FaceState::Empty);
  std::vector<std::uint8_t> partly(static_cast<std::size_t>(num_pieces_));
  for (std::size_t face = 0; face < 6; ++face) {
    for (FaceTrace& t : traces_[face]) t.piece = piece_of(t.piece);
    std::optional<std::int32_t> only;
    bool several = false;
    for (Trapezoid& z : trapezoids_[face]) {
      z.node = piece_of(z.node);
      if (z.high0 <= z.low0 && z.high1 <= z.low1) continue;
      several = several || (only && *only != z.node);
      only = z.node;
      if (z.node >= 0) faces_[6 * static_cast<std::size_t>(z.node) + face] = FaceState::Crossed;
    }
    if (!several && only && *only >= 0) faces_[6 * static_cast<std::size_t>(*only) + face] = FaceState::Full;
    const std::size_t edge = edge_at(face, axes_of(face)[1], true);
    for (std::size_t i = 0; i + 1 < ends_[edge].size(); ++i)
      if (const std::int32_t piece = piece_of(edge_node(edge, i, face)); piece >= 0)
        edge_stretches_[face].push_back({1, ends_[edge][i], 1, ends_[edge][i + 1], piece});
  }
}

// A closed sheet that bounds no body of its own belongs to the piece around it: the smallest closed body that encloses
// it, else the nearest other piece.
void SpanSplitter::place_cavities() {
  if (num_pieces_ == 0) return;
  const std::size_t num_polygons = first_vertex_.size() - 1;
  const std::vector<std::int32_t> known = polygon_piece_;
  for (std::size_t q = 0; q < num_polygons; ++q) {
    if (in_face_[q] || known[q] >= 0) continue;
    std::int32_t& piece = piece_of_root_[static_cast<std::size_t>(root(static_cast<std::int32_t>(q)))];
    if (piece < 0) piece = piece_around(q, known);
    polygon_piece_[q] = piece;
  }
}

std::int32_t SpanSplitter::piece_around(std::size_t cavity, const std::vector<std::int32_t>& known) {
  if (num_pieces_ == 1) return 0;
  struct Surroundings {
    double angle = 0, volume = 0, distance = std::numeric_limits<double>::infinity();
    bool closed = true;
  };
  std::vector<Surroundings> pieces(static_cast<std::size_t>(num_pieces_));
  for (std::size_t face = 0; face < 6; ++face)
    for (const Trapezoid& z : trapezoids_[face])
      if (const auto piece = piece_of_root_[static_cast<std::size_t>(root(z.node))]; piece >= 0)
        pieces[static_cast<std::size_t>(piece)].closed = false;
  const Point3 x = vertices_[first_vertex_[cavity]];
  for (std::size_t q = 0; q < known.size(); ++q) {
    if (known[q] < 0) continue;
    Surroundings& s = pieces[static_cast<std::size_t>(known[q])];
    const std::span<const Point3> polygon(vertices_.data() + first_vertex_[q], first_vertex_[q + 1] - first_vertex_[q]);
    s.distance = std::min(s.distance, distance_to_polygon(polygon, x));
    for (std::size_t v = 1; v + 1 < polygon.size(); ++v) {
      s.volume += dot(polygon[0], cross(polygon[v], polygon[v + 1])) / 6;
      s.angle += solid_angle({polygon[0], polygon[v], polygon[v + 1]}, x);
    }
  }
  std::int32_t best = -1;
  const auto at = [&](std::int32_t k) -> const Surroundings& { return pieces[static_cast<std::size_t>(k)]; };
  for (std::int32_t k = 0; k < num_pieces_; ++k)
    if (at(k).closed && at(k).angle > 2 * std::numbers::pi && (best < 0 || at(k).volume < at(best).volume)) best = k;
  if (best >= 0) return best;
  for (std::int32_t k = 0; k < num_pieces_; ++k)
    if (!at(k).closed && (best < 0 || at(k).distance < at(best).distance)) best = k;
  return std::max(best, 0);
}

std::int32_t SpanSplitter::piece_at(std::size_t face, double x, double y) const {
  for (const Trapezoid& z : trapezoids_[face]) {
    if (x < z.x0 || x > z.x1 || (z.high0 <= z.low0 && z.high1 <= z.low1)) continue;
    const double s = (x - z.x0) / (z.x1 - z.x0);
    if (y >= z.low0 + s * (z.low1 - z.low0) && y <= z.high0 + s * (z.high1 - z.high0)) return z.node;
  }
  return -1;
}

} // namespace iga::prep
