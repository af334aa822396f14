#pragma once
// The heads of HTTP answers, with the headers that restrict what a page may do.

#include <string>
#include <string_view>

namespace nendo::web {

/// A whole answer with an error status. why: a line for people.
std::string refusal(int status, std::string_view why);
/// Only scripts and styles with this nonce run in the page, and it connects to no host except the
/// one that it came from. bytes: of the page. host: the request's, which was checked.
std::string page_head(std::size_t bytes, std::string_view nonce, std::string_view host);
std::string model_head(std::size_t bytes);
std::string switching_head(std::string_view accept);

/// The page with the nonce in its place.
std::string page_with(std::string_view nonce);

/// Random bytes from the system in hexadecimal figures; empty if it has none.
std::string random_hex(std::size_t bytes);

} // namespace nendo::web
