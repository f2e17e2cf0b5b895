// Stress at the surface against closed solutions, as computed and recovered: largest errors, the stress concentration
// itself, and what the estimated error covers. Grids in general position; exact tractions act where the part is cut out
// of an endless body, of which the recovery knows nothing.
#include "solver/mechanics/assemble.hpp"
#include "solver/stress/stress_recovery.hpp"
#include "tests/solver/exact_solutions.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"
#include "tests/support/rate.hpp"

#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

using StressField = std::function<Voigt(const Point3&)>;
using Test = std::function<bool(const Point3& x, const Point3& n)>;

Support symmetry(const Point3& outward, double place) {
  Support support;
  support.name = fmt::format("symmetry {} {} {}", outward[0], outward[1], outward[2]);
  support.along_normal = true;
  support.region.plane = RegionChoice::Plane{times(outward, place), outward, 1e-6};
  support.region.normal = RegionChoice::Direction{outward, 1};
  return support;
}

/// A part cut out of an endless body, or a pressurised vessel.
struct StressCase {
  std::string name;
  TriangleMesh mesh;
  std::vector<Support> supports;
  StressField exact;
  std::function<double(const Point3&)> radius; ///< 1 on the surface that is looked at
  double concentration = 0;                    ///< largest von Mises stress there
};

/// What the surface of radius 1 has, relative to the largest von Mises stress there.
struct Found {
  double raw = 0, recovered = 0;                 ///< largest error of the von Mises stress
  double raw_largest = 0, recovered_largest = 0; ///< error of the largest von Mises stress
  double told = 0;                               ///< estimated error there
  double covered = 0;                            ///< share of the surface where the error is below the estimate
  double seconds = 0;
};

Found examine(const StressCase& part, const TrimmedModel& model) {
  const ElasticMaterial material = isotropic(1, exact_nu, 1);
  const SolutionSpace space(model, usual());
  const auto is_held = [](const Point3& n) { return std::max({n[0], n[1], n[2], -n[0], -n[1], -n[2]}) > 1 - 1e-9; };
  StiffnessMatrix K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), material);
  LoadReport report;
  const auto at_hole = [&](const Point3& x) { return std::abs(part.radius(x) - 1) < 0.02; };
  const auto on_symmetry = [&](const Point3& x, const Point3& n) {
    return is_held(n) && std::any_of(part.supports.begin(), part.supports.end(), [&](const Support& support) {
             const auto& plane = *support.region.plane;
             return dot(plane.normal, n) > 0.99 && std::abs(dot(plane.normal, minus(x, plane.point))) < 1e-6;
           });
  };
  const Eigen::VectorXd f = traction_load(
      space, choose_region(model, {}, "surface"),
      [&](const Point3& x, const Point3& n) { return on_symmetry(x, n) ? Point3{} : traction(part.exact(x), n); },
      report);
  const SupportTerms terms = apply_supports(space, material, part.supports, K);
  SystemMatrix system;
  system.stiffness = &K;
  RecoveryProblem problem;
  problem.space = &space;
  problem.material = &material;
  problem.unknowns = factorise_positive_definite(system)->solve(Eigen::VectorXd(f + terms.load));
  SurfaceConditions conditions;
  conditions.supports = part.supports;
  const TriangleMesh& mesh = model.surface.mesh;
  const bool is_pressed = part.exact(Point3{1, 0, 0})[0] < -0.5;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t c) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][c])]; };
    const Point3 n = cross(minus(corner(1), corner(0)), minus(corner(2), corner(0)));
    const Point3 middle = times(plus(corner(0), plus(corner(1), corner(2))), 1.0 / 3);
    if (!at_hole(middle) && !on_symmetry(middle, times(n, 1 / norm(n))))
      conditions.unknown.push_back(static_cast<std::int64_t>(t));
  }
  if (is_pressed) {
    Load pressure;
    pressure.name = "inside";
    pressure.kind = LoadKind::Pressure;
    pressure.pressure = 1;
    // Normals of the inner surface lie within 54.7 degrees of this direction, those of the sides do not.
    pressure.region.normal = part.supports.size() == 4 ? RegionChoice::Direction{{-1, -1, 0}, 44.9}
                                                       : RegionChoice::Direction{{-1, -1, -1}, 54};
    conditions.loads = {pressure};
  }
  const auto start = std::chrono::steady_clock::now();
  problem.tractions = known_tractions(space, conditions);
  SamplePoints points;
  std::vector<double> areas;
  const SurfacePoints& q = model.surface.quadrature;
  for (std::size_t a = 0; a < model.num_cells(); ++a)
    for (auto s = static_cast<std::size_t>(q.offsets[a]); s < static_cast<std::size_t>(q.offsets[a + 1]); ++s) {
      const double* u = &q.parameters[3 * s];
      const Point3 x = model.grid.to_position({u[0], u[1], u[2]});
      if (!at_hole(x) || on_symmetry(x, {q.normals[3 * s], q.normals[3 * s + 1], q.normals[3 * s + 2]})) continue;
      points.cell.push_back(static_cast<std::int64_t>(a));
      points.parameters.insert(points.parameters.end(), u, u + 3);
      areas.push_back(q.weights[s]);
    }
  const RecoveredStress recovered = StressRecovery(problem).at(points);
  Found found;
  found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<double> raw = sample_fields(space, material, points, problem.unknowns, Fields::VonMises).von_mises;
  double area = 0, covered = 0, largest = 0;
  for (std::size_t k = 0; k < raw.size(); ++k) {
    const double* u = &points.parameters[3 * k];
    const double exact = von_mises(part.exact(model.grid.to_position({u[0], u[1], u[2]})));
    const double off = std::abs(recovered.von_mises[k] - exact);
    found.raw = std::max(found.raw, std::abs(raw[k] - exact) / part.concentration);
    found.recovered = std::max(found.recovered, off / part.concentration);
    found.raw_largest = std::max(found.raw_largest, raw[k] / part.concentration);
    if (recovered.von_mises[k] > largest) {
      largest = recovered.von_mises[k];
      found.told = recovered.error[k] / part.concentration;
    }
    area += areas[k];
    if (off < recovered.error[k]) covered += areas[k];
  }
  found.raw_largest -= 1;
  found.recovered_largest = largest / part.concentration - 1;
  found.covered = covered / area;
  return found;
}

