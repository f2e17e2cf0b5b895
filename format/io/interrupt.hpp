// Ctrl-C and kill: a flag that the stages poll, so that nothing is left half-written.
#pragma once

namespace iga::io {

/// Thrown where a poll finds the flag set; ends the program with 128 + the signal's number.
struct Interrupted {};

/// From now on the first SIGINT, SIGTERM, SIGHUP or SIGQUIT only sets the flag; another one a second later or more ends
/// the program at once. (Closing a terminal or stopping a service sends two at a time.) SIGHUP stays ignored where it
/// is, as under nohup. To be called once: SIGTERM is blocked (see block_termination), and a thread of its own waits for
/// it.
void install_signal_handlers();

/// Blocks SIGTERM in the calling thread and those that it starts. METIS puts a handler of its own in the place of ours
/// while it works, one that jumps to where the thread that called METIS came from: run by another thread it ends in a
/// segmentation fault. A program that uses METIS calls this before its libraries start threads (OpenBLAS does so when
/// it is loaded), and then install_signal_handlers, or unblock_termination where nothing is to be caught.
void block_termination();
void unblock_termination();

/// Number of the signal that arrived, 0 for none.
int pending_signal();

/// The same, and forgets it: for work that an interrupt ends early without making it worthless.
int take_pending_signal();

/// @throws Interrupted if a signal arrived
void stop_if_interrupted();

} // namespace iga::io
