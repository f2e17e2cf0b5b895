#include "preprocessor/base/nnls.hpp"

#include <algorithm>
#include <cmath>

namespace iga::prep {

namespace {

// A column whose part orthogonal to the passive ones is smaller than this (relative) adds nothing but noise.
constexpr double dependent_column = 1e-12;
// Symmetric parts have columns that descend equally; of those this close the first is taken, so that rounding (another
// scale or place of the same part) does not choose.
constexpr double tie = 1e-6;
// The residual cannot be lowered further when no column makes a smaller angle with it than this.
constexpr double no_ascent = 1e-13;

// Vectors are padded with zeros to whole lanes.
double dot(const double* x, const double* y, std::size_t n) {
  Lanes s{};
  for (std::size_t i = 0; i < n; i += lanes) {
    Lanes a, b;
    __builtin_memcpy(&a, x + i, sizeof a);
    __builtin_memcpy(&b, y + i, sizeof b);
    s += a * b;
  }
  return sum(s);
}

void axpy(double a, const double* x, double* y, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) y[i] += a * x[i];
}

} // namespace

void Nnls::start(std::span<const double> b) {
  m_ = b.size();
  stride_ = (m_ + lanes - 1) / lanes * lanes;
  num_columns_ = 0;
  steps_ = 0;
  b_.assign(stride_, 0);
  std::copy(b.begin(), b.end(), b_.begin());
  r_ = b_;
  norm_b_ = std::sqrt(dot(b_.data(), b_.data(), stride_));
  Q_.resize(m_ * stride_);
  R_.resize(m_ * m_);
  c_.resize(m_);
  z_.resize(m_);
  w_.clear();
  A_.clear();
  inverse_norm_.clear();
  blocked_.clear();
  passive_.clear();
}

void Nnls::add_columns(std::span<const double> columns, std::size_t count) {
  const std::size_t total = num_columns_ + count, blocks = (total + lanes - 1) / lanes;
  A_.resize(blocks * m_);
  inverse_norm_.resize(blocks * lanes);
  blocked_.resize(blocks * lanes);
  for (std::size_t j = num_columns_; j < blocks * lanes; ++j) {
    double norm = 0;
    for (std::size_t k = 0; k < m_; ++k) {
      const double a = j < total ? columns[(j - num_columns_) * m_ + k] : 0;
      A_[j / lanes * m_ + k][j % lanes] = a;
      norm += a * a;
    }
    inverse_norm_[j] = norm > 0 ? 1 / std::sqrt(norm) : 0;
    blocked_[j] = norm > 0 ? 0 : 1;
  }
  num_columns_ = total;
}

double Nnls::relative_residual() const {
  return norm_b_ > 0 ? std::sqrt(dot(r_.data(), r_.data(), stride_)) / norm_b_ : 0;
}

// Column with the steepest descent of the residual, among those not blocked; num_columns_ where there is none.
std::size_t Nnls::best_column() {
  std::size_t best = num_columns_;
  double best_value = no_ascent * std::sqrt(dot(r_.data(), r_.data(), stride_));
  const std::size_t blocks = inverse_norm_.size() / lanes;
  for (std::size_t block = 0; block < blocks; ++block) {
    const Lanes* A = &A_[block * m_];
    Lanes g0{}, g1{}, g2{}, g3{};
    std::size_t k = 0;
    for (; k + 4 <= m_; k += 4) {
      g0 += A[k] * r_[k];
      g1 += A[k + 1] * r_[k + 1];
      g2 += A[k + 2] * r_[k + 2];
      g3 += A[k + 3] * r_[k + 3];
    }
    for (; k < m_; ++k) g0 += A[k] * r_[k];
    const Lanes g = (g0 + g1) + (g2 + g3);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t j = block * lanes + lane;
      const double value = g[lane] * inverse_norm_[j];
      if (value > best_value * (1 + tie) && !blocked_[j]) {
        best_value = value;
        best = j;
      }
    }
  }
  return best;
}

// Makes a column passive; false where it depends on the passive ones.
bool Nnls::append(std::size_t column) {
  const std::size_t k = passive_.size();
  double* v = q(k);
  std::fill(v, v + stride_, 0.0);
  for (std::size_t row = 0; row < m_; ++row) v[row] = A_[column / lanes * m_ + row][column % lanes];
  double* R = r_column(k);
  std::fill(R, R + k, 0.0);
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t i = 0; i < k; ++i) {
      const double s = dot(q(i), v, stride_);
      axpy(-s, q(i), v, stride_);
      R[i] += s;
    }
  const double norm = std::sqrt(dot(v, v, stride_));
  if (norm * inverse_norm_[column] < dependent_column) return false;
  for (std::size_t row = 0; row < stride_; ++row) v[row] /= norm;
  R[k] = norm;
  c_[k] = dot(v, r_.data(), stride_);
  passive_.push_back(column);
  w_.push_back(0);
  return true;
}

