#include "preprocessor/fit/span_moments.hpp"

#include "format/model/simd.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

/// What is integrated along the axis of the divergence theorem.
enum class AxisFactor {
  One,         ///< F_0 = 1 alone: projected moments
  ZeroAtLower, ///< F_a = G_a(x) - G_a(0): the lower face of the box adds nothing
  ZeroAtUpper  ///< F_a = G_a(x) - G_a(1): the upper face adds nothing (differs from the former in a = 0 only)
};

/// Eight points at a time in double precision, or one at a time in extended precision.
template <class Batch> struct BatchTraits;
template <> struct BatchTraits<Lanes> {
  using Scalar = double;
  static constexpr std::size_t size = lanes;
  static void set(Lanes& batch, std::size_t lane, double x) { batch[lane] = x; }
  static double total(const Lanes& batch) { return sum(batch); }
};
template <> struct BatchTraits<long double> {
  using Scalar = long double;
  static constexpr std::size_t size = 1;
  static void set(long double& batch, std::size_t, long double x) { batch = x; }
  static double total(long double batch) { return static_cast<double>(batch); }
};

/// Quadrature points on the surface, fed in batches to a tensor accumulator:
/// T[a + (q_a + 1) (b + (q_b + 1) c)] += w · F_a(x_axis) P_b(x_b) P_c(x_c) n_axis; b and c are the other axes,
/// ascending.
template <class Batch> class SurfaceIntegrator {
  using Traits = BatchTraits<Batch>;
  using Scalar = typename Traits::Scalar;

 public:
  SurfaceIntegrator(std::size_t axis, const std::array<int, 3>& degree, AxisFactor factor)
      : axis_(axis), b_(axis == 0 ? 1 : 0), c_(axis == 2 ? 1 : 2), factor_(factor),
        qa_(factor == AxisFactor::One ? 0 : degree[axis]), qb_(degree[b_]), qc_(degree[c_]),
        rule_(triangle_product_rule<Scalar>((factor == AxisFactor::One ? 0 : degree[axis] + 1) + degree[b_] +
                                            degree[c_])),
        sums_(static_cast<std::size_t>((qa_ + 1) * (qb_ + 1) * (qc_ + 1))) {}

  void add_triangle(const Point3& p, const Point3& q, const Point3& r) {
    const Scalar pa = p[axis_], pb = p[b_], pc = p[c_];
    const Scalar qb = q[b_] - pb, qc = q[c_] - pc, rb = r[b_] - pb, rc = r[c_] - pc;
    // Projected area along the axis; the pair (b, c) is cyclic for axes 0 and 2 and anticyclic for axis 1.
    const Scalar area = (axis_ == 1 ? Scalar(-0.5) : Scalar(0.5)) * (qb * rc - qc * rb);
    if (area == 0) return;
    const Scalar qa = q[axis_] - pa, ra = r[axis_] - pa;
    for (std::size_t k = 0; k < rule_.weights.size(); ++k) {
      const Scalar s = rule_.s[k], t = rule_.t[k];
      Traits::set(x_, filled_, pa + s * qa + t * ra);
      Traits::set(y_, filled_, pb + s * qb + t * rb);
      Traits::set(z_, filled_, pc + s * qc + t * rc);
      Traits::set(w_, filled_, area * rule_.weights[k]);
      if (++filled_ == Traits::size) flush();
    }
  }

  void add_polygon(std::span<const Point3> v) {
    for (std::size_t a = 1; a + 1 < v.size(); ++a) add_triangle(v[0], v[a], v[a + 1]);
  }

  /// Sum of entry (a, b, c).
  double value(int a, int b, int c) {
    return Traits::total(sums_[static_cast<std::size_t>(a + (qa_ + 1) * (b + (qb_ + 1) * c))]);
  }

  void finish() {
    if (filled_ == 0) return;
    for (std::size_t k = filled_; k < Traits::size; ++k) Traits::set(w_, k, 0);
    flush();
  }

 private:
  void flush() {
    filled_ = 0;
    if (qa_ == 1 && qb_ == 1 && qc_ == 1) return accumulate<1, 1, 1>();
    if (qa_ == 2 && qb_ == 2 && qc_ == 2) return accumulate<2, 2, 2>();
    if (qa_ == 3 && qb_ == 3 && qc_ == 3) return accumulate<3, 3, 3>();
    if (qa_ == 4 && qb_ == 4 && qc_ == 4) return accumulate<4, 4, 4>();
    if (qa_ == 0 && qb_ == 2 && qc_ == 2) return accumulate<0, 2, 2>();
    accumulate<-1, -1, -1>();
  }

  // Degrees known at compile time keep the polynomials and, at low degree, the sums in registers; -1 takes them at run
  // time.
  template <int QA, int QB, int QC> void accumulate() {
    const int qa = QA < 0 ? qa_ : QA, qb = QB < 0 ? qb_ : QB, qc = QC < 0 ? qc_ : QC;
    Batch F[max_moment_degree + 1]{}, B[max_moment_degree + 1]{}, C[max_moment_degree + 1]{};
    if (factor_ == AxisFactor::One)
      F[0] = Batch{} + 1.0;
    else
      legendre_integrals(x_, qa, F);
    if (factor_ == AxisFactor::ZeroAtUpper) F[0] -= 1.0;
    legendre(y_, qb, B);
    legendre(z_, qc, C);
    Batch* out = sums_.data();
    for (int c = 0; c <= qc; ++c) {
      const Batch wc = w_ * C[c];
      for (int b = 0; b <= qb; ++b) {
        const Batch wbc = wc * B[b];
        for (int a = 0; a <= qa; ++a) *out++ += wbc * F[a];
      }
    }
  }

  std::size_t axis_, b_, c_;
  AxisFactor factor_;
  int qa_, qb_, qc_;
  const TriangleProductRule<Scalar>& rule_;
  std::vector<Batch> sums_;
  Batch x_{}, y_{}, z_{}, w_{};
  std::size_t filled_ = 0;
};

