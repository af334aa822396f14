#include "web/admission.hpp"

#include "web/endpoint.hpp"
#include "web/handshake.hpp"

namespace nendo::web {
namespace {

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

} // namespace

bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t at = 0; at < a.size(); ++at)
    different |= static_cast<unsigned>(a[at]) ^ static_cast<unsigned>(b[at]);
  return different == 0;
}

Admission admit(const HttpRequest& request, std::string_view token) noexcept {
  if (request.method != "GET") return refuse(405, "GET is all that there is");
  const auto host = request.header("Host");
  if (!host) return refuse(400, "one Host is needed");
  if (!is_address_or_localhost(*host))
    return refuse(403, "use the machine's address in figures, or localhost, not a name");
  const auto origin = request.header("Origin");
  if (request.count("Origin") > 0 && !(origin && is_same_origin(*origin, *host)))
    return refuse(403, "this is no other page's to use");
  if (request.path == "/") return {200, Resource::page, {}};
  if (request.path != "/model" && request.path != "/picture" && request.path != "/ws")
    return refuse(404, "nothing of that name");
  const auto given = request.parameter("token");
  if (!given || !equal_in_constant_time(*given, token))
    return refuse(403, "the token is another one: use the whole address that nendo printed");
  if (request.path == "/ws") return admit_socket(request);
  return {200, request.path == "/model" ? Resource::model : Resource::picture, {}};
}

} // namespace nendo::web
