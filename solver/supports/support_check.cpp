#include "solver/supports/support_check.hpp"

#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/mechanics/rigid_modes.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace iga::solve {

namespace {

using Twist = Eigen::Matrix<double, 6, 1>; // velocity t at the body's centre, then ω · radius

// A motion is free where its mean square displacement along the fixed directions, per unit area of support, stays below
// this share of its own: a support of size r holds a body of size R to about (r / R)².
constexpr double free_below = 1e-11;
// Components of unit vectors below this are noise: normals of single precision mix free motions with held ones.
constexpr double small = 1e-4;

struct Body {
  double volume = 0, radius = 0, support_area = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 6> held = Eigen::Matrix<double, 6, 6>::Zero(); ///< ∫ (e · v)(e · v) dA over twists
  std::vector<std::string> names;                                         ///< of the run's bodies that it consists of
};

// A span belongs to the body of its nodes; one whose functions were all removed moves with none.
std::size_t body_of(const SystemBody& part, const Bodies& bodies, std::int64_t a) {
  const auto nodes = part.space->nodes(a);
  return nodes.empty() ? 0
                       : static_cast<std::size_t>(bodies.of_node[static_cast<std::size_t>(part.first_node + nodes[0])]);
}

std::vector<Body> measure(const BodySystem& system, const Bodies& bodies) {
  std::vector<Body> all(static_cast<std::size_t>(bodies.count));
  for (const SystemBody& part : system)
    for (std::int64_t a = 0; a < part.space->num_cells(); ++a) {
      auto& names = all[body_of(part, bodies, a)].names;
      if (names.empty() || names.back() != part.name) names.push_back(part.name);
    }
  const auto each = [&](auto&& use) {
    for (const SystemBody& part : system) {
      const TrimmedModel& model = part.space->model();
      for (std::size_t a = 0; a < model.cells.span.size(); ++a)
        for (std::int64_t q = model.points.offsets[a]; q < model.points.offsets[a + 1]; ++q) {
          const auto i = static_cast<std::size_t>(q);
          const double* u = model.points.parameters.data() + 3 * i;
          use(all[body_of(part, bodies, static_cast<std::int64_t>(a))],
              as_vector(model.grid.to_position({u[0], u[1], u[2]})), model.points.weights[i]);
        }
    }
  };
  each([](Body& body, const Eigen::Vector3d& x, double w) {
    body.volume += w;
    body.centre += w * x;
  });
  for (Body& body : all)
    if (body.volume > 0) body.centre /= body.volume;
  each([](Body& body, const Eigen::Vector3d& x, double) {
    body.radius = std::max(body.radius, (x - body.centre).norm());
  });
  return all;
}

void add_supports(const SystemBody& part, const Bodies& bodies, std::span<const PreparedSupport> supports,
                  std::vector<Body>& all) {
  for (const PreparedSupport& prepared : supports)
    for (std::size_t s = 0; s < prepared.region.cells.size(); ++s) {
      const PointBatch batch = gather(part.space->model(), prepared.region, s);
      Body& body = all[body_of(part, bodies, batch.cell)];
      // Lines and points count like strips and patches of the body's size.
      const Extent extent = prepared.region.report.extent;
      const double width = std::pow(body.radius, extent == Extent::Surface ? 0 : extent == Extent::Line ? 1 : 2);
      for (std::size_t q = 0; q < batch.size(); ++q) {
        const double area = width * batch.weights[q];
        body.support_area += area;
        const FixedDirections fixed = fixed_directions(prepared, batch.normals[q], batch.positions[q]);
        for (std::size_t d = 0; d < static_cast<std::size_t>(fixed.count); ++d) {
          const Eigen::Vector3d e = as_vector(fixed.direction[d]);
          Twist row;
          row.head<3>() = e;
          row.tail<3>() = (as_vector(batch.positions[q]) - body.centre).cross(e) / body.radius;
          body.held += area * row * row.transpose();
        }
      }
    }
}

// Orthonormal basis of the twists that no support resists.
Eigen::MatrixXd free_twists(const Body& body) {
  if (!(body.support_area > 0)) return Eigen::MatrixXd::Identity(6, 6);
  const SymmetricEigen eigen = symmetric_eigen(body.held / body.support_area);
  Eigen::Index count = 0;
  while (count < 6 && eigen.values[count] < free_below) ++count;
  return eigen.vectors.leftCols(count);
}

// The same space with as many zeros as possible: reduced row echelon form of the transposed basis, rows of length one.
Eigen::MatrixXd plain_basis(const Eigen::MatrixXd& basis) {
  Eigen::MatrixXd rows = basis.transpose();
  Eigen::Index row = 0;
  for (Eigen::Index c = 0; c < rows.cols() && row < rows.rows(); ++c) {
    Eigen::Index pivot = 0;
    if (rows.col(c).tail(rows.rows() - row).cwiseAbs().maxCoeff(&pivot) < small) continue;
    rows.row(row).swap(rows.row(row + pivot));
    rows.row(row) /= rows(row, c);
    for (Eigen::Index r = 0; r < rows.rows(); ++r)
      if (r != row) rows.row(r) -= rows(r, c) * rows.row(row);
    ++row;
  }
  rows = rows.unaryExpr([](double v) { return std::abs(v) < small ? 0.0 : v; });
  rows.rowwise().normalize();
  return rows.transpose();
}

std::string text(Eigen::Vector3d v, double unit) {
  for (double& c : v)
    if (std::abs(c) < small * unit) c = 0; // no "-0" and no rounding in messages
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]);
}

