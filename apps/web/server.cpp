#include "web/server.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include <sys/eventfd.h>

#include "web/page_commands.hpp"
#include "web/server_work.hpp"
#include "web/web_socket.hpp"
#include "web/wire.hpp"

namespace nendo::web {
namespace {

SharedBytes shared_message(std::vector<std::byte> message) {
  return std::make_shared<const std::vector<std::byte>>(std::move(message));
}

} // namespace

Result<std::unique_ptr<Server>> Server::open(const Endpoint& endpoint, ServerLimits limits) {
  Endpoint where = endpoint;
  auto listener = listen_at(where);
  if (!listener) return listener.error();
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

void Server::present(std::shared_ptr<FrameStream> stream, std::vector<std::byte> model,
                     Pictures pictures) {
  Work::Inbox& inbox = work_->inbox;
  {
    const std::scoped_lock lock(inbox.mutex);
    const std::uint16_t loop = ++inbox.loops;
    std::memcpy(model.data() + offsetof(ModelHead, loop), &loop, sizeof loop);
    inbox.next = Work::Presented{std::move(stream), shared_message(std::move(model)),
                                 std::move(pictures), loop};
  }
  work_->wake();
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

void Server::report(std::string message) {
  work_->report(std::move(message));
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
  set_fact(settings_fact, text_message(MessageType::settings, text_of(settings)));
}

void Server::set_commands(const commands::Situation& now) {
  set_fact(commands_fact, text_message(MessageType::commands, command_states(now)));
}

void Server::set_puppet(std::uint32_t number, const puppet::Rig* rig) {
  set_fact(puppet_fact, number, [&] { return message_of(number, rig); });
}

void Server::set_steps(const flow::StepList& steps) {
  set_fact(history_fact, steps.version, [&] { return message_of(steps); });
}

void Server::set_clay(const flow::Frame& frame) {
  constexpr std::chrono::milliseconds period(33);
  Work::Inbox& inbox = work_->inbox;
  {
    const std::scoped_lock lock(inbox.mutex);
    const HostTime now = HostClock::now();
    const bool is_shown = frame.clay.is_clay || frame.parts.count > 0;
    if ((!inbox.facts[clay_fact] && !is_shown) || now < inbox.next_clay) return;
    inbox.next_clay = now + period;
  }
  set_fact(clay_fact, clay_message(frame));
}

void Server::set_gloves(const GloveStates& gloves) noexcept {
  for (std::size_t slot = 0; slot < gloves.size(); ++slot) {
    Work::SharedGloveState& shared = work_->gloves[slot];
    const auto& [counts, uncalibrated] = gloves[slot];
    shared.delivered = counts.delivered;
    shared.missed = counts.counts_missed ? counts.missed : Work::unknown_count;
    shared.refused = counts.refused;
    shared.bad = counts.bad;
    shared.uncalibrated = uncalibrated;
  }
}

ServerCounters Server::counters() const noexcept {
  const auto& counts = work_->counts;
  return {counts.clients,      counts.accepted, counts.refused,     counts.dropped, counts.updates,
          counts.update_bytes, counts.shapes,   counts.shape_bytes, counts.weights, counts.skipped};
}

} // namespace nendo::web
