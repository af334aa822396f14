#include "web/http_request.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <nendo/base/endings.hpp>
#include <nendo/base/endpoint.hpp>
#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

#include "web/foxglove_words.hpp"
#include "web/web_socket.hpp"

namespace nendo::web {
namespace {

// Letters of ASCII alone.
bool equal_ignoring_case(std::string_view a, std::string_view b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return to_lower(x) == to_lower(y); });
}

// RFC 9110, section 5.6.2.
bool is_token(std::string_view text) noexcept {
  constexpr std::string_view marks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    const char l = to_lower(c);
    return (l >= 'a' && l <= 'z') || (c >= '0' && c <= '9') ||
           marks.find(c) != std::string_view::npos;
  });
}

bool is_visible(char c) noexcept {
  return c > ' ' && c < '\x7F';
}

// No control characters except the tab. Bytes above ASCII are passed on as they are.
bool is_value(std::string_view text) noexcept {
  return std::none_of(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7F';
  });
}

// Space and tab alone are optional white space (RFC 9110, section 5.6.3). is_value() must see all
// other control characters, which nendo::trimmed() would remove.
std::string_view without_blanks(std::string_view text) noexcept {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// The line before the next CR LF, taken off `rest`.
std::string_view take_line(std::string_view& rest) noexcept {
  const auto end = rest.find("\r\n");
  const auto line = rest.substr(0, end);
  rest.remove_prefix(end + 2);
  return line;
}

int parse_first_line(std::string_view line, HttpRequest& request) {
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return 400;
  request.method = line.substr(0, first);
  const auto target = line.substr(first + 1, last - first - 1);
  const auto version = line.substr(last + 1);
  if (!is_token(request.method) || !std::all_of(target.begin(), target.end(), is_visible) ||
      !target.starts_with('/'))
    return 400;
  if (version != "HTTP/1.1") return version.starts_with("HTTP/") ? 505 : 400;
  request.query = target;
  request.path = cut(request.query, '?');
  return 200;
}

int parse_headers(std::string_view rest, HttpRequest& request) {
  while (!rest.empty()) {
    const auto line = take_line(rest);
    const auto colon = line.find(':');
    if (colon == std::string_view::npos) return 400;
    const auto name = line.substr(0, colon);
    const auto value = without_blanks(line.substr(colon + 1));
    // Lines that begin with a space (the obsolete folding of headers) have no valid name, either.
    if (!is_token(name) || !is_value(value)) return 400;
    if (request.headers.size() == max_headers) return 431;
    request.headers.emplace_back(name, value);
  }
  return 200;
}

// Only a POST may have a body, whose length is one number, so that no body is ever taken for a
// second request.
int parse_body(HttpHead& head) noexcept {
  const HttpRequest& request = head.request;
  if (request.count("Transfer-Encoding") > 0) return 413;
  if (request.count("Content-Length") == 0) return 200;
  const auto length = request.header("Content-Length");
  const auto bytes = length ? number_in<std::size_t>(*length) : std::nullopt;
  if (request.method != "POST") return bytes == 0 ? 200 : 413;
  if (!bytes) return 400;
  head.body_bytes = *bytes;
  return head.body_bytes <= max_file_bytes ? 200 : 413;
}

Admission refuse(int status, std::string_view why) noexcept {
  return {status, Resource::page, why};
}

bool is_same_origin(std::string_view origin, std::string_view host) noexcept {
  constexpr std::string_view scheme = "http://";
  return origin.starts_with(scheme) && equal_ignoring_case(origin.substr(scheme.size()), host);
}

Admission admit_socket(const HttpRequest& request) noexcept {
  const bool asks = request.lists("Upgrade", "websocket") && request.lists("Connection", "upgrade");
  if (!asks || request.header("Sec-WebSocket-Version") != "13")
    return refuse(426, "this is a WebSocket, version 13");
  const auto key = request.header("Sec-WebSocket-Key");
  if (!key || !is_socket_key(*key)) return refuse(400, "Sec-WebSocket-Key is not one");
  return {200, Resource::socket, {}};
}

Admission admit_foxglove(const HttpRequest& request) noexcept {
  Admission admission = admit_socket(request);
  if (admission.status != 200) return admission;
  admission.resource = Resource::foxglove;
  for (const std::string_view protocol : foxglove_protocols) {
    if (!request.lists("Sec-WebSocket-Protocol", protocol)) continue;
    admission.protocol = protocol;
    return admission;
  }
  return refuse(400, "the subprotocol is foxglove.sdk.v1 or foxglove.websocket.v1");
}

} // namespace

std::size_t HttpRequest::count(std::string_view name) const noexcept {
  return static_cast<std::size_t>(std::count_if(headers.begin(), headers.end(), [&](const auto& h) {
    return equal_ignoring_case(h.first, name);
  }));
}

