#pragma once
// The heads of HTTP answers, with the headers that restrict what a page may do.

#include <string>
#include <string_view>

namespace nendo::web {

/// Returns a whole answer with an error status. why: a line for people.
std::string refusal(int status, std::string_view why);
/// Returns the head of the answer with the page. Only scripts and styles with this nonce run in the
/// page, and it can connect only to the host that it came from. bytes: the length of the page.
/// host: that of the request, which must have been checked.
std::string page_head(std::size_t bytes, std::string_view nonce, std::string_view host);
std::string model_head(std::size_t bytes);
/// Returns the head of the answer with that picture , PNG or JPEG.
std::string picture_head(std::string_view picture);
std::string switching_head(std::string_view accept);

/// Returns the page with the nonce in its place.
std::string page_with(std::string_view nonce);

/// Returns random bytes from the system in hexadecimal digits, or an empty text if the system has
/// none.
std::string random_hex(std::size_t bytes);

} // namespace nendo::web
