// Statics against closed solutions: convergence tables. The exact tractions act on the facets that stand for the curved
// surface, so that the closed solution is exact on the faceted part too and the facets cost no accuracy.
#include "solver/mechanics/assemble.hpp"
#include "tests/embed/surfaces.hpp"
#include "tests/solver/exact_solutions.hpp"
#include "tests/solver/static_support.hpp"
#include "tests/solver/trimmed_part.hpp"
#include "tests/support/rate.hpp"

#include <Eigen/LU>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

using namespace iga;
using namespace iga::solve;
using namespace iga::test;

namespace {

constexpr double E = 1, nu = 0.3;
using StressField = std::function<Voigt(const Point3&)>;
using DisplacementField = std::function<Point3(const Point3&)>;

/// Errors of a solution against a closed one: in energy (relative) and of the displacement (L2, relative).
struct Errors {
  double energy = 0, displacement = 0;
};

Errors errors_of(const TrimmedModel& model, const StaticResult& result, const ElasticMaterial& material,
                 const StressField& exact, const DisplacementField& displacement) {
  const VoigtMatrix compliance = material.C.inverse();
  double error = 0, energy = 0, off = 0, size = 0;
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* p = result.positions.data() + 3 * q;
    const Point3 x{p[0], p[1], p[2]};
    const Voigt s = exact(x);
    const Voigt d = Eigen::Map<const Voigt>(result.points.stress.data() + 6 * q) - s;
    error += model.points.weights[q] * d.dot(compliance * d);
    energy += model.points.weights[q] * s.dot(compliance * s);
    if (!displacement) continue;
    const Point3 u = displacement(x);
    const double* h = result.points.displacement.data() + 3 * q;
    const Point3 e = minus({h[0], h[1], h[2]}, u);
    off += model.points.weights[q] * dot(e, e);
    size += model.points.weights[q] * dot(u, u);
  }
  return {std::sqrt(error / energy), displacement ? std::sqrt(off / size) : 0};
}

Support symmetry(const Point3& outward, double place) {
  Support support;
  support.name = fmt::format("symmetry {} {} {}", outward[0], outward[1], outward[2]);
  support.along_normal = true;
  support.region.plane = RegionChoice::Plane{times(outward, place), outward, 1e-6};
  support.region.normal = RegionChoice::Direction{outward, 1};
  return support;
}

// Solves with the exact traction on every facet that no support holds; the supports' planes carry no shear.
StaticSolution solve_with(const TrimmedModel& model, const RunSettings& run, const StressField& exact,
                          const std::function<bool(const Point3& x, const Point3& n)>& loaded) {
  const SolutionSpace space(model, usual());
  StiffnessMatrix K = assemble_stiffness(space, std::make_shared<const Connectivity>(space), run.material);
  LoadReport report;
  Eigen::VectorXd f = traction_load(
      space, choose_region(model, {}, "surface"),
      [&](const Point3& x, const Point3& n) { return loaded(x, n) ? traction(exact(x), n) : Point3{}; }, report);
  const SupportTerms terms = apply_supports(space, run.material, run.supports, K);
  SystemMatrix system;
  system.stiffness = &K;
  StaticSolution solution;
  solution.unknowns = factorise_positive_definite(system)->solve(Eigen::VectorXd(f + terms.load));
  solution.result.points =
      recover_fields(space, run.material, solution.unknowns, model.points.offsets, model.points.parameters);
  for (std::size_t q = 0; q < model.points.weights.size(); ++q) {
    const double* u = model.points.parameters.data() + 3 * q;
    const Point3 x = model.grid.to_position({u[0], u[1], u[2]});
    solution.result.positions.insert(solution.result.positions.end(), x.begin(), x.end());
  }
  return solution;
}

// At degree 1, moments of degree 1 on trimmed spans leave half an order behind.
PartOptions grid_for(int p, double h) {
  return {p, h, 0.3, p == 1 ? 2 : 0, identity_rotation};
}

bool is_axis(const Point3& n) {
  return std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])}) > 1 - 1e-9;
}

} // namespace

TEST(ThickSphere, ConvergesInEnergyAndDisplacement) {
  const TriangleMesh mesh = octant(1, 2, 6);
  RunSettings run = run_with({symmetry({-1, 0, 0}, 0), symmetry({0, -1, 0}, 0), symmetry({0, 0, -1}, 0)});
  run.material = isotropic(E, nu, 1);
  for (const int p : {1, 2, 3}) {
    std::vector<double> sizes, energy, displacement;
    for (const double h : p == 3 ? std::vector{0.6, 0.45, 0.3} : std::vector{0.5, 0.34, 0.23, 0.16}) {
      const TrimmedModel model = make_part(mesh, grid_for(p, h));
      const StaticSolution s =
          solve_with(model, run, sphere_stress, [](const Point3&, const Point3& n) { return !is_axis(n); });
      const Errors e = errors_of(model, s.result, run.material, sphere_stress, sphere_displacement);
      sizes.push_back(h);
      energy.push_back(e.energy);
      displacement.push_back(e.displacement);
    }
    EXPECT_GT(print_rates(fmt::format("thick sphere, p = {}: energy", p), sizes, energy), p - 0.3);
    EXPECT_GT(print_rates(fmt::format("thick sphere, p = {}: displacement", p), sizes, displacement), p + 1 - 0.4);
  }
}

