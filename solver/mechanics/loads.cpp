#include "solver/mechanics/loads.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/in_order.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/space/locate.hpp"

#include <fmt/format.h>

namespace iga::solve {

namespace {

Point3 in_part_frame(const Rotation& frame, const Point3& v) {
  Point3 x{};
  for (std::size_t r = 0; r < 3; ++r) x[r] = frame[r][0] * v[0] + frame[r][1] * v[1] + frame[r][2] * v[2];
  return x;
}

void add_resultant(LoadReport& report, const Point3& x, const Point3& force) {
  report.force = plus(report.force, force);
  report.moment = plus(report.moment, cross(x, force));
}

Eigen::VectorXd volume_load(const SolutionSpace& space, const Point3& b, LoadReport& report) {
  const IntegrationPoints& points = space.model().points;
  for (std::size_t q = 0; q < points.weights.size(); ++q) {
    const Point3 u{points.parameters[3 * q], points.parameters[3 * q + 1], points.parameters[3 * q + 2]};
    add_resultant(report, space.model().grid.to_position(u), times(b, points.weights[q]));
  }
  return body_force(space, b);
}

Eigen::VectorXd point_load(const SolutionSpace& space, const Load& load, const Point3& force, LoadReport& report) {
  const LocatedPoint at = locate(space.model(), load.position, fmt::format("load '{}'", load.name));
  SpanShapes shapes;
  evaluate(space, at.cell, at.parameter, Shapes::Values, shapes);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(space.num_unknowns());
  const auto nodes = space.nodes(at.cell);
  for (std::size_t r = 0; r < nodes.size(); ++r)
    for (std::size_t d = 0; d < 3; ++d)
      f[3 * nodes[r] + static_cast<Eigen::Index>(d)] = shapes.values(0, static_cast<Eigen::Index>(r)) * force[d];
  add_resultant(report, at.position, force);
  return f;
}

} // namespace

Eigen::VectorXd traction_load(const SolutionSpace& space, const SurfaceRegion& region, const TractionField& traction,
                              LoadReport& report) {
  struct SpanLoad {
    Eigen::VectorXd local;
    LoadReport part;
  };
  Eigen::VectorXd f = Eigen::VectorXd::Zero(space.num_unknowns());
  in_order(
      region.cells.size(),
      [&](std::size_t s) {
        const PointBatch batch = gather(space.model(), region, s);
        SpanShapes shapes;
        evaluate(space, batch.cell, batch.parameters, Shapes::Values, shapes);
        Eigen::MatrixXd forces(3, static_cast<Eigen::Index>(batch.size()));
        SpanLoad result;
        for (std::size_t q = 0; q < batch.size(); ++q) {
          const Point3 t = times(traction(batch.positions[q], batch.normals[q]), batch.weights[q]);
          forces.col(static_cast<Eigen::Index>(q)) << t[0], t[1], t[2];
          add_resultant(result.part, batch.positions[q], t);
        }
        const Eigen::MatrixXd nodal = forces * shapes.values;
        result.local = nodal.reshaped();
        return result;
      },
      [&](std::size_t s, const SpanLoad& result) {
        const auto nodes = space.nodes(region.cells[s]);
        for (std::size_t r = 0; r < nodes.size(); ++r)
          f.segment<3>(3 * nodes[r]) += result.local.segment<3>(3 * static_cast<Eigen::Index>(r));
        report.force = plus(report.force, result.part.force);
        report.moment = plus(report.moment, result.part.moment);
      });
  return f;
}

LoadTerms assemble_loads(const SolutionSpace& space, double density, std::span<const Load> loads) {
  LoadTerms terms;
  terms.load = Eigen::VectorXd::Zero(space.num_unknowns());
  for (const Load& load : loads) {
    LoadReport report;
    report.name = load.name;
    const Point3 vector = in_part_frame(load.frame, load.vector);
    if (load.kind == LoadKind::BodyForce) {
      terms.load += volume_load(space, vector, report);
    } else if (load.kind == LoadKind::Acceleration) {
      terms.load += volume_load(space, times(vector, density), report);
    } else if (load.kind == LoadKind::Point) {
      terms.load += point_load(space, load, vector, report);
    } else {
      const SurfaceRegion region = choose_region(space.model(), load.region, fmt::format("load '{}'", load.name));
      report.region = region.report;
      report.region.name = load.name;
      const bool pressure = load.kind == LoadKind::Pressure;
      const Point3 constant = load.kind == LoadKind::TotalForce ? times(vector, 1 / region.report.area) : vector;
      terms.load += traction_load(
          space, region, [&](const Point3&, const Point3& n) { return pressure ? times(n, -load.pressure) : constant; },
          report);
    }
    terms.reports.push_back(std::move(report));
  }
  return terms;
}

} // namespace iga::solve
