#pragma once
// Heads of HTTP answers, with what keeps a page in its place.

#include <string>
#include <string_view>

namespace nendo::web {

/// An error, with a line that says why.
std::string refusal(int status, std::string_view why);
/// Of the page: nothing but what stands in it with this nonce runs, and it speaks to nobody but
/// the host that it came from.
std::string page_head(std::size_t bytes, std::string_view nonce, std::string_view host);
std::string model_head(std::size_t bytes);
std::string switching_head(std::string_view accept);

/// The page with the nonce where it belongs.
std::string page_with(std::string_view nonce);

/// So many random bytes of the system's in hexadecimal figures; empty if it has none.
std::string random_figures(std::size_t bytes);

} // namespace nendo::web
