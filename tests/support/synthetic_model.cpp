#include "tests/support/synthetic_model.hpp"

#include "format/model/bspline_basis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iga::test {

namespace {

/// The part of one span that the box fills along one direction.
struct Piece {
  std::int64_t span;
  double lower, upper;
  bool full;
};
using Pieces = std::array<std::vector<Piece>, 3>;

Pieces pieces_of(const SplineGrid& grid, const BoxCase& box) {
  Pieces pieces;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto& knots = grid.knots(static_cast<int>(d));
    for (std::int64_t e = 0; e < knots.num_spans(); ++e) {
      const double a = std::max(knots.lower(e), box.lower[d]), b = std::min(knots.upper(e), box.upper[d]);
      if (a < b) pieces[d].push_back({e, a, b, a == knots.lower(e) && b == knots.upper(e)});
    }
  }
  return pieces;
}

void add_volume(TrimmedModel& m, const Pieces& pieces) {
  m.state.assign(static_cast<std::size_t>(m.grid.num_spans()), 0);
  m.points.offsets = {0};
  std::array<std::vector<std::pair<double, double>>, 3> rule;
  for (std::size_t d = 0; d < 3; ++d) rule[d] = gauss_rule(m.grid.degree()[d] + 1);
  for (const Piece& w : pieces[2])
    for (const Piece& v : pieces[1])
      for (const Piece& u : pieces[0]) {
        const std::int64_t number = m.grid.span_number({u.span, v.span, w.span});
        const double volume = (u.upper - u.lower) * (v.upper - v.lower) * (w.upper - w.lower);
        m.state[static_cast<std::size_t>(number)] =
            static_cast<std::uint8_t>(u.full && v.full && w.full ? SpanState::Interior : SpanState::Trimmed);
        m.cells.span.push_back(number);
        m.cells.state.push_back(m.state[static_cast<std::size_t>(number)]);
        m.cells.volume_fraction.push_back(u.full && v.full && w.full ? 1 : volume / m.grid.span_volume());
        for (const auto& [c, wc] : rule[2])
          for (const auto& [b, wb] : rule[1])
            for (const auto& [a, wa] : rule[0]) {
              const double x[]{u.lower + a * (u.upper - u.lower), v.lower + b * (v.upper - v.lower),
                               w.lower + c * (w.upper - w.lower)};
              m.points.parameters.insert(m.points.parameters.end(), x, x + 3);
              m.points.weights.push_back(wa * wb * wc * volume);
            }
        m.points.offsets.push_back(static_cast<std::int64_t>(m.points.weights.size()));
      }
  m.points.residual.assign(m.cells.span.size(), 0);
}

void add_cells(TrimmedModel& m) {
  const auto p = m.grid.degree();
  const auto find = [](const std::vector<std::int64_t>& sorted, std::int64_t number) {
    const auto it = std::lower_bound(sorted.begin(), sorted.end(), number);
    return it != sorted.end() && *it == number ? static_cast<std::int32_t>(it - sorted.begin()) : -1;
  };
  m.cells.functions.clear();
  m.links.cells.clear();
  for (std::size_t c = 0; c < m.num_cells(); ++c) {
    const Index3 e = m.grid.span_index(m.cells.span[c]);
    for (std::int64_t w = 0; w <= p[2]; ++w)
      for (std::int64_t v = 0; v <= p[1]; ++v)
        for (std::int64_t u = 0; u <= p[0]; ++u)
          m.cells.functions.push_back(find(m.functions.number, m.grid.function_number({e[0] + u, e[1] + v, e[2] + w})));
    for (std::size_t d = 0; d < 3; ++d) {
      Index3 next = e;
      if (++next[d] == m.grid.spans()[d]) continue;
      const std::int32_t other = find(m.cells.span, m.grid.span_number(next));
      if (other >= 0) m.links.cells.insert(m.links.cells.end(), {static_cast<std::int32_t>(c), other});
    }
  }
}

