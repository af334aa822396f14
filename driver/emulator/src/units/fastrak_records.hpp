#pragma once
// The data records of an emulated FASTRAK.

#include <cstddef>
#include <optional>
#include <span>

#include "units/fastrak_settings.hpp"
#include "units/unit_message.hpp"

namespace nendo::emulator::fastrak {

/// Bytes before the items: the record's type, the station, the error letter.
inline constexpr std::size_t header_bytes = 3;
inline constexpr std::size_t max_items = 32;
inline constexpr std::size_t max_record_bytes = 254;

/// Returns the bytes of an item of the output list; nothing if there is no such item.
std::optional<std::size_t> item_bytes(unsigned item, bool binary) noexcept;

/// The content of a record.
struct RecordContent {
  std::size_t station = 0; ///< from 0
  char error = ' ';
  StationPose pose; ///< as the unit reports it
  bool button = false;
};

/// Returns the record with these items. `unit_cm` is the length of the unit of positions.
unit::Message data_record(const RecordContent& content, std::span<const unsigned> items,
                          bool binary, double unit_cm);

} // namespace nendo::emulator::fastrak
