// Every measurement works on one thread and counts what it did per second.
#pragma once

#include "tests/bench/bench_cases.hpp"

#include <benchmark/benchmark.h>

#include <functional>

namespace iga::bench {

/// Work of one iteration; returns how much of the unit it did.
using Work = std::function<std::int64_t()>;

/// Registers `<name>`; `prepare` runs once, untimed, and hands over the work. `unit` names the counter "unit/s".
void measure(const std::string& name, const std::string& unit, std::function<Work()> prepare);

/// Trimming, winding numbers, functions, surface points, file.
void measure_stages(BenchCase& part);
/// Moments, candidates, NNLS and the whole rule of trimmed spans.
void measure_fitting(BenchCase& part, int degree);

/// Assembly of the solver's matrices: quadrature points per second; products with them: entries per second.
void measure_solver(BenchCase& part, int degree);

/// Stress of the laws of the explicit kernel: points per second, data in the first level of cache.
void measure_laws();

/// Contact forces of a cube of 25³ spans with triangles of 4 % of its side: surface vertices per second, with the broad
/// phases they need while the cube moves by 3e-4 of its side per evaluation.
void measure_contact();

} // namespace iga::bench
