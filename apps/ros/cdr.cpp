#include "ros/cdr.hpp"

#include "ros/cdr_writer.hpp"

namespace nendo::ros {

void append_cdr(const String& message, std::vector<std::byte>& out) {
  CdrWriter(out).put(std::string_view(message.data));
}

void append_cdr(const JointState& message, std::vector<std::byte>& out) {
  CdrWriter writer(out);
  writer.put(message.header);
  writer.put(message.name);
  writer.put(message.position);
  writer.put(message.velocity);
  writer.put(message.effort);
}

void append_cdr(const TFMessage& message, std::vector<std::byte>& out) {
  CdrWriter(out).put(message.transforms);
}

void append_cdr(const PoseArray& message, std::vector<std::byte>& out) {
  CdrWriter writer(out);
  writer.put(message.header);
  writer.put(message.poses);
}

} // namespace nendo::ros
