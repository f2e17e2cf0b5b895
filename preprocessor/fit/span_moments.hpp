// Exact moments of the solid inside one trimmed span, from its surface pieces.
#pragma once

#include "preprocessor/base/gauss_rule.hpp"
#include "preprocessor/trim/trim.hpp"

#include <vector>

namespace iga::prep {

/// The surface inside one span in *box units*: the box around the solid's part in the span is [0, 1]³.
/// Pieces that lie flat on a lower face of the span are left out: they bound the neighbour or close the span's own
/// face.
struct LocalSurface {
  Index3 span{};
  Box3 box;                           ///< of the solid's part, in span units relative to the span's lower corner
  std::vector<Point3> vertices;       ///< of all polygons, box units
  std::vector<std::uint32_t> offsets; ///< (num_polygons + 1)
  std::array<FaceState, 6> faces{};   ///< of the span: u-, u+, v-, v+, w-, w+
  double fraction = 0;                ///< of the span's volume

  std::size_t num_polygons() const { return offsets.size() - 1; }
  std::span<const Point3> polygon(std::size_t q) const {
    return std::span(vertices).subspan(offsets[q], offsets[q + 1] - offsets[q]);
  }
  double box_volume() const {
    return (box.upper[0] - box.lower[0]) * (box.upper[1] - box.lower[1]) * (box.upper[2] - box.lower[2]);
  }
};

/// Gathers the pieces of the t-th touched span. `out` is reused without allocation once it has grown.
void gather_local_surface(const SplineGrid& grid, const Trimming& trimming, std::size_t touched, LocalSurface& out);

/// Projected moments ∫ P_b(v) P_c(w) n_u dA of everything further along u, for the spans whose six faces are all
/// crossed by the surface: the only ones whose moments need more than their own polygons. For cells of a split span the
/// same over their region on the face u+.
class FarMoments {
 public:
  FarMoments(const SplineGrid& grid, const Trimming& trimming, const std::array<int, 3>& degree);
  /// ((q_v + 1)(q_w + 1)) values, b fastest; nullptr for a span that needs none.
  const double* find(std::size_t touched) const;

 private:
  std::vector<std::size_t> spans_; // touched spans that need them, ascending
  std::vector<double> values_;
  std::vector<std::size_t> regions_; // touched entries of cells that need them, ascending
  std::vector<double> region_values_;
  std::size_t stride_ = 0;
};

/// Moments ∫ P_a(ξ) P_b(η) P_c(ζ) over the solid in the span, in box units (the whole box has M_000 = 1).
/// @param[out] moments  ((q_u + 1)(q_v + 1)(q_w + 1)), a fastest
/// Divergence theorem along the axis that has an empty or full span face, so that only the span's own pieces count and
/// the result is accurate relative to them, however small; along u with the far moments where all faces are crossed.
void span_moments(const LocalSurface& surface, const double* far, const std::array<int, 3>& degree, double* moments);

} // namespace iga::prep
