#pragma once
// Which requests are granted. This is the defence against pages of other sites in the same browser.

#include <string_view>

#include "http_request.hpp"

namespace nendo::web {

enum class Resource { page, model, socket };

struct Admission {
  int status = 200; ///< 200: granted. Otherwise: the status to refuse it with
  Resource resource = Resource::page;
  std::string_view why; ///< of a refusal; a line for people
};

/// Host must be an address in figures or localhost, against DNS rebinding. Origin, if there is one,
/// must be the same host. The model and the WebSocket need `?token=`. The request for a WebSocket
/// must be as RFC 6455, section 4.2.1, says.
Admission admit(const HttpRequest& request, std::string_view token) noexcept;

/// Compares two texts in a time that depends on their lengths only.
bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept;

} // namespace nendo::web
