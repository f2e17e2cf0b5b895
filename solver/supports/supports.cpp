#include "solver/supports/boundary.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/eigen_points.hpp"
#include "solver/base/in_order.hpp"
#include "solver/supports/support_rows.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace iga::solve {

namespace {

/// What one span of a support adds.
struct SpanTerms {
  Eigen::MatrixXd stiffness;
  Eigen::VectorXd load;
};

// K_N = K - (B + Bᵀ) + β M_Γ with B = ∫ (e·u)ᵀ (e·t); the penalty method keeps the last term alone.
SpanTerms span_terms(const SolutionSpace& space, const ElasticMaterial& material, const PreparedSupport& prepared,
                     std::size_t s) {
  SpanShapes shapes;
  const bool nitsche = prepared.support.method == SupportMethod::Nitsche;
  const PointBatch batch = gather(space.model(), prepared.region, s);
  const SupportRows rows =
      make_rows(space, material, prepared, batch, nitsche ? RowParts::Both : RowParts::Trace, shapes);
  const double beta = prepared.beta[s];
  const Eigen::MatrixXd weighted = rows.weight.asDiagonal() * rows.trace;
  SpanTerms terms;
  terms.stiffness = beta * (rows.trace.transpose() * weighted);
  terms.load = beta * (weighted.transpose() * rows.prescribed);
  if (nitsche) {
    const Eigen::MatrixXd flux = rows.traction.transpose() * weighted;
    terms.stiffness -= flux + flux.transpose();
    terms.load -= rows.traction.transpose() * rows.weight.cwiseProduct(rows.prescribed);
  }
  return terms;
}

void add_span(std::span<const std::int32_t> nodes, const Eigen::VectorXd& local, Eigen::VectorXd& global) {
  for (std::size_t r = 0; r < nodes.size(); ++r)
    global.segment<3>(3 * nodes[r]) += local.segment<3>(3 * static_cast<Eigen::Index>(r));
}

void add_stiffness(const SolutionSpace& space, const ElasticMaterial& material, const PreparedSupport& prepared,
                   std::int64_t first_node, StiffnessMatrix& K, Eigen::VectorXd& load) {
  in_order(
      prepared.region.cells.size(), [&](std::size_t s) { return span_terms(space, material, prepared, s); },
      [&](std::size_t s, const SpanTerms& terms) {
        const auto nodes = space.nodes(prepared.region.cells[s]);
        K.add(nodes, terms.stiffness, static_cast<std::int32_t>(first_node));
        add_span(nodes, terms.load, load);
      });
}

void add_constraints(const SolutionSpace& space, const ElasticMaterial& material, SupportTerms& terms) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> values;
  for (PreparedSupport& prepared : terms.prepared) {
    if (prepared.support.method != SupportMethod::Lagrange) continue;
    const ConstraintRows rows = lagrange_rows(space, material, prepared);
    prepared.first_constraint = static_cast<std::int64_t>(values.size());
    prepared.num_constraints = static_cast<std::int64_t>(rows.values.size());
    for (const auto& entry : rows.entries)
      entries.emplace_back(entry.row() + static_cast<int>(values.size()), entry.col(), entry.value());
    values.insert(values.end(), rows.values.begin(), rows.values.end());
  }
  const auto count = static_cast<Eigen::Index>(values.size());
  terms.constraints.resize(count, space.num_unknowns());
  terms.constraints.setFromTriplets(entries.begin(), entries.end());
  terms.values = Eigen::Map<const Eigen::VectorXd>(values.data(), count);
}

// -Cᵀ λ is the support's load vector; Greville points are the coefficients of the identity, so that Σ g_i × r_i is the
// moment of the tractions themselves.
Reaction multiplier_reaction(const SolutionSpace& space, const SupportTerms& terms, const PreparedSupport& prepared,
                             const Eigen::VectorXd& multipliers) {
  Eigen::VectorXd nodal = Eigen::VectorXd::Zero(space.num_unknowns());
  Reaction reaction;
  reaction.name = prepared.support.name;
  for (std::int64_t c = 0; c < prepared.num_constraints; ++c) {
    const Eigen::Index row = prepared.first_constraint + c;
    for (ConstraintMatrix::InnerIterator it(terms.constraints, row); it; ++it)
      nodal[it.col()] -= it.value() * multipliers[row];
    reaction.work -= 0.5 * multipliers[row] * terms.values[row];
  }
  const auto points = space.node_points();
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = force;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d f = nodal.segment<3>(3 * i), x = points.row(i).transpose();
    force += f;
    moment += x.cross(f);
  }
  reaction.force = as_point(force);
  reaction.moment = as_point(moment);
  return reaction;
}

