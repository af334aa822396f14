#pragma once
// Serves an EmulatedUnit on a pseudo-terminal, and two units that are no gloves.

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <poll.h>
#include <unistd.h>

#include "support/served_terminal.hpp"
#include "units/emulated_unit.hpp"

namespace nendo::test {

class PtyUnit {
public:
  explicit PtyUnit(std::unique_ptr<emulator::EmulatedUnit> unit)
      : unit_(std::move(unit)),
        terminal_([this](int master, const std::atomic<bool>& stop) { serve(master, stop); }) {}

  const std::string& path() const { return terminal_.path(); }
  void unplug() { terminal_.unplug(); } ///< the host's end hangs up
  /// Calls `look` with the unit while it serves. The caller must know the unit's class.
  template <class Unit, class Look>
  auto look(Look&& look) {
    const std::lock_guard lock(mutex_);
    return look(static_cast<const Unit&>(*unit_));
  }

  std::atomic<bool> mute{false}; // while true, nothing that the unit sends gets through

private:
  void serve(int master, const std::atomic<bool>& stop) {
    using namespace std::chrono_literals;
    const auto switched_on = std::chrono::steady_clock::now();
    while (!stop) {
      pollfd entry{master, POLLIN, 0};
      std::array<std::byte, 256> buffer;
      const bool readable = ::poll(&entry, 1, 2) > 0 && (entry.revents & POLLIN) != 0;
      const ssize_t count = readable ? ::read(master, buffer.data(), buffer.size()) : 0;
      const std::lock_guard lock(mutex_);
      const auto now = std::chrono::steady_clock::now() - switched_on;
      if (count > 0) unit_->receive(std::span(buffer).first(static_cast<std::size_t>(count)), now);
      unit_->advance(now);
      const auto output = unit_->output();
      const ssize_t sent = mute ? static_cast<ssize_t>(output.size())
                                : ::write(master, output.data(), output.size());
      if (sent > 0) unit_->take(static_cast<std::size_t>(sent));
    }
  }

  std::mutex mutex_; // guards unit_
  const std::unique_ptr<emulator::EmulatedUnit> unit_;
  ServedTerminal terminal_; // the last member, so that its thread ends first
};

/// A unit that never sends anything, or always the same noise.
class Stranger final : public emulator::EmulatedUnit {
public:
  explicit Stranger(std::string_view noise) : noise_(noise) {}
  void receive(std::span<const std::byte> /*bytes*/, Time /*now*/) override {}
  void advance(Time /*now*/) override { send(std::as_bytes(std::span(noise_))); }
  std::optional<Time> next_due() const noexcept override { return std::nullopt; }

private:
  const std::string noise_;
};

} // namespace nendo::test
