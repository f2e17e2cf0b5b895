#include "solver/space/nearest_span.hpp"

#include "format/model/span_state.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/cell_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iga::solve {

namespace {

// Distances (in spans) closer than this count as equal: far above the rounding of parameters, far below a sliver.
constexpr double same_distance = 1e-9;

class Search {
 public:
  Search(const TrimmedModel& model, const Point3& u, const Point3& outward)
      : model_(model), normal_(model.grid.along_axes(outward)) {
    const SplineGrid& grid = model.grid;
    for (std::size_t d = 0; d < 3; ++d) {
      xi_[d] = (u[d] - grid.A()[d]) / grid.span_size()[d];
      home_[d] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(xi_[d])), 0, grid.spans()[d] - 1);
    }
  }

  // Spans of growing boxes around the home span: those beyond a box of radius r lie at least r away.
  void run() {
    const Index3 n = model_.grid.spans();
    const std::int64_t largest = std::max({n[0], n[1], n[2]});
    for (std::int64_t r = 1; r <= largest; r *= 2) {
      for (std::int64_t k = std::max<std::int64_t>(home_[2] - r, 0); k <= std::min(home_[2] + r, n[2] - 1); ++k)
        for (std::int64_t j = std::max<std::int64_t>(home_[1] - r, 0); j <= std::min(home_[1] + r, n[1] - 1); ++j)
          for (std::int64_t i = std::max<std::int64_t>(home_[0] - r, 0); i <= std::min(home_[0] + r, n[0] - 1); ++i)
            consider({i, j, k});
      if (span_ >= 0 && distance_ <= static_cast<double>(r) - same_distance) return;
    }
    for (const std::int64_t span : model_.cells.span) consider(model_.grid.span_index(span));
  }

  NearestSpan found(const Point3& u) const {
    const Box3 box = model_.grid.span_box(model_.grid.span_index(span_));
    NearestSpan nearest{static_cast<std::int64_t>(choose_cell(model_, span_, u)), distance_, u};
    for (std::size_t d = 0; d < 3; ++d) nearest.parameter[d] = std::clamp(u[d], box.lower[d], box.upper[d]);
    return nearest;
  }

 private:
  void consider(const Index3& ijk) {
    const std::int64_t span = model_.grid.span_number(ijk);
    if (model_.state[static_cast<std::size_t>(span)] == static_cast<std::uint8_t>(SpanState::Exterior)) return;
    Point3 gap{};
    double height = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const auto low = static_cast<double>(ijk[d]);
      gap[d] = xi_[d] - std::clamp(xi_[d], low, low + 1);
      height += normal_[d] * model_.grid.span_size()[d] * (low + 0.5 - xi_[d]);
    }
    const double distance = norm(gap);
    const bool as_near = std::abs(distance - distance_) <= same_distance;
    const bool better = as_near ? height < height_ || (height == height_ && span < span_) : distance < distance_;
    if (span_ >= 0 && !better) return;
    span_ = span;
    distance_ = distance;
    height_ = height;
  }

  const TrimmedModel& model_;
  Point3 xi_{}, normal_{};
  Index3 home_{};
  std::int64_t span_ = -1;
  double distance_ = std::numeric_limits<double>::infinity();
  double height_ = 0;
};

} // namespace

NearestSpan nearest_span(const TrimmedModel& model, const Point3& u, const Point3& outward) {
  Search search(model, u, outward);
  search.run();
  return search.found(u);
}

} // namespace iga::solve
