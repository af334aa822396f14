#include "publish/osc_publisher.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include <nendo/base/system_error.hpp>

#include "publish/hand_messages.hpp"
#include "publish/osc_packer.hpp"

namespace nendo::publish {
namespace {

constexpr std::size_t slots = 256;
constexpr auto period = std::chrono::milliseconds(1);

} // namespace

Result<void> OscPublisher::open() {
  const std::string place = "--to " + name_;
  const int family = to_.address.any.sa_family;
  UniqueFd socket(::socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // A socket that is connected would get errors of ports without a listener, and count losses
  // there.
  const UniqueFd probe(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open() || !probe.is_open())
    return system_error(place, "no socket",
                        "a service needs RestrictAddressFamilies=AF_INET AF_INET6");
  if (::connect(probe.get(), &to_.address.any, to_.length) != 0)
    return system_error(place, "no way to that address", "see ip route");
  socket_ = std::move(socket);
  return {};
}

Result<void> OscPublisher::begin(const LoopOutline& outline) {
  end();
  if (!socket_.is_open())
    if (const auto opened = open(); !opened) return opened.error();
  constexpr std::size_t slot_words = 1 + sizeof(Record) / 8;
  memory_ = std::make_unique<AtomicWord[]>(slots * slot_words);
  ring_ = RecordRing(memory_.get(), slots, slot_words);
  for (std::size_t side = 0; side < 2; ++side) {
    avatar_[side].reset();
    if (outline.skeletons[side]) avatar_[side].emplace(*outline.skeletons[side]);
  }
  shown_ = 0;
  newest_ = 0;
  over_ = false;
  next_ = 1;
  first_ns_.reset();
  due_ns_ = 0;
  thread_ = std::thread([this] { send_until_over(); });
  return {};
}

void OscPublisher::show(const flow::Frame& frame) noexcept {
  ++shown_;
  const Record record{head_of(frame), states_of(frame, shown_)};
  ring_.write(shown_, std::bit_cast<std::array<std::uint64_t, sizeof(Record) / 8>>(record));
  newest_.store(shown_, std::memory_order_relaxed); // the record's stage has the order
}

void OscPublisher::end() {
  if (!thread_.joinable()) return;
  over_ = true;
  thread_.join();
  counts_.records += shown_;
}

void OscPublisher::send_until_over() noexcept {
  for (bool last = false; !last;) {
    last = over_;
    send_new();
    if (!last) std::this_thread::sleep_for(period);
  }
}

void OscPublisher::send_new() noexcept {
  const std::uint64_t newest = newest_.load(std::memory_order_relaxed);
  if (newest >= next_ + ring_.slots()) { // the older ones are no more there
    counts_.lost += newest - ring_.slots() + 1 - next_;
    next_ = newest - ring_.slots() + 1;
  }
  for (; next_ <= newest; ++next_) {
    std::array<std::uint64_t, sizeof(Record) / 8> words{};
    if (!ring_.read(next_, words)) {
      ++counts_.lost;
      continue;
    }
    const auto record = std::bit_cast<Record>(words);
    const std::int64_t now_ns = record.hands.woke_ns;
    if (now_ns < due_ns_) {
      ++counts_.skipped;
      continue;
    }
    // A tick that is a little early is not the one before the next.
    if (target_.rate_hz) due_ns_ = now_ns + static_cast<std::int64_t>(0.95e9 / *target_.rate_hz);
    if (!first_ns_) first_ns_ = now_ns;
    send(record);
    ++counts_.sent;
  }
}

void OscPublisher::send(const Record& record) {
  OscPacker packer([this](std::span<const std::byte> datagram) { send_datagram(datagram); });
  const bool is_vmc = target_.format == OscFormat::vmc;
  if (is_vmc) {
    packer.add("/VMC/Ext/OK", 1);
    const float time_s =
        static_cast<float>(1e-9 * static_cast<double>(record.hands.woke_ns - *first_ns_));
    packer.add("/VMC/Ext/T", std::span(&time_s, 1));
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const nendo_publish_hand& hand = record.hands.hands[side];
    const nendo_publish_hand_state& state = record.states.hands[side];
    if ((hand.flags & NENDO_PUBLISH_PRESENT) == 0) continue;
    if (is_vmc && avatar_[side]) add_bones(avatar_[side]->bones(hand, state.forearm), packer);
    if (!is_vmc) add_hand_messages(side == 0 ? Side::left : Side::right, hand, state, packer);
    packer.flush();
  }
}

void OscPublisher::send_datagram(std::span<const std::byte> datagram) noexcept {
  const ssize_t sent = ::sendto(socket_.get(), datagram.data(), datagram.size(), MSG_DONTWAIT,
                                &to_.address.any, to_.length);
  if (sent < 0) {
    ++counts_.refused;
    return;
  }
  ++counts_.datagrams;
  counts_.bytes += static_cast<std::uint64_t>(sent);
}

} // namespace nendo::publish
