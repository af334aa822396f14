#pragma once
// Appends the parts of messages in CDR (cdr.hpp). Only for sources of this module.

#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ros/messages.hpp"

namespace nendo::ros {

/// Writes the head of a message, and then its members in their order.
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
    put_numbers(&value, sizeof value, sizeof value);
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
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, Vector3>) {
      if (!sequence.empty())
        put_numbers(sequence.data(), sequence.size() * sizeof(T), number_bytes<T>);
    } else {
      for (const T& one : sequence)
        put(one);
    }
  }
  /// A sequence without an element: no number follows the count, so there is nothing to align.
  void put_none() { put_count(0); }

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
  template <class T>
  static constexpr std::size_t number_bytes = std::is_arithmetic_v<T> ? sizeof(T) : sizeof(double);
  static_assert(sizeof(Vector3) == 3 * sizeof(double));

  void put_numbers(const void* numbers, std::size_t bytes, std::size_t bytes_each) {
    static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");
    const std::size_t at = aligned(bytes_each);
    out_.resize(at + bytes);
    std::memcpy(&out_[at], numbers, bytes);
  }
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

} // namespace nendo::ros
