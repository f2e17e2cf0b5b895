#include "solver/nonlinear/tool_contact.hpp"

#include "format/model/errors.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/base/in_order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>

namespace iga::solve {

namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// A gap of this share of a span counts as closed: faces that begin on each other are held from the first iteration on.
constexpr double closed_share = 1e-9;
// Springs of friction beside those of the normal direction.
constexpr double tangential_share = 0.5;
constexpr double deepest_share = 0.5; // of a span: how far a part may go in a step

constexpr double ball_rounding = 1e-9;

constexpr std::size_t numbers_per_point = 7;

} // namespace

Pose pose_of(const RigidBody& body, double factor) {
  RigidState state(body);
  state.advance({.time = 0, .dt_last = 0, .dt = factor});
  return state.pose();
}

struct ToolContact::Motion {
  Vector3d centre_old, centre;
  Matrix3d turn_old, turn; ///< from the tool's frame to space

  /// Where what is at x now on the tool stood.
  Vector3d before(const Vector3d& x) const { return centre_old + turn_old * (turn.transpose() * (x - centre)); }
};

struct ToolContact::Touch {
  bool touches = false, sliding = false;
  double gap = 0, pressure = 0;
  Vector3d normal = Vector3d::Zero();
  Matrix3d bend = Matrix3d::Zero();
  Vector3d trial = Vector3d::Zero(), friction = Vector3d::Zero(); ///< force/length²
  Vector3d carried = Vector3d::Zero();                            ///< a of B a = trial
  bool has_friction = false;
  Vector3d way = Vector3d::Zero(); ///< of the part at the point, length
  Vector3d tool_way = Vector3d::Zero();
  Vector3d slip = Vector3d::Zero(); ///< that no spring gives back, length
  Vector3d traction() const { return pressure * normal + friction; }
};

ToolContact::ToolContact(const SolutionSpace& space, const ToolContactSettings& settings, const RigidBody& tool,
                         double modulus)
    : space_(&space), settings_(settings),
      region_(choose_region(
          space.model(), {.names = settings.regions, .numbers = {}, .box = {}, .plane = {}, .normal = {}, .patch = {}},
          fmt::format("contact '{}'", settings.name))),
      span_size_(std::ranges::min(space.model().grid.span_size())), shape_(tool.shape, span_size_), mover_(tool) {
  mover_.shape = SphereShape{};
  normal_stiffness_ = settings.stiffness * modulus;
  tangential_stiffness_ = tangential_share * normal_stiffness_;
  closed_ = closed_share * span_size_;
  u_old_ = Eigen::VectorXd::Zero(space.num_unknowns());
  pose_old_ = pose(0);
  SpanShapes shapes;
  std::size_t points = 0;
  for (std::size_t s = 0; s < region_.cells.size(); ++s) {
    const PointBatch batch = gather(space.model(), region_, s);
    evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
    Cell cell{batch.cell, points, shapes.values, Matrix3Xd(3, batch.size()), batch.weights, {}};
    for (std::size_t q = 0; q < batch.size(); ++q)
      cell.X.col(static_cast<Eigen::Index>(q)) = as_vector(batch.positions[q]);
    cell.centre = cell.X.rowwise().mean();
    cell.radius = (cell.X.colwise() - cell.centre).colwise().norm().maxCoeff();
    cell.amplification = cell.values.cwiseAbs().rowwise().sum().maxCoeff();
    cell.lacking = (1 - cell.values.rowwise().sum().array()).abs().maxCoeff();
    points += batch.size();
    cells_.push_back(std::move(cell));
  }
  memory_.resize(points);
  const ToolContactReport start = keep(u_old_, 0);
  if (start.depth > deepest_share * span_size_)
    throw InputError(
        fmt::format("{}: contact '{}': the part lies {:.3g} deep in '{}' before the first step, at ({:.4g}, "
                    "{:.4g}, {:.4g}); a span is {:.3g}: place the tool outside the part",
                    settings.where, settings.name, start.depth, tool.name, start.deepest[0], start.deepest[1],
                    start.deepest[2], span_size_));
  dissipated_ = tool_work_ = 0;
}

bool ToolContact::is_symmetric() const {
  const auto* driven = std::get_if<PrescribedMotion>(&mover_.motion);
  return settings_.friction == 0 && (!settings_.rough || (shape_.is_half_space() && !(driven && driven->rotation)));
}

ToolContact::Motion ToolContact::motion(double factor) const {
  const Pose now = pose(factor);
  return {pose_old_.centre, now.centre, pose_old_.turn.toRotationMatrix(), now.turn.toRotationMatrix()};
}

