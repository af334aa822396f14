// What comes in: requests, and what clients say.

#include <poll.h>

#include "admission.hpp"
#include "answers.hpp"
#include "client_words.hpp"
#include "handshake.hpp"
#include "server_work.hpp"

namespace nendo::web {

void Server::Work::look_at(Connection& connection, short events, HostTime now) {
  if ((events & POLLOUT) != 0) connection.send_on(now);
  if ((events & (POLLIN | POLLHUP | POLLERR)) == 0 || !connection.receive(now)) return;
  if (connection.stage() == Connection::Stage::head) read_head(connection, now);
  if (connection.stage() == Connection::Stage::socket) read_socket(connection, now);
}

void Server::Work::refuse(Connection& connection, int status, std::string_view why, HostTime now) {
  ++counts.refused;
  connection.answer(refusal(status, why), nullptr, now);
}

void Server::Work::read_head(Connection& connection, HostTime now) {
  const HttpHead head = parse_head(connection.incoming());
  if (head.status == 0) {
    connection.await_rest();
    return;
  }
  if (head.status != 200) {
    refuse(connection, head.status, "that is no request for this server", now);
    return;
  }
  const Admission admission = admit(head.request, token);
  if (admission.status != 200) {
    refuse(connection, admission.status, admission.why, now);
  } else if (admission.resource == Resource::page) {
    const std::string nonce = random_figures(16);
    const SharedBytes page = shared_bytes(page_with(nonce));
    connection.answer(page_head(page->size(), nonce, *head.request.header("Host")), page, now);
  } else if (!show_.model) {
    refuse(connection, 503, "the loop has not begun; try again in a second", now);
  } else if (admission.resource == Resource::model) {
    connection.answer(model_head(show_.model->size()), show_.model, now);
  } else {
    open_socket(connection, head.request, now);
    connection.incoming().erase(0, head.bytes);
  }
}

void Server::Work::open_socket(Connection& connection, const HttpRequest& request, HostTime now) {
  if (clients() >= limits_.clients) {
    refuse(connection, 503, "so many look already that there is no place", now);
    return;
  }
  connection.upgrade(switching_head(accept_of(*request.header("Sec-WebSocket-Key"))), now);
}

void Server::Work::read_socket(Connection& connection, HostTime now) {
  using Kind = ClientEvent::Kind;
  while (connection.stage() == Connection::Stage::socket) {
    const ClientEvent event = connection.reader.next(connection.incoming());
    if (event.kind == Kind::nothing) return;
    if (event.kind == Kind::ping)
      connection.send_control(control_frame(Opcode::pong, event.payload), now);
    if (event.kind == Kind::close) connection.close(CloseCode::normal, now);
    if (event.kind == Kind::fault) connection.close(event.code, now);
    if (event.kind == Kind::binary) connection.close(CloseCode::unsupported, now);
    if (event.kind == Kind::text) handle(connection, event.payload, now);
  }
}

void Server::Work::handle(Connection& connection, const std::string& text, HostTime now) {
  const auto wish = connection.may_speak(now) ? parse_words(text) : std::nullopt;
  if (!wish) {
    connection.close(CloseCode::policy, now);
    return;
  }
  // Full: the loop stands still, and asking again is as good.
  if (const auto* request = std::get_if<flow::Request>(&*wish)) requests.try_push(*request);
  if (const auto* change = std::get_if<flow::LoopChange>(&*wish)) changes.try_push(*change);
  if (const auto* wanted = std::get_if<flow::SaveRequest>(&*wish)) save_request.try_push(*wanted);
  if (const auto* move = std::get_if<flow::WristMove>(&*wish)) {
    auto& wrist = wrists[flow::Placement::index_of(move->side)];
    wrist.back() = *move;
    wrist.publish();
  }
}

} // namespace nendo::web
