// One factorisation by the multifrontal solver MUMPS: Amestoy, Duff, Koster, L'Excellent (2001).
#pragma once

#include "solver/linalg/linear_solver.hpp"

#include <dmumps_c.h>

#include <vector>

namespace iga::solve {

/// A scaled matrix by entries, and its elimination order.
struct MumpsEntries {
  std::vector<MUMPS_INT> rows, columns; ///< from 1; of symmetric matrices the lower triangle
  std::vector<double> values;
  std::vector<MUMPS_INT> position; ///< (size): place of each unknown in the elimination, from 1
  Eigen::VectorXd scale;           ///< (size)
};

/// What messages say of a matrix.
struct MumpsWords {
  const char* matrix;    ///< "an indefinite system"
  const char* in_memory; ///< the same where memory is the matter
  const char* cause;     ///< what a failed factorisation says about it
};

class MumpsFactor {
 public:
  enum class Kind { Unsymmetric = 0, Symmetric = 2 };
  /// @param unknowns  of the user's system, for messages
  MumpsFactor(MumpsEntries entries, Kind kind, const MumpsWords& words, std::int64_t unknowns);
  ~MumpsFactor();
  MumpsFactor(const MumpsFactor&) = delete;
  MumpsFactor& operator=(const MumpsFactor&) = delete;

  /// ICNTL and CNTL of MUMPS, by their numbers, before factorise().
  MUMPS_INT& control(int number) { return mumps_.icntl[number - 1]; }
  double& real_control(int number) { return mumps_.cntl[number - 1]; }
  /// Analysis and factorisation; the entries are given up.
  /// @throws InputError where memory does not suffice, NumericalError where the factorisation fails
  void factorise(const std::function<void(const FactorCost&)>& announce = {});
  /// y = A⁻¹ y of the scaled matrix, columns one after the other.
  void solve(double* y, int columns) const;

  std::int64_t size() const { return entries_.scale.size(); }
  const Eigen::VectorXd& scale() const { return entries_.scale; }
  const FactorCost& cost() const { return cost_; }
  MUMPS_INT info(int number) const { return mumps_.infog[number - 1]; } ///< INFOG

 private:
  void call(int job) const;
  [[noreturn]] void fail() const;

  MumpsEntries entries_;
  MumpsWords words_;
  std::int64_t unknowns_;
  mutable DMUMPS_STRUC_C mumps_{};
  FactorCost cost_;
};

/// @throws InputError for more unknowns than MUMPS can number
void need_mumps_numbers(std::int64_t unknowns);

} // namespace iga::solve
