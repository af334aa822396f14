// Reads HTTP requests and the messages of WebSockets, and answers them.

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <poll.h>

#include "forms/setting_pictures.hpp"
#include "web/client_commands.hpp"
#include "web/server_work.hpp"
#include "web/skin_message.hpp"

namespace nendo::web {

std::string_view page() noexcept; // which embed.cmake makes from the files in page/

namespace {

std::string_view reason(int status) noexcept {
  constexpr std::pair<int, std::string_view> reasons[] = {{200, "OK"},
                                                          {400, "Bad Request"},
                                                          {403, "Forbidden"},
                                                          {404, "Not Found"},
                                                          {405, "Method Not Allowed"},
                                                          {413, "Content Too Large"},
                                                          {426, "Upgrade Required"},
                                                          {431, "Request Header Fields Too Large"},
                                                          {503, "Service Unavailable"},
                                                          {505, "HTTP Version Not Supported"}};
  for (const auto& [number, text] : reasons)
    if (number == status) return text;
  return {};
}

// The answer is not cached, not shown in another page's frame, and not read by other sites' pages.
std::string answer_head(int status, std::string_view type, std::size_t bytes) {
  return "HTTP/1.1 " + std::to_string(status) + " " + std::string(reason(status)) +
         "\r\nContent-Type: " + std::string(type) + "\r\nContent-Length: " + std::to_string(bytes) +
         "\r\nConnection: close\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff"
         "\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin"
         "\r\nCross-Origin-Opener-Policy: same-origin\r\nX-Frame-Options: DENY\r\n";
}

std::string replaced(std::string_view rest, std::string_view mark, std::string_view by) {
  std::string text;
  while (true) {
    const auto at = rest.find(mark);
    text += rest.substr(0, at);
    if (at == std::string_view::npos) return text;
    text += by;
    rest.remove_prefix(at + mark.size());
  }
}

/// Returns a whole answer with an error status. why: a line for people. allowed: the method of the
/// path, if that is the error.
std::string refusal(int status, std::string_view why, std::string_view allowed) {
  const std::string body = std::string(why) + "\n";
  std::string more = "Content-Security-Policy: default-src 'none'\r\n";
  if (!allowed.empty()) more += "Allow: " + std::string(allowed) + "\r\n";
  if (status == 426) more += "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n";
  return answer_head(status, "text/plain; charset=utf-8", body.size()) + more + "\r\n" + body;
}

constexpr std::string_view binary_type = "application/octet-stream";

/// Only scripts and styles with this nonce run in the page, and it can connect only to the host
/// that it came from.
std::string page_head(std::size_t bytes, std::string_view nonce, std::string_view host) {
  const std::string mark = "'nonce-" + std::string(nonce) + "'";
  // To some browsers 'self' does not include ws:. The host was checked by admit().
  return answer_head(200, "text/html; charset=utf-8", bytes) +
         "Content-Security-Policy: default-src 'none'; script-src " + mark + "; style-src " + mark +
         "; connect-src 'self' ws://" + std::string(host) +
         "; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n";
}

std::string page_with(std::string_view nonce) {
  std::string text(page());
  for (const auto& [mark, by] :
       {std::pair<std::string_view, std::string>{"NENDO-PICTURES", forms::line_pictures_js()},
        {"NENDO-COMMANDS", page_commands()},
        {"NENDO-HINTS", page_hints()},
        {"NENDO-NONCE", std::string(nonce)}})
    text = replaced(text, mark, by);
  return text;
}

} // namespace

void Server::Work::serve(Connection& connection, short events, HostTime now) {
  if ((events & POLLOUT) != 0) connection.resume_sending(now);
  if ((events & (POLLIN | POLLHUP | POLLERR)) == 0 || !connection.receive(now)) return;
  if (connection.stage() == Connection::Stage::head) read_head(connection, now);
  if (connection.has_body()) take_file(connection, now);
  if (connection.stage() == Connection::Stage::socket) read_socket(connection, now);
}

void Server::Work::refuse(Connection& connection, int status, std::string_view why, HostTime now,
                          std::string_view allowed) {
  ++counts.refused;
  connection.answer(refusal(status, why, allowed), nullptr, now);
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
    refuse(connection, admission.status, admission.why, now, admission.allowed);
  } else if (admission.resource == Resource::page) {
    const std::string nonce = random_hex(16);
    const SharedBytes page = shared_bytes(page_with(nonce));
    connection.answer(page_head(page->size(), nonce, *head.request.header("Host")), page, now);
  } else if (admission.resource == Resource::skin) {
    static const SharedBytes skin = std::make_shared<const std::vector<std::byte>>(skin_message());
    connection.answer(answer_head(200, binary_type, skin->size()) + "\r\n", skin, now);
  } else if (admission.resource == Resource::file) {
    begin_file(connection, head, now);
  } else if (!presented_.model) {
    refuse(connection, 503, "the loop has not begun; try again in a second", now);
  } else if (admission.resource == Resource::model) {
    const std::size_t bytes = presented_.model->size();
    connection.answer(answer_head(200, binary_type, bytes) + "\r\n", presented_.model, now);
  } else if (admission.resource == Resource::picture) {
    send_picture(connection, head.request, now);
  } else {
    open_socket(connection, head.request, admission, now);
    connection.incoming().erase(0, head.bytes);
  }
}

