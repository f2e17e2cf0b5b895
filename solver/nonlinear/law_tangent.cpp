#include "solver/nonlinear/law_tangent.hpp"

#include "solver/explicit/simd/wide.hpp"

#include <cmath>
#include <type_traits>
#include <vector>

namespace iga::solve {

namespace {

// Central differences with this step in F have errors of about 1e-10 of the stiffness, by rounding and by curvature.
constexpr double difference = 6e-6;

constexpr std::size_t place(int a, int A, int b, int B) {
  return static_cast<std::size_t>(9 * (3 * a + A) + 3 * b + B);
}

// ∂ cof F_{aA} / ∂F_{bB} = ε_abc ε_ABC F_cC: zero for a = b or A = B.
double cofactor_derivative(const double (&F)[3][3], int a, int A, int b, int B) {
  if (a == b || A == B) return 0;
  const int c = 3 - a - b, C = 3 - A - B;
  const bool even = ((b - a + 3) % 3 == 1) == ((B - A + 3) % 3 == 1);
  return even ? F[c][C] : -F[c][C];
}

void neo_hookean(const double (&F)[3][3], double lambda, double mu, double* A) {
  double cof[3][3];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
      cof[a][b] = F[a1][b1] * F[a2][b2] - F[a1][b2] * F[a2][b1];
    }
  const double J = F[0][0] * cof[0][0] + F[0][1] * cof[0][1] + F[0][2] * cof[0][2], log_J = std::log(J);
  const double p = (lambda * log_J - mu) / J, dp = (lambda + mu - lambda * log_J) / (J * J);
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i)
      for (int b = 0; b < 3; ++b)
        for (int j = 0; j < 3; ++j)
          A[place(a, i, b, j)] =
              (a == b && i == j ? mu : 0) + dp * cof[a][i] * cof[b][j] + p * cofactor_derivative(F, a, i, b, j);
}

// P = F S: A = S δ_ab + F (∂S/∂E) Fᵀ.
void st_venant_kirchhoff(const double (&F)[3][3], double lambda, double mu, double* A) {
  double E[3][3], left[3][3], trace = 0; // Green's strain, F Fᵀ
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      E[i][j] = 0.5 * (F[0][i] * F[0][j] + F[1][i] * F[1][j] + F[2][i] * F[2][j] - (i == j ? 1 : 0));
      left[i][j] = F[i][0] * F[j][0] + F[i][1] * F[j][1] + F[i][2] * F[j][2];
    }
  for (int i = 0; i < 3; ++i) trace += E[i][i];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i)
      for (int b = 0; b < 3; ++b)
        for (int j = 0; j < 3; ++j) {
          const double stress = 2 * mu * E[i][j] + (i == j ? lambda * trace : 0);
          A[place(a, i, b, j)] =
              (a == b ? stress : 0) + lambda * F[a][i] * F[b][j] + mu * (F[a][j] * F[b][i] + (i == j ? left[a][b] : 0));
        }
}

} // namespace

StaticLaw::StaticLaw(const Law& law, double length) : length_(length) {
  std::visit(
      [this](const auto& own) {
        using Own = std::decay_t<decltype(own)>;
        access_ = access(own);
        if constexpr (std::is_same_v<Own, LinearElastic>) {
          form_ = Form::Linear;
          const auto& C = own.small_strain().C;
          for (int a = 0; a < 3; ++a)
            for (int i = 0; i < 3; ++i)
              for (int b = 0; b < 3; ++b)
                for (int j = 0; j < 3; ++j) linear_[place(a, i, b, j)] = C(voigt_place[a][i], voigt_place[b][j]);
        } else if constexpr (std::is_same_v<Own, StVenantKirchhoff> || std::is_same_v<Own, NeoHookean>) {
          form_ = std::is_same_v<Own, NeoHookean> ? Form::NeoHookean : Form::StVenantKirchhoff;
          lambda_ = own.lambda;
          mu_ = own.mu;
        }
      },
      law);
}

LaneMask StaticLaw::stress(const TensorLanes& F, const TensorLanes& F_old, Lanes* h, TensorLanes& P, Lanes& J) const {
  LawInput in{F, F_old, 0, length_};
  LawOutput out;
  access_.stress(access_.law.get(), in, h, P, out);
  J = out.J;
  return out.inverted;
}

void StaticLaw::tangent(const TensorLanes& F, const TensorLanes& F_old, const Lanes* h, TangentLanes& A) const {
  if (form_ == Form::Linear) {
    for (std::size_t k = 0; k < 81; ++k) A.c[k] = Lanes{} + linear_[k];
    return;
  }
  if (form_ == Form::Differences) return differences(F, F_old, h, A);
  TensorLanes P;
  LawOutput out;
  access_.stress(access_.law.get(), {F, F_old, 0, length_}, nullptr, P, out);
  if (any_lane(out.inverted)) return differences(F, F_old, h, A); // what resists crushing is added there
  for (std::size_t l = 0; l < lanes; ++l) {
    double own[3][3], tangent[81];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) own[a][b] = F(a, b)[l];
    if (form_ == Form::NeoHookean)
      neo_hookean(own, lambda_, mu_, tangent);
    else
      st_venant_kirchhoff(own, lambda_, mu_, tangent);
    for (std::size_t k = 0; k < 81; ++k) A.c[k][l] = tangent[k];
  }
}

void StaticLaw::differences(const TensorLanes& F, const TensorLanes& F_old, const Lanes* h, TangentLanes& A) const {
  std::vector<Lanes> history(static_cast<std::size_t>(access_.history) + 1);
  const auto stress_at = [&](const TensorLanes& at, TensorLanes& P) {
    for (std::size_t k = 0; k + 1 < history.size(); ++k) history[k] = h[k];
    LawOutput out;
    access_.stress(access_.law.get(), {at, F_old, 0, length_}, history.data(), P, out);
  };
  for (std::size_t k = 0; k < 9; ++k) {
    TensorLanes moved = F, above, below;
    moved.c[k] = F.c[k] + difference;
    stress_at(moved, above);
    moved.c[k] = F.c[k] - difference;
    stress_at(moved, below);
    for (std::size_t i = 0; i < 9; ++i) A.c[9 * i + k] = (above.c[i] - below.c[i]) * (0.5 / difference);
  }
}

} // namespace iga::solve
