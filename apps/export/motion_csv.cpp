#include "export/motion_csv.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "export/one_file.hpp"

namespace nendo::exporting {
namespace {

constexpr std::array<Side, 2> sides{Side::left, Side::right};

std::string_view word_for(deform::FieldStatus status) {
  switch (status) {
  case deform::FieldStatus::ok:
    return "ok";
  case deform::FieldStatus::merged:
    return "merged";
  case deform::FieldStatus::singular:
    return "singular";
  case deform::FieldStatus::too_dense:
    return "too_dense";
  case deform::FieldStatus::not_finite:
    return "not_finite";
  }
  return "";
}

// Not printf, whose decimal point is a matter of the locale.
void put_number(double value, int decimals, std::string& row) {
  row += ',';
  char digits[400]; // the largest double has 309 before the point
  if (!std::isfinite(value)) return;
  row.append(
      digits,
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr);
}

void put_count(std::uint64_t count, std::string& row) {
  row += ',';
  row += std::to_string(count);
}

const flow::HandFrame& hand_of(const flow::Frame& frame, Side side) {
  return frame.hands[flow::Placement::index_of(side)];
}

std::string head_for(const flow::Frame& frame) {
  std::string head = "time_s,tick,held,commits,undos,status";
  for (const Side side : sides) {
    if (!hand_of(frame, side).present) continue;
    const std::string hand = "," + std::string(name_of(side)) + "_";
    head += hand + "samples" + hand + "silent";
    for (const auto angle : hand::angle_names)
      head += hand + std::string(angle) + "_deg";
    for (const hand::Joint tip : hand::fingertips)
      for (const char* axis : {"x", "y", "z"})
        head.append(hand).append(name_of(tip)).append("_").append(axis).append("_m");
  }
  return head + "\n";
}

void put_hand(const flow::HandFrame& hand, std::string& row) {
  put_count(hand.samples, row);
  put_count(hand.silent ? 1 : 0, row);
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    put_number(to_degrees(hand.angles[hand::angle_at(at)]), 4, row);
  const auto tips_m = hand.pose.fingertip_positions();
  for (const double metres : tips_m.reshaped())
    put_number(metres, 7, row);
}

// Begins with a comma.
std::string row_for(const flow::Frame& frame, double time_s, const std::array<bool, 2>& present) {
  std::string row;
  put_number(time_s, 6, row);
  for (const std::uint64_t count :
       {frame.tick, std::uint64_t{frame.held}, frame.commits, frame.undos})
    put_count(count, row);
  row.append(",").append(word_for(frame.status));
  for (std::size_t slot = 0; slot < present.size(); ++slot)
    if (present[slot]) put_hand(frame.hands[slot], row);
  return row;
}

} // namespace

Result<Exported> export_motion_csv(ChosenFrames& frames, const std::filesystem::path& path) {
  std::array<bool, 2> present{};
  return export_to_one_file(frames, path, [&](FileReplacement& file) {
    const flow::Frame& frame = frames.frame();
    std::string text;
    if (frames.made() == 1) {
      text = head_for(frame);
      for (std::size_t slot = 0; slot < present.size(); ++slot)
        present[slot] = frame.hands[slot].present;
    }
    text.append(row_for(frame, frames.time_s(), present), 1); // without the first comma
    return file.write(text.append("\n"));
  });
}

} // namespace nendo::exporting