// Traction on the part: σ n - β (u - u_D) along the fixed directions.
Reaction weak_reaction(const SolutionSpace& space, const ElasticMaterial& material, const PreparedSupport& prepared,
                       const Eigen::VectorXd& u) {
  Reaction reaction;
  reaction.name = prepared.support.name;
  const bool nitsche = prepared.support.method == SupportMethod::Nitsche;
  in_order(
      prepared.region.cells.size(),
      [&](std::size_t s) {
        SpanShapes shapes;
        const PointBatch batch = gather(space.model(), prepared.region, s);
        const SupportRows rows =
            make_rows(space, material, prepared, batch, nitsche ? RowParts::Both : RowParts::Trace, shapes);
        const auto nodes = space.nodes(batch.cell);
        Eigen::VectorXd local(3 * static_cast<Eigen::Index>(nodes.size()));
        for (std::size_t r = 0; r < nodes.size(); ++r)
          local.segment<3>(3 * static_cast<Eigen::Index>(r)) = u.segment<3>(3 * nodes[r]);
        const Eigen::VectorXd gap = rows.trace * local - rows.prescribed;
        Eigen::VectorXd traction = -prepared.beta[s] * gap;
        Reaction part;
        part.penalty_energy = 0.5 * prepared.beta[s] * rows.weight.dot(gap.cwiseAbs2());
        if (nitsche) {
          const Eigen::VectorXd stress = rows.traction * local;
          part.gap_work = rows.weight.dot(stress.cwiseProduct(gap));
          traction += stress;
          if (rows.initial.size() > 0) {
            part.gap_work -= 0.5 * rows.weight.dot(rows.initial.cwiseProduct(gap));
            traction -= rows.initial;
          }
        }
        for (std::size_t k = 0; k < rows.point.size(); ++k) {
          const auto row = static_cast<Eigen::Index>(k);
          const Point3 f = times(rows.direction[k], traction[row] * rows.weight[row]);
          part.force = plus(part.force, f);
          part.moment = plus(part.moment, cross(batch.positions[static_cast<std::size_t>(rows.point[k])], f));
          part.work += 0.5 * traction[row] * rows.weight[row] * rows.prescribed[row];
        }
        return part;
      },
      [&](std::size_t, const Reaction& part) {
        reaction.force = plus(reaction.force, part.force);
        reaction.moment = plus(reaction.moment, part.moment);
        reaction.work += part.work;
        reaction.gap_work += part.gap_work;
        reaction.penalty_energy += part.penalty_energy;
      });
  return reaction;
}

} // namespace

SupportTerms apply_supports(const SolutionSpace& space, const ElasticMaterial& material,
                            std::span<const Support> supports, StiffnessMatrix& K,
                            std::span<PreparedSupport* const> tied, std::int64_t first_node) {
  SupportTerms terms;
  terms.load = Eigen::VectorXd::Zero(space.num_unknowns());
  for (const Support& support : supports) {
    PreparedSupport prepared;
    prepared.support = support;
    const std::string what = fmt::format("support '{}'", support.name);
    prepared.region = support.place.given() ? choose_places(space.model(), support.place, what)
                                            : choose_region(space.model(), support.region, what);
    prepared.region.report.name = support.name;
    if (support.radial) {
      prepared.cylinder = fit_cylinder(space.model(), prepared.region, what);
      prepared.region.report.note = prepared.cylinder.text();
    }
    terms.regions.push_back(prepared.region.report);
    terms.prepared.push_back(std::move(prepared));
  }
  const auto of_method = [&](SupportMethod method) {
    std::vector<PreparedSupport*> found;
    for (PreparedSupport& prepared : terms.prepared)
      if (prepared.support.method == method) found.push_back(&prepared);
    return found;
  };
  penalty_parameters(space, material, of_method(SupportMethod::Penalty));
  std::vector<PreparedSupport*> nitsche = of_method(SupportMethod::Nitsche);
  nitsche.insert(nitsche.end(), tied.begin(), tied.end());
  nitsche_parameters(space, material, nitsche);
  for (const PreparedSupport& prepared : terms.prepared)
    if (prepared.support.method != SupportMethod::Lagrange)
      add_stiffness(space, material, prepared, first_node, K, terms.load);
  add_constraints(space, material, terms);
  return terms;
}

Eigen::VectorXd initial_strain_load(const SolutionSpace& space, const ElasticMaterial& material,
                                    const SupportTerms& terms) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(space.num_unknowns());
  if (!material.initial_strain) return load;
  for (const PreparedSupport& prepared : terms.prepared) {
    if (prepared.support.method != SupportMethod::Nitsche) continue;
    in_order(
        prepared.region.cells.size(),
        [&](std::size_t s) {
          SpanShapes shapes;
          const PointBatch batch = gather(space.model(), prepared.region, s);
          const SupportRows rows = make_rows(space, material, prepared, batch, RowParts::Both, shapes);
          return Eigen::VectorXd(-rows.trace.transpose() * rows.weight.cwiseProduct(rows.initial));
        },
        [&](std::size_t s, const Eigen::VectorXd& local) {
          add_span(space.nodes(prepared.region.cells[s]), local, load);
        });
  }
  return load;
}

std::vector<std::string> region_warnings(std::span<const RegionReport> supports) {
  std::vector<std::string> all;
  for (const RegionReport& region : supports) {
    const auto warnings = region_warnings(region, fmt::format("support '{}'", region.name));
    all.insert(all.end(), warnings.begin(), warnings.end());
  }
  return all;
}

std::vector<Reaction> reactions(const SolutionSpace& space, const ElasticMaterial& material, const SupportTerms& terms,
                                const Eigen::VectorXd& u, const Eigen::VectorXd& multipliers) {
  std::vector<Reaction> all;
  for (const PreparedSupport& prepared : terms.prepared)
    all.push_back(prepared.support.method == SupportMethod::Lagrange
                      ? multiplier_reaction(space, terms, prepared, multipliers)
                      : weak_reaction(space, material, prepared, u));
  return all;
}

} // namespace iga::solve
