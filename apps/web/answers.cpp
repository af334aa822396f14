#include "web/answers.hpp"

#include <utility>
#include <vector>

#include <sys/random.h>

#include "web/page.hpp"
#include "web/page_commands.hpp"
#include "web/pictures.hpp"

namespace nendo::web {
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
std::string head_of(int status, std::string_view type, std::size_t bytes) {
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

} // namespace

std::string refusal(int status, std::string_view why) {
  const std::string body = std::string(why) + "\n";
  std::string more = "Content-Security-Policy: default-src 'none'\r\n";
  if (status == 405) more += "Allow: GET\r\n";
  if (status == 426) more += "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n";
  return head_of(status, "text/plain; charset=utf-8", body.size()) + more + "\r\n" + body;
}

std::string page_head(std::size_t bytes, std::string_view nonce, std::string_view host) {
  const std::string mark = "'nonce-" + std::string(nonce) + "'";
  // To some browsers 'self' does not include ws:. The host was checked by admit().
  return head_of(200, "text/html; charset=utf-8", bytes) +
         "Content-Security-Policy: default-src 'none'; script-src " + mark + "; style-src " + mark +
         "; connect-src 'self' ws://" + std::string(host) +
         "; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n";
}

std::string model_head(std::size_t bytes) {
  return head_of(200, "application/octet-stream", bytes) + "\r\n";
}

std::string picture_head(std::string_view picture) {
  return head_of(200, is_png(picture) ? "image/png" : "image/jpeg", picture.size()) + "\r\n";
}

std::string switching_head(std::string_view accept) {
  return "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
         "Sec-WebSocket-Accept: " +
         std::string(accept) + "\r\n\r\n";
}

std::string page_with(std::string_view nonce) {
  const std::string settled = replaced(page(), settings_mark, page_settings());
  return replaced(replaced(settled, commands_mark, page_commands()), nonce_mark, nonce);
}

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return {};
  constexpr std::string_view figures = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : random) {
    text += figures[byte >> 4U];
    text += figures[byte & 15U];
  }
  return text;
}

} // namespace nendo::web
