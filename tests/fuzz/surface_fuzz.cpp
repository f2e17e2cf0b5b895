// A surface file of any format, cut into triangles and prepared without repair. Small inputs only: what the surface
// costs is tested elsewhere.
#include "preprocessor/surface/prepare_surface.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  fuzz::read_or_refuse(
      [&] { prep::prepare_surface(prep::read_mesh_bytes(fuzz::bytes_of(data, size), "part.obj"), {}); });
  return 0;
}
