// Does a straight way cross a triangle? An answer that is sure, or none.
#pragma once

#include "format/model/vec3.hpp"

#include <limits>
#include <optional>

namespace iga {

namespace detail {

/// Sign of a determinant, 0 where rounding may have made it.
inline int sure_sign(double value, double error) {
  return value > error ? 1 : value < -error ? -1 : 0;
}

} // namespace detail

/// Change of the winding number along the way from `from` to `from + way` where it passes the triangle (a, a + ab,
/// a + ac), outward by the right-hand rule: +1 where it enters the solid behind it, -1 where it leaves, 0 where it does
/// not pass. None where the way ends on the triangle or meets its edge or plane within rounding: ask with another way.
/// Answers about the triangles of one surface fit together: every one is that of exact arithmetic.
/// Signs of determinants (Möller & Trumbore 1997) with a bound of their rounding (static filter, Shewchuk 1997).
inline std::optional<int> winding_change(const Point3& from, const Point3& way, const Point3& a, const Point3& ab,
                                         const Point3& ac) {
  // Every determinant is a sum of six products of three rounded factors: sixteen units cover them all.
  constexpr double unit = 16 * std::numeric_limits<double>::epsilon();
  const Point3 p = cross(way, ac), f = minus(from, a), q = cross(f, ab);
  const double scale = dot(ab, p), s = dot(f, p), r = dot(way, q), t = dot(ac, q);
  const double W = norm(way), F = norm(f), B = norm(ab), C = norm(ac);
  const double scale_error = unit * W * B * C, s_error = unit * F * W * C, r_error = unit * W * F * B,
               t_error = unit * C * F * B;
  const int in_s = detail::sure_sign(s, s_error), in_r = detail::sure_sign(r, r_error),
            in_rest = detail::sure_sign(scale - s - r, scale_error + s_error + r_error);
  if (in_s * in_r < 0 || in_s * in_rest < 0 || in_r * in_rest < 0) return 0;
  const int begin = detail::sure_sign(t, t_error), end = detail::sure_sign(scale - t, scale_error + t_error);
  if (begin * end < 0) return 0;
  if (in_s == 0 || in_r == 0 || in_rest == 0 || begin == 0 || end == 0) return std::nullopt;
  return in_s == begin ? std::optional<int>(in_s) : std::nullopt;
}

} // namespace iga
