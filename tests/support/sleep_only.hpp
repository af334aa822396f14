#pragma once
// A thread that may only sleep: the kernel stops every other system call of it, and counts.

#include <cstdint>

namespace nendo::test {

/// For the rest of the calling thread's life its system calls are not done, but counted, save
/// clock_nanosleep (which it is about), getrusage (by which a test counts page faults), the return
/// from a signal handler, and exit. It has to end in end_thread(). False: this kernel has no
/// seccomp.
bool allow_sleep_only() noexcept;

/// How many system calls of the calling thread were stopped so far, and which was the last.
struct StoppedCalls {
  std::uint64_t count = 0;
  int last = -1;
};
StoppedCalls stopped_calls() noexcept;

/// Ends the calling thread at once: its ordinary end makes system calls. Destructors do not run.
[[noreturn]] void end_thread() noexcept;

} // namespace nendo::test
