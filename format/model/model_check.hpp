// What the parts of check(TrimmedModel) share: the list of problems, careful sums and the bounds they must keep.
#pragma once

#include "format/model/trimmed_model.hpp"

#include <cmath>
#include <fmt/format.h>

namespace iga::detail {

/// Problems of one kind: the first `limit` are spelled out, the rest counted when the kind goes out of scope.
class ProblemKind {
 public:
  ProblemKind(std::vector<std::string>& problems, int limit, const char* what)
      : problems_(problems), limit_(limit), what_(what) {}
  ProblemKind(const ProblemKind&) = delete;
  ProblemKind& operator=(const ProblemKind&) = delete;
  ~ProblemKind() {
    if (count_ > limit_) problems_.push_back(fmt::format("{}: {} more of this kind", what_, count_ - limit_));
  }
  template <class... Args> void add(fmt::format_string<Args...> text, Args&&... args) {
    if (count_++ < limit_)
      problems_.push_back(fmt::format("{}: {}", what_, fmt::format(text, std::forward<Args>(args)...)));
  }
  bool empty() const { return count_ == 0; }

 private:
  std::vector<std::string>& problems_;
  std::int64_t limit_, count_ = 0;
  const char* what_;
};

/// Neumaier's compensated sum: its error does not grow with the number of terms.
class Sum {
 public:
  void add(double x) {
    const double t = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - t) + x : (x - t) + sum_;
    sum_ = t;
  }
  double value() const { return sum_ + rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

/// Rounding that no producer can avoid, per direction and in spans: a parameter is known to a few units in its last
/// place, and that place is large where the grid lies far from the origin.
Point3 parameter_rounding(const SplineGrid& grid);
/// The same for the volume of a span, as a fraction of it; at least 1e-12 for the sums along the rows of spans.
double volume_rounding(const SplineGrid& grid);
/// Largest relative error of a trimmed span's volume that its residual allows. The residual is relative to the
/// Euclidean norm of the n moments; each is bounded by the piece's volume (scaled Legendre polynomials lie within ±1)
/// and the first one is the volume itself: √n · tolerance.
double moment_error(const QuadratureInfo& info);
/// How far outside its closed span a parameter may lie, in spans.
constexpr double inside_tolerance = 1e-9;
/// Relative tolerance of the integrals over the whole part.
constexpr double integral_tolerance = 1e-9;

/// Does parameter u lie in the closed span, to inside_tolerance?
bool in_closed_span(const SplineGrid& grid, const Index3& span, const double* u, const Point3& rounding);
/// Ragged-array rule: starts at 0, never falls, ends at `count`.
void check_offsets(const std::vector<std::int64_t>& offsets, std::size_t count, ProblemKind& kind);

void check_volume(const TrimmedModel& model, int limit, std::vector<std::string>& problems);
/// cells/functions and links against each other: the right B-splines in the right order, every copy on cells that links
/// inside its support join, and no link between two copies of one function. False where nothing may index by them.
bool cells_fit(const TrimmedModel& model, int limit, std::vector<std::string>& problems);
/// The matrix of the unknowns: entries in range, rows that keep constant and linear fields. False where nothing may
/// index by it.
bool unknowns_fit(const TrimmedModel& model, ProblemKind& kind);
/// Are the unknowns' functions continuous across the face, normal to `axis`, between the cells of a link?
void check_continuity(const TrimmedModel& model, std::size_t link, std::size_t axis, ProblemKind& kind);
void check_functions(const TrimmedModel& model, int limit, std::vector<std::string>& problems);
void check_surface(const TrimmedModel& model, int limit, std::vector<std::string>& problems);
/// Curves and markers: shapes, names, finite numbers, curves of some length.
void check_places(const TrimmedModel& model, int limit, std::vector<std::string>& problems);

} // namespace iga::detail
