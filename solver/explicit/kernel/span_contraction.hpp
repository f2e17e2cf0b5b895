// From coefficients to displacement gradients at points and back: the tensor-product contractions of the kernel.
//
// One span's functions are numbered l = ((k W_v + j) W_u + i) 3 + c: coefficient c of function (i, j, k), W = p + 1.
// Forward, H_cd = Σ_ijk u_ijk,c ∂N_ijk/∂u_d is summed direction by direction; back, f_ijk,c = Σ_q Σ_d P_cd ∂N_ijk/∂u_d
// is the transpose of the same steps.
#pragma once

#include "solver/explicit/kernel/mean_volume.hpp"
#include "solver/explicit/kernel/span_plan.hpp"
#include "solver/explicit/simd/wide.hpp"

namespace iga::solve {

/// Degrees known to the compiler, which unrolls all loops over functions.
template <int p> struct EqualDegrees {
  explicit EqualDegrees(const std::array<int, 3>&) {}
  static constexpr int u = p, v = p, w = p, most = p;
};
/// Any degrees per direction.
struct AnyDegrees {
  explicit AnyDegrees(const std::array<int, 3>& p) : u(p[0]), v(p[1]), w(p[2]) {}
  int u, v, w;
  static constexpr int most = max_degree;
};

/// Coefficients and forces of eight spans or of one span, and what lies between.
template <class Degrees> struct ContractionWork {
  static constexpr int width = Degrees::most + 1;
  static constexpr int num_coefficients = 3 * width * width * width;
  static constexpr int padded = (num_coefficients + 7) / 8 * 8;
  Wide u[padded] = {}, f[padded] = {}; ///< of eight spans; beyond the coefficients nothing that counts
  Wide value[3 * width * width], slope[3 * width * width]; ///< contracted along w
  Wide f_value[3 * width * width], f_slope[3 * width * width];
  Wide row[3][3 * width]; ///< contracted along w and v; by the direction of the derivative
  TensorWide points[max_row_points];
  /// Functions at the places of the tensor worked on last, and their derivatives: [direction][place · (p + 1) +
  /// function]
  Wide values[3][max_row_points * width], slopes[3][max_row_points * width];
  std::int32_t tensor = -1;
  MeanVolumeLanes means; ///< with F-bar
  alignas(64) double scratch[lanes * padded] = {};
};

/// Horner's scheme at eight points for all functions of one direction.
template <int most>
[[gnu::always_inline]] inline void evaluate_polynomials(const SpanPolynomials& polynomials, int p, const Wide& t,
                                                        Wide (&values)[most + 1], Wide (&slopes)[most + 1]) {
  for (int a = 0; a <= p; ++a) {
    Wide value = t * polynomials.value[a][p] + polynomials.value[a][p - 1];
    Wide slope = wide(polynomials.slope[a][p - 1]);
    for (int k = p - 2; k >= 0; --k) {
      value = t * value + polynomials.value[a][k];
      slope = t * slope + polynomials.slope[a][k];
    }
    values[a] = value;
    slopes[a] = slope;
  }
}

/// Evaluates the functions at the places of a tensor, unless it is the one that work holds already.
template <class Degrees>
[[gnu::always_inline]] inline void evaluate_tensor(const Degrees p, const SpanPolynomials* const (&polynomials)[3],
                                                   const LaneTensor& tensor, std::int32_t number,
                                                   ContractionWork<Degrees>& work) {
  if (work.tensor == number) return;
  work.tensor = number;
  const int degree[3] = {p.u, p.v, p.w};
  for (int d = 0; d < 3; ++d)
    for (int q = 0; q < tensor.count[static_cast<std::size_t>(d)]; ++q) {
      Wide values[Degrees::most + 1], slopes[Degrees::most + 1];
      evaluate_polynomials<Degrees::most>(*polynomials[d], degree[d],
                                          wide(tensor.t[static_cast<std::size_t>(d)][static_cast<std::size_t>(q)]),
                                          values, slopes);
      for (int a = 0; a <= degree[d]; ++a) {
        work.values[d][q * (degree[d] + 1) + a] = values[a];
        work.slopes[d][q * (degree[d] + 1) + a] = slopes[a];
      }
    }
}

/// Gradients alone: `visit` keeps what it wants of H, nothing comes back. Forces alone: `visit` fills H with stresses.
enum class Sweep { Both, Gradients, Forces };

/// @param visit  visit(first, count, H): gives the stresses of points first … first + count of the tensor, times their
///               weights, for the gradients H[0 … count), in their place
/// Reads work.u, overwrites work.f.
template <Sweep sweep = Sweep::Both, class Degrees, class Visit>
[[gnu::always_inline]] inline void contract_tensor(const Degrees p, const std::array<int, 3>& count,
                                                   ContractionWork<Degrees>& work, Visit&& visit) {
  const int wu = p.u + 1, wv = p.v + 1, ww = p.w + 1, line = 3 * wu, plane = line * wv;
  const int nu = count[0], nv = count[1], nw = count[2];
  const Wide *Nu = work.values[0], *Nv = work.values[1], *Nw = work.values[2];
  const Wide *Du = work.slopes[0], *Dv = work.slopes[1], *Dw = work.slopes[2];
  for (int qw = 0; qw < nw; ++qw) {
    const Wide *N = Nw + qw * ww, *D = Dw + qw * ww;
    for (int m = 0; sweep != Sweep::Forces && m < plane; ++m) {
      Wide value = N[0] * work.u[m], slope = D[0] * work.u[m];
      for (int k = 1; k < ww; ++k) {
        value += N[k] * work.u[k * plane + m];
        slope += D[k] * work.u[k * plane + m];
      }
      work.value[m] = value;
      work.slope[m] = slope;
    }
    for (int qv = 0; qv < nv; ++qv) {
      const Wide *M = Nv + qv * wv, *E = Dv + qv * wv;
      for (int m = 0; sweep != Sweep::Forces && m < line; ++m) {
        Wide along_u = M[0] * work.value[m], along_v = E[0] * work.value[m], along_w = M[0] * work.slope[m];
        for (int j = 1; j < wv; ++j) {
          along_u += M[j] * work.value[j * line + m];
          along_v += E[j] * work.value[j * line + m];
          along_w += M[j] * work.slope[j * line + m];
        }
        work.row[0][m] = along_u;
        work.row[1][m] = along_v;
        work.row[2][m] = along_w;
      }
      for (int qu = 0; sweep != Sweep::Forces && qu < nu; ++qu) {
        const Wide *L = Nu + qu * wu, *C = Du + qu * wu;
        TensorWide& H = work.points[qu];
        for (int c = 0; c < 3; ++c) {
          Wide x = C[0] * work.row[0][c], y = L[0] * work.row[1][c], z = L[0] * work.row[2][c];
          for (int i = 1; i < wu; ++i) {
            x += C[i] * work.row[0][3 * i + c];
            y += L[i] * work.row[1][3 * i + c];
            z += L[i] * work.row[2][3 * i + c];
          }
          H(c, 0) = x;
          H(c, 1) = y;
          H(c, 2) = z;
        }
      }
      visit((qw * nv + qv) * nu, nu, work.points);
      if constexpr (sweep == Sweep::Gradients) continue;
      for (int i = 0; i < wu; ++i)
        for (int c = 0; c < 3; ++c) {
          Wide x{}, y{}, z{};
          for (int qu = 0; qu < nu; ++qu) {
            const Wide L = Nu[qu * wu + i], C = Du[qu * wu + i];
            const TensorWide& P = work.points[qu];
            x += C * P(c, 0);
            y += L * P(c, 1);
            z += L * P(c, 2);
          }
          const int m = 3 * i + c;
          if (qv == 0) {
            for (int j = 0; j < wv; ++j) {
              work.f_value[j * line + m] = M[j] * x + E[j] * y;
              work.f_slope[j * line + m] = M[j] * z;
            }
          } else {
            for (int j = 0; j < wv; ++j) {
              work.f_value[j * line + m] += M[j] * x + E[j] * y;
              work.f_slope[j * line + m] += M[j] * z;
            }
          }
        }
    }
    for (int k = 0; sweep != Sweep::Gradients && k < ww; ++k)
      for (int m = 0; m < plane; ++m) {
        const Wide share = N[k] * work.f_value[m] + D[k] * work.f_slope[m];
        work.f[k * plane + m] = qw == 0 ? share : work.f[k * plane + m] + share;
      }
  }
}

/// The same point by point, eight at a time. Of one span: `u` are its coefficients (double), work.f is overwritten with
/// eight shares of its forces, to be summed. One of each of eight spans: `u` (Wide) and work.f hold theirs, lane by
/// lane.
/// @param visit  visit(block, points, H): stresses times weights of that block of points in the place of H
template <Sweep sweep = Sweep::Both, class Degrees, class Coefficient, class Visit>
[[gnu::always_inline]] inline void contract_points(const Degrees p, const SpanPolynomials* const (&polynomials)[3],
                                                   std::span<const OwnPoints> blocks, const Coefficient* u,
                                                   ContractionWork<Degrees>& work, Visit&& visit) {
  constexpr int most = Degrees::most;
  const int wu = p.u + 1, wv = p.v + 1, ww = p.w + 1, line = 3 * wu;
  Wide Nu[most + 1], Du[most + 1], Nv[most + 1], Dv[most + 1], Nw[most + 1], Dw[most + 1];
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    evaluate_polynomials<most>(*polynomials[0], p.u, wide(blocks[b].t[0]), Nu, Du);
    evaluate_polynomials<most>(*polynomials[1], p.v, wide(blocks[b].t[1]), Nv, Dv);
    evaluate_polynomials<most>(*polynomials[2], p.w, wide(blocks[b].t[2]), Nw, Dw);
    TensorWide H{};
    for (int k = 0; sweep != Sweep::Forces && k < ww; ++k)
      for (int c = 0; c < 3; ++c) {
        Wide along_u{}, along_v{}, along_w{};
        for (int j = 0; j < wv; ++j) {
          const Coefficient* x = u + (k * wv + j) * line + c;
          Wide value = Nu[0] * x[0], slope = Du[0] * x[0];
          for (int i = 1; i < wu; ++i) {
            value += Nu[i] * x[3 * i];
            slope += Du[i] * x[3 * i];
          }
          along_u += Nv[j] * slope;
          along_v += Dv[j] * value;
          along_w += Nv[j] * value;
        }
        H(c, 0) += Nw[k] * along_u;
        H(c, 1) += Nw[k] * along_v;
        H(c, 2) += Dw[k] * along_w;
      }
    visit(static_cast<std::int64_t>(b), blocks[b], H);
    for (int k = 0; sweep != Sweep::Gradients && k < ww; ++k)
      for (int c = 0; c < 3; ++c) {
        const Wide x = Nw[k] * H(c, 0), y = Nw[k] * H(c, 1), z = Dw[k] * H(c, 2);
        for (int j = 0; j < wv; ++j) {
          const Wide value = Dv[j] * y + Nv[j] * z, slope = Nv[j] * x;
          Wide* f = work.f + (k * wv + j) * line + c;
          if (b == 0) {
            for (int i = 0; i < wu; ++i) f[3 * i] = Nu[i] * value + Du[i] * slope;
          } else {
            for (int i = 0; i < wu; ++i) f[3 * i] += Nu[i] * value + Du[i] * slope;
          }
        }
      }
  }
}

} // namespace iga::solve
