#pragma once
// The head of an HTTP/1.1 request (RFC 9112), strictly: a server that guesses what was meant can be
// talked into a misunderstanding. Pure: bytes in, views into them out.

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace nendo::web {

inline constexpr std::size_t most_head_bytes = 16384; ///< browsers send cookies of other ports, too
inline constexpr std::size_t most_headers = 64;

struct HttpRequest {
  std::string_view method;
  std::string_view path;  ///< of the target, before "?"
  std::string_view query; ///< after it
  std::vector<std::pair<std::string_view, std::string_view>> headers;

  /// By its name, whatever the case of its letters. Nothing if there is none, or several.
  std::optional<std::string_view> header(std::string_view name) const noexcept;
  std::size_t count(std::string_view name) const noexcept;
  /// Whether the header is a list in which that word stands.
  bool lists(std::string_view name, std::string_view word) const noexcept;
  /// "x" of "?name=x"; nothing if it is not there.
  std::optional<std::string_view> parameter(std::string_view name) const noexcept;
};

/// Without regard to the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b) noexcept;

struct HttpHead {
  /// 0: the head is not complete; 200: it is; otherwise what to refuse it with.
  int status = 0;
  std::size_t bytes = 0; ///< how long a complete head is
  HttpRequest request{}; ///< views into the bytes
};

/// Of all bytes that have come so far.
HttpHead parse_head(std::string_view bytes);

} // namespace nendo::web
