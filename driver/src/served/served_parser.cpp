#include "served/served_parser.hpp"

#include <string_view>
#include <utility>

namespace nendo::driver::served {

void Parser::want(const WantedDevice& device) noexcept {
  wanted_ = device;
  follows_ = false;
}

void Parser::reset() noexcept {
  discard_held();
  is_overlong_ = false;
  follows_ = false;
}

std::optional<Parser::Finding> Parser::push_byte(std::byte byte) {
  if (byte == line_end) return end_line();
  if (is_overlong_) {
    ++counters_.discarded_bytes;
    return std::nullopt;
  }
  line_[held_++] = std::to_integer<char>(byte);
  if (held_ == line_.size()) { // the LF does not fit
    discard_held();
    is_overlong_ = true;
    count_bad();
  }
  return std::nullopt;
}

std::optional<Parser::Finding> Parser::end_line() {
  if (std::exchange(is_overlong_, false)) {
    ++counters_.discarded_bytes;
    return std::nullopt;
  }
  const std::string_view text(line_.data(), held_);
  const std::uint64_t records = counters_.records;
  const auto line = decode_line(text);
  ++held_; // the LF
  auto finding = line ? found(*line) : std::nullopt;
  if (counters_.records == records) discard_held();
  if (!line) count_bad();
  return finding;
}

std::optional<Parser::Finding> Parser::found(const Line& line) {
  if (const auto* sample = std::get_if<SampleLine>(&line))
    return found(sample->sample, {WantedDevice::Kind::glove, sample->glove}, sample->dropped);
  if (const auto* pose = std::get_if<PoseLine>(&line))
    return found(pose->pose, {WantedDevice::Kind::tracker, pose->tracker}, pose->dropped);
  if (const auto* watch = std::get_if<WatchLine>(&line)) {
    follows_ = watch->samples;
    return *watch;
  }
  if (const auto* version = std::get_if<VersionLine>(&line)) return *version;
  if (const auto* glove = std::get_if<GloveLine>(&line)) return *glove;
  if (const auto* tracker = std::get_if<TrackerLine>(&line)) return *tracker;
  if (const auto* error = std::get_if<ErrorLine>(&line)) return *error;
  return std::nullopt;
}

template <class Sample>
std::optional<Parser::Finding> Parser::found(const Sample& sample, const WantedDevice& device,
                                             std::uint64_t dropped) noexcept {
  if (!follows_ || device.kind != wanted_.kind || device.index != wanted_.index)
    return std::nullopt;
  if (!is_of_this_time(sample)) {
    ++counters_.implausible;
    count_bad();
    return std::nullopt;
  }
  counters_.missed += dropped;
  accept_held();
  return sample;
}

template <class Sample>
bool Parser::is_of_this_time(const Sample& sample) const noexcept {
  const auto is_far = [](HostTime one, HostTime other) {
    return one - other > max_age || other - one > max_age;
  };
  if (is_far(sample.measured, sample.arrival)) return false;
  return !now_ || (sample.arrival <= *now_ && !is_far(sample.arrival, *now_));
}

} // namespace nendo::driver::served
