#pragma once
// Writes the entries of a loop's input log to a file, or keeps the latest ones in memory, on a
// separate thread. However slow or full the disk is, the loop is not delayed.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/record_counts.hpp>
#include <nendo/flow/input_script.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::recording {

struct RecorderOptions {
  std::filesystem::path file{}; ///< empty means no file; the file must not exist yet
  /// The time span of the latest entries that are kept in memory; 0 means none.
  HostClock::duration keep_last{};
  /// Prefix of the names of kept files: "clay" gives clay.kept-1.nendo and so on, and
  /// clay.crash.nendo.
  std::filesystem::path kept_stem{};
  bool keep_on_switch = false; ///< call save_last_minute() when a glove's switch is turned on
  /// Receives one-line messages for the user, on the recorder's thread: the kept file, or the
  /// failure.
  std::function<void(std::string_view)> report{};
  /// The interval between chunks written to the disk. A crash can lose one interval.
  HostClock::duration chunk_time = std::chrono::milliseconds(500);
  /// Returns the counts of each glove's records since the recording began, by glove number; the
  /// recorder's thread and end() call it. Empty: the file has no counts.
  std::function<std::vector<driver::RecordCounts>()> sent{};
  /// The interval between writes of these counts. A crash can lose the counts of one interval.
  HostClock::duration sent_time = std::chrono::seconds(10);
};

/// The counts of a recording that has ended.
struct Recorded {
  std::uint64_t samples = 0;
  std::uint64_t requests = 0;
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;                   ///< entries dropped because the input log was full
  std::uint64_t bytes = 0;                  ///< size of the file
  std::uint64_t kept = 0;                   ///< files that save_last_minute() made
  std::vector<driver::RecordCounts> sent{}; ///< final counts, by glove number
};

/// Asking thread, except for functions marked thread-safe.
class NENDO_API Recorder {
public:
  /// Creates the file with the setup in it, and starts the thread. `input_log` must outlive the
  /// recorder. Blocks during disk access. Error: failed (the file exists already or cannot be
  /// created, or the thread cannot be started). With keep_last, a crash of the process (SIGSEGV,
  /// SIGBUS, SIGILL, SIGFPE, SIGABRT) writes the entries in memory to a file, until the recorder is
  /// destroyed. Only one recorder at a time does so. Stack overflows are not covered, because the
  /// handler has no alternate stack.
  static Result<std::unique_ptr<Recorder>> begin(const Setup& setup, flow::InputLog& input_log,
                                                 RecorderOptions options);
  virtual ~Recorder() = default; ///< does what end() does
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Requests that the entries in memory be written to a file soon. Does nothing without keep_last.
  /// Thread-safe, wait-free.
  virtual void save_last_minute() noexcept = 0;
  /// Adds a puppet (flow::DeformLoop::puppet()) to the recording. Call before the loop gets it.
  /// Thread-safe. Takes a lock, which the loop never does.
  virtual void add_puppet(std::uint32_t number, RecordedPuppet puppet) = 0;
  /// To be called after the loop's last tick. Writes the remaining entries and the ending, and
  /// joins the thread. Further calls do nothing and return the same. Error: failed, if a write
  /// failed; the chunks in the file are whole.
  virtual Result<Recorded> end(const std::optional<ShapeSum>& shape = {}) = 0;

protected:
  Recorder() = default;
};

} // namespace nendo::recording
