// CHOLMOD's state, started and finished with its owner; 64-bit indices.
#pragma once

#include <cholmod.h>

namespace iga::solve {

class CholmodCommon {
 public:
  CholmodCommon() {
    cholmod_l_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
  }
  ~CholmodCommon() { cholmod_l_finish(&common_); }
  CholmodCommon(const CholmodCommon&) = delete;
  CholmodCommon& operator=(const CholmodCommon&) = delete;
  cholmod_common* get() { return &common_; }
  cholmod_common* operator->() { return &common_; }

 private:
  cholmod_common common_{};
};

} // namespace iga::solve
