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

/// The log has a line for each entry. A line begins with the time in seconds and the direction: <
/// from the host, > to the host, ! for a fault. Then follow
///   <  the bytes as they were read: in hexadecimal, and as text between bars (. for what cannot be
///      printed)
///   >  the kind of a message (record or reply), and its bytes as the faults of the line have left
///      them
///   !  the name of the fault
class TrafficLog {
public:
  using Time = std::chrono::nanoseconds;

  TrafficLog() = default; ///< writes nothing
  /// Opens the log. An old file is replaced. Error: failed, if the file cannot be written.
  static Result<TrafficLog> open(const std::string& path);

  explicit operator bool() const noexcept { return file_.is_open(); }
  void received(Time now, std::span<const std::byte> bytes);
  void sent(Time now, std::string_view kind, std::span<const std::byte> bytes);
  void event(Time now, std::string_view what);
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
