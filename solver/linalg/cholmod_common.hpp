// CHOLMOD's state, started and finished with its owner; 64-bit indices.
#pragma once

#include <cholmod.h>
#include <cstdint>
#include <vector>

namespace iga::solve {

/// A symmetric matrix by its lower triangle, compressed columns with ascending rows; `values` may be null: pattern
/// only. A view: CHOLMOD takes pointers to non-const and changes nothing behind them where it only reads.
inline cholmod_sparse lower_triangle(std::size_t size, const std::vector<std::int64_t>& offsets,
                                     const std::vector<std::int64_t>& rows, const double* values) {
  cholmod_sparse A{};
  A.nrow = A.ncol = size;
  A.nzmax = rows.size();
  A.p = const_cast<std::int64_t*>(offsets.data());
  A.i = const_cast<std::int64_t*>(rows.data());
  A.x = const_cast<double*>(values);
  A.stype = -1;
  A.itype = CHOLMOD_LONG;
  A.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  return A;
}

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