// Below this share of its box a part is so thin (opposite sheets nearly cancel) that its moments are summed in extended
// precision; the pieces of the two sheets are closed to the last bit, so nothing else spoils them.
constexpr double thin_part = 1e-2;

bool all_crossed(const std::uint8_t* faces) {
  return std::all_of(faces, faces + 6,
                     [](std::uint8_t f) { return f == static_cast<std::uint8_t>(FaceState::Crossed); });
}

Point3 corner_of(const Index3& span) {
  return {static_cast<double>(span[0]), static_cast<double>(span[1]), static_cast<double>(span[2])};
}

/// The face that closes the divergence theorem: an empty one if there is any, else a full one.
struct Anchor {
  std::size_t axis = 0;
  bool upper = true;
  FaceState state = FaceState::Crossed; ///< Crossed: none of the faces will do
};

Anchor choose_anchor(const std::array<FaceState, 6>& faces) {
  for (const FaceState wanted : {FaceState::Empty, FaceState::Full})
    for (std::size_t f = 0; f < 6; ++f)
      if (faces[f] == wanted) return {f / 2, f % 2 == 1, wanted};
  return {};
}

} // namespace

void gather_local_surface(const SplineGrid& grid, const Trimming& trimming, std::size_t touched, LocalSurface& out) {
  const SurfacePieces& pieces = trimming.pieces;
  out.span = grid.span_index(pieces.spans[touched]);
  out.fraction = trimming.touched_fraction[touched];
  for (std::size_t f = 0; f < 6; ++f) out.faces[f] = static_cast<FaceState>(trimming.face_state[6 * touched + f]);
  out.vertices.clear();
  out.offsets.assign(1, 0);
  const Point3 corner = corner_of(out.span);
  Box3 box{{1, 1, 1}, {0, 0, 0}};
  for (std::int64_t q = pieces.offsets[touched]; q < pieces.offsets[touched + 1]; ++q) {
    const std::size_t start = out.vertices.size();
    std::array<bool, 3> flat{true, true, true};
    for (const Point3& xi : pieces.polygon(q)) {
      const Point3 v{xi[0] - corner[0], xi[1] - corner[1], xi[2] - corner[2]};
      for (std::size_t d = 0; d < 3; ++d) flat[d] = flat[d] && v[d] == 0;
      out.vertices.push_back(v);
    }
    if (flat[0] || flat[1] || flat[2]) {
      out.vertices.resize(start);
      continue;
    }
    out.offsets.push_back(static_cast<std::uint32_t>(out.vertices.size()));
  }
  for (const Point3& v : out.vertices)
    for (std::size_t d = 0; d < 3; ++d) {
      box.lower[d] = std::min(box.lower[d], v[d]);
      box.upper[d] = std::max(box.upper[d], v[d]);
    }
  for (std::size_t d = 0; d < 3; ++d) {
    if (out.faces[2 * d] == FaceState::Full) box.lower[d] = 0;
    if (out.faces[2 * d + 1] == FaceState::Full) box.upper[d] = 1;
  }
  out.box = box;
  for (Point3& v : out.vertices)
    for (std::size_t d = 0; d < 3; ++d) v[d] = (v[d] - box.lower[d]) / (box.upper[d] - box.lower[d]);
}

