// Ctrl-C and kill: a flag that the stages poll, so that nothing is left half-written.
#pragma once

namespace iga::io {

/// Thrown where a poll finds the flag set; ends the program with 128 + the signal's number.
struct Interrupted {};

/// From now on the first SIGINT, SIGTERM, SIGHUP or SIGQUIT only sets the flag; another one a second later or more ends
/// the program at once. (Closing a terminal or stopping a service sends two at a time.) SIGHUP stays ignored where it
/// is, as under nohup. To be called once, before any other thread is started: SIGTERM is blocked in all of them, and
/// a thread of its own waits for it.
void install_signal_handlers();

/// Number of the signal that arrived, 0 for none.
int pending_signal();

/// The same, and forgets it: for work that an interrupt ends early without making it worthless.
int take_pending_signal();

/// @throws Interrupted if a signal arrived
void stop_if_interrupted();

} // namespace iga::io
