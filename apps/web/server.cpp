#include "web/server.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "commands/command_text.hpp"
#include "web/server_work.hpp"
#include "web/web_socket.hpp"
#include "web/wire.hpp"

namespace nendo::web {

namespace {

using std::chrono::milliseconds;

/// Screens do not show more frames. The steps that a faster loop makes in between share a message.
constexpr milliseconds frame_period(8);
/// How often deadlines are looked at.
constexpr milliseconds deadline_period(250);

SharedBytes shared_message(std::vector<std::byte> message) {
  return std::make_shared<const std::vector<std::byte>>(std::move(message));
}

} // namespace

Result<std::unique_ptr<Server>> Server::open(const Endpoint& endpoint, ServerLimits limits) {
  Endpoint where = endpoint;
  auto listener = open_at(where, SOCK_STREAM);
  if (!listener) return Error{listener.error().code, "--web " + listener.error().message};
  std::string token = random_hex(16);
  UniqueFd waker(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (token.empty() || !waker.is_open())
    return Error{Errc::failed, "--web: the system gives no randomness or no descriptor; close "
                               "some programs and try again"};
  return std::unique_ptr<Server>(new Server(std::make_unique<Work>(
      std::move(where), std::move(token), *std::move(listener), std::move(waker), limits)));
}

Server::Server(std::unique_ptr<Work> work) noexcept : work_(std::move(work)) {}
Server::~Server() = default;

const Endpoint& Server::endpoint() const noexcept {
  return work_->endpoint;
}

const std::string& Server::token() const noexcept {
  return work_->token;
}

std::string Server::url() const {
  return "http://" + work_->endpoint.authority() + "/#" + work_->token;
}

std::string Server::foxglove_url() const {
  return "ws://" + work_->endpoint.authority() + "/foxglove?token=" + work_->token;
}

void Server::present(std::shared_ptr<FrameStream> stream, std::vector<std::byte> model,
                     Pictures pictures) {
  work_->present({std::move(stream), nullptr, std::move(pictures)}, std::move(model), false);
}

void Server::present_beside(std::shared_ptr<FrameStream> stream, std::vector<std::byte> model,
                            Pictures pictures) {
  work_->present({std::move(stream), nullptr, std::move(pictures)}, std::move(model), true);
}

void Server::end_beside() {
  {
    const std::scoped_lock lock(work_->inbox.mutex);
    work_->inbox.beside = Work::Presented{};
  }
  work_->wake();
}

void Server::present_nothing() {
  const deform::Mesh nothing;
  const deform::BlockLayout layout(nothing.vertices);
  present(std::make_shared<FrameStream>(layout, flow::FrameCapacity{}),
          model_message(layout, nothing, {}, {}));
}

// What the loop was last requested to use may be refused, so that it continues with older ones.
void Server::add_weights(std::uint64_t number, std::vector<std::byte> message) {
  constexpr std::size_t max_weights = 3;
  Work::Inbox& inbox = work_->inbox;
  const std::scoped_lock lock(inbox.mutex);
  inbox.weights.push_back({number, shared_message(std::move(message))});
  if (inbox.weights.size() <= max_weights) return;
  inbox.weights.erase(
      std::find_if(inbox.weights.begin(), inbox.weights.end(),
                   [&](const Work::Weights& some) { return some.number != inbox.weights_in_use; }));
}

std::optional<ClientCommand> Server::next_command() noexcept {
  ClientCommand command;
  if (work_->commands.size() == 0 || !work_->commands.try_pop(command)) return std::nullopt;
  return command;
}

void Server::report(std::string message, bool is_error) {
  work_->report(std::move(message), is_error);
}

template <class Make>
void Server::set_fact(std::size_t fact, std::uint64_t version, const Make& make) {
  Work::Inbox& inbox = work_->inbox;
  {
    const std::scoped_lock lock(inbox.mutex);
    if (inbox.facts[fact] && version == inbox.versions[fact]) return;
    inbox.versions[fact] = version;
    inbox.facts[fact] = shared_message(make());
  }
  work_->wake();
}

void Server::set_fact(std::size_t fact, std::vector<std::byte> message) {
  Work::Inbox& inbox = work_->inbox;
  {
    const std::scoped_lock lock(inbox.mutex);
    if (inbox.facts[fact] && message == *inbox.facts[fact]) return;
    inbox.facts[fact] = shared_message(std::move(message));
  }
  work_->wake();
}

void Server::set_settings(const flow::LoopSettings& settings) {
  set_fact(settings_fact, text_message(MessageType::settings, commands::text_of(settings)));
}

void Server::set_form(FormKind kind, std::string_view json) {
  const auto number = static_cast<std::uint8_t>(kind);
  set_fact(form_fact + number, text_message(MessageType::form, json, number));
}

void Server::set_figures(std::string_view json) {
  set_fact(figures_fact, text_message(MessageType::figures, json));
}

void Server::set_pictures(FormPictures pictures) {
  const std::scoped_lock lock(work_->inbox.mutex);
  work_->inbox.pictures = std::move(pictures);
}

std::optional<FormInput> Server::next_input(FormKind kind) {
  const std::scoped_lock lock(work_->inbox.mutex);
  auto& inputs = work_->inbox.inputs[static_cast<std::size_t>(kind)];
  if (inputs.empty()) return std::nullopt;
  std::optional<FormInput> input(std::move(inputs.front()));
  inputs.pop_front();
  return input;
}

std::optional<Server::File> Server::take_file() {
  const std::scoped_lock lock(work_->inbox.mutex);
  return std::exchange(work_->inbox.file, std::nullopt);
}

void Server::set_commands(const commands::Situation& now) {
  set_fact(commands_fact, text_message(MessageType::commands, command_states(now)));
}

void Server::follow(const flow::Frame& frame, const puppet::Rig* rig) {
  constexpr std::chrono::milliseconds period(33);
  set_fact(puppet_fact, frame.puppet, [&] { return message_of(frame.puppet, rig); });
  Work::Inbox& inbox = work_->inbox;
  bool has_clay = frame.clay.is_clay || frame.parts.count > 0;
  bool has_wire = frame.wire.is_drawing();
  {
    const std::scoped_lock lock(inbox.mutex);
    const HostTime now = HostClock::now();
    if (now < inbox.next_marks) return;
    inbox.next_marks = now + period;
    has_clay = has_clay || inbox.facts[clay_fact]; // which it once was
    has_wire = has_wire || inbox.facts[wire_fact];
  }
  if (has_clay) set_fact(clay_fact, clay_message(frame));
  if (has_wire) set_fact(wire_fact, wire_message(frame));
}

ServerCounters Server::counters() const noexcept {
  const auto& counts = work_->counts;
  return {counts.clients,      counts.accepted, counts.refused,     counts.dropped, counts.updates,
          counts.update_bytes, counts.shapes,   counts.shape_bytes, counts.weights, counts.skipped};
}

Server::Work::Work(Endpoint where, std::string secret, UniqueFd listener, UniqueFd waker,
                   ServerLimits limits)
    : endpoint(std::move(where)), token(std::move(secret)), limits_(limits),
      listener_(std::move(listener)), waker_(std::move(waker)), thread_([this] { run(); }) {}

Server::Work::~Work() {
  over_ = true;
  wake();
  thread_.join();
}

void Server::Work::present(Presented next, std::vector<std::byte> model, bool is_beside) {
  {
    const std::scoped_lock lock(inbox.mutex);
    next.loop = ++inbox.loops;
    std::memcpy(model.data() + offsetof(ModelHead, loop), &next.loop, sizeof next.loop);
    next.model = shared_message(std::move(model));
    (is_beside ? inbox.beside : inbox.next) = std::move(next);
    if (!is_beside) {
      // Another run counts its puppets from the beginning, and has its own controls.
      for (const std::size_t fact : {puppet_fact, run_form_fact, status_fact})
        inbox.facts[fact] = nullptr;
      inbox.inputs[static_cast<std::size_t>(FormKind::run)].clear();
    }
  }
  wake();
}

void Server::Work::wake() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(waker_.get(), &one, sizeof one);
}

void Server::Work::report(std::string message, bool is_error) {
  {
    const std::scoped_lock lock(inbox.mutex);
    inbox.report = std::move(message);
    inbox.is_report_error = is_error;
  }
  wake();
}

bool Server::Work::has_pages() const noexcept {
  return std::ranges::any_of(connections_,
                             [](const Connection& connection) { return connection.is_page(); });
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
    take_presented();
    send_report(now);
    send_facts(now);
    std::size_t at = 2; // behind the listener and the waker
    for (Connection& connection : connections_)
      serve(connection, polled_[at++].revents, now);
    if ((polled_[0].revents & POLLIN) != 0) accept_all(now);
    if (now >= next_frames_) {
      next_frames_ = now + frame_period;
      send_frames(now);
    }
    drop_expired(now);
    counts.clients = clients();
    if (presented_.stream) presented_.stream->set_active(has_pages());
  }
  end();
}

