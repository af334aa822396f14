#include "server_work.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "listener.hpp"
#include "wire.hpp"

namespace nendo::web {
namespace {

using std::chrono::milliseconds;

/// Screens show no more pictures; what a faster loop makes in between goes in one message.
constexpr milliseconds frame_period(8);
/// How soon it is noticed that somebody is overdue.
constexpr milliseconds patience(250);

std::string words_message(const std::string& words) {
  return std::string{static_cast<char>(MessageType::words), 0, 0, 0} + words;
}

void write_loop(std::uint16_t loop, std::size_t at, std::vector<std::byte>& message) {
  std::memcpy(message.data() + at, &loop, sizeof loop);
}

} // namespace

Server::Work::Work(Endpoint where, std::string secret, Descriptor listener, Descriptor waker,
                   ServerLimits limits)
    : endpoint(std::move(where)), token(std::move(secret)), limits_(limits),
      listener_(std::move(listener)), waker_(std::move(waker)), thread_([this] { run(); }) {}

Server::Work::~Work() {
  over_ = true;
  wake();
  thread_.join();
}

void Server::Work::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(waker_.get(), &one, sizeof one);
}

void Server::Work::present(std::shared_ptr<FrameStream> tap, std::vector<std::byte> model) {
  {
    const std::scoped_lock lock(show_mutex_);
    write_loop(++loops_, offsetof(ModelHead, loop), model);
    next_ = Show{std::move(tap), std::make_shared<const std::vector<std::byte>>(std::move(model)),
                 loops_};
  }
  wake();
}

void Server::Work::tell(std::string words) {
  {
    const std::scoped_lock lock(show_mutex_);
    words_ = std::move(words);
  }
  wake();
}

std::size_t Server::Work::clients() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(connections_.begin(), connections_.end(), [](const Connection& connection) {
        return connection.stage() == Connection::Stage::socket;
      }));
}

void Server::Work::run() {
  while (!over_) {
    wait();
    const HostTime now = HostClock::now();
    take_show();
    pass_on_words(now);
    std::size_t at = 2; // behind the listener and the waker
    for (Connection& connection : connections_)
      look_at(connection, polled_[at++].revents, now);
    if ((polled_[0].revents & POLLIN) != 0) accept_all(now);
    if (now >= next_frames_) {
      next_frames_ = now + frame_period;
      send_frames(now);
    }
    drop_overdue(now);
    counts.clients = clients();
    if (show_.tap) show_.tap->listen(counts.clients > 0);
  }
  end();
}

// The last frame is the shape that the run leaves.
void Server::Work::end() {
  const HostTime now = HostClock::now();
  send_frames(now);
  if (show_.tap) show_.tap->listen(false);
  for (Connection& connection : connections_)
    if (connection.stage() == Connection::Stage::socket)
      connection.close(CloseCode::going_away, now);
}

void Server::Work::wait() {
  polled_.clear();
  const bool accepts = HostClock::now() >= next_accept_;
  polled_.push_back({listener_.get(), static_cast<short>(accepts ? POLLIN : 0), 0});
  polled_.push_back({waker_.get(), POLLIN, 0});
  for (const Connection& connection : connections_)
    polled_.push_back({connection.fd(), connection.events(), 0});
  milliseconds most(-1);
  if (!connections_.empty() || !accepts) most = patience;
  if (clients() > 0)
    most = std::clamp(std::chrono::ceil<milliseconds>(next_frames_ - HostClock::now()),
                      milliseconds(0), frame_period);
  ::poll(polled_.data(), polled_.size(), static_cast<int>(most.count()));
  std::uint64_t ignored = 0;
  if ((polled_[1].revents & POLLIN) != 0) [[maybe_unused]]
    const ssize_t got = ::read(waker_.get(), &ignored, sizeof ignored);
}

