// A model file as Bézier elements: what it says about space, cells and unknowns, and the shape functions of a cell.
#pragma once

#include <deal.II/base/polynomials_bernstein.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor_product_polynomials.h>
#include <deal.II/base/types.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/vector.h>

#include "h5_arrays.hpp"

#include <map>
#include <utility>

namespace sample {

using namespace dealii;

using Strain = SymmetricTensor<2, 3>;

inline void need(bool good, const std::string& what_to_do) {
  if (!good) throw std::invalid_argument(what_to_do);
}

/// A part of the model's arrays: points in knot space by cell, with physical weights.
struct Points {
  std::vector<std::int64_t> offsets;
  std::vector<double> parameters, weights;
  Points(const h5::File& file, const std::string& group)
      : offsets(file.read<std::int64_t>(group + "/offsets")), parameters(file.read<double>(group + "/parameters")),
        weights(file.read<double>(group + "/weights")) {}
};

/// What the file says about space, cells and unknowns.
struct Model {
  std::vector<int> degree, spans; // along u, v, w
  std::vector<double> knots[3], lower, upper, rotation;
  std::vector<std::int64_t> span, row_offsets;
  std::vector<int> functions, terms, region, triangle, triangles;
  std::vector<double> term_weights;
  std::vector<std::string> regions;
  std::vector<bool>
      whole; // cells whose own points only make sense in a run of spans (generalised rules): all of a span
  std::size_t num_functions, num_unknowns;
  Points volume, surface;

