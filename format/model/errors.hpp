// The three kinds of failure a caller can tell apart; anything else is our own bug (exit code 1).
#pragma once

#include <stdexcept>

namespace iga {

/// The user can mend it: a bad file, setting or surface, or a failed read or write. Exit code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An interchange or results file breaks the schema. Exit code 3.
struct FormatError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A method did not reach its tolerance. Exit code 4.
struct NumericalError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

} // namespace iga
