#pragma once
// Standard output, watched: whatever cannot be written is noticed, whichever command printed it.

#include <cstddef>
#include <cstdio>
#include <memory>
#include <streambuf>

#include <sys/types.h>

namespace nendo::cli {

/// Takes the place of std::cout and stdout while it lives, which must not be more than one at a
/// time. The first write that fails ends all output, and sets stop_requested(), so that a command
/// that continues until somebody stops it ends. Writes that a signal interrupts continue, so that
/// no line ends in its middle.
class StandardOutput {
public:
  StandardOutput();
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// Flushes, and returns the program's exit code: `exit_code`, or, if that is 0, what lost output
  /// makes of it. A failed write is told in one line and makes it 1. A reader that has gone, as in
  /// `| head`, makes it 141 without a word, which is what shells say of SIGPIPE; it stays 0 if a
  /// stop signal came first, since Ctrl-C ends both sides of a pipe.
  int finish(int exit_code);

private:
  static ssize_t write(void* self, const char* bytes, std::size_t size);
  bool write_all(const char* bytes, std::size_t size);
  void fail(int error_number) noexcept;

  std::FILE* file_; ///< hands all bytes to write()
  std::FILE* stdout_before_;
  std::unique_ptr<std::streambuf> buffer_; ///< hands what std::cout gets to `file_`
  std::streambuf* buffer_before_;
  bool failed_ = false;
  int error_number_ = 0; ///< why it failed; 0: nobody needs to know
};

} // namespace nendo::cli