std::optional<std::string_view> HttpRequest::header(std::string_view name) const noexcept {
  if (count(name) != 1) return std::nullopt;
  return std::find_if(headers.begin(), headers.end(),
                      [&](const auto& h) { return equal_ignoring_case(h.first, name); })
      ->second;
}

bool HttpRequest::lists(std::string_view name, std::string_view word) const noexcept {
  for (const auto& [key, value] : headers) {
    if (!equal_ignoring_case(key, name)) continue;
    for (std::string_view rest = value; !rest.empty();)
      if (equal_ignoring_case(without_blanks(cut(rest, ',')), word)) return true;
  }
  return false;
}

std::optional<std::string_view> HttpRequest::parameter(std::string_view name) const noexcept {
  for (std::string_view rest = query; !rest.empty();) {
    std::string_view value = cut(rest, '&');
    if (value.find('=') != std::string_view::npos && cut(value, '=') == name) return value;
  }
  return std::nullopt;
}

HttpHead parse_head(std::string_view bytes) {
  const auto end = bytes.substr(0, max_head_bytes).find("\r\n\r\n");
  if (end == std::string_view::npos) return {bytes.size() >= max_head_bytes ? 431 : 0, 0, {}};
  HttpHead head{200, end + 4, {}};
  std::string_view rest = bytes.substr(0, end + 2);
  head.status = parse_first_line(take_line(rest), head.request);
  if (head.status == 200) head.status = parse_headers(rest, head.request);
  if (head.status == 200) head.status = parse_body(head);
  return head;
}

std::optional<std::string> file_name_in(std::string_view text) {
  constexpr std::size_t max_bytes = 100;
  const auto digit = [](char c) {
    constexpr std::string_view digits = "0123456789abcdef";
    return digits.find(to_lower(c));
  };
  std::string name;
  for (std::size_t at = 0; at < text.size(); ++at) {
    char letter = text[at];
    if (letter == '%') {
      if (at + 2 >= text.size()) return std::nullopt;
      const std::size_t high = digit(text[at + 1]), low = digit(text[at + 2]);
      if (high > 15 || low > 15) return std::nullopt;
      letter = static_cast<char>(16 * high + low);
      at += 2;
    }
    if (static_cast<unsigned char>(letter) < ' ' || letter == '\x7F' || letter == '/')
      return std::nullopt;
    name += letter;
  }
  if (name.empty() || name.size() > max_bytes || name.front() == '.') return std::nullopt;
  return name;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t at = 0; at < a.size(); ++at)
    different |= static_cast<unsigned>(a[at]) ^ static_cast<unsigned>(b[at]);
  return different == 0;
}

bool is_address_or_localhost(std::string_view authority) {
  static constexpr std::string_view localhost = "localhost:";
  const auto is_one_with_port = [](std::string_view text) {
    if (text.starts_with(localhost))
      return number_in<std::uint16_t>(text.substr(localhost.size())).has_value();
    return text.find(':') != std::string_view::npos && bool(parse_endpoint(text, 0));
  };
  return is_one_with_port(authority) || is_one_with_port(std::string(authority) + ":80");
}

Admission admit(const HttpRequest& request, std::string_view token) noexcept {
  const std::string_view allowed = request.path == "/open" ? "POST" : "GET";
  if (request.method != allowed)
    return {405, Resource::page, "GET is all that there is, but for POST /open", {}, allowed};
  const auto host = request.header("Host");
  if (!host) return refuse(400, "one Host is needed");
  if (!is_address_or_localhost(*host))
    return refuse(403, "use the machine's address in figures, or localhost, not a name");
  const auto origin = request.header("Origin");
  const bool is_foxglove = request.path == "/foxglove";
  if (!is_foxglove && request.count("Origin") > 0 && !(origin && is_same_origin(*origin, *host)))
    return refuse(403, "this is no other page's to use");
  if (request.path == "/") return {200, Resource::page, {}};
  constexpr std::array<std::pair<std::string_view, Resource>, 6> resources{
      {{"/model", Resource::model},
       {"/picture", Resource::picture},
       {"/skin", Resource::skin},
       {"/ws", Resource::socket},
       {"/foxglove", Resource::foxglove},
       {"/open", Resource::file}}};
  const auto* const found =
      std::find_if(resources.begin(), resources.end(),
                   [&](const auto& resource) { return resource.first == request.path; });
  if (found == resources.end()) return refuse(404, "nothing of that name");
  const auto given = request.parameter("token");
  if (!given || !equal_in_constant_time(*given, token))
    return refuse(403, "the token is another one: use the whole address that nendo printed");
  if (found->second == Resource::socket) return admit_socket(request);
  if (is_foxglove) return admit_foxglove(request);
  return {200, found->second, {}};
}

} // namespace nendo::web
