#pragma once
// Encodes messages as ROS 2 does on the wire and in files: CDR, version 1 (OMG DDSI-RTPS 2.5,
// section 10, and CORBA 3.3, section 9.3), little-endian.

#include <cstddef>
#include <vector>

#include "ros/messages.hpp"

namespace nendo::ros {

/// Append the message to `out`, with the four bytes 00 01 00 00 before it, which name the
/// encoding. Alignment counts from the first byte after these four, so `out` may have any length
/// before. Strings of more than 4 GiB are a caller's mistake. Allocates only to enlarge `out`.
void append_cdr(const String& message, std::vector<std::byte>& out);
void append_cdr(const JointState& message, std::vector<std::byte>& out);
void append_cdr(const TFMessage& message, std::vector<std::byte>& out);
void append_cdr(const PoseArray& message, std::vector<std::byte>& out);

} // namespace nendo::ros
