// The part of the server for applications that use Foxglove's protocol (FOXGLOVE.md). They only
// look; no message of theirs reaches the run.

#include <chrono>
#include <string>
#include <utility>

#include <nendo/base/utc.hpp>
#include <nendo/version.hpp>

#include "web/server_work.hpp"

namespace nendo::web {
namespace {

/// A message has the whole model, so it is sent less often than the hands.
constexpr std::chrono::milliseconds drawn_period(200);

} // namespace

void Server::Work::send_text(Connection& connection, const std::string& text, HostTime now) {
  connection.send(Opcode::text, shared_bytes(text), false, now);
}

void Server::Work::begin_foxglove(HostTime now) {
  foxglove_.begin(*presented_.model, utc_ns(now));
}

void Server::Work::greet_foxglove(Connection& connection, HostTime now) {
  const std::string session = session_ + "-" + std::to_string(presented_.loop);
  send_text(connection, foxglove_server_info("Nendo " NENDO_VERSION, session), now);
  send_text(connection, foxglove_advertisement(foxglove_.channels()), now);
}

void Server::Work::handle_foxglove(Connection& connection, const std::string& text, HostTime now) {
  const auto request = parse_foxglove(text);
  if (!request) {
    connection.close(CloseCode::policy, now, request.error().message);
    return;
  }
  for (const std::string& warning : connection.foxglove->take(*request, foxglove_))
    if (connection.accepts_updates()) send_text(connection, foxglove_warning(warning), now);
}

/// Makes the messages that clients have subscribed to.
void Server::Work::make_foxglove(HostTime now) {
  bool hands_wanted = false, model_wanted = false;
  for (const Connection& client : connections_) {
    if (!client.is_foxglove()) continue;
    hands_wanted = hands_wanted || client.foxglove->has_hands();
    model_wanted = model_wanted || client.foxglove->has(FoxgloveTopic::model);
  }
  FrameStream& stream = *presented_.stream;
  stream.set_hands_active(hands_wanted);
  if (const FrameStream::Hands* const hands = stream.take_hands())
    foxglove_.set_hands(hands->present.all(), utc_ns(hands->woke));
  if (const auto woke = stream.take_drawn(drawn_)) foxglove_.set_shape(drawn_, utc_ns(*woke));
  if (!model_wanted || now < next_drawn_) return;
  next_drawn_ = now + drawn_period;
  stream.request_drawn();
}

void Server::Work::send_foxglove(HostTime now) {
  for (Connection& client : connections_) {
    if (!client.is_foxglove()) continue;
    client.keep_alive(now);
    while (client.accepts_updates()) { // others get the newest messages when their queue is empty
      const auto due = client.foxglove->next_due(foxglove_, !client.has_queued_shape());
      if (!due) break;
      auto message = std::make_shared<const std::vector<std::byte>>(
          foxglove_.message(due->topic, due->subscription));
      ++counts.updates;
      counts.update_bytes += message->size();
      client.send(Opcode::binary, message, due->topic == FoxgloveTopic::model, now);
    }
  }
}

} // namespace nendo::web
