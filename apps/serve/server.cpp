#include "serve/server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <list>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nendo/base/system_error.hpp>
#include <nendo/base/triple_buffer.hpp>
#include <nendo/base/unique_fd.hpp>

#include "serve/client.hpp"
#include "serve/lines.hpp"

namespace nendo::serve {
namespace {

using std::chrono::milliseconds;

/// How often the server looks for samples while clients watch: a tick must not wake a thread.
constexpr milliseconds watching_period(1);
/// How often it empties the log otherwise.
constexpr milliseconds idle_period(100);
/// The time for which the listener is left alone after a failure, as when there is no descriptor
/// left: poll() would return at once, over and over.
constexpr milliseconds accept_pause(250);

/// Keeps the hands of the newest frame.
class NewestHands final : public flow::FrameSink {
public:
  void show(const flow::Frame& frame) noexcept override {
    HandsFrame& next = frames_.back();
    next.tick = frame.tick;
    next.woke = frame.woke;
    next.hands = frame.hands;
    frames_.publish();
  }
  // Server's thread:
  bool update() noexcept { return frames_.update(); }
  const HandsFrame& newest() const noexcept { return frames_.front(); }

private:
  TripleBuffer<HandsFrame> frames_{HandsFrame{}};
};

/// The number by which clients know a device, and the index of its lines.
struct Place {
  std::size_t index = 0;  ///< among gloves, or among trackers
  std::size_t device = 0; ///< among all
};

/// A client, and the tick of the last hands that it got.
struct Connected {
  Client client;
  std::optional<std::uint64_t> tick{};
};

} // namespace

/// The server's thread, and all that it owns.
class Server::Work {
public:
  Work(Socket socket, UniqueFd waker, const Devices& devices, const ServerLimits& limits);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  flow::InputLog log;
  NewestHands hands;
  struct Counts {
    std::atomic<std::uint64_t> clients{0}, accepted{0}, refused{0}, dropped{0};
  } counts;
  const std::string& path() const noexcept { return socket_.path(); }

private:
  void run();
  void wait();
  milliseconds max_wait(HostTime now) const;
  void accept_all(HostTime now);
  void welcome(UniqueFd connection);
  void send_input();
  void offer(const Place& place, const std::string& object);
  void send_hands(HostTime now);
  void drop_gone(HostTime now);
  bool any_watches_samples() const;

