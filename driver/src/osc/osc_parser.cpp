#include "osc/osc_parser.hpp"

#include <cmath>
#include <utility>

namespace nendo::driver::osc {
namespace {

// Comparisons are such that a NaN is refused.
bool is_near(std::span<const double, 3> position_m) noexcept {
  return std::hypot(position_m[0], position_m[1], position_m[2]) <= max_distance_m;
}

bool is_rotation(std::span<const double, 4> q) noexcept {
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  return std::abs(norm - 1.0) <= max_norm_error;
}

} // namespace

bool Parser::begin_packet(std::span<const std::byte> packet, HostTime arrival) noexcept {
  if (waiting_.exists() && arrival - waiting_.arrival > max_pair_gap) drop_waiting_part();
  if (packet.empty()) return false;
  counters_.bytes += packet.size();
  if (packet.size() > max_packet_bytes || !is_well_formed(packet)) {
    counters_.discarded_bytes += packet.size();
    ++counters_.bad_records;
    return false;
  }
  completed_pose_ = has_waiting_part_ = false;
  return true;
}

void Parser::end_packet(std::size_t bytes) noexcept {
  if (completed_pose_) {
    counters_.record_bytes += bytes;
  } else if (has_waiting_part_) {
    waiting_.bytes = bytes;
  } else {
    counters_.discarded_bytes += bytes;
  }
}

bool Parser::knows(std::string_view address) const noexcept {
  return address == left_address || address == right_address || address == pair_.position ||
         address == pair_.rotation;
}

std::optional<Pose> Parser::take(const Message& message, HostTime arrival) noexcept {
  if (!knows(message.address)) return std::nullopt;
  const bool is_part = message.address == pair_.position || message.address == pair_.rotation;
  auto pose = is_part ? take_part(message, arrival) : take_whole(message);
  if (!pose) return std::nullopt;
  pose->time = message.time;
  completed_pose_ = true;
  ++counters_.records;
  return pose;
}

std::optional<Pose> Parser::take_whole(const Message& message) noexcept {
  std::array<double, 7> numbers{};
  Pose pose;
  pose.station = message.address == left_address ? left_station : right_station;
  const bool has_numbers = read_numbers(message, numbers);
  const std::span all(numbers);
  if (!has_numbers || !is_near(all.first<3>()) || !is_rotation(all.last<4>())) {
    ++counters_.bad_records;
    return std::nullopt;
  }
  pose.position_m = {numbers[0], numbers[1], numbers[2]};
  pose.turn_xyzw = {numbers[3], numbers[4], numbers[5], numbers[6]};
  return pose;
}

std::optional<Pose> Parser::take_part(const Message& message, HostTime arrival) noexcept {
  const bool is_position = message.address == pair_.position;
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{};
  const bool is_good = is_position ? read_numbers(message, position_m) && is_near(position_m)
                                   : read_numbers(message, turn_xyzw) && is_rotation(turn_xyzw);
  if (!is_good) {
    ++counters_.bad_records;
    return std::nullopt;
  }
  if (is_position ? waiting_.position_m.has_value() : waiting_.turn_xyzw.has_value())
    drop_waiting_part();
  if (is_position) {
    waiting_.position_m = position_m;
  } else {
    waiting_.turn_xyzw = turn_xyzw;
  }
  waiting_.arrival = arrival;
  has_waiting_part_ = !waiting_.position_m || !waiting_.turn_xyzw;
  if (has_waiting_part_) return std::nullopt;
  counters_.record_bytes += waiting_.bytes;
  const Part whole = std::exchange(waiting_, {});
  return Pose{pair_.station, *whole.position_m, *whole.turn_xyzw, std::nullopt};
}

void Parser::drop_waiting_part() noexcept {
  counters_.discarded_bytes += waiting_.bytes;
  ++counters_.bad_records;
  waiting_ = {};
}

} // namespace nendo::driver::osc
