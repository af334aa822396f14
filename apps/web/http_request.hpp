#pragma once
// A strict parser for the head of an HTTP/1.1 request (RFC 9112), which refuses ambiguous input.
// The result has views into the parsed bytes. Also admits requests, as a defence against pages of
// other sites in the same browser.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nendo::web {

inline constexpr std::size_t max_head_bytes =
    16384; ///< includes the cookies of a host's other ports
inline constexpr std::size_t max_headers = 64;
inline constexpr std::size_t max_file_bytes = std::size_t{128}
                                              << 20; ///< the longest file of POST /open

struct HttpRequest {
  std::string_view method;
  std::string_view path;  ///< the part of the target before "?"
  std::string_view query; ///< the part after it
  std::vector<std::pair<std::string_view, std::string_view>> headers;

  /// Returns the value of a header, by its case-insensitive name; nothing unless there is exactly
  /// one.
  std::optional<std::string_view> header(std::string_view name) const noexcept;
  std::size_t count(std::string_view name) const noexcept; ///< number of headers of that name
  /// Returns whether a header of that name is a comma-separated list that contains the word.
  bool lists(std::string_view name, std::string_view word) const noexcept;
  /// Returns the "x" of "?name=x" in the query; nothing without that name.
  std::optional<std::string_view> parameter(std::string_view name) const noexcept;
};

struct HttpHead {
  /// 0 if the head is incomplete, 200 if it was parsed, otherwise the status of the refusal.
  int status = 0;
  std::size_t bytes = 0; ///< length of a complete head
  HttpRequest request{};
  std::size_t body_bytes = 0; ///< the length of a POST, at most max_file_bytes
};

/// Parses the head of a request. `bytes` must be all bytes that the client has sent so far.
HttpHead parse_head(std::string_view bytes);

enum class Resource { page, model, picture, skin, socket, foxglove, file };

struct Admission {
  int status = 200; ///< 200 if granted, otherwise the status of the refusal
  Resource resource = Resource::page;
  std::string_view why;        ///< the reason of a refusal, in one line for the user
  std::string_view protocol{}; ///< the chosen subprotocol of Resource::foxglove
  std::string_view allowed{};  ///< the method of the path, if `status` is 405
};

/// Grants or refuses a request: a GET, or the POST of a file. Host must be a numeric address or
/// localhost, against DNS rebinding. Origin, if given, must be the same host; but for Foxglove it
/// may be any, because its application is a page of another site, and the token is secret. All
/// resources except the page need
/// `?token=`. A WebSocket request must conform to RFC 6455, section 4.2.1, and one for Foxglove
/// must offer one of foxglove_protocols.
Admission admit(const HttpRequest& request, std::string_view token) noexcept;

/// Returns the name of a file to open, from its percent-encoded form: 1 to 100 bytes without a
/// path, a control character or a "." at the beginning; nothing if it is none.
std::optional<std::string> file_name_in(std::string_view text);

/// Returns whether the host of an authority ("localhost:8080", "[::1]", "192.168.1.5") is a numeric
/// address or localhost. A hostile site can resolve its own name to this machine (DNS rebinding),
/// but none of these.
bool is_address_or_localhost(std::string_view authority);

/// Compares two strings in a time that depends only on their lengths.
bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept;

} // namespace nendo::web
