#include "solver/supports/added_mass.hpp"

#include "format/model/errors.hpp"
#include "solver/base/dense_algebra.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/supports/average_motion.hpp"
#include "solver/supports/body_choice.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

double extent_of(const RegionReport& report) {
  return report.extent == Extent::Surface ? report.area : report.extent == Extent::Line ? report.length : 1;
}

// A R, sparse as the rows of R together are.
RowMatrix combined(const Eigen::MatrixXd& A, const RowMatrix& R) {
  return RowMatrix(A.sparseView()) * R;
}

// W with Wᵀ W = Tᵀ diag(m, J) T, T the motion of the body's centre.
RowMatrix rigid_rows(const PreparedMass& mass) {
  const SymmetricEigen inertia = symmetric_eigen(mass.added.inertia);
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(6, 6);
  Eigen::Index rank = 0;
  if (mass.added.mass > 0)
    for (Eigen::Index d = 0; d < 3; ++d) root(rank++, d) = std::sqrt(mass.added.mass);
  for (Eigen::Index k = 0; k < 3; ++k)
    if (inertia.values[k] > 1e-14 * inertia.values[2]) // a rod has no inertia about its axis, to rounding
      root.row(rank++).tail<3>() = std::sqrt(inertia.values[k]) * inertia.vectors.col(k).transpose();
  return combined(root.topRows(rank), mass.motion);
}

/// use(batch, nodes, values, weights · mass per extent) for the cells of a mass that is spread.
template <class Use> void for_spread(const BodySystem& system, const PreparedMass& mass, Use&& use) {
  const SolutionSpace& space = *system[mass.body].space;
  const double density = mass.added.mass / extent_of(mass.region.report);
  SpanShapes shapes;
  for (std::size_t s = 0; s < mass.region.cells.size(); ++s) {
    const PointBatch batch = gather(space.model(), mass.region, s);
    evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
    const Eigen::VectorXd weights =
        density * Eigen::Map<const Eigen::VectorXd>(batch.weights.data(), static_cast<Eigen::Index>(batch.size()));
    use(batch, space.nodes(batch.cell), shapes.values, weights);
  }
}

// ∫ μ N_i N_j, cell by cell, and its row sums.
AddedMassTerms::Block spread_block(const BodySystem& system, const PreparedMass& mass, auto nodes, const auto& values,
                                   const Eigen::VectorXd& weights) {
  AddedMassTerms::Block block;
  block.nodes.assign(nodes.begin(), nodes.end());
  block.first_node = static_cast<std::int32_t>(system[mass.body].first_node);
  block.matrix = values.transpose() * weights.asDiagonal() * values;
  return block;
}

/// A field of acceleration about a place: f(x) = at + gradient (x - place), as all of them are linear.
struct LinearField {
  Eigen::Vector3d at;
  Eigen::Matrix3d gradient;
};

LinearField field_about(const Load& load, const Point3& place) {
  const BodyForce f = *volume_force(load, 1);
  LinearField field;
  field.at = as_vector(f(place));
  for (std::size_t d = 0; d < 3; ++d) {
    Point3 beside = place;
    beside[d] += 1;
    field.gradient.col(static_cast<Eigen::Index>(d)) = as_vector(f(beside)) - field.at;
  }
  return field;
}

// Force and moment about the centre of a rigid body: ∫ f dm, ∫ s × f dm with s from the centre.
Eigen::Matrix<double, 6, 1> force_on_body(const AddedMass& body, const LinearField& field) {
  const Eigen::Matrix3d second = 0.5 * body.inertia.trace() * Eigen::Matrix3d::Identity() - body.inertia; // ∫ s sᵀ dm
  const Eigen::Matrix3d A = field.gradient * second;
  Eigen::Matrix<double, 6, 1> force;
  force << body.mass * field.at, A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1);
  return force;
}

// ½ ω² aᵀ J a of a body about the axis a, by a rotation θ further: minus its second variation is θᵀ H θ.
Eigen::Matrix3d turning_softening(const Eigen::Matrix3d& J, const Eigen::Vector3d& a, double speed) {
  const Eigen::Matrix3d across = cross_matrix(a);
  const Eigen::Vector3d Ja = J * a;
  const Eigen::Matrix3d mixed = 0.5 * (Ja * a.transpose() + a * Ja.transpose());
  return -speed * speed * (across.transpose() * J * across + mixed - a.dot(Ja) * Eigen::Matrix3d::Identity());
}

void refuse_rigid(std::span<const PreparedMass> added, MassType type) {
  if (type == MassType::Consistent) return;
  for (const PreparedMass& mass : added)
    if (mass.added.rigid)
      throw InputError(fmt::format(
          "added mass '{}': a rigid body couples all functions of its region, which only mass = \"consistent\" knows; "
          "use that, or spread the mass over the surface (leave 'at' and 'inertia' out). Added mass lowers every "
          "frequency: a time step that is safe without it is safe with it",
          mass.added.name));
}

} // namespace