  explicit Model(const h5::File& file)
      : degree(file.attribute<int>("/patch", "degree")), spans(file.attribute<int>("/patch", "spans")),
        lower(file.attribute<double>("/patch", "A")), upper(file.attribute<double>("/patch", "B")),
        rotation(file.attribute<double>("/patch", "rotation")), span(file.read<std::int64_t>("/cells/span")),
        functions(file.read<int>("/cells/functions")), region(file.read<int>("/surface/region")),
        triangle(file.read<int>("/surface/quadrature/triangle")), triangles(file.read<int>("/surface/triangles")),
        regions(file.texts("/surface/regions")), volume(file, "/quadrature"), surface(file, "/surface/quadrature") {
    need(file.text("/", "format") == "iga-trimmed-solid" && file.text("/", "format_version")[0] == '2',
         "expected a model file of format 2.x; make it with igaprep");
    const std::string rule = file.text("/quadrature", "interior_rule");
    need(rule == "gauss" || rule == "ggq",
         "interior_rule " + rule + " integrates no stiffness exactly; use gauss or ggq");
    for (const auto cell_state : file.read<int>("/cells/state")) whole.push_back(rule == "ggq" && cell_state == 1);
    for (int d = 0; d < 3; ++d) knots[d] = file.read<double>(std::string("/patch/knots_") + "uvw"[d]);
    num_functions = num_unknowns = file.read<std::int64_t>("/functions/number").size();
    if (file.has("/unknowns")) { // a gap ends somewhere: coefficients of functions = C · unknowns
      row_offsets = file.read<std::int64_t>("/unknowns/offsets");
      terms = file.read<int>("/unknowns/terms");
      term_weights = file.read<double>("/unknowns/weights");
      num_unknowns = file.read<int>("/unknowns/function").size();
    }
  }
  /// Where the parameters u lie in space: the grid turned about the middle of its box.
  Point<3> position(const double* u) const {
    Point<3> x;
    for (int i = 0; i < 3; ++i) {
      x[i] = (lower[i] + upper[i]) / 2;
      for (int j = 0; j < 3; ++j) x[i] += rotation[3 * i + j] * (u[j] - (lower[j] + upper[j]) / 2);
    }
    return x;
  }
  int region_number(const std::string& name) const {
    const auto found = std::find(regions.begin(), regions.end(), name);
    need(found != regions.end(), "the model has no region '" + name + "'; igasolve info lists them");
    return static_cast<int>(found - regions.begin());
  }
};

/// Rows: the p + 1 B-splines of a span; columns: their Bernstein coefficients, by the B-splines' polar forms at
/// (a, …, a, b, …, b) with the span's ends a and b.
inline FullMatrix<double> extraction_1d(const std::vector<double>& knots, int p, int span) {
  FullMatrix<double> rows(p + 1, p + 1);
  for (int k = 0; k <= p; ++k) {
    std::vector<double> N{1};
    for (int q = 1; q <= p; ++q) {
      const double t = knots[span + (q <= p - k ? p : p + 1)];
      std::vector<double> next(q + 1);
      for (int r = 0; r < q; ++r) {
        const double low = knots[span + p + 1 - q + r], high = knots[span + p + 1 + r], s = (t - low) / (high - low);
        next[r] += (1 - s) * N[r];
        next[r + 1] += s * N[r];
      }
      N = next;
    }
    for (int i = 0; i <= p; ++i) rows(i, k) = N[i];
  }
  return rows;
}

/// A cell as a Bézier element.
class Element {
 public:
  Element(const Model& model, std::size_t cell, const AnisotropicPolynomials<3>& bernstein)
      : model_(model), bernstein_(bernstein) {
    FullMatrix<double> C[3];
    std::size_t number = model.span[cell];
    for (int d = 0; d < 3; ++d) {
      const int p = model.degree[d], at = static_cast<int>(number % model.spans[d]);
      number /= model.spans[d];
      C[d] = extraction_1d(model.knots[d], p, at);
      corner_[d] = model.knots[d][at + p];
      size_[d] = model.knots[d][at + p + 1] - corner_[d];
    }
    const std::size_t n = bernstein.n(), nu = C[0].m(), nv = C[1].m();
    std::map<types::global_dof_index, std::vector<double>> rows; // Bernstein coefficients of each unknown
    for (std::size_t f = 0; f < n; ++f) {
      const int function = model.functions[cell * n + f];
      const bool own = model.row_offsets.empty();
      for (std::int64_t t = own ? 0 : model.row_offsets[function]; t < (own ? 1 : model.row_offsets[function + 1]);
           ++t) {
        auto& row = rows.try_emplace(own ? function : model.terms[t], n).first->second;
        for (std::size_t b = 0; b < n; ++b)
          row[b] += (own ? 1 : model.term_weights[t]) * C[0](f % nu, b % nu) * C[1](f / nu % nv, b / nu % nv) *
                    C[2](f / (nu * nv), b / (nu * nv));
      }
    }
    for (auto& [unknown, row] : rows) {
      unknowns.push_back(unknown);
      extraction_.push_back(std::move(row));
    }
  }
  /// Points of the cell on the unit cube, with the file's weights: volumes or areas.
  Quadrature<3> quadrature(const Points& points, std::size_t cell) const {
    std::vector<Point<3>> unit;
    for (auto q = points.offsets[cell]; q < points.offsets[cell + 1]; ++q)
      unit.push_back(to_unit(&points.parameters[3 * q]));
    return {unit, {points.weights.begin() + points.offsets[cell], points.weights.begin() + points.offsets[cell + 1]}};
  }
  /// What integrates any product of shape functions: deal.II's Gauss rule where the cell's own points stand for a run.
  Quadrature<3> exact_quadrature(std::size_t cell) const {
    if (!model_.whole[cell]) return quadrature(model_.volume, cell);
    const auto& p = model_.degree;
    const QAnisotropic<3> gauss(QGauss<1>(p[0] + 1), QGauss<1>(p[1] + 1), QGauss<1>(p[2] + 1));
    std::vector<double> weights = gauss.get_weights();
    for (auto& weight : weights) weight *= size_[0] * size_[1] * size_[2];
    return {gauss.get_points(), weights};
  }
  Point<3> to_unit(const double* u) const {
    return {(u[0] - corner_[0]) / size_[0], (u[1] - corner_[1]) / size_[1], (u[2] - corner_[2]) / size_[2]};
  }
  /// Values and gradients in space of the unknowns' shape functions.
  void evaluate(const Point<3>& unit) {
    std::vector<Tensor<2, 3>> none2;
    std::vector<Tensor<3, 3>> none3;
    std::vector<Tensor<4, 3>> none4;
    std::vector<double> B(bernstein_.n());
    std::vector<Tensor<1, 3>> dB(bernstein_.n());
    bernstein_.evaluate(unit, B, dB, none2, none3, none4);
    for (auto& gradient : dB) {
      const Tensor<1, 3> g = gradient;
      for (int i = 0; i < 3; ++i) {
        gradient[i] = 0;
        for (int j = 0; j < 3; ++j) gradient[i] += model_.rotation[3 * i + j] * g[j] / size_[j];
      }
    }
    N.assign(unknowns.size(), 0);
    dN.assign(unknowns.size(), Tensor<1, 3>());
    for (std::size_t a = 0; a < unknowns.size(); ++a)
      for (std::size_t b = 0; b < B.size(); ++b) {
        N[a] += extraction_[a][b] * B[b];
        dN[a] += extraction_[a][b] * dB[b];
      }
  }
  /// Displacement and strain at the point of evaluate().
  std::pair<Tensor<1, 3>, Strain> field(const Vector<double>& u) const {
    Tensor<1, 3> value;
    Tensor<2, 3> gradient;
    for (std::size_t a = 0; a < unknowns.size(); ++a) {
      const Tensor<1, 3> c = Point<3>(u[3 * unknowns[a]], u[3 * unknowns[a] + 1], u[3 * unknowns[a] + 2]);
      value += N[a] * c;
      gradient += outer_product(c, dN[a]);
    }
    return {value, symmetrize(gradient)};
  }
  std::vector<types::global_dof_index> unknowns;
  std::vector<double> N;
  std::vector<Tensor<1, 3>> dN;

 private:
  const Model& model_;
  const AnisotropicPolynomials<3>& bernstein_;
  std::vector<std::vector<double>> extraction_; // (unknowns × Bernstein polynomials)
  Point<3> corner_;
  Tensor<1, 3> size_;
};

} // namespace sample
