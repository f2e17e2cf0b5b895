// Telling files of other formats by their first bytes; gzip archives are looked into.
#include "format/io/foreign_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  fuzz::read_or_refuse([&] { io::refuse_foreign(fuzz::bytes_of(data, size), "part.stl"); });
  return 0;
}
