#include "cli/standard_output.hpp"

#include <cerrno>
#include <csignal>
#include <iostream>
#include <new>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <nendo/base/result.hpp>

#include "cli/cli.hpp"

namespace nendo::cli {
namespace {

/// Passes everything to a FILE, which has the buffer, so that std::cout and printf keep their
/// order.
class FileBuffer final : public std::streambuf {
public:
  explicit FileBuffer(std::FILE* file) noexcept : file_(file) {}

private:
  int_type overflow(int_type byte) override {
    if (traits_type::eq_int_type(byte, traits_type::eof())) return traits_type::not_eof(byte);
    return std::fputc(byte, file_) == EOF ? traits_type::eof() : byte;
  }
  std::streamsize xsputn(const char* bytes, std::streamsize size) override {
    const auto wanted = static_cast<std::size_t>(size);
    return static_cast<std::streamsize>(std::fwrite(bytes, 1, wanted, file_));
  }
  int sync() override { return std::fflush(file_) == 0 ? 0 : -1; }

  std::FILE* file_;
};

// Where standard output was closed, the next file that is opened would get its number, and with it
// whatever is printed. What stands there instead cannot be written to.
void fill_closed_descriptors() noexcept {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0)
      static_cast<void>(::open("/dev/null", fd == STDOUT_FILENO ? O_RDONLY : O_RDWR));
}

} // namespace

StandardOutput::StandardOutput() : stdout_before_(stdout) {
  fill_closed_descriptors();
  // glibc lets a program exchange stdout. Its own stdout would tell that a write has failed, but
  // not why, and not at once.
  file_ = ::fopencookie(this, "w", {nullptr, &StandardOutput::write, nullptr, nullptr});
  if (file_ == nullptr) throw std::bad_alloc();
  std::setvbuf(file_, nullptr, ::isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF, BUFSIZ);
  std::fflush(stdout);
  stdout = file_;
  buffer_ = std::make_unique<FileBuffer>(file_);
  buffer_before_ = std::cout.rdbuf(buffer_.get());
}

StandardOutput::~StandardOutput() {
  std::cout.rdbuf(buffer_before_);
  stdout = stdout_before_;
  std::fclose(file_);
}

int StandardOutput::finish(int exit_code) {
  std::fflush(file_);
  if (!failed_ || error_number_ == 0) return exit_code;
  if (error_number_ == EPIPE) return exit_code != 0 ? exit_code : 128 + SIGPIPE;
  const int lost = report({Errc::failed, "standard output cannot be written: " +
                                             std::generic_category().message(error_number_)});
  return exit_code != 0 ? exit_code : lost;
}

ssize_t StandardOutput::write(void* self, const char* bytes, std::size_t size) {
  const bool written = static_cast<StandardOutput*>(self)->write_all(bytes, size);
  return written ? static_cast<ssize_t>(size) : 0; // 0 is fopencookie's word for an error
}

bool StandardOutput::write_all(const char* bytes, std::size_t size) {
  while (size > 0 && !failed_) { // after a gap, nothing more would be of use
    const ssize_t written = ::write(STDOUT_FILENO, bytes, size);
    if (written >= 0) {
      bytes += written;
      size -= static_cast<std::size_t>(written);
    } else if (errno == EAGAIN) { // another program has made it so, and still has it
      pollfd output{STDOUT_FILENO, POLLOUT, 0};
      ::poll(&output, 1, -1);
    } else if (errno != EINTR) {
      fail(errno);
    }
  }
  return !failed_;
}

void StandardOutput::fail(int error_number) noexcept {
  failed_ = true;
  const bool nobody_is_there = error_number == EPIPE || error_number == EIO;
  if (!nobody_is_there || !stop_requested()) error_number_ = error_number;
  request_stop();
}

} // namespace nendo::cli
