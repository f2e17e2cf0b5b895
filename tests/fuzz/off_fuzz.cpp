// OFF files as igaprep reads them, up to points and polygons.
#include "format/io/off_reader.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  fuzz::read_or_refuse([&] { io::read_off(fuzz::bytes_of(data, size), "part.off"); });
  return 0;
}
