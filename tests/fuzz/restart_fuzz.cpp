// Restart files of explicit runs.
#include "solver/explicit/run/run_restart.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("run_restart.h5", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] { solve::read_restart(file); });
  return 0;
}
