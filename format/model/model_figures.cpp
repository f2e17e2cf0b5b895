// Figures of a sound model, with the bounds of check(TrimmedModel).
#include "format/model/model_figures.hpp"

#include "format/model/bspline_basis.hpp"
#include "format/model/model_check.hpp"
#include "format/model/vec3.hpp"

#include <algorithm>
#include <numeric>

namespace iga {

namespace {

using detail::Sum;

constexpr double unity_tolerance = 1e-12; // sums of at most 125 products of rounded numbers

double relative(double found, double expected) {
  return std::abs(found - expected) / std::abs(expected);
}

Point3 row_of(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

struct PointFigures {
  double beyond = 0;     // of the farthest point outside its span, in spans
  double from_unity = 0; // of the sum of the functions
  double cell_volume = 0, interior_volume = 0;
  Sum total;
};

PointFigures measure_points(const TrimmedModel& m) {
  PointFigures f;
  std::array<std::vector<double>, 3> values;
  for (std::size_t d = 0; d < 3; ++d) values[d].resize(static_cast<std::size_t>(m.grid.degree()[d]) + 1);
  Sum interior;
  std::int64_t num_interior = 0;
  const double span_volume = m.grid.span_volume();
  for (std::size_t c = 0; c < m.num_cells(); ++c) {
    const Index3 span = m.grid.span_index(m.cells.span[c]);
    Sum own;
    for (auto q = static_cast<std::size_t>(m.points.offsets[c]); q < static_cast<std::size_t>(m.points.offsets[c + 1]);
         ++q) {
      double product = 1;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto& knots = m.grid.knots(static_cast<int>(d));
        const double u = m.points.parameters[3 * q + d];
        const double beyond = std::max(knots.lower(span[d]) - u, u - knots.upper(span[d]));
        f.beyond = std::max(f.beyond, beyond / m.grid.span_size()[d]);
        evaluate_basis(knots, span[d], u, values[d]);
        product *= std::accumulate(values[d].begin(), values[d].end(), 0.0);
      }
      f.from_unity = std::max(f.from_unity, std::abs(product - 1));
      own.add(m.points.weights[q]);
    }
    f.total.add(own.value());
    if (m.is_interior(c)) {
      ++num_interior;
      interior.add(own.value());
    } else {
      f.cell_volume = std::max(f.cell_volume, std::abs(own.value() / span_volume - m.cells.volume_fraction[c]));
    }
  }
  if (num_interior > 0) f.interior_volume = relative(interior.value(), static_cast<double>(num_interior) * span_volume);
  return f;
}

// Powers of the three coordinates in a box, -1 … 1 each, at a point.
class BoxPowers {
 public:
  explicit BoxPowers(const TrimmedModel& m) : lower_{1e300, 1e300, 1e300}, upper_{-1e300, -1e300, -1e300} {
    for (const std::int64_t number : m.cells.span) {
      const Index3 span = m.grid.span_index(number);
      for (std::size_t d = 0; d < 3; ++d) {
        lower_[d] = std::min(lower_[d], m.grid.knots(static_cast<int>(d)).lower(span[d]));
        upper_[d] = std::max(upper_[d], m.grid.knots(static_cast<int>(d)).upper(span[d]));
      }
    }
    for (std::size_t d = 0; d < 3; ++d) degree_[d] = std::min(m.grid.degree()[d], m.quadrature.moment_degree[d]);
  }
  std::size_t count() const { return static_cast<std::size_t>((degree_[0] + 1) * (degree_[1] + 1) * (degree_[2] + 1)); }
  /// Largest slope of the antiderivatives.
  double slope() const {
    double sum = 1;
    for (std::size_t d = 0; d < 3; ++d) sum += degree_[d] * (upper_[0] - lower_[0]) / (upper_[d] - lower_[d]);
    return sum;
  }
  /// visit(number, value); along u the antiderivative instead where asked for
  template <class Visit> void at(const Point3& u, bool antiderivative, Visit&& visit) {
    const double half = (upper_[0] - lower_[0]) / 2;
    for (std::size_t d = 0; d < 3; ++d) {
      const double s = (u[d] - (lower_[d] + upper_[d]) / 2) / ((upper_[d] - lower_[d]) / 2);
      powers_[d][0] = 1;
      for (std::size_t a = 1; a < powers_[d].size(); ++a) powers_[d][a] = powers_[d][a - 1] * s;
    }
    std::size_t number = 0;
    for (int c = 0; c <= degree_[2]; ++c)
      for (int b = 0; b <= degree_[1]; ++b)
        for (int a = 0; a <= degree_[0]; ++a) {
          const auto i = static_cast<std::size_t>(a);
          const double along = antiderivative ? half * powers_[0][i + 1] / (a + 1) : powers_[0][i];
          visit(number++, along * powers_[1][static_cast<std::size_t>(b)] * powers_[2][static_cast<std::size_t>(c)]);
        }
  }

