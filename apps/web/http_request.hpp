#pragma once
// A strict parser for the head of an HTTP/1.1 request (RFC 9112). It refuses all that can be read
// in two ways. The result consists of views into the bytes that were parsed. And the decision which
// requests are granted: the defence against pages of other sites in the same browser.

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace nendo::web {

inline constexpr std::size_t max_head_bytes =
    16384; ///< includes the cookies of a host's other ports
inline constexpr std::size_t max_headers = 64;

struct HttpRequest {
  std::string_view method;
  std::string_view path;  ///< the part of the target before "?"
  std::string_view query; ///< the part after it
  std::vector<std::pair<std::string_view, std::string_view>> headers;

  /// Returns the value of a header, whose name is compared without regard to case. Returns nothing
  /// if there is no such header or more than one.
  std::optional<std::string_view> header(std::string_view name) const noexcept;
  std::size_t count(std::string_view name) const noexcept; ///< number of headers of that name
  /// Returns whether one of the headers of that name is a comma-separated list with that word in
  /// it.
  bool lists(std::string_view name, std::string_view word) const noexcept;
  /// Returns the "x" of "?name=x" in the query, or nothing if that name is not there.
  std::optional<std::string_view> parameter(std::string_view name) const noexcept;
};

struct HttpHead {
  /// 0 if the head is incomplete, 200 if it was parsed, otherwise the status of the refusal.
  int status = 0;
  std::size_t bytes = 0; ///< length of a complete head
  HttpRequest request{};
};

/// Parses the head of a request. `bytes` must be everything that the client has sent so far.
HttpHead parse_head(std::string_view bytes);

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
