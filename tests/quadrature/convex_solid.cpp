#include "tests/quadrature/convex_solid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iga::test {

namespace {

Long3 minus(const Long3& a, const Long3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Long3 cross(const Long3& a, const Long3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
long double dot(const Long3& a, const Long3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct LongRule {
  std::vector<long double> x, w;
};

// Gauss–Legendre on [0, 1] by Newton's method from Chebyshev's guess.
LongRule gauss(int n) {
  LongRule rule;
  for (int i = n; i >= 1; --i) {
    long double x = std::cos(std::numbers::pi_v<long double> * (i - 0.25L) / (n + 0.5L)), slope = 1;
    for (int step = 0; step < 8; ++step) {
      long double p0 = 1, p1 = x;
      for (int k = 1; k < n; ++k) {
        const long double p2 = ((2 * k + 1) * x * p1 - k * p0) / (k + 1);
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      x -= p1 / slope;
    }
    rule.x.push_back((1 + x) / 2);
    rule.w.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

void legendre_values(long double x, int q, long double* P) {
  P[0] = 1;
  if (q > 0) P[1] = 2 * x - 1;
  for (int a = 1; a < q; ++a) P[a + 1] = ((2 * a + 1) * (2 * x - 1) * P[a] - a * P[a - 1]) / (a + 1);
}

} // namespace

Polyhedron cube_of(const Index3& span) {
  Long3 l{}, u{};
  for (std::size_t d = 0; d < 3; ++d) {
    l[d] = static_cast<long double>(span[d]);
    u[d] = l[d] + 1;
  }
  return {{{l[0], l[1], l[2]}, {l[0], l[1], u[2]}, {l[0], u[1], u[2]}, {l[0], u[1], l[2]}},
          {{u[0], l[1], l[2]}, {u[0], u[1], l[2]}, {u[0], u[1], u[2]}, {u[0], l[1], u[2]}},
          {{l[0], l[1], l[2]}, {u[0], l[1], l[2]}, {u[0], l[1], u[2]}, {l[0], l[1], u[2]}},
          {{l[0], u[1], l[2]}, {l[0], u[1], u[2]}, {u[0], u[1], u[2]}, {u[0], u[1], l[2]}},
          {{l[0], l[1], l[2]}, {l[0], u[1], l[2]}, {u[0], u[1], l[2]}, {u[0], l[1], l[2]}},
          {{l[0], l[1], u[2]}, {u[0], l[1], u[2]}, {u[0], u[1], u[2]}, {l[0], u[1], u[2]}}};
}

Polyhedron cut(const Polyhedron& solid, const HalfSpace& h) {
  Polyhedron out;
  std::vector<Long3> rim;
  for (const auto& face : solid) {
    if (std::all_of(face.begin(), face.end(), [&](const Long3& p) { return dot(h.n, p) == h.offset; })) return solid;
    std::vector<Long3> kept;
    for (std::size_t a = 0; a < face.size(); ++a) {
      const Long3 &p = face[a], &q = face[(a + 1) % face.size()];
      const long double fp = dot(h.n, p) - h.offset, fq = dot(h.n, q) - h.offset;
      if (fp <= 0) kept.push_back(p);
      if ((fp < 0 && fq > 0) || (fp > 0 && fq < 0)) {
        const long double t = fp / (fp - fq);
        Long3 x;
        for (std::size_t d = 0; d < 3; ++d) x[d] = p[d] + t * (q[d] - p[d]);
        kept.push_back(x);
        rim.push_back(x);
      } else if (fp == 0) {
        rim.push_back(p);
      }
    }
    if (kept.size() >= 3) out.push_back(kept);
  }
  if (rim.size() < 3) return out;
  // The cap: the rim's points around its middle, anticlockwise about n.
  Long3 middle{};
  for (const Long3& x : rim)
    for (std::size_t d = 0; d < 3; ++d) middle[d] += x[d] / static_cast<long double>(rim.size());
  const std::size_t thin = std::abs(h.n[0]) > std::abs(h.n[1]) ? 1 : 0;
  Long3 axis{};
  axis[thin] = 1;
  const Long3 e = cross(h.n, axis), f = cross(h.n, e);
  std::sort(rim.begin(), rim.end(), [&](const Long3& a, const Long3& b) {
    const Long3 p = minus(a, middle), q = minus(b, middle);
    return std::atan2(dot(p, f) * std::sqrt(dot(e, e)), dot(p, e) * std::sqrt(dot(f, f))) <
           std::atan2(dot(q, f) * std::sqrt(dot(e, e)), dot(q, e) * std::sqrt(dot(f, f)));
  });
  out.push_back(rim);
  return out;
}

std::vector<HalfSpace> half_spaces(const std::vector<Point3>& vertices, const std::vector<Triangle>& triangles) {
  std::vector<HalfSpace> out;
  for (const Triangle& t : triangles) {
    std::array<Long3, 3> x;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t d = 0; d < 3; ++d) x[a][d] = vertices[static_cast<std::size_t>(t[a])][d];
    Long3 n = cross(minus(x[1], x[0]), minus(x[2], x[0]));
    const long double length = std::sqrt(dot(n, n));
    for (long double& c : n) c /= length;
    // The two triangles of a rectangle have one plane; two that differ by rounding would leave splinters.
    const HalfSpace h{n, dot(n, x[0])};
    const bool known = std::any_of(out.begin(), out.end(), [&](const HalfSpace& o) {
      return dot(o.n, h.n) > 1 - 1e-12L && std::abs(o.offset - h.offset) < 1e-9L;
    });
    if (!known) out.push_back(h);
  }
  return out;
}

std::vector<long double> legendre_moments(const Polyhedron& solid, const Box3& box, const std::array<int, 3>& degree) {
  std::vector<long double> moments(static_cast<std::size_t>((degree[0] + 1) * (degree[1] + 1) * (degree[2] + 1)), 0);
  Long3 middle{};
  std::size_t count = 0;
  for (const auto& face : solid) count += face.size();
  if (count == 0) return moments;
  for (const auto& face : solid)
    for (const Long3& x : face)
      for (std::size_t d = 0; d < 3; ++d) middle[d] += x[d] / static_cast<long double>(count);
  const auto to_box = [&](const Long3& x) {
    Long3 y;
    for (std::size_t d = 0; d < 3; ++d)
      y[d] = (x[d] - static_cast<long double>(box.lower[d])) /
             (static_cast<long double>(box.upper[d]) - static_cast<long double>(box.lower[d]));
    return y;
  };
  const Long3 apex = to_box(middle);
  const LongRule g = gauss((degree[0] + degree[1] + degree[2] + 2) / 2 + 1);
  const std::size_t n = g.x.size();
  long double P[3][16];
  for (const auto& face : solid)
    for (std::size_t a = 1; a + 1 < face.size(); ++a) {
      const Long3 p = minus(to_box(face[0]), apex), q = minus(to_box(face[a]), apex),
                  r = minus(to_box(face[a + 1]), apex);
      const long double volume = dot(p, cross(q, r));
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          for (std::size_t k = 0; k < n; ++k) {
            // The cube collapsed on the tetrahedron: towards the apex, then towards p.
            const long double s = g.x[i], t = g.x[j], v = g.x[k];
            const long double w = g.w[i] * g.w[j] * g.w[k] * s * s * t * volume;
            for (std::size_t d = 0; d < 3; ++d)
              legendre_values(apex[d] + s * (p[d] + t * (q[d] - p[d] + v * (r[d] - q[d]))), degree[d], P[d]);
            std::size_t m = 0;
            for (int c = 0; c <= degree[2]; ++c)
              for (int b = 0; b <= degree[1]; ++b)
                for (int e = 0; e <= degree[0]; ++e) moments[m++] += w * P[0][e] * P[1][b] * P[2][c];
          }
    }
  return moments;
}

} // namespace iga::test