void add_functions(TrimmedModel& m) {
  std::vector<double> mass(static_cast<std::size_t>(m.grid.num_functions()), 0), whole = mass;
  const auto p = m.grid.degree();
  std::array<std::array<double, max_degree + 1>, 3> N{};
  const auto scatter = [&](const Index3& e, double factor, std::vector<double>& sums) {
    for (std::int64_t c = 0; c <= p[2]; ++c)
      for (std::int64_t b = 0; b <= p[1]; ++b)
        for (std::int64_t a = 0; a <= p[0]; ++a)
          sums[static_cast<std::size_t>(m.grid.function_number({e[0] + a, e[1] + b, e[2] + c}))] +=
              factor * N[0][static_cast<std::size_t>(a)] * N[1][static_cast<std::size_t>(b)] *
              N[2][static_cast<std::size_t>(c)];
  };
  for (std::size_t a = 0; a < m.cells.span.size(); ++a) {
    const Index3 e = m.grid.span_index(m.cells.span[a]);
    for (auto q = m.points.offsets[a]; q < m.points.offsets[a + 1]; ++q) {
      for (std::size_t d = 0; d < 3; ++d)
        evaluate_basis(m.grid.knots(static_cast<int>(d)), e[d],
                       m.points.parameters[3 * static_cast<std::size_t>(q) + d],
                       std::span(N[d]).first(static_cast<std::size_t>(p[d] + 1)));
      scatter(e, m.points.weights[static_cast<std::size_t>(q)], mass);
    }
  }
  for (std::int64_t number = 0; number < m.grid.num_spans(); ++number) {
    const Index3 e = m.grid.span_index(number);
    for (std::size_t d = 0; d < 3; ++d)
      integrate_basis(m.grid.knots(static_cast<int>(d)), e[d],
                      std::span(N[d]).first(static_cast<std::size_t>(p[d] + 1)));
    scatter(e, 1, whole);
  }
  for (std::size_t i = 0; i < mass.size(); ++i)
    if (mass[i] > 0) {
      m.functions.number.push_back(static_cast<std::int64_t>(i));
      m.functions.mass_fraction.push_back(mass[i] / whole[i]);
    }
  add_cells(m);
}

// Face 2 d + side of the box lies at lower[d] (side 0) or upper[d] (side 1); its triangles are split along the diagonal
// from its low to its high corner.
void add_surface(TrimmedModel& m, const BoxCase& box, const Pieces& pieces) {
  auto& s = m.surface;
  for (int corner = 0; corner < 8; ++corner) {
    Point3 u{};
    Index3 owner{};
    for (std::size_t d = 0; d < 3; ++d) {
      const bool high = (corner >> d) & 1;
      u[d] = high ? box.upper[d] : box.lower[d];
      owner[d] = high ? pieces[d].back().span : pieces[d].front().span;
    }
    s.mesh.vertices.push_back(m.grid.to_position(u));
    s.vertex_parameters.insert(s.vertex_parameters.end(), u.begin(), u.end());
    s.vertex_cell.push_back(static_cast<std::int64_t>(m.cells_of(m.grid.span_number(owner)).first));
  }
  const char* names[]{"u-", "u+", "v-", "v+", "w-", "w+"};
  struct FacePoint {
    std::int64_t span;
    Point3 u, n;
    double area;
    std::int32_t triangle;
  };
  std::vector<FacePoint> points;
  for (std::size_t face = 0; face < 6; ++face) {
    const std::size_t d = face / 2, e = (d + 1) % 3, f = (d + 2) % 3;
    const bool high = face % 2 == 1;
    const auto corner = [&](bool on_e, bool on_f) {
      return static_cast<std::int32_t>((high << d) | (on_e << e) | (on_f << f));
    };
    Triangle low{corner(0, 0), corner(1, 0), corner(1, 1)}, up{corner(0, 0), corner(1, 1), corner(0, 1)};
    if (!high) {
      std::swap(low[1], low[2]);
      std::swap(up[1], up[2]);
    }
    s.mesh.triangles.push_back(low);
    s.mesh.triangles.push_back(up);
    s.mesh.region.insert(s.mesh.region.end(), 2, static_cast<std::int32_t>(face));
    s.mesh.region_names.push_back(names[face]);
    Point3 normal{};
    for (std::size_t r = 0; r < 3; ++r) normal[r] = m.grid.rotation()[r][d] * (high ? 1 : -1);
    const Piece& depth = high ? pieces[d].back() : pieces[d].front();
    for (const Piece& pe : pieces[e])
      for (const Piece& pf : pieces[f])
        for (const auto& [b, wb] : gauss_rule(m.grid.degree()[f] + 1))
          for (const auto& [a, wa] : gauss_rule(m.grid.degree()[e] + 1)) {
            FacePoint point{0, {}, normal, wa * wb * (pe.upper - pe.lower) * (pf.upper - pf.lower), 0};
            point.u[d] = high ? box.upper[d] : box.lower[d];
            point.u[e] = pe.lower + a * (pe.upper - pe.lower);
            point.u[f] = pf.lower + b * (pf.upper - pf.lower);
            Index3 span{};
            span[d] = depth.span;
            span[e] = pe.span;
            span[f] = pf.span;
            point.span = m.grid.span_number(span);
            const double along_e = (point.u[e] - box.lower[e]) / (box.upper[e] - box.lower[e]);
            const double along_f = (point.u[f] - box.lower[f]) / (box.upper[f] - box.lower[f]);
            point.triangle = static_cast<std::int32_t>(2 * face + (along_f > along_e ? 1 : 0));
            points.push_back(point);
          }
  }
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.span < b.span; });
  auto& q = s.quadrature;
  q.offsets = {0};
  std::size_t next = 0;
  for (const std::int64_t span : m.cells.span) {
    for (; next < points.size() && points[next].span == span; ++next) {
      q.parameters.insert(q.parameters.end(), points[next].u.begin(), points[next].u.end());
      q.normals.insert(q.normals.end(), points[next].n.begin(), points[next].n.end());
      q.weights.push_back(points[next].area);
      q.triangle.push_back(points[next].triangle);
    }
    q.offsets.push_back(static_cast<std::int64_t>(q.weights.size()));
  }
}

} // namespace

