// What becomes of a point whose volume ratio J = det F fell below what its law is meant for.
#pragma once

#include "solver/explicit/laws/law.hpp"
#include "solver/explicit/simd/pack_tensor.hpp"

namespace iga::solve {

enum class InvertedPoints {
  Clamp, ///< the law is evaluated at smallest_J at most; what resists full crushing is added (compaction.hpp)
  Erode, ///< no stress; the kernel takes the point out for good and accounts for its energy
  Stop   ///< no stress; the kernel ends the run
};

/// Points with J < smallest_J, or squeezed flatter than that (is_crushed), are named in LawOutput::inverted, whatever
/// the action.
struct InversionPolicy {
  InvertedPoints action = InvertedPoints::Clamp;
  double smallest_J = 0.05;
};

/// Output of one pack, for laws without damping.
struct PackOutput {
  Pack wave_speed_squared{};
  Pack J{};
  PackMask inverted{};
  Pack viscous_power{};
  Pack damping_ratio{};
  Pack compression{};
};

/// Hands stress and output of a pack to the kernel. Inverted points that are not clamped get no stress and the wave
/// speed of the untouched material, squared: `at_rest`.
inline void store(const InversionPolicy& policy, double at_rest, PackTensor& stress, const PackOutput& o, int k,
                  TensorLanes& P, LawOutput& out) {
  Pack c2 = o.wave_speed_squared;
  if (policy.action != InvertedPoints::Clamp) {
    for (Pack& component : stress.c) component = o.inverted ? Pack{} : component;
    c2 = o.inverted ? pack(at_rest) : c2;
  }
  store(P, k, stress);
  store(out.wave_speed_squared, k, c2);
  store(out.J, k, o.J);
  store(out.inverted, k, o.inverted);
  store(out.viscous_power, k, o.viscous_power);
  store(out.damping_ratio, k, o.damping_ratio);
  store(out.compression, k, o.compression);
}

} // namespace iga::solve
