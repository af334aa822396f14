#pragma once
// The data records of an emulated Flock of Birds.

#include <optional>

#include "units/rotation.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator::flock {

/// A receiver's pose, in inches, in the transmitter's axes.
struct ReceiverInches {
  Vector3 position_in{};
  Rotation attitude = no_rotation; ///< turns vectors of the receiver into those of the transmitter
};

/// Whether `letter` is a command that chooses the content of records: V W X Y Z \ ].
bool is_format(unit::Byte letter) noexcept;

/// Returns the values of a record in this format, two bytes each. Bit 7 is set in the first one.
unit::Message record_values(unit::Byte format, const ReceiverInches& pose, double range_in);

} // namespace nendo::emulator::flock