// The last frame is sent, because it is the shape that the run leaves.
void Server::Work::end() {
  const HostTime now = HostClock::now();
  send_frames(now);
  if (presented_.stream) {
    presented_.stream->set_active(false);
    presented_.stream->set_hands_active(false);
  }
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
  if (!connections_.empty() || !accepts) most = deadline_period;
  if (clients() > 0)
    most = std::clamp(std::chrono::ceil<milliseconds>(next_frames_ - HostClock::now()),
                      milliseconds(0), frame_period);
  ::poll(polled_.data(), polled_.size(), static_cast<int>(most.count()));
  std::uint64_t ignored = 0;
  if ((polled_[1].revents & POLLIN) != 0) [[maybe_unused]]
    const ssize_t got = ::read(waker_.get(), &ignored, sizeof ignored);
}

void Server::Work::take_presented() {
  std::optional<Presented> next, beside;
  std::optional<FormPictures> pictures;
  {
    const std::scoped_lock lock(inbox.mutex);
    next = std::exchange(inbox.next, std::nullopt);
    beside = std::exchange(inbox.beside, std::nullopt);
    pictures = std::exchange(inbox.pictures, std::nullopt);
  }
  if (next) loop_ = *std::move(next);
  if (beside) beside_ = *std::move(beside);
  if (pictures) form_pictures_ = *std::move(pictures);
  const Presented& shown = beside_.stream ? beside_ : loop_;
  if (shown.loop == presented_.loop) return;
  if (presented_.stream) {
    presented_.stream->set_active(false);
    presented_.stream->set_hands_active(false);
  }
  presented_ = shown;
  begin_foxglove(HostClock::now());
  for (Connection& connection : connections_)
    if (connection.stage() == Connection::Stage::socket)
      connection.close(CloseCode::service_restart, HostClock::now());
}