const Support no_x = symmetry({-1, 0, 0}, 0), no_y = symmetry({0, -1, 0}, 0), no_z = symmetry({0, 0, -1}, 0);

std::vector<StressCase> cases() {
  const auto round = [](const Point3& x) { return norm(x); };
  const auto about_z = [](const Point3& x) { return std::hypot(x[0], x[1]); };
  const auto lame = [](const Point3& x) { return lame_stress(x); };
  return {{"thick cylinder, Lamé",
           quarter_ring(24, 2, 1),
           {no_x, no_y, no_z, symmetry({0, 0, 1}, 1)},
           lame,
           about_z,
           von_mises(lame({1, 0, 0}))},
          {"thick sphere, Lamé",
           octant(1, 2, 32),
           {no_x, no_y, no_z},
           sphere_stress,
           round,
           von_mises(sphere_stress({1, 0, 0}))},
          {"plate with a hole, Kirsch",
           quarter_plate(24, 1),
           {no_x, no_y, no_z, symmetry({0, 0, 1}, 1)},
           kirsch_stress,
           about_z,
           von_mises(kirsch_stress({0, 1, 0}))},
          {"spherical cavity, Goodier",
           octant(1, 2.5, 32, true),
           {no_x, no_y, no_z},
           goodier_stress,
           round,
           von_mises(goodier_stress({1, 0, 0}))}};
}

} // namespace

TEST(SurfaceStress, ConvergesToClosedSolutions) {
  for (const StressCase& part : cases()) {
    std::printf("%s\n%3s %7s %20s %20s %9s %9s %8s\n%11s %10s %9s %10s %9s\n", part.name.c_str(), "p", "h",
                "largest error, %", "of the largest, %", "told, %", "covered", "s", "", "raw", "recovered", "raw",
                "recovered");
    for (const int p : {1, 2, 3}) {
      std::vector<double> sizes, errors;
      for (const double h : {0.5, 1.0 / 3, 0.25}) {
        if (p == 3 && h < 0.3) continue;
        const TrimmedModel model = make_part(part.mesh, {p, h, 0.3, 0, rotation(20, 15)});
        const Found f = examine(part, model);
        std::printf("%3d %7.3f %10.2f %9.2f %10.2f %9.2f %9.2f %9.0f %8.2f\n", p, h, 100 * f.raw, 100 * f.recovered,
                    100 * f.raw_largest, 100 * f.recovered_largest, 100 * f.told, 100 * f.covered, f.seconds);
        std::fflush(stdout);
        if (p > 1 && h < 0.4) {
          EXPECT_LT(std::abs(f.recovered_largest), 0.02);
          EXPECT_LT(f.recovered, f.raw);
        }
      }
    }
  }
}
