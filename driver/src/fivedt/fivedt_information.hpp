#pragma once
// What a 5DT Data Glove 5 says of itself. Pure, like the parser.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <nendo/driver/sample.hpp>

#include "fivedt/fivedt_protocol.hpp"

namespace nendo::driver::fivedt {

struct Information {
  Side side = Side::right;
  std::uint8_t version_major = 0;
  std::uint8_t version_minor = 0;
  bool tilt_sensor = false;
  std::string name; ///< printable, without blanks at its ends; may be empty
};

/// Returns nullopt if the answer does not begin as it must.
std::optional<Information> decode_information(std::span<const std::byte, information_bytes> answer);

/// Finds the answer in a glove's bytes, cut anywhere. A sample or another answer may stand before
/// it.
class InformationFinder {
public:
  /// Takes the next bytes. Returns true once the whole answer was seen; later bytes are ignored.
  bool push(std::span<const std::byte> chunk) noexcept;
  std::span<const std::byte, information_bytes> answer() const noexcept { return answer_; }

private:
  std::array<std::byte, information_bytes> answer_{};
  std::size_t held_ = 0;
};

} // namespace nendo::driver::fivedt
