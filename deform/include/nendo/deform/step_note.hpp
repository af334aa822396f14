#pragma once
// What a caller notes of a step of the history, for example its name, or the settings before it.

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace nendo::deform {

/// Bytes that mean nothing to this library. It allocates nothing for them.
struct StepNote {
  alignas(8) std::array<std::byte, 192> bytes;

  template <class Value>
  void set(const Value& value) noexcept {
    static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) <= sizeof(StepNote));
    std::memcpy(bytes.data(), &value, sizeof value);
  }
  template <class Value>
  Value get() const noexcept {
    Value value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
};

} // namespace nendo::deform
