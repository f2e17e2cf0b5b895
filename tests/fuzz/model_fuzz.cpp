// Model files: the whole reader with its checks, and the provenance by itself.
#include "format/io/trimmed_model_io.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("model.h5", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] { io::read_model(file); });
  fuzz::read_or_refuse([&] { io::read_provenance(file); });
  return 0;
}
