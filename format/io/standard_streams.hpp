// Standard output and error as a tool meets them: full, closed, or read by a program that has gone away.
#pragma once

#include <string_view>

namespace iga::io {

/// Thrown by write_report() where the reader of a pipe has gone (`igasolve info part.h5 | head -1`).
struct ReaderGone {};

/// Call first in main. A stream that the caller closed (2>&-) is opened as one that leads nowhere, so that no file gets
/// its number and no message lands in a file; writing to a pipe without reader becomes an error instead of a death.
void prepare_standard_streams();

/// Writes to standard output, at once. @throws InputError with the system's reason; ReaderGone
void write_report(std::string_view text);

/// Writes to standard error as far as that is possible: a message that nobody can read stops no run.
void write_message(std::string_view text);

} // namespace iga::io
