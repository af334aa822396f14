#include "publish/hands_sender.hpp"

#include <array>
#include <bit>
#include <chrono>
#include <utility>

namespace nendo::publish {
namespace {

constexpr std::size_t slots = 256;
constexpr auto period = std::chrono::milliseconds(1);

using Words = std::array<std::uint64_t, sizeof(HandsRecord) / 8>;

} // namespace

void HandsSender::begin(std::function<void(const HandsRecord&)> send, std::function<void()> turn) {
  end();
  constexpr std::size_t slot_words = 1 + sizeof(HandsRecord) / 8;
  memory_ = std::make_unique<AtomicWord[]>(slots * slot_words);
  ring_ = RecordRing(memory_.get(), slots, slot_words);
  shown_ = 0;
  newest_ = 0;
  over_ = false;
  next_ = 1;
  send_ = std::move(send);
  turn_ = std::move(turn);
  thread_ = std::thread([this] { run(); });
}

void HandsSender::show(const flow::Frame& frame) noexcept {
  ++shown_;
  const HandsRecord record{head_of(frame), states_of(frame, shown_)};
  ring_.write(shown_, std::bit_cast<Words>(record));
  newest_.store(shown_, std::memory_order_relaxed); // the record's stage has the order
}

void HandsSender::end() {
  if (!thread_.joinable()) return;
  over_ = true;
  thread_.join();
  counts_.records += shown_;
}

void HandsSender::run() {
  for (bool last = false; !last;) {
    last = over_;
    if (turn_) turn_();
    send_new();
    // It polls, because waking it would be a system call in the tick.
    if (!last) std::this_thread::sleep_for(period);
  }
}

void HandsSender::send_new() {
  const std::uint64_t newest = newest_.load(std::memory_order_relaxed);
  if (newest >= next_ + ring_.slots()) { // the older ones are no more there
    counts_.lost += newest - ring_.slots() + 1 - next_;
    next_ = newest - ring_.slots() + 1;
  }
  for (; next_ <= newest; ++next_) {
    Words words{};
    if (!ring_.read(next_, words)) {
      ++counts_.lost;
      continue;
    }
    const auto record = std::bit_cast<HandsRecord>(words);
    if (!pace_.is_due(record.record.woke_ns)) {
      ++counts_.skipped;
      continue;
    }
    send_(record);
    ++counts_.sent;
  }
}

} // namespace nendo::publish
