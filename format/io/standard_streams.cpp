#include "format/io/standard_streams.hpp"

#include "format/model/errors.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace iga::io {

void prepare_standard_streams() {
  // open() takes the lowest free number: the streams are filled up in order. What would be written to a closed standard
  // output is refused, as a file that can only be read refuses it; a closed standard error is silence.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1 && errno == EBADF) [[maybe_unused]]
      const int opened = open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  std::signal(SIGPIPE, SIG_IGN);
}

void write_report(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  const int error = errno;
  if (error == EPIPE) throw ReaderGone{};
  throw InputError(fmt::format("standard output: the report cannot be written: {} (files that this run writes are not "
                               "affected)",
                               error == EBADF ? "it is closed" : std::strerror(error)));
}

void write_message(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
  std::clearerr(stderr);
}

} // namespace iga::io
