// Results files of all analyses.
#include "format/io/results_io.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("results.h5", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] { io::read_results(file); });
  return 0;
}
