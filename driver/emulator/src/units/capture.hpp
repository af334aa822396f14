#pragma once
// Records cut out of a file of bytes that a host received from a CyberGlove.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "units/unit_message.hpp"

namespace nendo::emulator {

/// The records of 8 bits a value, and the text ones: what begins with a record's letter and ends at
/// the next NUL, which occurs nowhere else in a record. Replies and what is too long for a record
/// are left out. Pure.
std::vector<unit::Message> cut_records(std::span<const std::byte> bytes);

/// Errors: bad_input, if the file cannot be read, is larger than 64 MiB or holds no record.
Result<std::vector<unit::Message>> read_capture(const std::string& path);

} // namespace nendo::emulator
