// Ctrl-C and SIGTERM inside work that cannot poll for them: factorisations by libraries, assembly, sampling.
#pragma once

#include <functional>

namespace iga::solve {

/// Runs `work` in a thread of its own and gives back its result or throws what it threw. Where SIGINT or SIGTERM
/// arrives and the work does not end by itself within a second, the program ends at once with 128 + the signal's
/// number: nothing is lost, as files are written in one go at the end, under OutputsBeingWritten.
int run_interruptibly(const std::function<int()>& work);

/// While one exists a signal waits: what is being written is finished, or taken away by its own error handling.
class OutputsBeingWritten {
 public:
  OutputsBeingWritten();
  ~OutputsBeingWritten();
  OutputsBeingWritten(const OutputsBeingWritten&) = delete;
  OutputsBeingWritten& operator=(const OutputsBeingWritten&) = delete;
};

} // namespace iga::solve