 private:
  Point3 lower_, upper_;
  std::array<int, 3> degree_{};
  std::array<std::array<double, max_degree + 2>, 3> powers_{};
};

// Largest difference of a moment by the two ways, over the volume.
double moment_difference(const TrimmedModel& m, BoxPowers powers, double volume) {
  std::vector<Sum> inside(powers.count()), around(powers.count());
  for (std::size_t q = 0; q < m.points.weights.size(); ++q)
    powers.at(row_of(m.points.parameters, q), false,
              [&](std::size_t k, double value) { inside[k].add(m.points.weights[q] * value); });
  const auto& surface = m.surface.quadrature;
  const auto& R = m.grid.rotation();
  for (std::size_t q = 0; q < surface.weights.size(); ++q) {
    const Point3 n = row_of(surface.normals, q);
    const double along_u = R[0][0] * n[0] + R[1][0] * n[1] + R[2][0] * n[2];
    powers.at(row_of(surface.parameters, q), true,
              [&](std::size_t k, double value) { around[k].add(surface.weights[q] * along_u * value); });
  }
  double worst = 0;
  for (std::size_t k = 0; k < inside.size(); ++k)
    worst = std::max(worst, std::abs(inside[k].value() - around[k].value()) / volume);
  return worst;
}

// Between the surface and the points that were clamped to their spans: they leave their triangles.
double clamped_volume(const TrimmedModel& m) {
  const auto& q = m.surface.quadrature;
  Sum volume;
  for (std::size_t i = 0; i < q.weights.size(); ++i)
    volume.add(q.weights[i] * distance_to_triangle(m.surface.mesh, static_cast<std::size_t>(q.triangle[i]),
                                                   m.grid.to_position(row_of(q.parameters, i))));
  return volume.value();
}

// Bound on what snapping has moved (a layer of the sliver depth along six faces of a span), and what was dropped.
double left_out_volume(const TrimmedModel& m) {
  const auto& info = m.quadrature;
  return 6 * info.sliver_tolerance * m.grid.span_volume() * static_cast<double>(info.snapped_spans) +
         info.dropped_volume;
}

void measure_surface(const TrimmedModel& m, double volume, std::vector<CheckFigure>& figures) {
  const auto& q = m.surface.quadrature;
  const auto& mesh = m.surface.mesh;
  std::vector<Sum> found(mesh.region_names.size()), expected(mesh.region_names.size());
  std::array<Sum, 3> normal;
  Sum area, enclosed;
  Point3 origin{};
  for (std::size_t d = 0; d < 3; ++d) origin[d] = (m.grid.A()[d] + m.grid.B()[d]) / 2;
  for (std::size_t i = 0; i < q.weights.size(); ++i) {
    const auto t = static_cast<std::size_t>(q.triangle[i]);
    const Point3 n = row_of(q.normals, i);
    found[static_cast<std::size_t>(mesh.region[t])].add(q.weights[i]);
    area.add(q.weights[i]);
    for (std::size_t d = 0; d < 3; ++d) normal[d].add(q.weights[i] * n[d]);
    enclosed.add(q.weights[i] * dot(minus(mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][0])], origin), n) /
                 3);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])]; };
    expected[static_cast<std::size_t>(mesh.region[t])].add(
        norm(cross(minus(corner(1), corner(0)), minus(corner(2), corner(0)))) / 2);
  }
  double worst = 0;
  for (std::size_t r = 0; r < found.size(); ++r)
    if (expected[r].value() > 0) worst = std::max(worst, relative(found[r].value(), expected[r].value()));
  figures.push_back({"area of a region, relative", worst, detail::integral_tolerance});
  figures.push_back({"surface closed: ∮ n dA over the area",
                     norm({normal[0].value(), normal[1].value(), normal[2].value()}) / area.value(),
                     detail::integral_tolerance});
  figures.push_back({"volume by the divergence theorem, relative", relative(enclosed.value(), m.quadrature.part_volume),
                     detail::integral_tolerance});
  if (m.quadrature.surface_rule != "exact") return; // its points are exact for areas and normals alone
  const BoxPowers powers(m);
  figures.push_back({"moments up to the degree by the divergence theorem, of the volume",
                     moment_difference(m, powers, volume),
                     detail::integral_tolerance + detail::moment_error(m.quadrature) +
                         (powers.slope() * clamped_volume(m) + left_out_volume(m)) / volume});
}

} // namespace

std::vector<CheckFigure> measure(const TrimmedModel& m) {
  const PointFigures f = measure_points(m);
  const double volume = f.total.value(), rounding = detail::volume_rounding(m.grid);
  const Point3 parameter = detail::parameter_rounding(m.grid);
  const auto& info = m.quadrature;
  Sum of_functions;
  for (std::size_t i = 0; i < m.functions.number.size(); ++i)
    of_functions.add(m.functions.mass_fraction[i] * m.grid.integral(m.grid.function_index(m.functions.number[i])));
  const auto not_positive =
      std::count_if(m.points.weights.begin(), m.points.weights.end(), [](double w) { return !(w > 0); });
  std::vector<CheckFigure> figures{
      {"points whose weight is not positive", static_cast<double>(not_positive), 0},
      {"points beyond their span, in spans", f.beyond,
       std::max({detail::inside_tolerance, parameter[0], parameter[1], parameter[2]})},
      {"sum of the functions at a point, from 1", f.from_unity, unity_tolerance},
      {"volume of a trimmed cell, of its span's", f.cell_volume, detail::moment_error(info) + rounding},
      {"volume of the interior cells, relative", f.interior_volume, rounding},
      {"volume of the part, relative", relative(volume, info.part_volume + info.snapped_volume - info.dropped_volume),
       detail::integral_tolerance},
      {"mass of the functions against the volume, relative", relative(of_functions.value(), volume),
       detail::integral_tolerance}};
  if (m.surface.accepted_leak == 0) measure_surface(m, volume, figures);
  return figures;
}

} // namespace iga
