// Run files of all analyses of `igasolve` but explicit and nonlinear ones.
#include "solver/analysis/run_settings.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("run.toml", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] {
    const solve::TypedRun typed = solve::read_run_file(file);
    using enum solve::Analysis;
    for (const auto analysis : {Eigen, Timestep, Static, Heat, Buckling, Harmonic, Random, Transient})
      fuzz::read_or_refuse([&] { solve::validate_run(typed, analysis); });
  });
  return 0;
}
