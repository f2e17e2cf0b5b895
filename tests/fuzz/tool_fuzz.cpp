// Rigid tools: an STL file up to its shape, mass and inertia.
#include "solver/explicit/contact/tool_mesh.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  const auto file = folder.write("tool.stl", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] { solve::solid_tool(solve::read_tool(file), 1.0); });
  return 0;
}