// As a user does it: pressure on the faceted inside, nothing else known.
TEST(ThickSphere, UnderPressureMovesAsLameSays) {
  const TrimmedModel model = make_part(octant(1, 2, 24), {2, 0.25, 0.3, 0, identity_rotation});
  RunSettings run = run_with({symmetry({-1, 0, 0}, 0), symmetry({0, -1, 0}, 0), symmetry({0, 0, -1}, 0)});
  run.material = isotropic(E, nu, 1);
  Load pressure;
  pressure.name = "inside";
  pressure.kind = LoadKind::Pressure;
  pressure.pressure = 1;
  // Normals of the inner surface lie within 54.7 degrees of this direction, those of the sides do not.
  pressure.region.normal = RegionChoice::Direction{{-1, -1, -1}, 54};
  StaticSettings settings;
  settings.loads = {pressure};
  const double third = 1 / std::sqrt(3.0);
  settings.probes = {{"inner", {third, third, third}}, {"outer", {2 * third, 2 * third, 2 * third}}};
  const StaticSolution s = run_static(run, settings, SolutionSpace(model, usual()));
  EXPECT_NEAR(s.result.loads[0].area, std::numbers::pi / 2, 0.003);
  const auto& u = s.result.probes.fields.displacement;
  std::printf("thick sphere under pressure: u(a) = %.5f (0.8), u(b) = %.5f (0.3), energy %.5f\n",
              norm({u[0], u[1], u[2]}), norm({u[3], u[4], u[5]}), s.result.strain_energy);
  EXPECT_NEAR(norm({u[0], u[1], u[2]}), 0.8, 0.8 * 5e-3);
  EXPECT_NEAR(norm({u[3], u[4], u[5]}), 0.3, 0.3 * 5e-3);
  EXPECT_NEAR(s.result.strain_energy, 0.5 * 0.8 * std::numbers::pi / 2, 5e-3); // ½ p u(a) · area
}

TEST(PlateWithHole, ConvergesInEnergyAndFindsTheStressConcentration) {
  constexpr double thickness = 0.5;
  const TriangleMesh mesh = quarter_plate(6, thickness);
  RunSettings run = run_with(
      {symmetry({-1, 0, 0}, 0), symmetry({0, -1, 0}, 0), symmetry({0, 0, -1}, 0), symmetry({0, 0, 1}, thickness)});
  run.material = isotropic(E, nu, 1);
  const auto loaded = [](const Point3& x, const Point3& n) {
    return std::abs(n[2]) < 0.5 && x[0] > 1e-9 && x[1] > 1e-9;
  };
  for (const int p : {1, 2, 3}) {
    std::vector<double> sizes, energy;
    double concentration = 0;
    for (const double h : p == 3 ? std::vector{0.5, 0.35, 0.25} : std::vector{0.5, 0.35, 0.25, 0.17}) {
      const TrimmedModel model = make_part(mesh, grid_for(p, h));
      const StaticSolution s = solve_with(model, run, kirsch_stress, loaded);
      sizes.push_back(h);
      energy.push_back(errors_of(model, s.result, run.material, kirsch_stress, {}).energy);
      const SolutionSpace space(model, usual());
      const std::vector<Probe> probes{{"top of the hole", {0, 1, thickness / 2}}};
      concentration =
          recover_probes(space, run.material, s.unknowns, probes, locate_probes(model, probes)).fields.stress[0];
    }
    const double rate = print_rates(fmt::format("plate with a hole, p = {}: energy", p), sizes, energy);
    std::printf("stress concentration %.4f (3)\n", concentration);
    EXPECT_GT(rate, p - 0.3);
    if (p > 1) {
      EXPECT_NEAR(concentration, 3, 0.3);
    }
  }
}

// Clamped at one end, sheared at the other. Without lateral contraction the clamp leaves the section alone and the
// deflection is Timoshenko's.
TEST(Cantilever, DeflectsAsBeamTheorySays) {
  constexpr double length = 8, modulus = 1000;
  const TriangleMesh mesh = transformed(box({0, 0, 0}, {length, 1, 1}), rotation(20, 15), {});
  const Rotation R = rotation(20, 15);
  const auto column = [&](std::size_t d) { return Point3{R[0][d], R[1][d], R[2][d]}; };
  constexpr double shear_area = 5.0 / 6, G = modulus / 2;
  const double theory = length * length * length * 12 / (3 * modulus) + length / (shear_area * G);
  for (const auto method : {SupportMethod::Nitsche, SupportMethod::Lagrange, SupportMethod::Penalty}) {
    Support clamp;
    clamp.name = "clamp";
    clamp.region.normal = RegionChoice::Direction{times(column(0), -1), 1};
    clamp.method = method;
    RunSettings run = run_with({clamp});
    run.material = isotropic(modulus, 0, 1);
    Load load;
    load.name = "tip";
    load.kind = LoadKind::TotalForce;
    load.vector = column(2);
    load.region.normal = RegionChoice::Direction{column(0), 1};
    StaticSettings settings;
    settings.loads = {load};
    std::printf("cantilever, method %d: mean deflection of the tip (beam theory %.5f)\n%4s %8s %12s %12s\n",
                static_cast<int>(method), theory, "p", "h", "deflection", "relative");
    for (const int p : {1, 2, 3}) {
      double off = 0;
      for (const double h : p == 3 ? std::vector{0.7, 0.5} : std::vector{0.7, 0.5, 0.35}) {
        const TrimmedModel model = make_part(mesh, grid_for(p, h));
        const StaticSolution s = run_static(run, settings, SolutionSpace(model, usual()));
        const double deflection = 2 * s.result.external_work;
        std::printf("%4d %8.3f %12.6f %12.2e\n", p, h, deflection, deflection / theory - 1);
        off = std::abs(deflection / theory - 1);
        EXPECT_NEAR(dot(s.reactions[0].force, column(2)), -1, 1e-8);
      }
      if (p > 1) {
        EXPECT_LT(off, 5e-3);
      }
    }
  }
}
