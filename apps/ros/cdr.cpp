#include "ros/cdr.hpp"

#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace nendo::ros {
namespace {

class CdrWriter {
public:
  explicit CdrWriter(std::vector<std::byte>& out) : out_(out) {
    for (const unsigned byte : {0U, 1U, 0U, 0U})
      out_.push_back(static_cast<std::byte>(byte));
    begin_ = out_.size();
  }

  template <class T>
    requires std::is_arithmetic_v<T>
  void put(T value) {
    static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");
    const std::size_t at = aligned(sizeof value);
    out_.resize(at + sizeof value);
    std::memcpy(&out_[at], &value, sizeof value);
  }

  void put(std::string_view text) {
    put_count(text.size() + 1);
    const std::size_t at = out_.size();
    out_.resize(at + text.size() + 1); // and a NUL
    std::memcpy(&out_[at], text.data(), text.size());
  }

  template <class T>
  void put(const std::vector<T>& sequence) {
    put_count(sequence.size());
    for (const T& one : sequence)
      put(one);
  }

  void put(const Header& header) {
    put(header.stamp.sec);
    put(header.stamp.nanosec);
    put(std::string_view(header.frame_id));
  }
  void put(const Vector3& vector) {
    for (const double number : {vector.x, vector.y, vector.z})
      put(number);
  }
  void put(const Quaternion& turn) {
    for (const double number : {turn.x, turn.y, turn.z, turn.w})
      put(number);
  }
  void put(const Pose& pose) {
    put(pose.position);
    put(pose.orientation);
  }
  void put(const TransformStamped& stamped) {
    put(stamped.header);
    put(std::string_view(stamped.child_frame_id));
    put(stamped.transform.translation);
    put(stamped.transform.rotation);
  }

private:
  void put_count(std::size_t count) {
    assert(count <= UINT32_MAX);
    put(static_cast<std::uint32_t>(count));
  }
  /// Returns the position of the next number of that size. A resize to it fills with zeros.
  std::size_t aligned(std::size_t bytes) const noexcept {
    return begin_ + (out_.size() - begin_ + bytes - 1) / bytes * bytes;
  }

  std::vector<std::byte>& out_;
  std::size_t begin_;
};

} // namespace

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
