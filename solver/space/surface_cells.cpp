#include "solver/space/surface_cells.hpp"

#include "format/model/vec3.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace iga::solve {

namespace {

// Distances (in spans) closer than this count as equal: far above the rounding of parameters, far below a sliver.
constexpr double same_distance = 1e-9;

class Search {
 public:
  Search(const TrimmedModel& model, const Point3& u, const Point3& outward)
      : model_(model), normal_(model.grid.along_axes(outward)) {
    const SplineGrid& grid = model.grid;
    for (std::size_t d = 0; d < 3; ++d) xi_[d] = (u[d] - grid.A()[d]) / grid.span_size()[d];
  }

  // Cells of the spans around the one that holds the place: those beyond lie at least one away.
  template <class Visit> void for_near(Visit visit) const {
    const Index3 n = model_.grid.spans();
    Index3 home;
    for (std::size_t d = 0; d < 3; ++d)
      home[d] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(xi_[d])), 0, n[d] - 1);
    for (std::int64_t k = std::max<std::int64_t>(home[2] - 1, 0); k <= std::min(home[2] + 1, n[2] - 1); ++k)
      for (std::int64_t j = std::max<std::int64_t>(home[1] - 1, 0); j <= std::min(home[1] + 1, n[1] - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(home[0] - 1, 0); i <= std::min(home[0] + 1, n[0] - 1); ++i) {
          const auto [first, last] = model_.cells_of(model_.grid.span_number({i, j, k}));
          for (auto c = first; c < last; ++c) visit(static_cast<std::int64_t>(c));
        }
  }
  double distance() const { return distance_; }

  void consider(std::int64_t cell) {
    const Index3 ijk = model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(cell)]);
    Point3 gap{};
    double height = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const auto low = static_cast<double>(ijk[d]);
      gap[d] = xi_[d] - std::clamp(xi_[d], low, low + 1);
      height += normal_[d] * model_.grid.span_size()[d] * (low + 0.5 - xi_[d]);
    }
    const double distance = norm(gap);
    const bool as_near = std::abs(distance - distance_) <= same_distance;
    const bool better = as_near ? height < height_ || (height == height_ && cell < cell_) : distance < distance_;
    if (cell_ >= 0 && !better) return;
    cell_ = cell;
    distance_ = distance;
    height_ = height;
  }

  CellPlace found(const Point3& u) const {
    const Box3 box = model_.grid.span_box(model_.grid.span_index(model_.cells.span[static_cast<std::size_t>(cell_)]));
    CellPlace place{cell_, distance_, u};
    for (std::size_t d = 0; d < 3; ++d) place.parameter[d] = std::clamp(u[d], box.lower[d], box.upper[d]);
    return place;
  }

 private:
  const TrimmedModel& model_;
  Point3 xi_{}, normal_{};
  std::int64_t cell_ = -1;
  double distance_ = std::numeric_limits<double>::infinity();
  double height_ = 0;
};

// Few cells are looked at one by one.
constexpr std::size_t few = 27;

// A sliver without a cell keeps its surface, which belongs to a cell no more than its depth away.
constexpr double beyond_slivers = 2;

} // namespace

SurfaceCells::SurfaceCells(const TrimmedModel& model) : model_(model) {
  const SurfacePoints& points = model.surface.quadrature;
  std::vector<std::pair<std::int32_t, std::int64_t>> owners;
  for (std::size_t c = 0; c < model.num_cells(); ++c) {
    std::int32_t before = -1;
    for (auto q = points.offsets[c]; q < points.offsets[c + 1]; ++q) {
      const std::int32_t triangle = points.triangle[static_cast<std::size_t>(q)];
      if (triangle != before) owners.emplace_back(triangle, static_cast<std::int64_t>(c));
      before = triangle;
    }
  }
  std::sort(owners.begin(), owners.end());
  owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
  first_.assign(model.surface.mesh.triangles.size() + 1, 0);
  for (const auto& [triangle, cell] : owners) {
    ++first_[static_cast<std::size_t>(triangle) + 1];
    cells_.push_back(cell);
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

bool SurfaceCells::is_linked(std::int64_t a, std::int64_t b) const {
  const std::pair wanted{static_cast<std::int32_t>(std::min(a, b)), static_cast<std::int32_t>(std::max(a, b))};
  const std::size_t link = model_.links.first_from(wanted);
  return link < model_.links.size() && model_.links[link] == wanted;
}

CellPlace SurfaceCells::find(std::size_t triangle, const Point3& u) const {
  const TriangleMesh& mesh = model_.surface.mesh;
  const Triangle& t = mesh.triangles[triangle];
  const auto corner = [&](std::size_t a) { return mesh.vertices[static_cast<std::size_t>(t[a])]; };
  Point3 normal = twice_area(corner(0), corner(1), corner(2));
  if (const double length = norm(normal); length > 0) normal = times(normal, 1 / length);
  Search search(model_, u, normal);
  const auto cells = std::span(cells_).subspan(first_[triangle], first_[triangle + 1] - first_[triangle]);
  if (cells.empty())
    for (const std::int32_t v : t) search.consider(model_.surface.vertex_cell[static_cast<std::size_t>(v)]);
  if (cells.size() > few)
    search.for_near([&](std::int64_t cell) {
      if (std::binary_search(cells.begin(), cells.end(), cell)) search.consider(cell);
    });
  if (!(search.distance() <= 1 - same_distance))
    for (const std::int64_t cell : cells) search.consider(cell);
  if (search.distance() > beyond_slivers * model_.quadrature.sliver_tolerance + same_distance)
    search.for_near([&](std::int64_t cell) {
      if (std::any_of(cells.begin(), cells.end(), [&](std::int64_t own) { return is_linked(own, cell); }))
        search.consider(cell);
    });
  return search.found(u);
}

} // namespace iga::solve