  Socket socket_;
  const UniqueFd waker_;
  const ServerLimits limits_;
  std::array<std::optional<Place>, flow::max_inputs> gloves_;
  std::array<std::optional<Place>, 2> trackers_; ///< index: flow::Placement::index_of(side)
  std::size_t devices_ = 0;
  std::string introduction_;
  std::list<Connected> clients_;
  std::vector<pollfd> polled_;
  std::uint64_t lost_ = 0; ///< entries of the log that clients know to be lost
  HostTime next_accept_{};
  std::atomic<bool> over_{false};
  std::thread thread_;
};

Server::Work::Work(Socket socket, UniqueFd waker, const Devices& devices,
                   const ServerLimits& limits)
    : log(limits.log_entries), socket_(std::move(socket)), waker_(std::move(waker)),
      limits_(limits), introduction_(version_line(socket_.name()) + "\n") {
  for (std::size_t at = 0; at < devices.gloves.size(); ++at) {
    const ServedGlove& glove = devices.gloves[at];
    introduction_ += glove_line(glove, at) + "\n";
    assert(glove.input < gloves_.size());
    gloves_[glove.input] = Place{at, devices_++};
  }
  for (std::size_t at = 0; at < devices.trackers.size(); ++at) {
    const ServedTracker& tracker = devices.trackers[at];
    introduction_ += tracker_line(tracker, at) + "\n";
    trackers_[flow::Placement::index_of(tracker.side)] = Place{at, devices_++};
  }
  thread_ = std::thread([this] { run(); });
}

Server::Work::~Work() {
  over_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(waker_.get(), &one, sizeof one);
  thread_.join();
}

void Server::Work::run() {
  while (!over_) {
    wait();
    const HostTime now = HostClock::now();
    std::size_t at = 2; // after the listener and the waker
    for (Connected& one : clients_)
      one.client.serve(polled_[at++].revents, now);
    if ((polled_[0].revents & POLLIN) != 0) accept_all(now);
    send_input();
    send_hands(now);
    drop_gone(now);
  }
}

void Server::Work::wait() {
  const HostTime now = HostClock::now();
  polled_.clear();
  polled_.push_back({socket_.fd(), static_cast<short>(now >= next_accept_ ? POLLIN : 0), 0});
  polled_.push_back({waker_.get(), POLLIN, 0});
  for (const Connected& one : clients_)
    polled_.push_back({one.client.fd(), one.client.events(), 0});
  if (::poll(polled_.data(), polled_.size(), static_cast<int>(max_wait(now).count())) > 0) return;
  for (pollfd& one : polled_) // a signal came, or nothing
    one.revents = 0;
}

/// Frames that are due but not there yet are looked for as samples are.
milliseconds Server::Work::max_wait(HostTime now) const {
  if (any_watches_samples()) return watching_period;
  milliseconds most = idle_period;
  for (const Connected& one : clients_) {
    if (!one.client.watches_hands()) continue;
    const auto left = std::chrono::ceil<milliseconds>(one.client.next_hands() - now);
    most = std::clamp(left, watching_period, most);
  }
  return most;
}

bool Server::Work::any_watches_samples() const {
  return std::any_of(clients_.begin(), clients_.end(),
                     [](const Connected& one) { return one.client.watches_samples(); });
}

void Server::Work::accept_all(HostTime now) {
  next_accept_ = now + accept_pause;
  for (;;) {
    UniqueFd connection(::accept4(socket_.fd(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!connection.is_open()) {
      if (errno == EAGAIN) next_accept_ = now; // there is no other one
      return;
    }
    ++counts.accepted;
    welcome(std::move(connection));
  }
}

void Server::Work::welcome(UniqueFd connection) {
  const int bytes = static_cast<int>(limits_.send_buffer_bytes);
  ::setsockopt(connection.get(), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  if (clients_.size() < limits_.max_clients) {
    clients_.push_back({Client(std::move(connection), introduction_, devices_), {}});
    return;
  }
  ++counts.refused;
  const std::string line = error_line("so many programs are connected that there is no place for "
                                      "another one") +
                           "\n";
  ::send(connection.get(), line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void Server::Work::send_input() {
  const bool is_watched = any_watches_samples();
  log.drain([&](const flow::InputLogEntry& entry) {
    if (!is_watched) return;
    if (const auto* taken = std::get_if<flow::TakenSample>(&entry)) {
      if (taken->hand >= gloves_.size() || !gloves_[taken->hand]) return;
      const Place& place = *gloves_[taken->hand];
      offer(place, sample_line(taken->sample, place.index));
    } else if (const auto* pose = std::get_if<flow::TakenPose>(&entry)) {
      const auto& place = trackers_[flow::Placement::index_of(pose->side)];
      if (place) offer(*place, pose_line(pose->pose, place->index));
    }
  });
  // The log does not know of which devices the refused entries were.
  const std::uint64_t lost = log.lost();
  if (lost == lost_) return;
  for (Connected& one : clients_)
    if (one.client.watches_samples()) one.client.count_lost(lost - lost_);
  lost_ = lost;
}

void Server::Work::offer(const Place& place, const std::string& object) {
  for (Connected& one : clients_)
    if (one.client.watches_samples()) one.client.offer(place.device, object);
}

/// Makes the line only if a client gets it.
void Server::Work::send_hands(HostTime now) {
  hands.update();
  const HandsFrame& frame = hands.newest();
  if (frame.woke == HostTime{}) return; // there is none yet
  std::string line;
  for (Connected& one : clients_) {
    if (!one.client.watches_hands() || now < one.client.next_hands() || one.tick == frame.tick)
      continue;
    if (line.empty()) line = hands_line(frame);
    one.client.offer_hands(line, now);
    one.tick = frame.tick;
  }
}

void Server::Work::drop_gone(HostTime now) {
  for (Connected& one : clients_)
    counts.dropped += one.client.take_dropped();
  clients_.remove_if([&](const Connected& one) { return one.client.is_over(now); });
  counts.clients = clients_.size();
}

Result<std::unique_ptr<Server>> Server::open(Socket socket, const Devices& devices,
                                             const ServerLimits& limits) {
  UniqueFd waker(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (!waker.is_open())
    return system_error(socket.path(), "no descriptor is left", "close some programs");
  if (auto listens = socket.listen(); !listens) return listens.error();
  return std::unique_ptr<Server>(
      new Server(std::make_unique<Work>(std::move(socket), std::move(waker), devices, limits)));
}

Server::Server(std::unique_ptr<Work> work) noexcept : work_(std::move(work)) {}
Server::~Server() = default;

flow::InputLog& Server::input() noexcept {
  return work_->log;
}

flow::FrameSink& Server::frames() noexcept {
  return work_->hands;
}

const std::string& Server::path() const noexcept {
  return work_->path();
}

ServerCounters Server::counters() const noexcept {
  const auto& counts = work_->counts;
  return {counts.clients, counts.accepted, counts.refused, counts.dropped, work_->log.lost()};
}

} // namespace nendo::serve