void Server::Work::take_show() {
  std::optional<Show> next;
  {
    const std::scoped_lock lock(show_mutex_);
    next = std::exchange(next_, std::nullopt);
  }
  if (!next) return;
  if (show_.tap) show_.tap->listen(false);
  show_ = *std::move(next);
  for (Connection& connection : connections_)
    if (connection.stage() == Connection::Stage::socket)
      connection.close(CloseCode::service_restart, HostClock::now());
}

// To all who have room for them: words are not worth waiting for.
void Server::Work::pass_on_words(HostTime now) {
  std::string words;
  {
    const std::scoped_lock lock(show_mutex_);
    words.swap(words_);
  }
  if (words.empty()) return;
  const SharedBytes message = shared_bytes(words_message(words));
  for (Connection& client : connections_)
    if (client.stage() == Connection::Stage::socket && client.has_room())
      client.send(Opcode::binary, message, false, now);
}

// A system that has no descriptor left says at once, and over and over, that somebody waits.
void Server::Work::accept_all(HostTime now) {
  next_accept_ = now + patience;
  while (auto socket = accept_from(listener_, limits_.system_buffer)) {
    next_accept_ = now;
    ++counts.accepted;
    if (connections_.size() >= limits_.connections) make_place();
    connections_.emplace_back(*std::move(socket), now, limits_);
  }
}

// Who is in has shown the token, and stays.
void Server::Work::make_place() {
  const auto oldest =
      std::find_if(connections_.begin(), connections_.end(), [](const Connection& connection) {
        return connection.stage() != Connection::Stage::socket;
      });
  if (oldest == connections_.end()) return; // one more may ask, and is told that there is no place
  connections_.erase(oldest);
  ++counts.dropped;
}

void Server::Work::send_frames(HostTime now) {
  if (!show_.tap) return;
  records_.clear();
  show_.tap->take(records_);
  auto shape = show_.tap->take_shape();
  if (shape) write_loop(show_.loop, offsetof(ShapeHead, loop), shape->message);
  const SharedBytes bytes =
      shape ? std::make_shared<const std::vector<std::byte>>(std::move(shape->message)) : nullptr;
  feed_counters_.lost = show_.tap->lost();
  const std::uint64_t bad = bad_records;
  feed_counters_.bad_records = {static_cast<std::uint32_t>(bad),
                                static_cast<std::uint32_t>(bad >> 32U)};
  bool shape_wanted = false;
  for (Connection& client : connections_) {
    if (client.stage() != Connection::Stage::socket) continue;
    send_frames(client, shape, bytes, now);
    client.keep_alive(now);
    shape_wanted = shape_wanted ||
                   (client.feed.wants_shape() && client.has_room() && !client.has_shape_waiting());
  }
  if (shape_wanted) show_.tap->ask_for_shape();
}

void Server::Work::send_frames(Connection& client, const std::optional<FrameStream::Shape>& shape,
                               const SharedBytes& bytes, HostTime now) {
  if (!client.has_room()) {
    client.feed.skip(records_);
    counts.skipped += records_.size();
    return;
  }
  if (shape && client.feed.wants_shape() && !client.has_shape_waiting()) {
    client.send(Opcode::binary, bytes, true, now);
    client.feed.got_shape(shape->number);
    ++counts.shapes;
    counts.shape_bytes += bytes->size();
  }
  const auto update = client.feed.update(records_, feed_counters_);
  if (!update) return;
  ++counts.updates;
  counts.update_bytes += update->size();
  client.send(Opcode::binary, std::make_shared<const std::vector<std::byte>>(*std::move(update)),
              false, now);
}

void Server::Work::drop_overdue(HostTime now) {
  connections_.remove_if([&](const Connection& connection) {
    const bool overdue =
        connection.stage() != Connection::Stage::over && connection.is_overdue(now);
    if (overdue && connection.stage() != Connection::Stage::linger) ++counts.dropped;
    return overdue || connection.stage() == Connection::Stage::over;
  });
}

} // namespace nendo::web
