#pragma once
// Who gets in. Whatever a browser can be made to do by somebody else's page ends here.

#include <string_view>

#include "http_request.hpp"

namespace nendo::web {

enum class Resource { page, model, socket };

struct Admission {
  int status = 200; ///< otherwise what to refuse it with
  Resource resource = Resource::page;
  std::string_view why; ///< of a refusal, a line for people
};

/// Host must be an address or localhost (DNS rebinding), Origin the same host, if it is said;
/// model and socket need `?token=`. A socket must be asked for as RFC 6455, section 4.2.1 says.
Admission admit(const HttpRequest& request, std::string_view token) noexcept;

/// Takes as long for a text that is nearly the same as for any other of its length.
bool same_secret(std::string_view a, std::string_view b) noexcept;

} // namespace nendo::web