namespace {

// ∫ P_b(v) P_c(w) dA over a region of the face u+ = ∮ G_b(v) P_c(w) dw around it (Green), G_b the integral of P_b from
// 0.
void region_moments(const std::vector<std::array<double, 4>>& bounds, const std::array<int, 3>& degree, double* out) {
  const LineRule& rule = gauss_legendre((degree[1] + degree[2] + 3) / 2);
  std::fill_n(out, (degree[1] + 1) * (degree[2] + 1), 0.0);
  for (const auto& [v0, w0, v1, w1] : bounds)
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double s = rule.nodes[k], weight = rule.weights[k] * (w1 - w0);
      double G[max_moment_degree + 1]{}, P[max_moment_degree + 1]{};
      legendre_integrals(v0 + s * (v1 - v0), degree[1], G);
      legendre(w0 + s * (w1 - w0), degree[2], P);
      for (int c = 0; c <= degree[2]; ++c)
        for (int b = 0; b <= degree[1]; ++b) out[b + (degree[1] + 1) * c] += weight * G[b] * P[c];
    }
}

} // namespace

FarMoments::FarMoments(const SplineGrid& grid, const Trimming& trimming, const std::array<int, 3>& degree)
    : stride_(static_cast<std::size_t>((degree[1] + 1) * (degree[2] + 1))) {
  for (const auto& [touched, bounds] : trimming.far_bounds) {
    regions_.push_back(touched);
    region_values_.resize(regions_.size() * stride_);
    region_moments(bounds, degree, &region_values_[(regions_.size() - 1) * stride_]);
  }
  const SurfacePieces& pieces = trimming.pieces;
  const std::int64_t num_u = grid.spans()[0];
  struct Row {
    std::size_t first_needed, last_touched, first_slot;
  };
  std::vector<Row> rows;
  for (std::size_t t = 0, row_first = 0; t < pieces.spans.size(); ++t) {
    if (pieces.spans[t] / num_u != pieces.spans[row_first] / num_u) row_first = t;
    if (!all_crossed(&trimming.face_state[6 * t]) || std::binary_search(regions_.begin(), regions_.end(), t)) continue;
    if (rows.empty() || rows.back().last_touched <= t) {
      std::size_t last = t + 1;
      while (last < pieces.spans.size() && pieces.spans[last] / num_u == pieces.spans[t] / num_u) ++last;
      rows.push_back({t, last, spans_.size()});
    }
    spans_.push_back(t);
  }
  values_.resize(spans_.size() * stride_);
  const auto sum_row = [&](auto integrator, const Row& row, std::size_t slot) {
    for (std::size_t t = row.last_touched; t-- > row.first_needed;) {
      if (slot > row.first_slot && spans_[slot - 1] == t) {
        --slot;
        integrator.finish();
        double* out = &values_[slot * stride_];
        for (int c = 0; c <= degree[2]; ++c)
          for (int b = 0; b <= degree[1]; ++b) *out++ = integrator.value(0, b, c);
      }
      const Point3 corner = corner_of(grid.span_index(pieces.spans[t]));
      for (std::int64_t q = pieces.offsets[t]; q < pieces.offsets[t + 1]; ++q) {
        std::array<Point3, 9> v;
        const auto polygon = pieces.polygon(q);
        for (std::size_t a = 0; a < polygon.size(); ++a)
          v[a] = {polygon[a][0] - corner[0], polygon[a][1] - corner[1], polygon[a][2] - corner[2]};
        integrator.add_polygon(std::span<const Point3>(v.data(), polygon.size()));
      }
    }
  };
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t r) {
    const std::size_t slot_end = r + 1 < rows.size() ? rows[r + 1].first_slot : spans_.size();
    double smallest = 1;
    for (std::size_t slot = rows[r].first_slot; slot < slot_end; ++slot)
      smallest = std::min(smallest, trimming.touched_fraction[spans_[slot]]);
    if (smallest < thin_part)
      sum_row(SurfaceIntegrator<long double>(0, degree, AxisFactor::One), rows[r], slot_end);
    else
      sum_row(SurfaceIntegrator<Lanes>(0, degree, AxisFactor::One), rows[r], slot_end);
  });
}

