#pragma once
// Decides which requests are granted. This is the defence against pages of other sites in the same
// browser.

#include <string_view>

#include "web/http_request.hpp"

namespace nendo::web {

enum class Resource { page, model, picture, socket };

struct Admission {
  int status = 200; ///< 200 if granted, otherwise the status of the refusal
  Resource resource = Resource::page;
  std::string_view why; ///< the reason of a refusal; a line for people
};

/// Decides about a request. Host must be a numeric address or localhost, against DNS rebinding.
/// Origin, if there is one, must be the same host. All but the page need `?token=`. The
/// request for a WebSocket must conform to RFC 6455, section 4.2.1.
Admission admit(const HttpRequest& request, std::string_view token) noexcept;

/// Compares two strings in a time that depends on their lengths only.
bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept;

} // namespace nendo::web