// A client whose queue is too long does not get the report at all.
void Server::Work::send_report(HostTime now) {
  std::string text;
  bool is_error = false;
  {
    const std::scoped_lock lock(inbox.mutex);
    text.swap(inbox.report);
    is_error = inbox.is_report_error;
  }
  if (text.empty()) return;
  const SharedBytes message =
      shared_message(text_message(MessageType::report, text, is_error ? 1 : 0));
  for (Connection& client : connections_)
    if (client.is_page() && client.accepts_updates())
      client.send(Opcode::binary, message, false, now);
}

// Each client gets each message once, before the updates that follow it. They are small, so that
// also a client whose queue is long gets them.
void Server::Work::send_facts(HostTime now) {
  Facts facts;
  {
    const std::scoped_lock lock(inbox.mutex);
    facts = inbox.facts;
  }
  for (Connection& client : connections_) {
    // One that lags behind gets the newest ones when its queue is empty.
    if (!client.is_page() || !client.accepts_updates()) continue;
    for (std::size_t at = 0; at < facts.size(); ++at) {
      if (!facts[at] || client.sent_facts[at] == facts[at]) continue;
      client.sent_facts[at] = facts[at];
      client.send(Opcode::binary, facts[at], false, now);
    }
  }
}

// When the system has no descriptor left, poll() would return at once, over and over. So the
// listener is left alone for a while after each failure.
void Server::Work::accept_all(HostTime now) {
  next_accept_ = now + deadline_period;
  while (auto socket = accept_from(listener_, limits_.send_buffer_bytes)) {
    next_accept_ = now;
    ++counts.accepted;
    if (connections_.size() >= limits_.max_connections) drop_oldest();
    connections_.emplace_back(*std::move(socket), now, limits_);
  }
}

