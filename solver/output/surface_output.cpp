#include "solver/output/surface_output.hpp"

#include "format/model/errors.hpp"
#include "format/model/vec3.hpp"
#include "solver/space/surface_cells.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unordered_map>

namespace iga::solve {

namespace {

// A picture of more triangles than this helps nobody and its fields outweigh the analysis.
constexpr double most_triangles = 2e7;

class Subdivision {
 public:
  /// Edges are measured along the grid's axes in `unit` (length per axis).
  Subdivision(const TrimmedModel& model, const Point3& unit, double longest)
      : grid_(model.grid), unit_(unit), longest_(longest), vertices_(model.surface.mesh.vertices),
        given_(vertices_.size()) {}

  void run(const TriangleMesh& mesh, const char* advice) {
    refuse_too_many(mesh, advice);
    std::vector<Piece> rest(mesh.triangles.size()), next;
    for (std::size_t t = 0; t < rest.size(); ++t) rest[t] = {mesh.triangles[t], t};
    while (!rest.empty()) {
      next.clear();
      middles_.clear(); // both triangles of an edge come by in the same round
      for (const Piece& piece : rest) halve_edges(piece, next);
      rest.swap(next);
    }
    for (const std::size_t t : cut_from_) region_.push_back(mesh.region[t]);
  }

  OutputMesh result(const TrimmedModel& model) && {
    OutputMesh out;
    const std::size_t n = vertices_.size();
    out.parameters = model.surface.vertex_parameters;
    out.cell = model.surface.vertex_cell;
    out.parameters.resize(3 * n);
    out.cell.resize(n);
    out.span.resize(n);
    const SurfaceCells surface(model);
    tbb::parallel_for(given_, n, [&](std::size_t v) {
      const CellPlace owner = surface.find(on_triangle_[v - given_], grid_.to_parameter(vertices_[v]));
      out.cell[v] = owner.cell;
      std::copy(owner.parameter.begin(), owner.parameter.end(), &out.parameters[3 * v]);
    });
    for (std::size_t v = 0; v < n; ++v) out.span[v] = model.cells.span[static_cast<std::size_t>(out.cell[v])];
    out.mesh = {std::move(vertices_), std::move(triangles_), std::move(region_), model.surface.mesh.region_names};
    return out;
  }

 private:
  struct Piece {
    Triangle corners;
    std::size_t triangle; ///< of the model that it is a part of
  };

  // No triangle of the result is larger than the equilateral one of the longest edge.
  void refuse_too_many(const TriangleMesh& mesh, const char* advice) const {
    double area = 0;
    for (const Triangle& t : mesh.triangles) area += 0.5 * norm(cross(edge(t[0], t[1]), edge(t[0], t[2])));
    const double least = area / (0.25 * std::sqrt(3.0) * longest_ * longest_);
    if (least > most_triangles)
      throw InputError(fmt::format("the surface would be cut into {:.2g} triangles, more than {:.2g}; {}", least,
                                   most_triangles, advice));
  }

  // From a to b along the grid's axes.
  Point3 edge(std::int32_t a, std::int32_t b) const {
    const Point3 along =
        grid_.along_axes(minus(vertices_[static_cast<std::size_t>(b)], vertices_[static_cast<std::size_t>(a)]));
    return {along[0] / unit_[0], along[1] / unit_[1], along[2] / unit_[2]};
  }

  double length2(std::int32_t a, std::int32_t b) const {
    const Point3 e = edge(a, b);
    return dot(e, e);
  }

  // Number of the middle of an edge that is too long, -1 for other edges; the same for both of its triangles.
  std::int32_t middle(const Piece& piece, std::size_t side) {
    const std::int32_t a = piece.corners[side], b = piece.corners[(side + 1) % 3];
    const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
    if (length2(std::min(a, b), std::max(a, b)) <= longest_ * longest_) return -1;
    const auto [entry, is_new] = middles_.try_emplace(low << 32 | high, static_cast<std::int32_t>(vertices_.size()));
    if (is_new) {
      const Point3 x = vertices_[low], y = vertices_[high];
      vertices_.push_back({0.5 * x[0] + 0.5 * y[0], 0.5 * x[1] + 0.5 * y[1], 0.5 * x[2] + 0.5 * y[2]});
      on_triangle_.push_back(piece.triangle);
    }
    return entry->second;
  }

  void halve_edges(const Piece& piece, std::vector<Piece>& next) {
    std::array<std::int32_t, 3> m{};
    for (std::size_t side = 0; side < 3; ++side) m[side] = middle(piece, side);
    const auto halved = static_cast<std::size_t>(std::count_if(m.begin(), m.end(), [](auto v) { return v >= 0; }));
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      next.push_back({{a, b, c}, piece.triangle});
    };
    if (halved == 0) {
      triangles_.push_back(piece.corners);
      cut_from_.push_back(piece.triangle);
      return;
    }
    // Turned so that side 0 is the only one halved, or the last one is the only whole one.
    std::size_t turn = 0;
    while ((halved == 1 && m[turn] < 0) || (halved == 2 && m[(turn + 2) % 3] >= 0)) ++turn;
    const std::int32_t a = piece.corners[turn], b = piece.corners[(turn + 1) % 3], c = piece.corners[(turn + 2) % 3];
    const std::int32_t ab = m[turn], bc = m[(turn + 1) % 3], ca = m[(turn + 2) % 3];
    if (halved == 1) {
      add(a, ab, c);
      add(ab, b, c);
    } else if (halved == 2) {
      add(ab, b, bc);
      if (length2(a, bc) <= length2(ab, c)) { // the quadrilateral's shorter diagonal
        add(a, ab, bc);
        add(a, bc, c);
      } else {
        add(a, ab, c);
        add(ab, bc, c);
      }
    } else {
      add(a, ab, ca);
      add(ab, b, bc);
      add(ca, bc, c);
      add(ab, bc, ca);
    }
  }

  const SplineGrid& grid_;
  Point3 unit_;
  double longest_;
  std::vector<Point3> vertices_;
  std::size_t given_;
  std::vector<std::size_t> on_triangle_; ///< of the model, for the vertices that were added
  std::unordered_map<std::uint64_t, std::int32_t> middles_;
  std::vector<Triangle> triangles_;
  std::vector<std::size_t> cut_from_; ///< triangle of the model that each triangle is a part of
  std::vector<std::int32_t> region_;
};

} // namespace

OutputMesh subdivide_surface(const TrimmedModel& model, int subdivide) {
  if (subdivide < 1) throw InputError(fmt::format("subdivide is {}, expected at least 1", subdivide));
  Subdivision subdivision(model, model.grid.span_size(), 1.0 / subdivide);
  subdivision.run(model.surface.mesh, "choose a smaller 'subdivide'");
  return std::move(subdivision).result(model);
}

OutputMesh refine_surface(const TrimmedModel& model, double longest) {
  if (!(longest > 0)) throw InputError(fmt::format("the longest edge is {}, expected a length above 0", longest));
  Subdivision subdivision(model, {1, 1, 1}, longest);
  subdivision.run(model.surface.mesh, "allow longer edges");
  return std::move(subdivision).result(model);
}

SurfaceResult sample_surface(const SolutionSpace& space, const ElasticMaterial& material, OutputMesh output,
                             const Eigen::Ref<const Eigen::MatrixXd>& unknowns, std::vector<double> steps,
                             Fields fields) {
  const SamplePoints points{output.cell, output.parameters};
  SurfaceResult result;
  result.fields = sample_fields(space, material, points, unknowns, fields);
  result.output = std::move(output);
  result.steps = std::move(steps);
  return result;
}

} // namespace iga::solve
