// Curves in CSV files, of laws and of drives.
#include "solver/explicit/laws/curve.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("curve.csv", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] { solve::Curve::read_csv(file); });
  return 0;
}
