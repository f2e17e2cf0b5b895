// PLY files as igaprep reads them, up to points and polygons.
#include "format/io/ply_reader.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  fuzz::read_or_refuse([&] { io::read_ply(fuzz::bytes_of(data, size), "part.ply"); });
  return 0;
}
