#include "publish/osc_publisher.hpp"

#include <nendo/base/system_error.hpp>

#include "publish/hand_messages.hpp"
#include "publish/osc_packer.hpp"

namespace nendo::publish {

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
  for (std::size_t side = 0; side < 2; ++side) {
    avatar_[side].reset();
    if (outline.skeletons[side]) avatar_[side].emplace(*outline.skeletons[side]);
  }
  first_ns_.reset();
  sender_.begin([this](const HandsRecord& record) { send(record); });
  return {};
}

OscCounts OscPublisher::counts() const noexcept {
  OscCounts all = counts_;
  static_cast<SenderCounts&>(all) = sender_.counts();
  return all;
}

void OscPublisher::send(const HandsRecord& record) {
  const std::int64_t woke_ns = record.record.woke_ns;
  if (!first_ns_) first_ns_ = woke_ns;
  OscPacker packer([this](std::span<const std::byte> datagram) { send_datagram(datagram); });
  const bool is_vmc = format_ == OscFormat::vmc;
  if (is_vmc) {
    packer.add("/VMC/Ext/OK", 1);
    const float time_s = static_cast<float>(1e-9 * static_cast<double>(woke_ns - *first_ns_));
    packer.add("/VMC/Ext/T", std::span(&time_s, 1));
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const nendo_publish_hand& hand = record.record.hands[side];
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
