#include "web/server.hpp"

#include <utility>

#include <sys/eventfd.h>

#include "web/answers.hpp"
#include "web/listener.hpp"
#include "web/page_commands.hpp"
#include "web/server_work.hpp"
#include "web/wire.hpp"

namespace nendo::web {

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
  work_->present(std::move(stream), std::move(model), std::move(pictures));
}

void Server::add_weights(std::uint64_t number, std::vector<std::byte> message) {
  work_->add_weights(number, std::move(message));
}

std::optional<ClientCommand> Server::next_command() noexcept {
  ClientCommand command;
  if (work_->commands.size() == 0 || !work_->commands.try_pop(command)) return std::nullopt;
  return command;
}

void Server::report(std::string message) {
  work_->report(std::move(message));
}

void Server::set_settings(const flow::LoopSettings& settings) {
  work_->set_fact(settings_fact, text_message(MessageType::settings, text_of(settings)));
}

void Server::set_commands(const commands::Situation& now) {
  work_->set_fact(commands_fact, text_message(MessageType::commands, command_states(now)));
}

void Server::set_puppet(std::uint32_t number, const puppet::Rig* rig) {
  work_->set_fact(puppet_fact, number, [&] { return message_of(number, rig); });
}

void Server::set_clay(const flow::Frame& frame) {
  work_->set_clay(frame);
}

void Server::set_steps(const flow::StepList& steps) {
  work_->set_fact(history_fact, steps.version, [&] { return message_of(steps); });
}

void Server::set_gloves(const GloveStates& gloves) noexcept {
  for (std::size_t slot = 0; slot < gloves.size(); ++slot) {
    Work::SharedGloveState& shared = work_->gloves[slot];
    const auto& [counts, uncalibrated] = gloves[slot];
    shared.delivered = counts.delivered;
    shared.missed = counts.tells_missed ? counts.missed : Work::unknown_count;
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
