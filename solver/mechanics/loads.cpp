#include "solver/mechanics/loads.hpp"

#include "format/model/vec3.hpp"
#include "solver/base/in_order.hpp"
#include "solver/mechanics/assemble.hpp"
#include "solver/mechanics/spread_loads.hpp"

#include <cassert>
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

Eigen::VectorXd volume_load(const SolutionSpace& space, const BodyForce& b, LoadReport& report) {
  const IntegrationPoints& points = space.model().points;
  for (std::size_t q = 0; q < points.weights.size(); ++q) {
    const Point3 u{points.parameters[3 * q], points.parameters[3 * q + 1], points.parameters[3 * q + 2]};
    const Point3 x = space.model().grid.to_position(u);
    add_resultant(report, x, times(b(x), points.weights[q]));
  }
  return distributed_load(space, b);
}

// The traction of a load on a region; force/length on a line, force at a point.
TractionField traction_of(const TrimmedModel& model, const Load& load, SurfaceRegion& region, const std::string& what) {
  const Point3 vector = in_part_frame(load.frame, load.vector);
  const auto constant = [](const Point3& t) { return [t](const Point3&, const Point3&) { return t; }; };
  switch (load.kind) {
  case LoadKind::Pressure:
    return [p = load.pressure](const Point3&, const Point3& n) { return times(n, -p); };
  case LoadKind::TotalForce:
    return constant(times(vector, 1 / region.report.area));
  case LoadKind::Line:
    return constant(times(vector, 1 / region.report.length));
  case LoadKind::Remote: {
    const Point3 arm = minus(load.remote.value_or(region.report.centroid), region.report.centroid);
    return spread_evenly(model, region, vector, plus(in_part_frame(load.frame, load.moment), cross(arm, vector)));
  }
  case LoadKind::Bearing: {
    const Cylinder cylinder = fit_cylinder(model, region, what);
    region.report.note = cylinder.text();
    return bearing_pressure(model, region, cylinder, vector, what);
  }
  default:
    return constant(vector);
  }
}

SurfaceLoad surface_load(const SolutionSpace& space, const Load& load) {
  const std::string what = fmt::format("load '{}'", load.name);
  SurfaceLoad surface;
  surface.region = load.place.given() ? choose_places(space.model(), load.place, what)
                                      : choose_region(space.model(), load.region, what);
  surface.traction = traction_of(space.model(), load, surface.region, what);
  return surface;
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

bool acts_on_volume(LoadKind kind) {
  return kind == LoadKind::BodyForce || kind == LoadKind::Acceleration || kind == LoadKind::Centrifugal;
}

std::optional<BodyForce> volume_force(const Load& load, double density) {
  if (load.kind == LoadKind::Centrifugal) {
    assert(!load.spin.rpm);
    const Point3 axis = in_part_frame(load.frame, load.spin.axis);
    const double outward = density * load.spin.speed * load.spin.speed, along = density * load.spin.acceleration;
    return [axis, outward, along, point = load.spin.point](const Point3& x) {
      const Point3 from = minus(x, point), r = minus(from, times(axis, dot(axis, from)));
      return minus(times(r, outward), times(cross(axis, r), along));
    };
  }
  const Point3 vector = in_part_frame(load.frame, load.vector);
  const double factor = load.kind == LoadKind::Acceleration ? density : 1;
  if (acts_on_volume(load.kind)) return [b = times(vector, factor)](const Point3&) { return b; };
  return std::nullopt;
}

LoadTerms assemble_loads(const SolutionSpace& space, double density, std::span<const Load> loads) {
  LoadTerms terms;
  terms.load = Eigen::VectorXd::Zero(space.num_unknowns());
  for (const Load& load : loads) {
    LoadReport report;
    report.name = load.name;
    terms.surfaces.emplace_back();
    if (const auto force = volume_force(load, density)) {
      terms.load += volume_load(space, *force, report);
    } else {
      terms.surfaces.back() = surface_load(space, load);
      const SurfaceLoad& surface = terms.surfaces.back();
      report.region = surface.region.report;
      report.region.name = load.name;
      terms.load += traction_load(space, surface.region, surface.traction, report);
    }
    terms.reports.push_back(std::move(report));
  }
  return terms;
}

const char* name_of(LoadKind kind) {
  switch (kind) {
  case LoadKind::BodyForce:
    return "body force";
  case LoadKind::Acceleration:
    return "acceleration";
  case LoadKind::Centrifugal:
    return "centrifugal";
  case LoadKind::Pressure:
    return "pressure";
  case LoadKind::TotalForce:
    return "total force";
  case LoadKind::Remote:
    return "force and moment";
  case LoadKind::Bearing:
    return "bearing";
  case LoadKind::Line:
    return "line";
  case LoadKind::Point:
    return "point";
  default:
    return "traction";
  }
}

std::vector<std::string> region_warnings(std::span<const LoadReport> loads) {
  std::vector<std::string> all;
  for (const LoadReport& load : loads) {
    const auto warnings = region_warnings(load.region, fmt::format("load '{}'", load.name));
    all.insert(all.end(), warnings.begin(), warnings.end());
  }
  return all;
}

} // namespace iga::solve