const double* FarMoments::find(std::size_t touched) const {
  if (const auto it = std::lower_bound(regions_.begin(), regions_.end(), touched);
      it != regions_.end() && *it == touched)
    return &region_values_[static_cast<std::size_t>(it - regions_.begin()) * stride_];
  const auto it = std::lower_bound(spans_.begin(), spans_.end(), touched);
  if (it == spans_.end() || *it != touched) return nullptr;
  return &values_[static_cast<std::size_t>(it - spans_.begin()) * stride_];
}

void span_moments(const LocalSurface& surface, const double* far, const std::array<int, 3>& degree, double* moments) {
  const Anchor anchor = choose_anchor(surface.faces);
  const std::size_t b_axis = anchor.axis == 0 ? 1 : 0, c_axis = anchor.axis == 2 ? 1 : 2;
  const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(degree[0] + 1),
                                          static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1))};
  const auto integrate = [&](auto integrator) {
    for (std::size_t q = 0; q < surface.num_polygons(); ++q) integrator.add_polygon(surface.polygon(q));
    integrator.finish();
    for (int c = 0; c <= degree[c_axis]; ++c)
      for (int b = 0; b <= degree[b_axis]; ++b)
        for (int a = 0; a <= degree[anchor.axis]; ++a)
          moments[static_cast<std::size_t>(a) * stride[anchor.axis] + static_cast<std::size_t>(b) * stride[b_axis] +
                  static_cast<std::size_t>(c) * stride[c_axis]] = integrator.value(a, b, c);
  };
  // The far side of the box is the span's own face wherever the solid reaches it: its term vanishes by the choice of F.
  const AxisFactor factor = anchor.upper ? AxisFactor::ZeroAtLower : AxisFactor::ZeroAtUpper;
  if (surface.fraction < thin_part * surface.box_volume())
    integrate(SurfaceIntegrator<long double>(anchor.axis, degree, factor));
  else
    integrate(SurfaceIntegrator<Lanes>(anchor.axis, degree, factor));
  if (anchor.state == FaceState::Full) moments[0] += 1;
  if (anchor.state == FaceState::Crossed)
    for (int c = 0; c <= degree[2]; ++c)
      for (int b = 0; b <= degree[1]; ++b)
        moments[static_cast<std::size_t>(b) * stride[1] + static_cast<std::size_t>(c) * stride[2]] +=
            far[b + (degree[1] + 1) * c];
}

} // namespace iga::prep