std::vector<std::string> describe(const Body& body, const Eigen::MatrixXd& twists) {
  std::vector<std::string> motions;
  // Combinations without rotation are translations; what is orthogonal to them rotates.
  const RightSingular turning = right_singular(twists.bottomRows(3));
  const Eigen::Index rotations = (turning.values.array() > small).count();
  const Eigen::Index translations = twists.cols() - rotations;
  Eigen::MatrixXd along(3, 0);
  if (translations > 0) {
    along = plain_basis((twists * turning.vectors.rightCols(translations)).topRows(3));
    for (Eigen::Index k = 0; k < translations; ++k)
      motions.push_back(fmt::format("translation along {}", text(along.col(k), 1)));
  }
  if (rotations == 0) return motions;
  const Eigen::MatrixXd space = twists * turning.vectors.leftCols(rotations);
  const Eigen::MatrixXd axes = plain_basis(space.bottomRows(3));
  const Eigen::MatrixXd factors = least_squares(space.bottomRows(3), axes);
  for (Eigen::Index k = 0; k < rotations; ++k) {
    const Eigen::Vector3d axis = axes.col(k);
    const Eigen::Vector3d velocity = body.radius * (space * factors.col(k)).head(3); // at the centre, for ω = axis
    const Eigen::Vector3d through = body.centre + axis.cross(velocity);
    motions.push_back(fmt::format("rotation about the axis {} through {}", text(axis, 1), text(through, body.radius)));
  }
  return motions;
}

} // namespace

std::vector<std::string> free_rigid_motions(const BodySystem& system, const NodePattern& pattern,
                                            std::span<const SupportTerms> supports) {
  const Bodies bodies = separate_bodies(pattern);
  std::vector<Body> all = measure(system, bodies);
  for (std::size_t b = 0; b < system.size(); ++b) add_supports(system[b], bodies, supports[b].prepared, all);
  std::vector<std::string> lines;
  for (std::size_t b = 0; b < all.size(); ++b) {
    const Eigen::MatrixXd twists = free_twists(all[b]);
    if (twists.cols() == 0) continue;
    const std::string names = system.size() == 1 ? ""
                                                 : fmt::format(", {}'{}'", all[b].names.size() > 1 ? "tied: " : "",
                                                               fmt::join(all[b].names, "', '"));
    lines.push_back(fmt::format("body {} of {}{} (centre {}, volume {:.4g}) is free to move: {}", b + 1, all.size(),
                                names, text(all[b].centre, all[b].radius), all[b].volume,
                                fmt::join(describe(all[b], twists), ", ")));
  }
  return lines;
}

} // namespace iga::solve
