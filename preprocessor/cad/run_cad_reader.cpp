#include "preprocessor/cad/run_cad_reader.hpp"

#include "format/model/errors.hpp"
#include "format/model/version.hpp"
#include "preprocessor/cad/cad_archive.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;

namespace iga::prep {

namespace {

namespace fs = std::filesystem;

// A file in memory that the reader inherits.
class Exchange {
 public:
  Exchange() : file_(memfd_create("igaprep-cad", 0)) {
    if (file_ < 0) throw InputError(fmt::format("no memory to read a CAD file: {}", std::strerror(errno)));
  }
  ~Exchange() { close(file_); }
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  int file() const { return file_; }
  void put(const std::string& bytes) const {
    if (pwrite(file_, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
      throw InputError(fmt::format("no memory to read a CAD file: {}", std::strerror(errno)));
  }
  CadAnswer answer() const {
    struct stat status {};
    if (fstat(file_, &status) != 0 || status.st_size == 0) throw std::runtime_error("the CAD reader gave no answer");
    const auto size = static_cast<std::size_t>(status.st_size);
    void* const bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file_, 0);
    if (bytes == MAP_FAILED) throw std::bad_alloc();
    const struct Unmap {
      void* bytes;
      std::size_t size;
      ~Unmap() { munmap(bytes, size); }
    } unmap{bytes, size};
    const std::string_view text(static_cast<const char*>(bytes), size);
    if (const std::string version = version_of(text); version != program_version())
      throw InputError(
          fmt::format("the CAD reader beside igaprep is of version {}, igaprep of {}; build or install both again",
                      version, program_version()));
    return answer_of(text);
  }

 private:
  int file_;
};

fs::path reader_program() {
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : own.parent_path() / "igaprep-cad";
}

/// @return the reader's status as waitpid gives it; nothing where `stop` ended it
std::optional<int> wait_for(pid_t reader, const std::function<bool()>& stop) {
  int status = 0;
  while (waitpid(reader, &status, WNOHANG) == 0) {
    if (stop && stop()) {
      kill(reader, SIGKILL);
      waitpid(reader, &status, 0);
      return std::nullopt;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return status;
}

} // namespace

CadModel run_cad_reader(const fs::path& file, const CadOptions& options, const std::function<bool()>& stop) {
  const fs::path program = reader_program();
  if (!fs::exists(program))
    throw InputError(
        fmt::format("{}: igaprep-cad, which reads CAD files, is not beside igaprep: it was built without OpenCASCADE, "
                    "or the package is not installed; install iga-trimmed-solids-cad, or "
                    "libocct-data-exchange-dev and build again, or export the part as STL",
                    file.string()));
  const Exchange exchange;
  exchange.put(to_bytes(CadRequest{program_version(), file.string(), options}));
  std::string name = program.string(), number = std::to_string(exchange.file());
  char* const arguments[] = {name.data(), number.data(), nullptr};
  pid_t reader = 0;
  if (const int error = posix_spawn(&reader, name.c_str(), nullptr, nullptr, arguments, environ); error != 0)
    throw InputError(
        fmt::format("{}: the CAD reader {} cannot be started: {}", file.string(), name, std::strerror(error)));
  const std::optional<int> status = wait_for(reader, stop);
  if (!status) return {};
  if (WIFSIGNALED(*status))
    throw InputError(fmt::format("{}: OpenCASCADE broke down while reading this file ({}); it is damaged, or holds "
                                 "something that OpenCASCADE cannot read: export the part again",
                                 file.string(), strsignal(WTERMSIG(*status))));
  if (WEXITSTATUS(*status) == 3) throw std::bad_alloc();
  if (WEXITSTATUS(*status) != 0)
    throw std::runtime_error(fmt::format("the CAD reader ended with exit code {}", WEXITSTATUS(*status)));
  CadAnswer answer = exchange.answer();
  if (!answer.error.empty()) throw InputError(answer.error);
  return std::move(answer.model);
}

} // namespace iga::prep
