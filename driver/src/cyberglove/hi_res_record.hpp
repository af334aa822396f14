#pragma once
// The layout of the CyberGlove III's high-resolution record (cyberglove_protocol.hpp). Pure.

#include <cstddef>
#include <span>

#include "cyberglove/cyberglove_parser.hpp"

namespace nendo::driver::cyberglove {

/// May the last of `bytes` stand where it does, all others being right already? At most
/// hi_res_bytes.
bool continues_hi_res(std::span<const std::byte> bytes) noexcept;

/// May a record begin with all of `bytes`, which are fewer than hi_res_bytes?
bool begins_hi_res(std::span<const std::byte> bytes) noexcept;

/// The content of a whole record, for which continues_hi_res() held at every byte.
Record read_hi_res(std::span<const std::byte> frame) noexcept;

} // namespace nendo::driver::cyberglove