// Clients with a WebSocket, or that send a file, have shown the token, so they stay.
void Server::Work::drop_oldest() {
  const auto oldest =
      std::find_if(connections_.begin(), connections_.end(), [](const Connection& connection) {
        return connection.stage() != Connection::Stage::socket &&
               connection.stage() != Connection::Stage::body;
      });
  if (oldest == connections_.end())
    return; // the new one is answered with 503 if it asks for a WebSocket
  connections_.erase(oldest);
  ++counts.dropped;
}

void Server::Work::send_frames(HostTime now) {
  if (!presented_.stream) return;
  records_.clear();
  presented_.stream->take(records_);
  auto shape = presented_.stream->take_shape();
  SharedBytes bytes;
  if (shape) {
    std::memcpy(shape->message.data() + offsetof(ShapeHead, loop), &presented_.loop,
                sizeof presented_.loop);
    bytes = shared_message(std::move(shape->message));
  }
  {
    const std::scoped_lock lock(inbox.mutex);
    if (!records_.empty() && records_.back().weights != 0)
      inbox.weights_in_use = records_.back().weights;
  }
  bool shape_wanted = false;
  for (Connection& client : connections_) {
    if (!client.is_page()) continue;
    send_frames(client, shape, bytes, now);
    client.keep_alive(now);
    shape_wanted = shape_wanted || (client.feed.wants_shape() && client.accepts_updates() &&
                                    !client.has_queued_shape());
  }
  if (shape_wanted) presented_.stream->request_shape();
  make_foxglove(now);
  send_foxglove(now);
}

// They are no longer than a shape or two, and count as one.
void Server::Work::send_weights(Connection& client, HostTime now) {
  const std::uint64_t wanted = client.feed.wanted_weights();
  if (wanted == 0 || client.has_queued_shape()) return;
  SharedBytes message;
  {
    const std::scoped_lock lock(inbox.mutex);
    for (const Weights& some : inbox.weights)
      if (some.number == wanted) message = some.message;
  }
  if (!message) return; // it is not there yet
  client.send(Opcode::binary, message, true, now);
  client.feed.weights_sent(wanted);
  ++counts.weights;
}

void Server::Work::send_frames(Connection& client, const std::optional<FrameStream::Shape>& shape,
                               const SharedBytes& bytes, HostTime now) {
  client.feed.look_at(records_);
  if (!client.accepts_updates()) {
    client.feed.skip(records_);
    counts.skipped += records_.size();
    return;
  }
  send_weights(client, now);
  if (shape && client.feed.wants_shape() && !client.has_queued_shape()) {
    client.send(Opcode::binary, bytes, true, now);
    client.feed.shape_sent(shape->number);
    ++counts.shapes;
    counts.shape_bytes += bytes->size();
  }
  auto update = client.feed.update(records_, presented_.stream->lost());
  if (!update) return;
  ++counts.updates;
  counts.update_bytes += update->size();
  client.send(Opcode::binary, shared_message(*std::move(update)), false, now);
}

void Server::Work::drop_expired(HostTime now) {
  connections_.remove_if([&](const Connection& connection) {
    const bool overdue =
        connection.stage() != Connection::Stage::ended && connection.is_expired(now);
    if (overdue && connection.stage() != Connection::Stage::linger) ++counts.dropped;
    return overdue || connection.stage() == Connection::Stage::ended;
  });
}

} // namespace nendo::web
