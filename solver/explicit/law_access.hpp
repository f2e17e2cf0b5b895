// Any material law behind four functions: one call serves eight points, so that the kernel is compiled once for all.
#pragma once

#include "solver/explicit/law.hpp"

#include <memory>

namespace iga::solve {

struct LawAccess {
  std::shared_ptr<const void> law;
  int history = 0;
  bool needs_old_F = false;
  double wave_speed = 0; ///< reference_wave_speed()
  void (*start)(const void* law, Lanes* h) = nullptr;
  void (*stress)(const void* law, const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) = nullptr;
};

template <class OwnLaw> LawAccess access(const OwnLaw& law) {
  return {std::make_shared<const OwnLaw>(law),
          OwnLaw::history,
          OwnLaw::needs_old_F,
          law.reference_wave_speed(),
          [](const void* own, Lanes* h) { static_cast<const OwnLaw*>(own)->start(h); },
          [](const void* own, const LawInput& in, Lanes* h, TensorLanes& P, LawOutput& out) {
            static_cast<const OwnLaw*>(own)->stress(in, h, P, out);
          }};
}

} // namespace iga::solve
