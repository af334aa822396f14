// What comes in: HTTP requests, and what clients ask for.

#include <poll.h>

#include "web/admission.hpp"
#include "web/answers.hpp"
#include "web/client_commands.hpp"
#include "web/handshake.hpp"
#include "web/pictures.hpp"
#include "web/server_work.hpp"

namespace nendo::web {

void Server::Work::serve(Connection& connection, short events, HostTime now) {
  if ((events & POLLOUT) != 0) connection.resume_sending(now);
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
    connection.await_more();
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
    const std::string nonce = random_hex(16);
    const SharedBytes page = shared_bytes(page_with(nonce));
    connection.answer(page_head(page->size(), nonce, *head.request.header("Host")), page, now);
  } else if (!presented_.model) {
    refuse(connection, 503, "the loop has not begun; try again in a second", now);
  } else if (admission.resource == Resource::model) {
    connection.answer(model_head(presented_.model->size()), presented_.model, now);
  } else if (admission.resource == Resource::picture) {
    send_picture(connection, head.request, now);
  } else {
    open_socket(connection, head.request, now);
    connection.incoming().erase(0, head.bytes);
  }
}

void Server::Work::send_picture(Connection& connection, const HttpRequest& request, HostTime now) {
  const auto number = picture_number(request.parameter("number").value_or(""));
  if (!number || *number >= presented_.pictures.size() || !presented_.pictures[*number]) {
    refuse(connection, 404, "the model has no picture of that number", now);
    return;
  }
  const SharedBytes picture = shared_bytes(*presented_.pictures[*number]);
  connection.answer(picture_head(*presented_.pictures[*number]), picture, now);
}

void Server::Work::open_socket(Connection& connection, const HttpRequest& request, HostTime now) {
  if (clients() >= limits_.max_clients) {
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
  if (!connection.within_message_rate(now)) {
    connection.close(CloseCode::policy, now, "more than 128 messages a second");
    return;
  }
  const auto command = parse_command(text);
  if (!command) {
    connection.close(CloseCode::policy, now, command.error().message);
    return;
  }
  if (!commands.try_push(*command)) // the run stands still
    report("The run does not answer, and what was asked of it is dropped.");
}

} // namespace nendo::web
