#include "tests/bench/measurements.hpp"

#include "solver/explicit/laws/laws.hpp"

#include <memory>
#include <random>

namespace iga::bench {

namespace {

using namespace solve;

// Points that are pressed together along x a little more every step, from `start` to `end`, then again from the start.
template <class L> class Points {
 public:
  Points(L law, double start, double end) : law_(std::move(law)), start_(start), end_(end) { reset(); }

  std::int64_t step() {
    constexpr int steps = 20;
    constexpr double advance = 2e-6;
    for (int s = 0; s < steps; ++s) {
      for (Batch& b : batches_) {
        b.in.F_old = b.in.F;
        b.in.F.c[0] -= advance;
        law_.stress(b.in, b.h, b.P, b.out);
      }
      benchmark::DoNotOptimize(batches_.data());
      depth_ += advance;
      if (depth_ > end_) reset();
    }
    return steps * 8 * static_cast<std::int64_t>(batches_.size());
  }

 private:
  struct Batch {
    LawInput in;
    Lanes h[L::history > 0 ? L::history : 1];
    TensorLanes P;
    LawOutput out;
  };

  void reset() {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> noise(-0.004, 0.004);
    for (Batch& b : batches_) {
      b = Batch{};
      law_.start(b.h);
      for (int i = 0; i < 9; ++i)
        for (int l = 0; l < 8; ++l) b.in.F.c[i][l] = (i % 4 ? 0 : 1) + noise(generator);
      b.in.dt = 1e-3;
      b.in.length = 10;
      for (const double depth : {0.5 * start_, start_}) {
        b.in.F_old = b.in.F;
        b.in.F.c[0] = 1.0 - depth + Lanes{};
        law_.stress(b.in, b.h, b.P, b.out);
      }
    }
    depth_ = start_;
  }

  L law_;
  double start_, end_, depth_ = 0;
  std::vector<Batch> batches_ = std::vector<Batch>(8); // the first level of cache holds them
};

template <class L> void measure_law(const std::string& name, const L& law, double start, double end) {
  measure("law/" + name, "points", [=]() -> Work {
    const auto points = std::make_shared<Points<L>>(law, start, end);
    return [points] { return points->step(); };
  });
}

} // namespace

void measure_laws() {
  const ElasticMaterial steel = isotropic(210, 0.3, 7.8e-6);
  measure_law("linear-elastic", LinearElastic(steel), 0.01, 0.02);
  measure_law("st-venant-kirchhoff", st_venant_kirchhoff(210, 0.3, 7.8e-6), 0.1, 0.2);
  measure_law("neo-hookean", neo_hookean(210, 0.3, 7.8e-6), 0.1, 0.2);
  measure_law("neo-hookean-bulk-viscosity", BulkViscosity<NeoHookean>{.law = neo_hookean(210, 0.3, 7.8e-6)}, 0.1, 0.2);
  const Curve epp({0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95},
                  {0.22, 0.22, 0.29, 0.32, 0.35, 0.38, 0.43, 0.50, 0.64, 0.92, 1.7, 2.8, 5.5, 15}, "EPP");
  FoamSettings foam{.E = 20, .nu = 0, .density = 6e-11, .yield = epp, .tension_limit = 0.25};
  measure_law("crushable-foam-crushing", CrushableFoam(foam), 0.3, 0.5);
  foam.damping = 0.1;
  measure_law("crushable-foam-damped", CrushableFoam(foam), 0.3, 0.5);
  foam.damping = 0;
  foam.E = 1; // stays below its yield stress
  measure_law("crushable-foam-elastic", CrushableFoam(foam), 0.01, 0.02);
  measure_law(
      "elliptic-foam",
      EllipticFoam({.E = 20, .nu = 0, .density = 6e-11, .plastic_nu = 0, .yield = Curve({0, 1}, {0.3, 0.6}, "foam")}),
      0.3, 0.5);
  J2Settings copper{.E = 117e3, .nu = 0.35, .density = 8.93e-9, .yield = Curve({0, 1}, {400, 500}, "copper")};
  measure_law("j2", J2Plasticity(copper), 0.1, 0.2);
  copper.rate = {.kind = RateFactor::Kind::CowperSymonds, .rate = 40, .exponent = 5};
  measure_law("j2-cowper-symonds", J2Plasticity(copper), 0.1, 0.2);
  copper.rate = {.kind = RateFactor::Kind::JohnsonCook, .rate = 1e-6, .exponent = 0.025};
  measure_law("j2-johnson-cook", J2Plasticity(copper), 0.1, 0.2);
}

} // namespace iga::bench
