#include "web/feed.hpp"

#include <algorithm>
#include <cstring>

#include "web/wire.hpp"

namespace nendo::web {
namespace {

bool has_fields(const Record& record) noexcept {
  std::uint16_t count = 0;
  std::memcpy(&count, record.step.data() + 2, sizeof count);
  return count > 0;
}

float max_late(std::span<const Record> records) noexcept {
  float most = 0.0F;
  for (const Record& record : records) {
    UpdateHead head;
    std::memcpy(&head, record.head.data(), sizeof head);
    most = std::max(most, head.late_us);
  }
  return most;
}

} // namespace

void Feed::look_at(std::span<const Record> records) noexcept {
  if (!records.empty()) needed_ = records.back().weights;
}

void Feed::shape_sent(std::uint64_t number) noexcept {
  lacks_shape_ = false;
  base_ = shape_ = number;
  drift_ = 0.0;
}

// Records up to the base are known to the client. The record of the shape's own frame is needed
// only if its step is drawn: what it baked is in the shape.
std::span<const Record> Feed::unseen(std::span<const Record> records) noexcept {
  std::size_t first = 0;
  const auto is_needed = [&](const Record& record) {
    return record.number > base_ || (record.number == shape_ && base_ == shape_ && !record.bakes);
  };
  while (first < records.size() && !is_needed(records[first]))
    ++first;
  return records.subspan(first);
}

bool Feed::can_follow(std::span<const Record> records) const noexcept {
  return !lacks_shape_ && std::none_of(records.begin(), records.end(), [&](const Record& record) {
    return (record.discontinuous && record.number > shape_) ||
           (record.weights != 0 && record.weights != weights_);
  });
}

std::optional<std::vector<std::byte>> Feed::update(std::span<const Record> records,
                                                   const FeedCounters& counters) {
  if (records.empty()) return std::nullopt;
  const auto news = unseen(records);
  lacks_shape_ = !can_follow(news);
  const Record& newest = records.back();
  UpdateHead head;
  std::memcpy(&head, newest.head.data(), sizeof head);
  head.max_late_us = max_late(records);
  head.lost = static_cast<std::uint32_t>(counters.lost);
  head.skipped = static_cast<std::uint32_t>(skipped_);
  for (std::size_t slot = 0; slot < counters.gloves.size(); ++slot) {
    const auto& [counts, uncalibrated] = counters.gloves[slot];
    head.bad_records[slot] = static_cast<std::uint32_t>(counts.bad);
    head.delivered[slot] = static_cast<std::uint32_t>(counts.delivered);
    head.missed_records[slot] = static_cast<std::uint32_t>(counts.missed);
    head.refused[slot] = static_cast<std::uint32_t>(counts.refused);
    if (uncalibrated) head.state = static_cast<std::uint8_t>(head.state | 2U << slot);
  }
  std::vector<std::byte> message = newest.head;
  for (std::size_t at = 0; !lacks_shape_ && at < news.size(); ++at) {
    const Record& record = news[at];
    if (!record.bakes && at + 1 < news.size()) continue; // the next step replaces it
    message.insert(message.end(), record.step.begin(), record.step.end());
    ++head.steps;
    drift_ += record.drift;
  }
  if (!lacks_shape_) base_ = std::max(base_, newest.number);
  std::memcpy(message.data(), &head, sizeof head);
  return message;
}

void Feed::skip(std::span<const Record> records) noexcept {
  skipped_ += records.size();
  const auto news = unseen(records);
  const bool bakes = std::any_of(news.begin(), news.end(), [](const Record& record) {
    return record.bakes && has_fields(record);
  });
  if (bakes || !can_follow(news)) lacks_shape_ = true;
  if (!lacks_shape_ && !records.empty()) base_ = std::max(base_, records.back().number);
}

} // namespace nendo::web
