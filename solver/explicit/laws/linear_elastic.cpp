#include "solver/explicit/laws/linear_elastic.hpp"

#include "solver/explicit/laws/inversion.hpp"

namespace iga::solve {

LinearElastic::LinearElastic(const ElasticMaterial& material)
    : density(material.density), material_(material), wave_speed_(material.fastest_wave()) {}

void LinearElastic::stress(const LawInput& in, Lanes*, TensorLanes& P, LawOutput& out) const {
  const VoigtMatrix& C = material_.C;
  for (int k = 0; k < num_packs; ++k) {
    const PackTensor F = load(in.F, k);
    const Pack strain[6] = {F(0, 0) - 1.0,     F(1, 1) - 1.0,     F(2, 2) - 1.0,
                            F(0, 1) + F(1, 0), F(1, 2) + F(2, 1), F(2, 0) + F(0, 2)};
    PackSymmetric sigma;
    for (int i = 0; i < 6; ++i) {
      sigma.c[i] = C(i, 0) * strain[0];
      for (int j = 1; j < 6; ++j) sigma.c[i] += C(i, j) * strain[j];
    }
    PackTensor stress;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) stress(a, b) = sigma(a, b);
    PackOutput o{.wave_speed_squared = pack(wave_speed_ * wave_speed_), .J = determinant(F, cofactor(F))};
    store(InversionPolicy{}, 0, stress, o, k, P, out);
  }
}

} // namespace iga::solve