Matrix3Xd ToolContact::positions(const Cell& cell, const Eigen::VectorXd& u) const {
  const auto nodes = space_->nodes(cell.cell);
  Matrix3Xd local(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    local.col(static_cast<Eigen::Index>(i)) = u.segment<3>(3 * static_cast<Eigen::Index>(nodes[i]));
  return cell.X + local * cell.values.transpose();
}

// X + u = X + ū + Σ N_i (c_i - ū) where the functions add up to 1.
ToolContact::Ball ToolContact::ball(const Cell& cell, const Eigen::VectorXd& u) const {
  const auto nodes = space_->nodes(cell.cell);
  Vector3d mean = Vector3d::Zero();
  for (const std::int32_t node : nodes) mean += u.segment<3>(3 * static_cast<Eigen::Index>(node));
  mean /= static_cast<double>(nodes.size());
  double furthest = 0;
  for (const std::int32_t node : nodes)
    furthest = std::max(furthest, (u.segment<3>(3 * static_cast<Eigen::Index>(node)) - mean).norm());
  return {cell.centre + mean, cell.radius + cell.amplification * furthest + cell.lacking * mean.norm()};
}

bool ToolContact::apart(const Cell& cell, const Motion& motion, const Eigen::VectorXd& u) const {
  const auto first = memory_.begin() + static_cast<std::ptrdiff_t>(cell.first);
  if (std::any_of(first, first + static_cast<std::ptrdiff_t>(cell.weights.size()),
                  [](const Memory& memory) { return memory.touches; }))
    return false;
  const Ball now = ball(cell, u);
  const Vector3d x = motion.turn.transpose() * (now.centre - motion.centre);
  return shape_.at(x).gap > (1 + ball_rounding) * now.radius + closed_;
}

bool ToolContact::stays_away(const Cell& cell, const Motion& motion, const Eigen::VectorXd& u) const {
  const Ball now = ball(cell, u), before = ball(cell, u_old_);
  const double way = (motion.before(now.centre) - before.centre).norm() + now.radius + before.radius;
  const Vector3d x = motion.turn_old.transpose() * (before.centre - motion.centre_old);
  return shape_.at(x).gap > (1 + ball_rounding) * (way + before.radius) + closed_;
}

ToolContact::Touch ToolContact::touch(const Motion& motion, const Vector3d& x, const Vector3d& x_old,
                                      const Memory& old) const {
  Touch t;
  const ToolGap found = shape_.at(motion.turn.transpose() * (x - motion.centre));
  t.gap = found.gap;
  t.touches = t.gap <= closed_;
  t.way = x - x_old;
  t.tool_way = x - motion.before(x);
  t.normal = motion.turn * found.normal;
  if (!t.touches) return t;
  t.bend = motion.turn * found.bend * motion.turn.transpose();
  t.pressure = normal_stiffness_ * std::max(-t.gap, 0.0);
  t.has_friction = old.touches && (settings_.rough || settings_.friction > 0);
  if (!t.has_friction) return t;
  const Matrix3d B = Matrix3d::Identity() - t.normal * t.normal.transpose();
  const Vector3d way = t.way - t.tool_way;
  t.carried = motion.turn * (motion.turn_old.transpose() * old.friction) - tangential_stiffness_ * way;
  t.trial = B * t.carried;
  const double size = t.trial.norm(), limit = settings_.friction * t.pressure;
  t.sliding = !settings_.rough && size > limit;
  t.friction = t.sliding ? Vector3d(limit / size * t.trial) : t.trial;
  t.slip = (t.friction - t.trial) / tangential_stiffness_;
  return t;
}

Matrix3d ToolContact::stiffness(const Motion& motion, const Touch& t) const {
  const Vector3d& n = t.normal;
  Matrix3d K = normal_stiffness_ * (n * n.transpose() + t.bend);
  if (!t.has_friction) return K;
  const Matrix3d B = Matrix3d::Identity() - n * n.transpose();
  Matrix3d by_normal = Matrix3d::Zero(); // ∂n/∂x
  if (t.gap < -closed_) by_normal = t.bend / t.gap;
  const Matrix3d D = -(n.dot(t.carried) * by_normal + n * (by_normal * t.carried).transpose()) -
                     tangential_stiffness_ * B * motion.turn_old * motion.turn.transpose();
  if (!t.sliding) return K - D;
  const double size = t.trial.norm(), mu = settings_.friction;
  const Vector3d along = t.trial / size;
  K += mu * normal_stiffness_ * along * n.transpose();
  K -= mu * t.pressure / size * (Matrix3d::Identity() - along * along.transpose()) * D;
  return K;
}

ToolContactReport ToolContact::add_forces(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& f) const {
  const Motion moved = motion(factor);
  struct OfCell {
    Matrix3Xd nodal; ///< no columns where nothing touches
    ToolContactReport report;
  };
  ToolContactReport all;
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
  in_order(
      cells_.size(),
      [&](std::size_t s) {
        OfCell of;
        const Cell& cell = cells_[s];
        if (apart(cell, moved, u)) return of;
        const Matrix3Xd x = positions(cell, u), x_old = positions(cell, u_old_);
        Matrix3Xd forces = Matrix3Xd::Zero(3, x.cols());
        Vector3d turning = Vector3d::Zero();
        bool any = false;
        ToolContactReport& r = of.report;
        for (std::size_t q = 0; q < cell.weights.size(); ++q) {
          const auto column = static_cast<Eigen::Index>(q);
          const double w = cell.weights[q];
          const Memory& old = memory_[cell.first + q];
          const Touch t = touch(moved, x.col(column), x_old.col(column), old);
          const Vector3d traction = t.touches ? t.traction() : Vector3d::Zero();
          r.by_tool += 0.5 * w * (traction + old.traction).dot(t.tool_way);
          const double springs = old.friction.squaredNorm() / (2 * tangential_stiffness_);
          if (!t.touches) {
            r.dissipated += w * springs; // let go
            continue;
          }
          any = true;
          forces.col(column) = w * traction;
          turning += (x.col(column) - moved.centre).cross(forces.col(column));
          r.normal_force += w * t.pressure;
          r.friction_force += w * t.friction.norm();
          r.area += w;
          r.stored += w * (0.5 * t.pressure * t.pressure / normal_stiffness_ +
                           t.friction.squaredNorm() / (2 * tangential_stiffness_));
          r.dissipated -= 0.5 * w * (old.friction + t.friction).dot(t.slip);
          ++r.points;
          r.sliding += t.sliding ? 1 : 0;
          if (-t.gap > r.depth) {
            r.depth = -t.gap;
            r.deepest = as_point(x.col(column));
          }
        }
        if (any) of.nodal = forces * cell.values;
        r.force = as_point(forces.rowwise().sum());
        r.moment = as_point(turning);
        return of;
      },
      [&](std::size_t s, const OfCell& of) {
        const ToolContactReport& r = of.report;
        all.by_tool += r.by_tool;
        all.dissipated += r.dissipated;
        if (of.nodal.cols() == 0) return;
        const auto nodes = space_->nodes(cells_[s].cell);
        for (std::size_t i = 0; i < nodes.size(); ++i)
          f.segment<3>(3 * static_cast<Eigen::Index>(nodes[i])) += of.nodal.col(static_cast<Eigen::Index>(i));
        force += as_vector(r.force);
        moment += as_vector(r.moment);
        all.normal_force += r.normal_force;
        all.friction_force += r.friction_force;
        all.area += r.area;
        all.stored += r.stored;
        all.points += r.points;
        all.sliding += r.sliding;
        if (r.depth > all.depth) {
          all.depth = r.depth;
          all.deepest = r.deepest;
        }
      });
  all.force = as_point(force);
  all.moment = as_point(moment);
  return all;
}

void ToolContact::subtract_stiffness(const Eigen::VectorXd& u, double factor, Tangent& A) const {
  const Motion moved = motion(factor);
  in_order(
      cells_.size(),
      [&](std::size_t s) {
        const Cell& cell = cells_[s];
        if (apart(cell, moved, u)) return Eigen::MatrixXd();
        const Matrix3Xd x = positions(cell, u), x_old = positions(cell, u_old_);
        Eigen::MatrixXd K(x.cols(), 9); // by point, column 3 b + a
        bool any = false;
        for (std::size_t q = 0; q < cell.weights.size(); ++q) {
          const auto column = static_cast<Eigen::Index>(q);
          const Touch t = touch(moved, x.col(column), x_old.col(column), memory_[cell.first + q]);
          const Matrix3d k = t.touches ? Matrix3d(cell.weights[q] * stiffness(moved, t)) : Matrix3d::Zero();
          K.row(column) = Eigen::Map<const Eigen::RowVectorXd>(k.data(), 9);
          any = any || t.touches;
        }
        Eigen::MatrixXd block;
        if (!any) return block;
        const Eigen::Index n = cell.values.cols();
        block.resize(3 * n, 3 * n);
        for (Eigen::Index b = 0; b < 3; ++b)
          for (Eigen::Index a = 0; a < 3; ++a) {
            const Eigen::MatrixXd product = cell.values.transpose() * K.col(3 * b + a).asDiagonal() * cell.values;
            for (Eigen::Index j = 0; j < n; ++j)
              for (Eigen::Index i = 0; i < n; ++i) block(3 * i + a, 3 * j + b) = product(i, j);
          }
        return block;
      },
      [&](std::size_t s, const Eigen::MatrixXd& block) {
        if (block.size() > 0) A.add(space_->nodes(cells_[s].cell), block);
      });
}

std::string ToolContact::too_far(const Eigen::VectorXd& u, double factor) const {
  const Motion moved = motion(factor);
  const double most = deepest_share * span_size_;
  double depth = 0, beyond = 0;
  for (const Cell& cell : cells_) {
    if (stays_away(cell, moved, u)) continue;
    const Matrix3Xd x = positions(cell, u), x_old = positions(cell, u_old_);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const Touch t = touch(moved, x.col(q), x_old.col(q), {});
      depth = std::max(depth, -t.gap);
      if (shape_.is_half_space()) continue;
      const double before = shape_.at(moved.turn_old.transpose() * (x_old.col(q) - moved.centre_old)).gap;
      beyond = std::max(beyond, (t.way - t.tool_way).norm() - std::max(before, 0.0));
    }
  }
  if (depth > most)
    return fmt::format(
        "in contact '{}' the part lies {:.3g} spans deep in the tool; a larger stiffness or smaller spans",
        settings_.name, depth / span_size_);
  if (beyond > most)
    return fmt::format(
        "in contact '{}' the part and the tool move {:.3g} spans past each other in a step, and may have "
        "gone through each other; more load steps",
        settings_.name, beyond / span_size_);
  return {};
}

