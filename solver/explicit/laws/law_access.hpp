// Any material law behind four functions: one call serves eight points, so that the kernel is compiled once for all.
#pragma once

#include "solver/explicit/laws/law.hpp"

#include <memory>

namespace iga::solve {

struct LawAccess {
  std::shared_ptr<const void> law;
  int history = 0;
  bool needs_old_F = false;
  int plastic_strain = -1; ///< where the equivalent plastic strain lies in the history; -1: the law has none
  double wave_speed = 0;   ///< reference_wave_speed()
  void (*start)(const void* law, Lanes* h) = nullptr;
  void (*stress)(const void* law, const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) = nullptr;
};

/// Wrapped laws (bulk viscosity) keep the history of the law inside.
template <class OwnLaw> constexpr int plastic_strain_place() {
  if constexpr (requires { OwnLaw::plastic_strain; })
    return OwnLaw::plastic_strain;
  else if constexpr (requires(OwnLaw own) { own.law; })
    return plastic_strain_place<decltype(OwnLaw::law)>();
  else
    return -1;
}

template <class OwnLaw> LawAccess access(const OwnLaw& law) {
  return {std::make_shared<const OwnLaw>(law),
          OwnLaw::history,
          OwnLaw::needs_old_F,
          plastic_strain_place<OwnLaw>(),
          law.reference_wave_speed(),
          [](const void* own, Lanes* h) { static_cast<const OwnLaw*>(own)->start(h); },
          [](const void* own, const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) {
            static_cast<const OwnLaw*>(own)->stress(in, h, P, out);
          }};
}

} // namespace iga::solve
