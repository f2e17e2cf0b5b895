// Run files of `igasolve explicit` and `nonlinear`. The files that the seeds name exist beside them; the models are not
// opened yet.
#include "solver/explicit/run/run_file.hpp"
#include "solver/nonlinear/nonlinear_run.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace iga;
  static const fuzz::ScratchFolder folder;
  static const auto curve = [] {
    for (const char* model : {"a.h5", "b.h5"}) folder.write(model, "not opened");
    return folder.write("curve.csv", "time,value\n0,0\n1,-2\n");
  }();
  const auto file = folder.write("run.toml", fuzz::bytes_of(data, size));
  fuzz::read_or_refuse([&] { solve::read_explicit_run(file); });
  fuzz::read_or_refuse([&] { solve::read_nonlinear_run(file); });
  return 0;
}
