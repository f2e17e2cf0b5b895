// Writes results whose content is known, reads results files and says what is wrong: for the tests in Python.
#include "format/io/results_io.hpp"
#include "format/io/trimmed_model_io.hpp"
#include "format/io/vtp_writer.hpp"
#include "format/model/errors.hpp"
#include "tests/support/synthetic_model.hpp"
#include "tests/support/synthetic_results.hpp"

#include <cstdio>
#include <string_view>

using namespace iga;

namespace {

int write(std::string_view kind, const char* file) {
  const TrimmedModel model = test::make_box_model();
  const Results results = kind == "static"     ? test::make_static_results(model)
                          : kind == "eigen"    ? test::make_eigen_results(model)
                          : kind == "buckling" ? test::make_buckling_results(model)
                                               : test::make_full_results(model);
  io::write_results(file, results, false);
  io::write_viewer_files(file, results, false);
  return 0;
}

} // namespace

int main(int argc, char** argv) try {
  const std::string_view command = argc > 2 ? argv[1] : "";
  if (command == "write" && argc == 4) return write(argv[2], argv[3]);
  if (command == "model" && argc == 3) return io::write_model(argv[2], test::make_box_model()), 0;
  if (command == "check" && argc == 3) return io::read_results(argv[2]), 0;
  std::fputs("usage: synthetic_results_tool write eigen|static|buckling|full FILE | model FILE | check FILE\n", stderr);
  return 2;
} catch (const FormatError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
} catch (const InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
