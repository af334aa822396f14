#pragma once
// Devices without a terminal: one that answers everything with fixed bytes, and a ScriptedUnit.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "support/scripted_unit.hpp"
#include "transport/transport.hpp"

namespace nendo::test {

/// Answers the n-th write with the n-th reply, or the last one, a byte at a time. After that, reads
/// time out at once.
class CannedTransport final : public driver::Transport {
public:
  explicit CannedTransport(std::string_view reply) : replies_{std::string(reply)} {}
  explicit CannedTransport(std::vector<std::string> replies) : replies_(std::move(replies)) {}
  driver::ReadResult read_some(std::span<std::byte> buffer,
                               std::chrono::milliseconds) noexcept override {
    if (gone) return {driver::IoStatus::gone, 0};
    if (unread_.empty()) return {driver::IoStatus::timeout, 0};
    buffer[0] = static_cast<std::byte>(unread_.front());
    unread_.remove_prefix(1);
    return {driver::IoStatus::done, 1};
  }
  driver::IoStatus write_all(std::span<const std::byte> bytes,
                             std::chrono::milliseconds) noexcept override {
    for (const std::byte byte : bytes)
      written.push_back(std::to_integer<char>(byte));
    unread_ = replies_[std::min(next_++, replies_.size() - 1)];
    return gone ? driver::IoStatus::gone : driver::IoStatus::done;
  }
  void discard_input() noexcept override { unread_ = {}; }

  std::string written;
  bool gone = false;

private:
  const std::vector<std::string> replies_;
  std::size_t next_ = 0;
  std::string_view unread_;
};

/// A ScriptedUnit in memory, on a line with a rate.
class UnitTransport final : public driver::Transport {
public:
  explicit UnitTransport(const Script& script)
      : unit(script), script_(script), unread_(script.waiting) {}
  driver::ReadResult read_some(std::span<std::byte> buffer,
                               std::chrono::milliseconds timeout) noexcept override {
    if (unread_.empty() && unit.streaming) unread_ = unit.record();
    if (unread_.empty()) {
      std::this_thread::sleep_for(timeout);
      return {driver::IoStatus::timeout, 0};
    }
    const std::size_t count = std::min(buffer.size(), unread_.size());
    for (std::size_t k = 0; k < count; ++k)
      buffer[k] = static_cast<std::byte>(unread_[k]);
    unread_.erase(0, count);
    return {driver::IoStatus::done, count};
  }
  driver::IoStatus write_all(std::span<const std::byte> bytes,
                             std::chrono::milliseconds) noexcept override {
    if (script_.baud != 0 && baud_ != static_cast<int>(script_.baud)) return driver::IoStatus::done;
    std::string input = unit.held;
    unit.held.clear();
    for (const std::byte byte : bytes)
      input.push_back(std::to_integer<char>(byte));
    for (std::string_view rest = input; !rest.empty();)
      unread_ += unit.answer(rest);
    return driver::IoStatus::done;
  }
  void discard_input() noexcept override { unread_.clear(); }
  bool set_baud(int baud) noexcept override {
    baud_ = baud;
    return true;
  }

  ScriptedUnit unit;

private:
  const Script script_;
  std::string unread_;
  int baud_ = 115'200;
};

} // namespace nendo::test
