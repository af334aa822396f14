#pragma once
// A client's connection: its received bytes, what it watches, and what waits to be sent. No call
// blocks.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/unique_fd.hpp>
#include <nendo/base/units.hpp>

#include "serve/request.hpp"

namespace nendo::serve {

/// Requests that a client may send per second.
inline constexpr int max_requests_per_s = 100;

class Client {
public:
  /// `introduction` are lines that are sent first. `devices` is the number of gloves and trackers.
  Client(UniqueFd socket, std::string introduction, std::size_t devices);

  int fd() const noexcept { return socket_.get(); }
  short events() const noexcept; ///< the events for poll()
  /// Handles what poll() reports: reads requests, answers them, and sends what waits.
  void serve(short events, HostTime now);
  /// Returns whether the connection has ended, so that it can be destroyed.
  bool is_over(HostTime now) const noexcept;

  bool watches_samples() const noexcept { return watch_.samples && !is_closing_; }
  bool watches_hands() const noexcept { return watch_.hands && !is_closing_; }
  /// Returns when the next frame of hands is due.
  HostTime next_hands() const noexcept { return next_hands_; }

  /// Sends a line of a device, a whole object. If the buffer is full, it waits, and displaces the
  /// device's previous line, which is then counted as dropped.
  void offer(std::size_t device, const std::string& object);
  /// Counts so many lines of each device as dropped.
  void count_lost(std::uint64_t lines) noexcept;
  /// Sends a frame of hands, which is due. If the buffer is full, counts it as skipped.
  void offer_hands(const std::string& object, HostTime now);
  /// Returns the number of lines that were dropped or skipped since the last call.
  std::uint64_t take_dropped() noexcept;

private:
  /// The newest line of a device that waits, and the number of those that were dropped before it.
  struct Waiting {
    std::string object; ///< empty: none
    std::uint64_t dropped = 0;
  };

  void receive(HostTime now);
  void take_requests(HostTime now);
  void handle(std::string_view request, HostTime now);
  void refuse(std::string_view why, HostTime now);
  void answer(const std::string& line);
  /// Sends as much of `rest_` as the system takes.
  void flush();
  void send_waiting();
  /// Sends a line, the end of it perhaps later. Returns false if the buffer is full.
  bool try_send(const std::string& line);
  /// Returns the number of bytes that the system took.
  std::size_t send_now(std::string_view bytes);

  UniqueFd socket_;
  Watch watch_;
  std::string incoming_; ///< the unfinished request
  std::string rest_;     ///< what the system has not taken yet: answers, and the rest of a line
  std::vector<Waiting> waiting_; ///< index: device
  std::uint64_t skipped_ = 0;    ///< frames of hands
  std::uint64_t dropped_ = 0;    ///< since take_dropped()
  HostTime next_hands_{};
  HostTime requests_since_{};
  int requests_ = 0; ///< since `requests_since_`
  HostTime closing_since_{};
  /// The system takes no more until poll() says so. True if `rest_` or a line waits.
  bool is_full_ = false;
  bool is_closing_ = false; ///< ends when `rest_` is sent
  bool may_ask_ = true;     ///< it has not shut down its sending side
  bool is_gone_ = false;
};

} // namespace nendo::serve
