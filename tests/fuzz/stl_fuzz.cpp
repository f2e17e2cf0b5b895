// STL, ASCII and binary, as both tools read it.
#include "format/io/stl_reader.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  fuzz::read_or_refuse([&] { io::read_stl(fuzz::bytes_of(data, size), "part.stl", 1.0); });
  return 0;
}
