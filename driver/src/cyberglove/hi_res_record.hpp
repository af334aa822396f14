#pragma once
// The layout of the CyberGlove III's high-resolution record (cyberglove_protocol.hpp). Pure.

#include <cstddef>
#include <span>

#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

/// Returns whether the last of `bytes`, at most hi_res_bytes, may stand where it does. The others
/// must have been found right.
bool continues_hi_res(std::span<const std::byte> bytes) noexcept;

/// Returns whether a record may begin with all of `bytes`, which are fewer than hi_res_bytes.
bool begins_hi_res(std::span<const std::byte> bytes) noexcept;

/// Returns the content of a whole record, for which continues_hi_res() was true at every byte.
Record read_hi_res(std::span<const std::byte> frame) noexcept;

} // namespace nendo::driver::cyberglove
