#pragma once
// Writes the entries of a loop's input log to a file, or keeps the latest ones in memory, on a
// thread of its own. However slow or full the disk is, the loop is not delayed.

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
  /// The latest time span that is kept in memory; 0 means nothing is kept.
  HostClock::duration keep_last{};
  /// The beginning of the names of kept files: "clay" gives clay.kept-1.nendo and so on, and
  /// clay.crash.nendo.
  std::filesystem::path kept_stem{};
  bool keep_on_switch = false; ///< save_last_minute() when a glove's switch is turned on
  /// Receives one line for people, from the recorder's thread: which file was kept, or what failed.
  std::function<void(std::string_view)> report{};
  /// The period in which a chunk is written to the disk. A crash can lose that much.
  HostClock::duration chunk_time = std::chrono::milliseconds(500);
  /// Returns what became of each glove's records since the recording began, by the gloves' numbers;
  /// the recorder's thread and end() call it. Empty: the file has no counts.
  std::function<std::vector<driver::RecordCounts>()> sent{};
  /// The period in which the file gets these counts. A crash can lose that much of the counts.
  HostClock::duration sent_time = std::chrono::seconds(10);
};

/// The counts of a recording that has ended.
struct Recorded {
  std::uint64_t samples = 0;
  std::uint64_t requests = 0;
  std::uint64_t ticks = 0;
  std::uint64_t lost = 0;                   ///< entries that found the input log full
  std::uint64_t bytes = 0;                  ///< size of the file
  std::uint64_t kept = 0;                   ///< files that save_last_minute() made
  std::vector<driver::RecordCounts> sent{}; ///< at the end, by the gloves' numbers
};

/// Asking thread, but for the functions that are thread-safe.
class NENDO_API Recorder {
public:
  /// Creates the file with the setup in it, and starts the thread. `input_log` must outlive the
  /// recorder. Blocks as long as the disk does. Error: failed (the file exists already or cannot be
  /// created, or the thread cannot be started).
  /// With keep_last, a crash of the process (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) writes what
  /// is in memory to a file, until the recorder is destroyed. Only one recorder at a time does so.
  /// It does not do so for a thread whose stack has overflowed, because the handler has no other
  /// stack.
  static Result<std::unique_ptr<Recorder>> begin(const Setup& setup, flow::InputLog& input_log,
                                                 RecorderOptions options);
  virtual ~Recorder() = default; ///< does what end() does
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Requests that what is in memory is written to a file soon. Does nothing without keep_last.
  /// Thread-safe, wait-free.
  virtual void save_last_minute() noexcept = 0;
  /// Announces a puppet (flow::DeformLoop::puppet()) before the loop gets it, for the recording to
  /// have it. Thread-safe. It takes a lock, which the loop never does.
  virtual void add_puppet(std::uint32_t number, RecordedPuppet puppet) = 0;
  /// To be called after the loop's last tick. Writes the remaining entries and the ending, and
  /// joins the thread. Further calls do nothing and return the same. Error: failed, if anything
  /// could not be written; all that is in the file is whole.
  virtual Result<Recorded> end(const std::optional<ShapeSum>& shape = {}) = 0;

protected:
  Recorder() = default;
};

} // namespace nendo::recording
