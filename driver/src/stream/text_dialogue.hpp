#pragma once
// Commands of text and their answers, for the dialogue of a protocol with its device.

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "stream/listen.hpp"

namespace nendo::driver {

/// All waits end at the ReplyDeadline, and at once when the device is gone.
class TextDialogue {
public:
  TextDialogue(Transport& transport, const ReplyDeadline& limit) noexcept
      : transport_(transport), limit_(limit) {}

  void send(std::string_view command) noexcept {
    constexpr std::chrono::milliseconds write_timeout{100};
    if (is_gone_) return;
    const auto bytes = std::as_bytes(std::span(command));
    is_gone_ = transport_.write_all(bytes, write_timeout) == IoStatus::gone;
  }

  /// Discards what comes until nothing has come for `quiet`, and returns true; false if `max_time`
  /// is over before.
  bool fall_quiet(std::chrono::milliseconds quiet, std::chrono::milliseconds max_time) noexcept {
    const HostTime until = HostClock::now() + max_time;
    const auto take = [this](std::span<const std::byte> chunk) {
      bytes_received_ += chunk.size();
      return true;
    };
    IoStatus status = IoStatus::done;
    while (!is_gone_ && status == IoStatus::done && HostClock::now() < until)
      note(status = listen(transport_, limit_, quiet, take));
    return status == IoStatus::timeout;
  }

  /// Appends what comes to heard(), until `done(heard())`, which it returns, or `max_time` is over.
  template <class Done>
  bool hear(std::chrono::milliseconds max_time, Done&& done) {
    if (is_gone_) return false;
    const auto take = [&](std::span<const std::byte> chunk) {
      bytes_received_ += chunk.size();
      if (heard_.size() > max_heard) heard_.erase(0, heard_.size() / 2);
      heard_.append(reinterpret_cast<const char*>(chunk.data()), chunk.size());
      return done(heard_);
    };
    return note(listen(transport_, limit_, max_time, take)) == IoStatus::done;
  }
  void hear(std::chrono::milliseconds time) {
    hear(time, [](const std::string&) { return false; });
  }

  /// Sends `query` and hears until `done(heard())`, up to three times, since noise may damage an
  /// answer, and a host or a device may be held up.
  template <class Done>
  bool ask(std::string_view query, std::chrono::milliseconds answer_time, Done&& done) {
    constexpr int tries = 3;
    for (int k = 0; k < tries && !is_over(); ++k) {
      send(query);
      if (hear(answer_time, done)) return true;
    }
    return false;
  }

  /// What hear() has received since forget(); of very much, the end.
  const std::string& heard() const noexcept { return heard_; }
  void forget() noexcept { heard_.clear(); }
  bool is_gone() const noexcept { return is_gone_; }
  /// Returns true once the time is over.
  bool is_over() const noexcept {
    return is_gone_ || limit_.cancelled.stop_requested() || HostClock::now() >= limit_.deadline;
  }
  std::uint64_t bytes_received() const noexcept { return bytes_received_; }

private:
  static constexpr std::size_t max_heard = 8192;

  IoStatus note(IoStatus status) noexcept {
    is_gone_ = is_gone_ || status == IoStatus::gone;
    return status;
  }

  Transport& transport_;
  const ReplyDeadline limit_;
  std::string heard_;
  std::uint64_t bytes_received_ = 0;
  bool is_gone_ = false;
};

} // namespace nendo::driver
