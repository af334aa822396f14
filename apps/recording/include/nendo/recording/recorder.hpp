#pragma once
// Takes what a loop leaves on its input log to a file, or keeps the last of it in memory, on a
// thread of its own. However slow or full the disk is, the loop does not notice.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/flow/input_log.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

struct RecorderOptions {
  std::filesystem::path file{}; ///< empty: none. It may not be there yet
  /// So much is kept in memory; 0: nothing.
  HostClock::duration keep_last{};
  /// "clay" for clay.kept-1.nendo and so on, and for clay.crash.nendo.
  std::filesystem::path kept_stem{};
  bool keep_on_switch = false; ///< keep() when a glove's switch is turned on
  /// One line for people, from the recorder's thread: what was kept where, what failed.
  std::function<void(std::string_view)> report{};
  /// A chunk is written, and is on the disk, so often: what a crash can cost.
  HostClock::duration chunk_time = std::chrono::milliseconds(500);
};

struct Recorded {
  std::uint64_t samples = 0;
  std::uint64_t requests = 0;
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;  ///< entries that found the input log full
  std::uint64_t bytes = 0; ///< of the file
  std::uint64_t kept = 0;  ///< files that keep() made
};

class Recorder {
public:
  /// Makes the file, with the setup in it, and the thread. With keep_last, a crash of the process
  /// (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) writes what is in memory, until this is destroyed;
  /// one recorder at a time does so, and not for a thread whose stack has overflowed: a handler has
  /// no other to run on. `input log` must outlive it. Blocks for as long as the disk does.
  /// Error: failed (the file is there already, or cannot be made).
  static Result<std::unique_ptr<Recorder>> begin(const Setup& setup, flow::InputLog& input_log,
                                                 RecorderOptions options);
  virtual ~Recorder() = default; ///< as end()
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// The last of it becomes a file, soon. Any thread, wait-free; nothing without keep_last.
  virtual void keep() noexcept = 0;
  /// After the loop's last tick: writes the rest and the ending, and joins the thread. Idempotent.
  /// Error: failed, if anything that was to be written could not be; what is in the file is whole.
  virtual Result<Recorded> end(const std::optional<ShapeSum>& shape = {}) = 0;

protected:
  Recorder() = default;
};

} // namespace nendo::recording
