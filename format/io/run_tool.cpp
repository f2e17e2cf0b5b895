#include "format/io/run_tool.hpp"

#include "format/io/interrupt.hpp"
#include "format/model/errors.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <new>
#include <system_error>

namespace iga::io {

int run_tool(const std::string& name, const std::function<int()>& work) {
  const auto fail = [&](int code, const std::string& text) {
    fmt::print(stderr, "{}: {}\n", name, text);
    return code;
  };
  try {
    return work();
  } catch (const InputError& error) {
    return fail(exit_input, fmt::format("error: {}", error.what()));
  } catch (const FormatError& error) {
    return fail(exit_format, fmt::format("error: {}", error.what()));
  } catch (const NumericalError& error) {
    return fail(exit_numerical, fmt::format("error: {}", error.what()));
  } catch (const Interrupted&) {
    return fail(128 + pending_signal(), "interrupted; no file was changed");
  } catch (const std::system_error& error) {
    return fail(exit_input, fmt::format("error: {}", error.what()));
  } catch (const std::bad_alloc&) {
    return fail(exit_input, "error: the memory of this machine is not enough; choose larger spans");
  } catch (const std::exception& error) {
    return fail(exit_our_bug,
                fmt::format("internal error: {}\nThis is a fault of the program, not of your input: please "
                            "report it with the command line and the input file.",
                            error.what()));
  }
}

} // namespace iga::io
