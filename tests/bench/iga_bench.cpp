// iga_bench: rates of the kernels of igaprep and igasolve on one core. Takes Google Benchmark's flags
// (--benchmark_filter=…). IGA_PARTS_DIR names the folder of the sample parts (default: samples beside the program's
// folder), IGA_SHARED_DIR that of parts made by others.
#include "tests/bench/measurements.hpp"

#include <tbb/global_control.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fmt/format.h>

namespace iga::bench {

void measure(const std::string& name, const std::string& unit, std::function<Work()> prepare) {
  benchmark::RegisterBenchmark(name.c_str(), [name, unit, prepare = std::move(prepare)](benchmark::State& state) {
    // The library calls this several times in a row to find the number of iterations.
    static std::string prepared;
    static Work work;
    if (prepared != name) {
      work = nullptr;
      work = prepare();
      prepared = name;
    }
    std::int64_t done = 0;
    for (auto _ : state) done += work();
    state.counters[unit + "/s"] = benchmark::Counter(static_cast<double>(done), benchmark::Counter::kIsRate);
    if (unit == "spans")
      state.counters["per span"] =
          benchmark::Counter(static_cast<double>(done), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  })->Unit(benchmark::kMillisecond);
}

namespace {

std::filesystem::path folder_from(const char* variable, const std::filesystem::path& otherwise) {
  const char* value = std::getenv(variable);
  return value ? std::filesystem::path(value) : otherwise;
}

int run(int argc, char** argv) {
  const auto program = std::filesystem::canonical("/proc/self/exe");
  auto cases = bench_cases(folder_from("IGA_PARTS_DIR", program.parent_path().parent_path() / "samples"),
                           folder_from("IGA_SHARED_DIR", {}));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  for (BenchCase& part : cases) {
    measure_stages(part);
    for (const int degree : {2, 3, 4}) measure_fitting(part, degree);
    for (const int degree : {2, 3}) measure_solver(part, degree);
  }
  measure_laws();
  measure_contact();
  // Short by default: every kernel is measured on many spans at once. A flag given by hand comes later and wins.
  std::string shortly = "--benchmark_min_time=0.1";
  std::vector<char*> flags{argv[0], shortly.data()};
  flags.insert(flags.end(), argv + 1, argv + argc);
  argc = static_cast<int>(flags.size());
  argv = flags.data();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

} // namespace

} // namespace iga::bench

int main(int argc, char** argv) {
  try {
    return iga::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "iga_bench: {}\n", error.what());
    return 2;
  }
}
