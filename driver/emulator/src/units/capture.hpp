#pragma once
// Cuts records out of a file of bytes that a host received from a CyberGlove.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

#include "units/unit_message.hpp"

namespace nendo::emulator {

/// Returns the records of 8 bits a value and those in text. A record begins with its letter and
/// ends at the next NUL, which occurs nowhere else in it. Replies, and pieces that are too long for
/// a record, are left out. Pure.
std::vector<unit::Message> cut_records(std::span<const std::byte> bytes);

/// Reads a file and returns its records. Error: bad_input, if the file cannot be read, is larger
/// than 64 MiB or holds no record.
Result<std::vector<unit::Message>> read_capture(const std::string& path);

} // namespace nendo::emulator