void make_cells(TrimmedModel& model) {
  add_cells(model);
}

std::vector<std::pair<double, double>> gauss_rule(int n) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double before = 1, now = x; // Legendre polynomials by their three-term recurrence
      for (int k = 2; k <= n; ++k) before = std::exchange(now, ((2 * k - 1) * x * now - (k - 1) * before) / k);
      slope = n * (before - x * now) / (1 - x * x);
      x -= now / slope;
    }
    rule.emplace_back(0.5 * (1 - x), 1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

Rotation some_rotation(double angle) {
  const Point3 k{1.0 / 3, 2.0 / 3, 2.0 / 3}; // Rodrigues' formula
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{c + k[0] * k[0] * (1 - c), k[0] * k[1] * (1 - c) - k[2] * s, k[0] * k[2] * (1 - c) + k[1] * s},
           {k[1] * k[0] * (1 - c) + k[2] * s, c + k[1] * k[1] * (1 - c), k[1] * k[2] * (1 - c) - k[0] * s},
           {k[2] * k[0] * (1 - c) - k[1] * s, k[2] * k[1] * (1 - c) + k[0] * s, c + k[2] * k[2] * (1 - c)}}};
}

TrimmedModel make_box_model(const BoxCase& box) {
  TrimmedModel m;
  m.title = "a box";
  m.length_unit = "mm";
  m.grid = SplineGrid(box.A, box.B, box.spans, box.degree, box.rotation);
  m.quadrature.moment_degree = box.degree;
  m.quadrature.part_volume =
      (box.upper[0] - box.lower[0]) * (box.upper[1] - box.lower[1]) * (box.upper[2] - box.lower[2]);
  const Pieces pieces = pieces_of(m.grid, box);
  add_volume(m, pieces);
  add_functions(m);
  add_surface(m, box, pieces);
  m.surface.bodies = 1;
  m.provenance.version = "0.0";
  m.provenance.command_line = "igaprep box.stl -o box.h5";
  m.provenance.inputs = {{"box.stl", std::string(64, 'a')}, {"größe µ.stl", std::string(64, 'b')}};
  m.provenance.settings_sha256 = std::string(64, 'c');
  m.provenance.created = "2020-01-01T00:00:00Z";
  m.provenance.timings = {{"read", 0.25}, {"trim", 1.5}};
  m.provenance.findings = {"12 duplicate vertices were welded"};
  m.provenance.warnings = {"a wall is thinner than a span"};
  return m;
}

void add_places(TrimmedModel& m) {
  m.curves.names = {"edge 1", "rim größe"};
  m.curves.offsets = {0, 3, 7};
  m.curves.points = {{1.25, 1.5, 1}, {4.25, 1.5, 1}, {4.25, 3.5, 1}, {1, 1, 1}, {4, 1, 1}, {4, 5, 1}, {1, 1, 1}};
  m.markers.names = {"vertex 1", "vertex 2"};
  m.markers.positions = {{1.25, 1.5, 1}, {1.5, 2.5, 3.5}};
}

BoxCase very_fine_case() {
  return {{0, 0, 0},          {1'900'000, 2, 2}, {1'900'000, 2, 2}, {1, 1, 1},
          some_rotation(0.4), {7.25, 0.5, 0.5},  {11.5, 1.5, 1.25}};
}

TrimmedModel make_large_model(std::int64_t n) {
  const double size = static_cast<double>(n + 4);
  BoxCase box{{0, 0, 0}, {size, size, size}, {n + 4, n + 4, n + 4}, {2, 2, 2}, identity_rotation, {2, 2, 2}, {}};
  box.upper = {size - 2, size - 2, size - 2};
  return make_box_model(box);
}

} // namespace iga::test
