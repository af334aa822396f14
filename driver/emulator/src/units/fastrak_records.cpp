#include "units/fastrak_records.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>

namespace nendo::emulator::fastrak {
namespace {

using unit::append;
using unit::Byte;
using unit::Message;

/// Numbers in text: with few digits, with few digits for numbers up to 1, or with an exponent.
enum class Digits : std::uint8_t { two, four, exponent };

struct Item {
  unsigned number;
  std::size_t text_bytes;
  std::size_t binary_bytes;
};
constexpr std::array items{Item{0, 1, 1},    Item{1, 2, 2},    Item{2, 21, 12},  Item{4, 21, 12},
                           Item{5, 21, 12},  Item{6, 21, 12},  Item{7, 21, 12},  Item{11, 28, 16},
                           Item{16, 2, 2},   Item{50, 1, 1},   Item{51, 2, 2},   Item{52, 39, 12},
                           Item{54, 39, 12}, Item{55, 39, 12}, Item{56, 39, 12}, Item{57, 39, 12},
                           Item{61, 52, 16}, Item{66, 2, 2}};

/// Sxxx.xx, Sx.xxxx, or Sx.xxxxxESxx and a blank. Numbers that do not fit become the largest ones
/// that do, so that a record keeps its length.
void append_text(Message& record, double value, Digits digits) {
  value += 0.0; // no negative zero
  std::array<char, 32> text{};
  switch (digits) {
  case Digits::two:
    std::snprintf(text.data(), text.size(), "%7.2f", std::clamp(value, -999.99, 999.99));
    break;
  case Digits::four:
    std::snprintf(text.data(), text.size(), "%7.4f", std::clamp(value, -9.9999, 9.9999));
    break;
  case Digits::exponent:
    std::snprintf(text.data(), text.size(), "%12.5E ", std::clamp(value, -1e9, 1e9));
    break;
  }
  append(record, text.data());
}

void append_numbers(Message& record, std::span<const double> values, bool binary, Digits digits) {
  for (const double value : values) {
    if (!binary) {
      append_text(record, value, digits);
      continue;
    }
    const Message bytes =
        unit::low_first(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
    record.insert(record.end(), bytes.begin(), bytes.end());
  }
}

void append_item(Message& record, unsigned item, const RecordContent& content, bool binary,
                 double unit_cm) {
  constexpr unsigned first_long = 50; // the same items, with an exponent in text
  const bool is_long = item >= first_long;
  const unsigned short_item = is_long ? item - first_long : item;
  const auto put = [&](std::span<const double> values, Digits digits) {
    append_numbers(record, values, binary, is_long ? Digits::exponent : digits);
  };
  const StationPose& pose = content.pose;
  switch (short_item) {
  case 0:
    append(record, " ");
    return;
  case 1:
    append(record, "\r\n");
    return;
  case 2:
    put(scaled(pose.position_cm, 1.0 / unit_cm), Digits::two);
    return;
  case 4:
    put(euler_deg(pose.attitude), Digits::two);
    return;
  case 5:
  case 6:
  case 7:
    put(inverse(pose.attitude)[short_item - 5], Digits::four); // a column: an axis of the receiver
    return;
  case 11:
    put(quaternion_wxyz(pose.attitude), Digits::four);
    return;
  case 16:
    append(record, content.button ? " 1" : " 0");
    return;
  default:
    return;
  }
}

} // namespace

std::optional<std::size_t> item_bytes(unsigned item, bool binary) noexcept {
  const auto found =
      std::find_if(items.begin(), items.end(), [item](const Item& i) { return i.number == item; });
  if (found == items.end()) return std::nullopt;
  return binary ? found->binary_bytes : found->text_bytes;
}

Message data_record(const RecordContent& content, std::span<const unsigned> list, bool binary,
                    double unit_cm) {
  Message record{'0', static_cast<Byte>('1' + content.station), static_cast<Byte>(content.error)};
  for (const unsigned item : list)
    append_item(record, item, content, binary, unit_cm);
  return record;
}

} // namespace nendo::emulator::fastrak
