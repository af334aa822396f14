#pragma once
// A text file of all that goes over an emulated line.

#include <chrono>
#include <cstddef>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::emulator {

/// The log has a line for each entry: time_s, direction (< from the host, > to the host, ! a
/// fault), then
///   <  the bytes in hexadecimal, and as text between bars (. for what cannot be printed), as they
///      were read
///   >  the same for one message, with its kind (record or reply) in front, after the line's faults
///   !  what happened
class TrafficLog {
public:
  using Time = std::chrono::nanoseconds;

  TrafficLog() = default; ///< writes nothing
  /// Opens the log. An old file is replaced. Error: failed, if the file cannot be written.
  static Result<TrafficLog> open(const std::string& path);

  explicit operator bool() const noexcept { return file_.is_open(); }
  void received(Time now, std::span<const std::byte> bytes);
  void sent(Time now, std::string_view kind, std::span<const std::byte> bytes);
  void happened(Time now, std::string_view what);
  /// Hands what was written to the system. Error: failed (e.g. the disk is full).
  Result<void> flush();

private:
  void begin(Time now, char direction);
  void end(std::span<const std::byte> bytes);

  std::ofstream file_;
  std::string path_;
  std::string line_;
  bool fresh_ = false; ///< there is something to flush
};

} // namespace nendo::emulator
