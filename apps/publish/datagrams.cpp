#include "publish/datagrams.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace nendo::publish {
namespace {

// Numbers are copied as they are in memory.
static_assert(std::endian::native == std::endian::little);

constexpr std::size_t ring_bytes = std::size_t{8} << 20;
constexpr auto period = std::chrono::milliseconds(1);
constexpr std::size_t head_bytes = sizeof(nendo_publish_datagram);
constexpr std::size_t max_payload = NENDO_PUBLISH_DATAGRAM_BYTES - head_bytes;
// An update is the record without its stage and hands.
constexpr std::size_t update_begin = offsetof(nendo_publish_record, number);
constexpr std::size_t update_end = offsetof(nendo_publish_record, hands);

static_assert(sizeof(nendo_publish_hand) <= max_payload);

} // namespace

Result<void> DatagramPublisher::open() {
  const std::string place = "--publish " + name_;
  const int family = target_.address.any.sa_family;
  UniqueFd socket(::socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // A socket that is connected would get errors of ports without a listener, and count losses
  // there.
  const UniqueFd probe(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open() || !probe.is_open())
    return system_error(place, "no socket",
                        "a service needs RestrictAddressFamilies=AF_INET AF_INET6");
  if (::connect(probe.get(), &target_.address.any, target_.length) != 0)
    return system_error(place, "no way to that address", "see ip route");
  socket_ = std::move(socket);
  return {};
}

Result<void> DatagramPublisher::begin(const LoopOutline& outline) {
  end();
  if (!socket_.is_open())
    if (const auto opened = open(); !opened) return opened.error();
  const std::size_t slot_words = (max_record_words(outline) + 7) / 8 * 8;
  const std::size_t slots = std::clamp<std::size_t>(ring_bytes / (8 * slot_words), 8, 1024);
  memory_ = std::make_unique<AtomicWord[]>(slots * slot_words);
  ring_ = RecordRing(memory_.get(), slots, slot_words);
  record_ = FrameRecord(outline, ++generation_);
  shown_ = 0;
  newest_ = 0;
  over_ = false;
  next_ = 1;
  session_ = static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch() /
                                        std::chrono::nanoseconds(1));
  words_.assign(slot_words, 0);
  update_.reserve(8 * slot_words);
  datagram_.assign(NENDO_PUBLISH_DATAGRAM_BYTES, std::byte{0});
  thread_ = std::thread([this] { send_until_over(); });
  return {};
}

void DatagramPublisher::show(const flow::Frame& frame) noexcept {
  ++shown_;
  record_.describe(frame, shown_, 0);
  ring_.write(shown_, record_.words());
  newest_.store(shown_, std::memory_order_relaxed); // the record's stage has the order
}

void DatagramPublisher::end() {
  if (!thread_.joinable()) return;
  over_ = true;
  thread_.join();
  counts_.records += shown_;
}

void DatagramPublisher::send_until_over() noexcept {
  for (bool last = false; !last;) {
    last = over_;
    send_new();
    if (!last) std::this_thread::sleep_for(period);
  }
}

void DatagramPublisher::send_new() noexcept {
  const std::uint64_t newest = newest_.load(std::memory_order_relaxed);
  if (newest >= next_ + ring_.slots()) { // the older ones are no more there
    counts_.lost += newest - ring_.slots() + 1 - next_;
    next_ = newest - ring_.slots() + 1;
  }
  for (; next_ <= newest; ++next_) {
    // The whole slot: how much of it is the record's, the record says.
    if (ring_.read(next_, std::span(words_).subspan(1))) {
      send_record();
      ++counts_.sent;
    } else {
      ++counts_.lost;
    }
  }
}

void DatagramPublisher::send_record() noexcept {
  nendo_publish_record record{};
  std::memcpy(&record, words_.data(), sizeof record);
  nendo_publish_datagram head{};
  std::memcpy(head.magic, "NNDO", sizeof head.magic);
  head.major = NENDO_PUBLISH_MAJOR;
  head.minor = NENDO_PUBLISH_MINOR;
  head.session = session_;
  head.number = record.number;
  head.tick = record.tick;
  head.woke_ns = record.woke_ns;
  head.kind = 1;
  head.parts = 1;
  for (std::uint8_t side = 0; side < 2; ++side) {
    const nendo_publish_hand& hand = record.hands[side];
    if ((hand.flags & NENDO_PUBLISH_PRESENT) == 0) continue;
    head.side = side;
    send(head, reinterpret_cast<const std::byte*>(&hand), sizeof hand);
  }
  send_update(record, head);
}

void DatagramPublisher::send_update(const nendo_publish_record& record,
                                    nendo_publish_datagram head) noexcept {
  const auto* const bytes = reinterpret_cast<const std::byte*>(words_.data());
  const auto* const fields = bytes + sizeof record;
  update_.assign(bytes + update_begin, bytes + update_end); // within what was reserved
  update_.insert(update_.end(), fields, fields + record.fields_bytes);
  head.kind = 2;
  head.side = 0;
  head.parts = static_cast<std::uint16_t>((update_.size() + max_payload - 1) / max_payload);
  for (head.part = 0; head.part < head.parts; ++head.part) {
    head.offset = static_cast<std::uint32_t>(head.part * max_payload);
    send(head, update_.data() + head.offset, std::min(max_payload, update_.size() - head.offset));
  }
}

void DatagramPublisher::send(const nendo_publish_datagram& head, const std::byte* payload,
                             std::size_t payload_bytes) noexcept {
  std::memcpy(datagram_.data(), &head, sizeof head);
  std::memcpy(datagram_.data() + head_bytes, payload, payload_bytes);
  const ssize_t sent = ::sendto(socket_.get(), datagram_.data(), head_bytes + payload_bytes,
                                MSG_DONTWAIT, &target_.address.any, target_.length);
  if (sent < 0) {
    ++counts_.refused;
    return;
  }
  ++counts_.datagrams;
  counts_.bytes += static_cast<std::uint64_t>(sent);
}

} // namespace nendo::publish