ToolContactReport ToolContact::keep(const Eigen::VectorXd& u, double factor) {
  Eigen::VectorXd ignored = Eigen::VectorXd::Zero(u.size());
  ToolContactReport report = add_forces(u, factor, ignored);
  dissipated_ += report.dissipated;
  tool_work_ += report.by_tool;
  const Motion moved = motion(factor);
  for (const Cell& cell : cells_) {
    if (apart(cell, moved, u)) continue;
    const Matrix3Xd x = positions(cell, u), x_old = positions(cell, u_old_);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      Memory& memory = memory_[cell.first + static_cast<std::size_t>(q)];
      const Touch t = touch(moved, x.col(q), x_old.col(q), memory);
      memory = {t.touches, t.friction, t.touches ? t.traction() : Vector3d::Zero()};
    }
  }
  u_old_ = u;
  pose_old_ = pose(factor);
  return report;
}

SurfaceRegion ToolContact::touching() const {
  SurfaceRegion touching;
  touching.offsets.push_back(0);
  for (std::size_t s = 0; s < cells_.size(); ++s) {
    for (std::size_t q = 0; q < cells_[s].weights.size(); ++q) {
      if (!memory_[cells_[s].first + q].touches) continue;
      const auto p = static_cast<std::size_t>(region_.offsets[s]) + q;
      touching.parameters.insert(touching.parameters.end(),
                                 region_.parameters.begin() + static_cast<std::ptrdiff_t>(3 * p),
                                 region_.parameters.begin() + static_cast<std::ptrdiff_t>(3 * p + 3));
      touching.weights.push_back(region_.weights[p]);
      touching.normals.push_back(region_.normals[p]);
    }
    const auto count = static_cast<std::int64_t>(touching.weights.size());
    if (count == touching.offsets.back()) continue;
    touching.cells.push_back(region_.cells[s]);
    touching.offsets.push_back(count);
  }
  return touching;
}

std::vector<double> ToolContact::save() const {
  std::vector<double> numbers;
  for (const Memory& m : memory_) {
    numbers.push_back(m.touches ? 1 : 0);
    numbers.insert(numbers.end(), m.friction.begin(), m.friction.end());
    numbers.insert(numbers.end(), m.traction.begin(), m.traction.end());
  }
  numbers.push_back(dissipated_);
  numbers.push_back(tool_work_);
  return numbers;
}

void ToolContact::load(const std::vector<double>& saved, const Eigen::VectorXd& u, double factor) {
  const std::size_t expected = numbers_per_point * memory_.size() + 2;
  if (saved.size() != expected)
    throw InputError(fmt::format("contact '{}': found {} numbers, expected {}; the state is that of another model",
                                 settings_.name, saved.size(), expected));
  for (std::size_t q = 0; q < memory_.size(); ++q) {
    const double* m = saved.data() + numbers_per_point * q;
    memory_[q] = {m[0] != 0, {m[1], m[2], m[3]}, {m[4], m[5], m[6]}};
  }
  dissipated_ = saved[expected - 2];
  tool_work_ = saved[expected - 1];
  u_old_ = u;
  pose_old_ = pose(factor);
}

} // namespace iga::solve
