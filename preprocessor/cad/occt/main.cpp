// igaprep-cad: reads a CAD file for igaprep. A process of its own, so that a file that brings OpenCASCADE down is
// refused like any other, its memory is given back, and igaprep starts without loading forty libraries.
#include "format/model/errors.hpp"
#include "format/model/version.hpp"
#include "preprocessor/cad/cad_archive.hpp"
#include "preprocessor/cad/occt/read_cad.hpp"

#include <Standard_Failure.hxx>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <new>
#include <string>
#include <string_view>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

using namespace iga::prep;

std::string read_all(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0) return {};
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  const ssize_t got = pread(file, bytes.data(), bytes.size(), 0);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

bool write_all(int file, const std::string& bytes) {
  if (ftruncate(file, 0) != 0) return false;
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t put = pwrite(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (put <= 0) return false;
    done += static_cast<std::size_t>(put);
  }
  return true;
}

const char* const help =
    R"(Reads a CAD file for igaprep: igaprep starts this program beside it for STEP, IGES and BREP files, and nobody else needs to.
Usage: igaprep-cad [OPTIONS] [number]

Positionals:
  number INT                  Number of the open file in which igaprep asks and is answered

Options:
  -h,--help                   Print this help message and exit
  --version                   Display program version information and exit

Examples:
  igaprep part.step --list                               faces of a CAD file: names, types, areas, places
  igaprep part.step --span-size 4                        a model of the part

Exit codes: 0 done, 2 input, usage or file access, 3 too little memory.
)";

CadAnswer answer(const std::string& bytes) {
  CadAnswer out;
  out.version = iga::program_version();
  if (version_of(bytes) != out.version) return out; // igaprep says so
  const CadRequest request = request_of(bytes);
  try {
    out.model = read_cad(request.file, request.options);
  } catch (const iga::InputError& error) {
    out.error = error.what();
  } catch (const Standard_Failure& failure) {
    out.error = fmt::format("{}: OpenCASCADE fails on this file ({}: {}); export the part again", request.file,
                            failure.DynamicType()->Name(), failure.GetMessageString());
  }
  return out;
}

} // namespace

int main(int argc, char** argv) {
  const std::string_view word = argc == 2 ? argv[1] : "";
  if (word == "-h" || word == "--help" || word == "--version") {
    fmt::print("{}", word == "--version" ? fmt::format("igaprep-cad {}\n", iga::program_version()) : help);
    return 0;
  }
  if (argc != 2 || std::atoi(argv[1]) < 3) {
    std::fputs("igaprep-cad: error: this program reads CAD files for igaprep, which starts it; run igaprep FILE.step\n",
               stderr);
    return 2;
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL); // it has no purpose without igaprep
  const int exchange = std::atoi(argv[1]);
  // OpenCASCADE prints to stdout, where igaprep's report goes.
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDOUT_FILENO);
  try {
    return write_all(exchange, to_bytes(answer(read_all(exchange)))) ? 0 : 2;
  } catch (const std::bad_alloc&) {
    return 3;
  }
}
