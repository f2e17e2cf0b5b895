#include "solver/stress/known_tractions.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/supports/support_rows.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace iga::solve {

namespace {

// Pieces of a span's surface: places in one box of this share of a span, and normals that differ by less than this.
constexpr double boxes_per_span = 4, normal_steps = 8;

/// A load or a support and the polygons that it acts on.
struct Region {
  std::vector<std::vector<std::size_t>> on_triangle; ///< numbers of polygons
  std::vector<ChosenPolygon> polygons;

  Region(const TrimmedModel& model, const RegionChoice& choice, const std::string& what)
      : on_triangle(model.surface.mesh.triangles.size()), polygons(choose_polygons(model, choice, what)) {
    for (std::size_t k = 0; k < polygons.size(); ++k) on_triangle[polygons[k].triangle].push_back(k);
  }

  bool holds(std::size_t triangle, const Point3& x, double rounding) const {
    return std::any_of(on_triangle[triangle].begin(), on_triangle[triangle].end(), [&](std::size_t k) {
      const auto& corners = polygons[k].corners;
      for (std::size_t a = 0; a < corners.size(); ++a) {
        const Point3 edge = minus(corners[(a + 1) % corners.size()], corners[a]);
        if (dot(cross(edge, minus(x, corners[a])), polygons[k].normal) < -rounding * norm(edge)) return false;
      }
      return true;
    });
  }
};

class Tractions {
 public:
  Tractions(const SolutionSpace& space, const SurfaceConditions& conditions)
      : model_(space.model()), rounding_(surface_depth(model_)), is_unknown_(model_.surface.mesh.triangles.size()) {
    for (const std::int64_t t : conditions.unknown) is_unknown_[static_cast<std::size_t>(t)] = 1;
    for (const Load& load : conditions.loads) {
      if (load.place.given() || volume_force(load, 1)) continue;
      LoadTerms terms = assemble_loads(space, 1, std::span(&load, 1));
      loads_.push_back(
          {Region(model_, load.region, fmt::format("load '{}'", load.name)), std::move(terms.surfaces[0]), load.rigid});
    }
    for (const Support& support : conditions.supports) {
      if (support.place.given()) continue;
      const std::string what = fmt::format("support '{}'", support.name);
      Held held{Region(model_, support.region, what), {}};
      held.prepared.support = support;
      if (support.radial)
        held.prepared.cylinder = fit_cylinder(model_, choose_region(model_, support.region, what), what);
      supports_.push_back(std::move(held));
    }
  }

  KnownTractions find() {
    const SurfacePoints& q = model_.surface.quadrature;
    out_.offsets = {0};
    for (std::size_t a = 0; a < model_.num_cells(); ++a) {
      const Box3 box = model_.grid.span_box(model_.grid.span_index(model_.cells.span[a]));
      Point3 centre = times(plus(box.lower, box.upper), 0.5), moment{};
      double area = 0;
      pieces_.clear();
      for (auto s = static_cast<std::size_t>(q.offsets[a]); s < static_cast<std::size_t>(q.offsets[a + 1]); ++s) {
        add_point(s, box);
        area += q.weights[s];
        moment = plus(moment, times(parameter(s), q.weights[s]));
      }
      if (area > 0) centre = times(moment, 1 / area);
      out_.centres.push_back(centre);
      for (const auto& [key, piece] : pieces_) finish(piece);
      out_.offsets.push_back(static_cast<std::int64_t>(out_.areas.size()));
    }
    return std::move(out_);
  }

 private:
  struct Acting {
    Region region;
    SurfaceLoad load;
    bool rigid;
  };
  struct Held {
    Region region;
    PreparedSupport prepared;
  };
  struct Piece {
    double area = 0;
    Point3 parameter{}, normal{}; ///< sums over the area
    Eigen::Vector3d traction = Eigen::Vector3d::Zero();
    bool unknown = false;
    std::vector<std::size_t> holders; ///< supports
  };

  Point3 parameter(std::size_t s) const {
    const double* u = &model_.surface.quadrature.parameters[3 * s];
    return {u[0], u[1], u[2]};
  }

  void add_point(std::size_t s, const Box3& box) {
    const SurfacePoints& q = model_.surface.quadrature;
    const Point3 u = parameter(s), x = model_.grid.to_position(u),
                 n{q.normals[3 * s], q.normals[3 * s + 1], q.normals[3 * s + 2]};
    const auto triangle = static_cast<std::size_t>(q.triangle[s]);
    std::vector<std::int64_t> key;
    for (std::size_t d = 0; d < 3; ++d) {
      const double share = (u[d] - box.lower[d]) / (box.upper[d] - box.lower[d]);
      key.push_back(static_cast<std::int64_t>(std::clamp(share * boxes_per_span, 0.0, boxes_per_span - 0.5)));
      key.push_back(static_cast<std::int64_t>(std::lround(n[d] * normal_steps)));
    }
    bool unknown = is_unknown_[triangle] != 0;
    Eigen::Vector3d traction = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < loads_.size(); ++k) {
      if (!loads_[k].region.holds(triangle, x, rounding_)) continue;
      key.push_back(static_cast<std::int64_t>(k));
      unknown = unknown || loads_[k].rigid;
      if (!loads_[k].rigid) traction += as_vector(loads_[k].load.traction(x, n));
    }
    std::vector<std::size_t> holders;
    for (std::size_t k = 0; k < supports_.size(); ++k) {
      if (!supports_[k].region.holds(triangle, x, rounding_)) continue;
      key.push_back(static_cast<std::int64_t>(loads_.size() + k));
      holders.push_back(k);
    }
    key.push_back(unknown ? -1 : -2);
    Piece& piece = pieces_[key];
    const double w = q.weights[s];
    piece.area += w;
    piece.parameter = plus(piece.parameter, times(u, w));
    piece.normal = plus(piece.normal, times(n, w));
    piece.traction += w * traction;
    piece.unknown = unknown;
    piece.holders = std::move(holders);
  }

  void finish(const Piece& piece) {
    if (piece.unknown || !(piece.area > 0)) return;
    const Point3 u = times(piece.parameter, 1 / piece.area), n = times(piece.normal, 1 / piece.area);
    Eigen::Matrix3d known = Eigen::Matrix3d::Identity();
    const Point3 unit = times(n, 1 / norm(n));
    for (const std::size_t k : piece.holders) {
      const FixedDirections fixed = fixed_directions(supports_[k].prepared, unit, model_.grid.to_position(u));
      for (std::size_t d = 0; d < static_cast<std::size_t>(fixed.count); ++d) {
        // Directions of several supports need not be perpendicular.
        const Eigen::Vector3d e = known * as_vector(fixed.direction[d]);
        if (e.norm() > 1e-6) known -= e * e.transpose() / e.squaredNorm();
      }
    }
    if (known.norm() < 1e-6) return; // all is held
    out_.parameters.push_back(u);
    out_.areas.push_back(piece.area);
    out_.normals.push_back(n);
    out_.known.push_back(known);
    out_.tractions.emplace_back(known * (piece.traction / piece.area));
  }

  const TrimmedModel& model_;
  double rounding_; // length
  std::vector<char> is_unknown_;
  std::vector<Acting> loads_;
  std::vector<Held> supports_;
  std::map<std::vector<std::int64_t>, Piece> pieces_; // of the cell at hand
  KnownTractions out_;
};

} // namespace

KnownTractions known_tractions(const SolutionSpace& space, const SurfaceConditions& conditions) {
  return Tractions(space, conditions).find();
}

} // namespace iga::solve