// Takes the column at a position out of Q R by Givens rotations of neighbouring rows.
void Nnls::remove(std::size_t position) {
  const std::size_t k = passive_.size();
  for (std::size_t i = position; i + 1 < k; ++i) {
    std::copy_n(r_column(i + 1), i + 2, r_column(i));
    passive_[i] = passive_[i + 1];
    w_[i] = w_[i + 1];
  }
  for (std::size_t i = position; i + 1 < k; ++i) {
    const double a = r_column(i)[i], b = r_column(i)[i + 1];
    const double h = std::hypot(a, b), cs = a / h, sn = b / h;
    for (std::size_t j = i; j + 1 < k; ++j) {
      double* R = r_column(j);
      const double x = R[i], y = R[i + 1];
      R[i] = cs * x + sn * y;
      R[i + 1] = cs * y - sn * x;
    }
    double *qi = q(i), *qn = q(i + 1);
    for (std::size_t row = 0; row < stride_; ++row) {
      const double x = qi[row], y = qn[row];
      qi[row] = cs * x + sn * y;
      qn[row] = cs * y - sn * x;
    }
    const double x = c_[i], y = c_[i + 1];
    c_[i] = cs * x + sn * y;
    c_[i + 1] = cs * y - sn * x;
  }
  passive_.pop_back();
  w_.pop_back();
}

// z = R^{-1} c, column by column.
void Nnls::back_substitute() {
  const std::size_t k = passive_.size();
  std::copy_n(c_.begin(), k, z_.begin());
  for (std::size_t i = k; i-- > 0;) {
    const double* R = r_column(i);
    z_[i] /= R[i];
    axpy(-z_[i], R, z_.data(), i);
  }
}

void Nnls::refresh_residual() {
  r_ = b_;
  for (std::size_t i = 0; i < passive_.size(); ++i) {
    // Modified Gram–Schmidt: the coefficients are taken from what is left of b.
    c_[i] = dot(q(i), r_.data(), stride_);
    axpy(-c_[i], q(i), r_.data(), stride_);
  }
}

Nnls::Status Nnls::solve(double tolerance, int max_steps) {
  const int last_step = steps_ + max_steps;
  std::vector<std::size_t> refused;
  const auto forgive = [&] {
    for (std::size_t j : refused) blocked_[j] = 0;
    refused.clear();
  };
  while (true) {
    if (relative_residual() <= tolerance) {
      forgive();
      return Status::Converged;
    }
    if (steps_ >= last_step) {
      forgive();
      return Status::OutOfSteps;
    }
    const std::size_t j = passive_.size() < m_ ? best_column() : num_columns_;
    if (j == num_columns_) {
      forgive();
      return Status::NoAscent;
    }
    ++steps_;
    const std::size_t k = passive_.size();
    if (!append(j)) {
      blocked_[j] = 1;
      refused.push_back(j);
      continue;
    }
    back_substitute();
    if (z_[k] <= 0) { // rounding: this column would leave at once
      passive_.pop_back();
      w_.pop_back();
      blocked_[j] = 1;
      refused.push_back(j);
      continue;
    }
    forgive();
    blocked_[j] = 1;
    axpy(-c_[k], q(k), r_.data(), stride_);
    bool removed = false;
    while (std::any_of(z_.begin(), z_.begin() + static_cast<std::ptrdiff_t>(passive_.size()),
                       [](double z) { return z <= 0; })) {
      double alpha = 1;
      for (std::size_t i = 0; i < passive_.size(); ++i)
        if (z_[i] <= 0) alpha = std::min(alpha, w_[i] / (w_[i] - z_[i]));
      for (std::size_t i = 0; i < passive_.size(); ++i) {
        const bool leaves = z_[i] <= 0 && w_[i] / (w_[i] - z_[i]) <= alpha;
        w_[i] = leaves ? 0 : w_[i] + alpha * (z_[i] - w_[i]);
      }
      for (std::size_t i = passive_.size(); i-- > 0;)
        if (w_[i] <= 0) {
          blocked_[passive_[i]] = 0;
          remove(i);
        }
      removed = true;
      back_substitute();
    }
    std::copy_n(z_.begin(), passive_.size(), w_.begin());
    if (removed) refresh_residual();
  }
}

} // namespace iga::prep
