#include "export/motion_csv.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "export/csv_row.hpp"
#include "export/one_file.hpp"

namespace nendo::exporting {
namespace {

constexpr std::array<Side, 2> sides{Side::left, Side::right};

/// As the page of exports has it.
std::uint64_t code_of(deform::FieldStatus status) {
  switch (status) {
  case deform::FieldStatus::ok:
    return 0;
  case deform::FieldStatus::merged:
    return 1;
  case deform::FieldStatus::singular:
    return 2;
  case deform::FieldStatus::too_dense:
    return 3;
  case deform::FieldStatus::not_finite:
    return 4;
  }
  return 5;
}

const flow::HandFrame& hand_of(const flow::Frame& frame, Side side) {
  return frame.hands[flow::Placement::index_of(side)];
}

std::string head_for(const flow::Frame& frame) {
  std::string head = "time_s,tick,held,commits,undos,status";
  for (const Side side : sides) {
    if (!hand_of(frame, side).present) continue;
    const std::string hand = "," + std::string(name_of(side)) + "_";
    head += hand + "samples" + hand + "silent" + hand + "calibrated";
    for (const auto angle : hand::angle_names)
      head += hand + std::string(angle) + "_deg";
    for (const hand::Joint tip : hand::fingertips)
      for (const char* axis : {"x", "y", "z"})
        head.append(hand).append(name_of(tip)).append("_").append(axis).append("_m");
  }
  return head + "\n";
}

void put_hand(const flow::HandFrame& hand, std::optional<bool> is_calibrated, CsvRow& row) {
  row.put(hand.samples);
  row.put_flag(hand.silent);
  if (is_calibrated)
    row.put_flag(*is_calibrated);
  else
    row.put_nothing();
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    row.put(to_degrees(hand.angles[hand::angle_at(at)]), 4);
  const auto tips_m = hand.pose.fingertip_positions();
  for (const double metres : tips_m.reshaped())
    row.put(metres, 7);
}

std::string row_for(const ChosenFrames& frames, const std::array<bool, 2>& present) {
  const flow::Frame& frame = frames.frame();
  CsvRow row;
  row.put(frames.time_s(), 6);
  for (const std::uint64_t count :
       {frame.tick, std::uint64_t{frame.held}, frame.commits, frame.undos})
    row.put(count);
  row.put(code_of(frame.status));
  for (const Side side : sides)
    if (present[flow::Placement::index_of(side)])
      put_hand(hand_of(frame, side), frames.source().is_calibrated(side), row);
  return row.take();
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
    return file.write(text + row_for(frames, present));
  });
}

} // namespace nendo::exporting
