#include "solver/linalg/mumps_factor.hpp"

#include "format/model/errors.hpp"
#include "solver/linalg/blas_threads.hpp"
#include "solver/linalg/free_memory.hpp"

#include <fmt/format.h>

#include <limits>

namespace iga::solve {

namespace {

constexpr int job_start = -1, job_end = -2, job_analyse = 1, job_factorise = 2, job_solve = 3;
constexpr MUMPS_INT world = -987654; ///< MUMPS's name for "all processes", also where there is just one

} // namespace

void need_mumps_numbers(std::int64_t unknowns) {
  if (unknowns > std::numeric_limits<MUMPS_INT>::max())
    throw InputError(fmt::format("{} unknowns are more than MUMPS can number; use larger spans", unknowns));
}

MumpsFactor::MumpsFactor(MumpsEntries entries, Kind kind, const MumpsWords& words, std::int64_t unknowns)
    : entries_(std::move(entries)), words_(words), unknowns_(unknowns) {
  follow_run_threads();
  mumps_.comm_fortran = world;
  mumps_.par = 1;
  mumps_.sym = static_cast<MUMPS_INT>(kind);
  call(job_start);
  control(1) = control(2) = control(3) = -1; // no output
  control(4) = 0;
  mumps_.n = static_cast<MUMPS_INT>(size());
  mumps_.nnz = static_cast<MUMPS_INT8>(entries_.values.size());
  mumps_.irn = entries_.rows.data();
  mumps_.jcn = entries_.columns.data();
  mumps_.a = entries_.values.data();
  mumps_.perm_in = entries_.position.data();
  control(6) = 0;  // rows stay in place: the order is given
  control(7) = 1;  // perm_in
  control(8) = 0;  // scaled already
  control(10) = 0; // no refinement
}

MumpsFactor::~MumpsFactor() {
  call(job_end);
}

void MumpsFactor::call(int job) const {
  mumps_.job = job;
  dmumps_c(&mumps_);
}

void MumpsFactor::factorise(const std::function<void(const FactorCost&)>& announce) {
  call(job_analyse);
  if (info(1) < 0) fail();
  cost_.nonzeros = info(20) >= 0 ? info(20) : std::int64_t{-1000000} * info(20);
  cost_.flops = mumps_.rinfog[0];
  // Pivots that are delayed need more than the analysis foresaw.
  for (const MUMPS_INT percent : {20, 60, 200, 800}) {
    control(14) = percent;
    cost_.bytes = 1e6 * static_cast<double>(info(17)) * (1 + 0.01 * (percent - 20));
    require_memory(cost_, unknowns_, free_memory());
    if (announce) announce(cost_);
    call(job_factorise);
    const MUMPS_INT status = info(1);
    if (status >= 0) {
      entries_.rows = entries_.columns = {};
      entries_.values = {};
      return;
    }
    if (status != -8 && status != -9 && status != -14 && status != -15) fail();
  }
  fail();
}

void MumpsFactor::solve(double* y, int columns) const {
  follow_run_threads();
  mumps_.rhs = y;
  mumps_.nrhs = columns;
  mumps_.lrhs = static_cast<MUMPS_INT>(size());
  call(job_solve);
  if (info(1) < 0) fail();
}

void MumpsFactor::fail() const {
  const MUMPS_INT status = info(1);
  if (status == -13 || status == -7 || status == -19)
    throw InputError(fmt::format("not enough memory to factorise {} of {} unknowns (about {:.2f} GiB); use larger "
                                 "spans or a lower degree",
                                 words_.in_memory, unknowns_, cost_.bytes / (1024.0 * 1024 * 1024)));
  throw NumericalError(fmt::format("the factorisation of {} of {} unknowns failed (MUMPS {}, {}){}", words_.matrix,
                                   unknowns_, status, info(2), words_.cause));
}

} // namespace iga::solve