std::vector<PreparedMass> prepare_masses(const BodySystem& system, std::span<const AddedMass> masses) {
  std::vector<PreparedMass> all;
  for (const AddedMass& added : masses) {
    const std::string what = fmt::format("added mass '{}'", added.name);
    const auto choose = [&](std::size_t b) {
      const TrimmedModel& model = system[b].space->model();
      return added.place.given() ? choose_places(model, added.place, what) : choose_region(model, added.region, what);
    };
    PreparedMass mass;
    mass.added = added;
    mass.body = chosen_body(system, added.body, what, choose);
    mass.region = choose(mass.body);
    mass.region.report.name = added.name;
    mass.region.report.body = system.name_among_several(mass.body);
    mass.centre = added.centre.value_or(mass.region.report.centroid);
    mass.rows.resize(0, system.num_unknowns());
    mass.motion.resize(0, system.num_unknowns());
    if (added.rigid) {
      mass.motion =
          combined(moved_to(mass.centre, mass.region.report.centroid), average_motion(system, mass.body, mass.region));
      mass.rows = rigid_rows(mass);
    }
    all.push_back(std::move(mass));
  }
  return all;
}

MassOperator make_mass(MassType type, const BodySystem& system, const std::shared_ptr<const Connectivity>& connectivity,
                       std::span<const PreparedMass> added) {
  refuse_rigid(added, type);
  AddedMassTerms terms;
  terms.lumped = Eigen::VectorXd::Zero(system.num_nodes());
  for (const PreparedMass& mass : added) {
    if (mass.added.rigid) {
      terms.rows.push_back(mass.rows);
      continue;
    }
    for_spread(system, mass, [&](const PointBatch&, auto nodes, const auto& values, const Eigen::VectorXd& weights) {
      terms.blocks.push_back(spread_block(system, mass, nodes, values, weights));
      const Eigen::VectorXd sums = values.transpose() * weights;
      for (std::size_t i = 0; i < nodes.size(); ++i)
        terms.lumped[system[mass.body].first_node + nodes[i]] += sums[static_cast<Eigen::Index>(i)];
    });
  }
  return make_mass(type, system, connectivity, terms);
}

bool acts_on_mass(LoadKind kind) {
  return kind == LoadKind::Acceleration || kind == LoadKind::Centrifugal;
}

Eigen::Vector3d spin_axis(const Load& load) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) axis[static_cast<Eigen::Index>(r)] += load.frame[r][c] * load.spin.axis[c];
  return axis.normalized();
}

Eigen::VectorXd inertia_force(const BodySystem& system, const PreparedMass& mass, const Load& load) {
  if (mass.added.rigid) return mass.motion.transpose() * force_on_body(mass.added, field_about(load, mass.centre));
  Eigen::VectorXd force = Eigen::VectorXd::Zero(system.num_unknowns());
  const BodyForce f = *volume_force(load, 1);
  for_spread(system, mass,
             [&](const PointBatch& batch, auto nodes, const auto& values, const Eigen::VectorXd& weights) {
               for (std::size_t q = 0; q < batch.size(); ++q) {
                 const auto row = static_cast<Eigen::Index>(q);
                 const Eigen::Vector3d own = weights[row] * as_vector(f(batch.positions[q]));
                 for (std::size_t i = 0; i < nodes.size(); ++i)
                   force.segment<3>(3 * (system[mass.body].first_node + nodes[i])) +=
                       values(row, static_cast<Eigen::Index>(i)) * own;
               }
             });
  return force;
}

void add_inertia_stiffness(const BodySystem& system, const PreparedMass& mass, const Load& load, StiffnessMatrix& L) {
  const bool spins = load.kind == LoadKind::Centrifugal;
  const Eigen::Vector3d axis = spin_axis(load);
  const double speed = spins ? load.spin.speed : 0;
  const Eigen::Matrix3d across = -speed * speed * (Eigen::Matrix3d::Identity() - axis * axis.transpose());
  if (!mass.added.rigid) {
    if (!spins) return; // a weight that is spread moves with the part and stays what it is
    for_spread(system, mass, [&](const PointBatch&, auto nodes, const auto& values, const Eigen::VectorXd& weights) {
      const AddedMassTerms::Block block = spread_block(system, mass, nodes, values, weights);
      const Eigen::Index n = block.matrix.rows();
      Eigen::MatrixXd all(3 * n, 3 * n);
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) all.block<3, 3>(3 * i, 3 * j) = block.matrix(i, j) * across;
      L.add(block.nodes, all, block.first_node);
    });
    return;
  }
  // Of the motion (u, θ) of the centre: u is that of the linear theory, θ × d of the arm d from the region; the second
  // order of its turn, ½ θ × (θ × d), works on the force F.
  const Eigen::Vector3d F = force_on_body(mass.added, field_about(load, mass.centre)).head<3>();
  const Eigen::Vector3d d = as_vector(mass.centre) - as_vector(mass.region.report.centroid);
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
  H.topLeftCorner<3, 3>() = mass.added.mass * across;
  H.bottomRightCorner<3, 3>() = F.dot(d) * Eigen::Matrix3d::Identity() - 0.5 * (F * d.transpose() + d * F.transpose());
  if (spins) H.bottomRightCorner<3, 3>() += turning_softening(mass.added.inertia, axis, speed);
  // Rotations times the size of the region are comparable with displacements.
  Eigen::Matrix<double, 6, 1> size = Eigen::Matrix<double, 6, 1>::Ones();
  size.tail<3>().setConstant(std::sqrt(mass.region.report.area));
  const Eigen::MatrixXd scaled = H.cwiseQuotient(size * size.transpose());
  const SymmetricEigen parts = symmetric_eigen(scaled);
  const double rounding = 1e-14 * parts.values.cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < 6; ++k)
    if (std::abs(parts.values[k]) > rounding)
      L.add_low_rank(combined(parts.vectors.col(k).transpose() * size.asDiagonal(), mass.motion),
                     Eigen::VectorXd::Constant(1, parts.values[k]));
}

} // namespace iga::solve
