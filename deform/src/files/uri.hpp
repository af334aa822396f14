#pragma once
// The URIs of glTF: relative names with %XX (RFC 3986), and data in base64 (RFC 2397, RFC 4648).

#include <optional>
#include <string>
#include <string_view>

namespace nendo::deform {

/// Returns the text with the bytes that %XX stands for. A % without two digits stays.
std::string percent_decoded(std::string_view uri);

bool is_data_uri(std::string_view uri) noexcept;
/// Returns the data of a data URI in base64, or nothing if it is damaged.
std::optional<std::string> data_of_uri(std::string_view uri);

/// Returns a URI for a message: printable, and cut after 40 characters.
std::string printable_uri(std::string_view uri);

} // namespace nendo::deform
