// Ties: surfaces of two bodies that move as one, joined by symmetric Nitsche terms with weights, or by a penalty.
#pragma once

#include "solver/mechanics/body_system.hpp"
#include "solver/space/surface_region.hpp"
#include "solver/supports/boundary.hpp"

#include <array>
#include <optional>

namespace iga::solve {

enum class TieMethod { Nitsche, Penalty };

/// One of [[ties]], as asked for.
struct Tie {
  std::string name;
  std::string where; ///< "file:line" of the table, opens messages
  /// Names of the two bodies; without them every pair of bodies is looked at.
  std::optional<std::array<std::string, 2>> bodies;
  std::array<RegionChoice, 2> choice; ///< of surface of each of the two; no test: the whole surface
  std::optional<double> tolerance;    ///< length; largest gap or overlap that is tied; default: tie_tolerance of a span
  TieMethod method = TieMethod::Nitsche;
  double penalty_factor = 1e3; ///< C in beta = C E / h, of the softer body; for the penalty method
};

/// Default tolerance and the largest one, as shares of the smallest span of the two bodies.
constexpr double tie_tolerance = 0.01, most_tie_tolerance = 0.5;

/// What a tie between two bodies turned out to be.
struct TieReport {
  std::string name;
  std::array<std::string, 2> bodies;
  double area = 0;                ///< length², on the first body
  std::array<double, 2> chosen{}; ///< area of each side's choice of surface, length²
  double largest_gap = 0;         ///< length; distance of the surfaces, apart or overlapping
  double tolerance = 0;           ///< length
  std::int64_t points = 0;
};

/// Places where a cell of one body lies on a cell of the other: quadrature points, as many for each triangle that the
/// common pieces of the surfaces fall into. Their parameters may lie outside a cell's span by the gap: its polynomials
/// continue there, so that no rigid motion is resisted.
struct TiePair {
  std::array<std::int64_t, 2> cell{};
  std::array<std::vector<double>, 2> parameters; ///< (n × 3) of the same places, row-major, in either body's grid
  std::vector<double> weights;                   ///< (n); area, length²
  std::vector<Point3> normals;                   ///< (n); of the first body, outward, unit
  std::size_t size() const { return weights.size(); }
};

/// One tie between two bodies.
struct TieSurface {
  Tie tie;
  std::array<std::size_t, 2> body{};   ///< of the system, the lower one first
  std::vector<TiePair> pairs;          ///< sorted by their cells
  std::size_t points_per_triangle = 1; ///< that follow one another
  TieReport report;
};

/// Finds what is tied. The surfaces are cut so that on every piece the functions of both bodies are polynomials: at
/// the triangles of either one, projected along the first body's normals, at the span faces of both, and where the
/// distance passes the tolerance. Surfaces must face each other to 60°.
/// @throws InputError for a tie that finds nothing (with the smallest distance), an unknown body, a tolerance larger
///         than the spans bear, and surface that lies on several layers of the other body
std::vector<TieSurface> find_ties(const BodySystem& system, std::span<const Tie> ties);

/// Sets of nodes that the ties couple, for BodySystem::connectivity.
std::vector<std::vector<std::int32_t>> coupled_nodes(const BodySystem& system, std::span<const TieSurface> ties);

/// A tie with what each side's cells bear: Nitsche's β as a support on the same points would need it.
struct PreparedTie {
  TieSurface surface;
  /// Side s as a support that fixes all components: its cells and, after nitsche_parameters, their β. Its points are
  /// those of the pairs; triangles that are small beside the spans have one each, which β does not feel.
  std::array<PreparedSupport, 2> side;
};
std::vector<PreparedTie> prepare_ties(const BodySystem& system, std::vector<TieSurface> surfaces);
/// The sides of Nitsche ties that belong to a body: they draw on the same strain energy as its supports.
std::vector<PreparedSupport*> nitsche_sides(std::span<PreparedTie> ties, std::size_t body);

/// Adds K_ab = -(B + Bᵀ) + β M with B = ∫ [v]·{t} over the tied surface, [u] = u_a - u_b, {t} = γ_a σ_a n + γ_b σ_b n.
/// With β_a, β_b of the cells, γ_a = β_b / (β_a + β_b) and β = β_a β_b / (β_a + β_b): the stiffer or the worse
/// supported side weighs less, and the sum stays positive definite (Annavarapu, Hautefeuille, Dolbow 2012). @pre β of
/// all sides is there
void add_ties(const BodySystem& system, std::span<const PreparedTie> ties, StiffnessMatrix& K);

/// What the bodies' initial strains add to the right-hand side through Nitsche ties: -∫ {C ε₀ n}·[v] dA. (num_unknowns)
Eigen::VectorXd initial_strain_load(const BodySystem& system, std::span<const PreparedTie> ties);

/// What goes through a tie.
struct TieForce {
  Point3 force{};            ///< of the second body on the first
  Point3 moment{};           ///< about the origin
  double gap_work = 0;       ///< ∫ {t}·[u] dA, as Reaction has it (initial strains too)
  double penalty_energy = 0; ///< ½ ∫ β |[u]|² dA
  double largest_jump = 0;   ///< largest |[u]| at the points, length
};
/// The bodies' initial strains count.
std::vector<TieForce> tie_forces(const BodySystem& system, std::span<const PreparedTie> ties, const Eigen::VectorXd& u);

} // namespace iga::solve
