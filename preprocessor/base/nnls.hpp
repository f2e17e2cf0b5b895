// Non-negative least squares with an updated QR factorisation and candidates that may be added while it runs.
#pragma once

#include "format/model/simd.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace iga::prep {

/// min ‖A w - b‖ over w >= 0, by the active-set method of Lawson & Hanson (1974, chapter 23). The passive columns are
/// kept as A_P = Q R (Gram–Schmidt, twice); a column leaves by Givens rotations. At most m columns are ever passive.
/// One object per thread: nothing is allocated once the buffers have grown.
class Nnls {
 public:
  /// Starts a new problem with m rows. @param b  (m)
  void start(std::span<const double> b);
  /// Adds candidates to the ones there are; the current solution stays valid.
  /// @param columns  (count × m), row by row one candidate's column
  void add_columns(std::span<const double> columns, std::size_t count);

  enum class Status { Converged, NoAscent, OutOfSteps };
  /// Runs until ‖A w - b‖ <= tolerance ‖b‖, or no candidate can lower the residual any more (NoAscent: add others), for
  /// at most `max_steps` exchanges of columns.
  Status solve(double tolerance, int max_steps);

  std::size_t num_columns() const { return num_columns_; }
  double relative_residual() const;
  std::span<const double> residual() const { return std::span(r_).first(m_); } ///< (m) b - A w
  std::size_t num_passive() const { return passive_.size(); }
  std::size_t passive(std::size_t i) const { return passive_[i]; } ///< column number
  double weight(std::size_t i) const { return w_[i]; }             ///< of that column, > 0
  int num_steps() const { return steps_; }

 private:
  double* q(std::size_t i) { return &Q_[i * stride_]; }
  double* r_column(std::size_t i) { return &R_[i * m_]; }
  bool append(std::size_t column);
  void remove(std::size_t position);
  void back_substitute();
  void refresh_residual();
  std::size_t best_column();

  std::size_t m_ = 0, stride_ = 0, num_columns_ = 0;
  double norm_b_ = 0;
  int steps_ = 0;
  std::vector<double> b_, r_, c_, z_, w_;
  std::vector<double> Q_;             // (passive × stride)
  std::vector<double> R_;             // (passive × m), column i holds rows 0 … i
  std::vector<Lanes> A_;              // blocks of 8 candidates: [block][row][lane]
  std::vector<double> inverse_norm_;  // 1 / ‖a_j‖, 0 for padding
  std::vector<std::uint8_t> blocked_; // passive, or refused in this step
  std::vector<std::size_t> passive_;
};

} // namespace iga::prep
