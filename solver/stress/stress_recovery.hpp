// Stress recovered from a computed displacement field: smoother and, at the surface, several times more accurate than
// C ε(u_h) itself.
#pragma once

#include "solver/output/sample_fields.hpp"
#include "solver/stress/equilibrated_polynomials.hpp"
#include "solver/stress/known_tractions.hpp"

#include <unordered_map>

namespace iga::solve {

/// A static solution of one body. Initial strains of its material must be smooth.
struct RecoveryProblem {
  const SolutionSpace* space = nullptr;
  const ElasticMaterial* material = nullptr;
  Eigen::VectorXd unknowns; ///< (space->num_unknowns())
  BodyForce body_force;     ///< empty: none; taken as linear over a few spans
  KnownTractions tractions;
};

/// Stress at n points.
struct RecoveredStress {
  std::vector<double> stress;    ///< (n × 6): xx yy zz xy yz zx, force/length²
  std::vector<double> von_mises; ///< (n)
  std::vector<double> error;     ///< (n): estimated error of the von Mises stress, force/length²
};

/// For every cell one polynomial displacement (EquilibratedPolynomials) is fitted by least squares to the strains of
/// u_h in the cell and its neighbours, as far as links lead to them, and to the tractions that are known on their
/// surface. Strains are taken where those of splines are most accurate: in whole cells at the zeros of the Bernoulli
/// polynomial B_p, in cut cells that are filled well enough at their quadrature points. What is near counts most. A
/// second fit of one degree less tells the error.
/// Superconvergent patch recovery: Zienkiewicz & Zhu (1992); with equilibrium and tractions: Blacker & Belytschko
/// (1994), Ródenas et al. (2007); on splines: Kumar, Kvamsdal & Johannessen (2017).
class StressRecovery {
 public:
  explicit StressRecovery(RecoveryProblem problem);

  /// Fits are kept: cells that were asked for before cost nothing but the evaluation. Parallel; the same bits for any
  /// number of threads.
  RecoveredStress at(const SamplePoints& points);

 private:
  struct Plan;
  struct Samples;
  struct Equations;
  /// Factors of the fields, and those of the fit of one degree less.
  struct Fit {
    Point3 centre{};
    LinearForce force;
    Eigen::VectorXd fields, lower;
    double misfit = 0; ///< share of what it leaves of strains and tractions in the error, force/length²
  };
  Plan plan(std::int64_t cell) const;
  bool take(Plan& plan, double least_fraction, double spread) const;
  Samples sample(const std::vector<Plan>& plans) const;
  Equations equations(const Plan& plan, const Samples& samples, const LinearForce& force) const;
  Fit fit(const Plan& plan, const Samples& samples) const;
  void make_fits(std::vector<std::int64_t> cells);
  void evaluate_at(const Fit& fit, const SamplePoints& points, std::span<const std::size_t> numbers,
                   RecoveredStress& out) const;
  std::vector<std::int32_t> neighbourhood(std::int64_t cell, int rings) const;
  /// Where strains are taken in a cell: parameters (n × 3) and shares of a span (n).
  void data_points(std::int32_t cell, std::vector<double>& parameters, std::vector<double>& weights) const;
  /// Linear force in equilibrium with C ε, about a fit's centre.
  LinearForce force_about(std::int64_t cell, const Point3& centre) const;
  Point3 in_spans(const Point3& u, const Point3& centre) const;

  RecoveryProblem problem_;
  const TrimmedModel* model_;
  int degree_;
  double spread_;
  EquilibratedPolynomials polynomials_;
  std::vector<FieldStrains> stresses_; ///< C ε of polynomials_.strains_of_degree(1 …)
  double traction_weight_;             ///< of |t|² on a unit area against strain energy of a unit share of a span
  std::vector<double> whole_[2];       ///< data points of a whole span in units of it (n × 3), and their weights (n)
  std::vector<std::size_t> first_neighbour_;
  std::vector<std::int32_t> neighbours_;
  std::unordered_map<std::int64_t, Fit> fits_;
};

} // namespace iga::solve