// One at a time, so that clients with the token fill no memory.
void Server::Work::begin_file(Connection& connection, const HttpHead& head, HostTime now) {
  const auto name = file_name_in(head.request.parameter("name").value_or(""));
  if (!name) return refuse(connection, 400, "that is no name of a file", now);
  bool is_busy = std::ranges::any_of(connections_, [](const Connection& other) {
    return other.stage() == Connection::Stage::body;
  });
  bool opens = false;
  {
    const std::scoped_lock lock(inbox.mutex);
    opens = inbox.facts[form_fact] != nullptr;
    is_busy = is_busy || inbox.file;
  }
  if (!opens) return refuse(connection, 404, "this run opens no files; nendo studio does", now);
  if (is_busy) return refuse(connection, 503, "another file is coming; try again", now);
  connection.file_name = *name;
  connection.begin_body(head.bytes, head.body_bytes, now);
}

void Server::Work::take_file(Connection& connection, HostTime now) {
  {
    const std::scoped_lock lock(inbox.mutex);
    inbox.file = File{std::move(connection.file_name), std::move(connection.incoming())};
  }
  connection.incoming().clear();
  connection.answer(answer_head(200, "text/plain; charset=utf-8", 0) + "\r\n", nullptr, now);
}

std::shared_ptr<const std::string> Server::Work::picture_of(std::size_t number) const {
  if (number < presented_.pictures.size()) return presented_.pictures[number];
  const auto found = form_pictures_.find(number);
  return found != form_pictures_.end() ? found->second : nullptr;
}

void Server::Work::send_picture(Connection& connection, const HttpRequest& request, HostTime now) {
  const auto number = picture_number(request.parameter("number").value_or(""));
  const auto picture = number ? picture_of(*number) : nullptr;
  if (!picture) {
    refuse(connection, 404, "there is no picture of that number", now);
    return;
  }
  const std::string_view type = picture->starts_with("\x89PNG") ? "image/png" : "image/jpeg";
  connection.answer(answer_head(200, type, picture->size()) + "\r\n", shared_bytes(*picture), now);
}

void Server::Work::open_socket(Connection& connection, const HttpRequest& request,
                               const Admission& admission, HostTime now) {
  if (clients() >= limits_.max_clients) {
    refuse(connection, 503, "so many look already that there is no place", now);
    return;
  }
  const bool is_foxglove = admission.resource == Resource::foxglove;
  std::string head =
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Accept: " +
      accept_of(*request.header("Sec-WebSocket-Key")) + "\r\n";
  if (is_foxglove) {
    connection.foxglove.emplace();
    head.append("Sec-WebSocket-Protocol: ").append(admission.protocol).append("\r\n");
  }
  connection.upgrade(head + "\r\n", now);
  if (is_foxglove) greet_foxglove(connection, now);
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

void Server::Work::handle_input(Connection& connection, const std::string& text, HostTime now) {
  auto input = parse_form_input(text);
  if (!input) return connection.close(CloseCode::policy, now, input.error().message);
  const std::scoped_lock lock(inbox.mutex);
  const auto kind = static_cast<std::size_t>(input->form);
  if (!inbox.facts[form_fact + kind]) return;
  auto& inputs = inbox.inputs[kind];
  // Sliders and the pointer send faster than forms take.
  if (!inputs.empty() && inputs.back().take_in(*input)) return;
  if (inputs.size() < max_inputs) inputs.push_back(*std::move(input));
}

void Server::Work::handle(Connection& connection, const std::string& text, HostTime now) {
  if (!connection.within_message_rate(now)) {
    connection.close(CloseCode::policy, now, "more than 128 messages per second");
    return;
  }
  if (connection.is_foxglove()) {
    handle_foxglove(connection, text, now);
    return;
  }
  if (text.starts_with("form") || text.starts_with("panel"))
    return handle_input(connection, text, now);
  const auto command = parse_command(text);
  if (!command) {
    connection.close(CloseCode::policy, now, command.error().message);
    return;
  }
  if (!commands.try_push(*command)) // the run has stopped
    report("The run does not answer, and what was asked of it is dropped.", true);
}

} // namespace nendo::web
