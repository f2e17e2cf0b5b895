#include "format/io/run_tool.hpp"

#include "format/io/interrupt.hpp"
#include "format/io/standard_streams.hpp"
#include "format/model/errors.hpp"

#include <csignal>
#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <new>
#include <string_view>
#include <system_error>

namespace iga::io {

namespace {

const std::string memory_text =
    "error: out of memory: the free memory of this machine (or the limit set for this process) is not enough; choose "
    "larger spans or a lower degree, close other programs, or use a machine with more memory";

} // namespace

int run_tool(const std::string& name, const std::function<int()>& work) {
  const auto fail = [&](int code, const std::string& text) {
    write_message(fmt::format("{}: {}\n", name, text));
    return code;
  };
  prepare_standard_streams();
  try {
    const int code = work();
    std::cout.flush(); // what --help and --version print
    if (!std::cout) throw InputError("standard output cannot be written: it is full or closed");
    return code;
  } catch (const InputError& error) {
    return fail(exit_input, fmt::format("error: {}", error.what()));
  } catch (const FormatError& error) {
    return fail(exit_format, fmt::format("error: {}", error.what()));
  } catch (const NumericalError& error) {
    return fail(exit_numerical, fmt::format("error: {}", error.what()));
  } catch (const Interrupted&) {
    return fail(128 + pending_signal(), "interrupted; no file was changed");
  } catch (const ReaderGone&) {
    return 128 + SIGPIPE;
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(exit_input, fmt::format("error: {}: {}", error.path1().string(), error.code().message()));
  } catch (const std::system_error& error) {
    // A thread that cannot be started lacks the memory for its stack.
    const bool no_memory =
        error.code() == std::errc::not_enough_memory || error.code() == std::errc::resource_unavailable_try_again;
    return fail(exit_input, no_memory ? memory_text : fmt::format("error: {}", error.what()));
  } catch (const std::bad_alloc&) {
    return fail(exit_input, memory_text);
  } catch (const std::exception& error) {
    // TBB's words for a thread that cannot be started.
    if (std::string_view(error.what()).starts_with("pthread_create has failed")) return fail(exit_input, memory_text);
    return fail(exit_our_bug,
                fmt::format("internal error: {}\nThis is a fault of the program, not of your input: please "
                            "report it with the command line and the input file.",
                            error.what()));
  } catch (...) {
    return fail(exit_our_bug, "internal error without a message\nThis is a fault of the program, not of your input: "
                              "please report it with the command line and the input file.");
  }
}

} // namespace iga::io
