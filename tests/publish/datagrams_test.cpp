#include <array>
#include <cstring>
#include <map>
#include <optional>

#include "publish/datagrams.hpp"
#include "publish/publish_fixtures.hpp"

namespace datagrams_test {

using namespace nendo;
using namespace nendo::publish;
using test::LoopUnderTest;

namespace {

/// A socket of this machine, bound to a port that was free.
class Receiver {
public:
  explicit Receiver(int family = AF_INET)
      : socket_(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    DatagramTarget any;
    any.length = family == AF_INET ? sizeof any.address.v4 : sizeof any.address.v6;
    any.address.any.sa_family = static_cast<sa_family_t>(family);
    if (family == AF_INET) any.address.v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (family == AF_INET6) any.address.v6.sin6_addr = in6addr_loopback;
    is_bound_ = ::bind(socket_.get(), &any.address.any, any.length) == 0;
    target_ = any;
    ::getsockname(socket_.get(), &target_.address.any, &target_.length);
    const int bytes = 4 << 20;
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  }
  bool is_bound() const { return is_bound_; }
  const DatagramTarget& target() const { return target_; }
  /// What has come, without waiting for more.
  std::optional<std::vector<std::uint8_t>> take() {
    std::vector<std::uint8_t> bytes(65536);
    const ssize_t got = ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got < 0) return std::nullopt;
    bytes.resize(static_cast<std::size_t>(got));
    return bytes;
  }

private:
  UniqueFd socket_;
  DatagramTarget target_;
  bool is_bound_ = false;
};

/// A number at a place of FORMAT.md's tables.
std::uint64_t number_at(const std::vector<std::uint8_t>& bytes, std::size_t at, std::size_t size) {
  REQUIRE(at + size <= bytes.size());
  std::uint64_t number = 0;
  for (std::size_t n = size; n > 0; --n)
    number = number << 8U | bytes[at + n - 1];
  return number;
}

/// Puts together what belongs together, by FORMAT.md.
struct Assembled {
  std::map<std::uint64_t, std::array<std::vector<std::uint8_t>, 2>> hands; ///< each record's
  std::map<std::uint64_t, std::map<std::uint64_t, std::vector<std::uint8_t>>> parts;
  std::map<std::uint64_t, std::uint64_t> wanted; ///< parts of an update
  std::uint64_t datagrams = 0, bytes = 0, session = 0;

  void add(const std::vector<std::uint8_t>& datagram) {
    REQUIRE(datagram.size() > 48);
    REQUIRE(datagram.size() <= 1400);
    REQUIRE(std::memcmp(datagram.data(), "NNDO\x01", 5) == 0);
    ++datagrams;
    bytes += datagram.size();
    const std::uint64_t number = number_at(datagram, 16, 8);
    if (session == 0) session = number_at(datagram, 8, 8);
    CHECK(number_at(datagram, 8, 8) == session);
    const std::vector<std::uint8_t> payload(datagram.begin() + 48, datagram.end());
    if (datagram[6] == 1) {
      CHECK(payload.size() == 744);
      hands[number].at(datagram[7]) = payload;
      return;
    }
    REQUIRE(datagram[6] == 2);
    parts[number][number_at(datagram, 44, 4)] = payload;
    wanted[number] = number_at(datagram, 42, 2);
    CHECK(number_at(datagram, 40, 2) < wanted[number]);
  }
  /// Nothing if a part is missing.
  std::optional<std::vector<std::uint8_t>> update(std::uint64_t number) {
    if (parts[number].size() != wanted[number]) return std::nullopt;
    std::vector<std::uint8_t> whole;
    for (const auto& [offset, payload] : parts[number]) {
      CHECK(offset == whole.size());
      whole.insert(whole.end(), payload.begin(), payload.end());
    }
    return whole;
  }
};

} // namespace

TEST_SUITE("datagrams") {
  TEST_CASE("what arrives is what the segment has, split and put together again") {
    for (const int family : {AF_INET, AF_INET6}) {
      Receiver receiver(family);
      if (!receiver.is_bound()) continue; // no IPv6 here
      LoopUnderTest test(
          flow::Mode::type1,
          {.rings_of_ball = 8, .injective = deform::InjectiveOptions{.max_bound = 0.2}});
      SegmentPublisher publisher(test::segment_name("both"), {});
      DatagramPublisher sender("udp:port", receiver.target());
      test::attach(test, {&publisher, &sender});
      REQUIRE(publisher.begin(test::outline_of(test)));
      REQUIRE(sender.begin(test::outline_of(test)));
      const test::MappedSegment segment(test::segment_name("both"));
      test::Player player(test);
      constexpr std::uint64_t ticks = 100; // fewer than the segment has slots
      REQUIRE(segment.header().record_slots > ticks);
      for (std::uint64_t tick = 0; tick < ticks; ++tick)
        player.next();
      sender.end();
      const DatagramCounts counts = sender.counts();
      CHECK(counts.records == ticks);
      CHECK(counts.sent + counts.lost == ticks);
      CHECK(counts.sent > 0);
      Assembled got;
      while (const auto datagram = receiver.take())
        got.add(*datagram);
      CHECK(got.datagrams <= counts.datagrams);
      CHECK(got.bytes <= counts.bytes);
      std::uint64_t whole = 0, split = 0;
      for (std::uint64_t number = 1; number <= ticks; ++number) {
        const auto record = segment.record(number);
        const auto* const bytes = reinterpret_cast<const std::uint8_t*>(record.data());
        for (std::size_t side = 0; side < 2; ++side) {
          const auto& hand = got.hands[number][side];
          if (!hand.empty()) CHECK(std::memcmp(hand.data(), bytes + 128 + 744 * side, 744) == 0);
        }
        const auto update = got.update(number);
        if (!update || update->empty()) continue;
        ++whole;
        split += got.wanted[number] > 1 ? 1U : 0U;
        const auto& head = test::head_of(record);
        REQUIRE(update->size() == 120 + head.fields_bytes);
        // Shape changes are the segment's.
        CHECK(std::memcmp(update->data(), bytes + 8, 80) == 0);
        CHECK(std::memcmp(update->data() + 88, bytes + 96, 32) == 0);
        CHECK(std::memcmp(update->data() + 120, bytes + 1616, head.fields_bytes) == 0);
      }
      CHECK(whole > 0);
      CHECK(split > 0);
    }
  }

  TEST_CASE("a missing listener is no loss, and a new loop is another session") {
    DatagramTarget target;
    {
      const Receiver gone; // its port is free again
      target = gone.target();
    }
    LoopUnderTest test(flow::Mode::type2, {.rings_of_ball = 8});
    DatagramPublisher sender("udp:192.0.2.1:9", target);
    test::attach(test, {&sender});
    for (int loop = 0; loop < 2; ++loop) {
      REQUIRE(sender.begin(test::outline_of(test)));
      test::Player player(test);
      for (int tick = 0; tick < 30; ++tick)
        player.next();
    }
    sender.end();
    const DatagramCounts counts = sender.counts();
    CHECK(counts.records == 60);
    CHECK(counts.sent + counts.lost == 60);
    CHECK(counts.datagrams >= 3 * counts.sent);
    CHECK(counts.refused == 0);
  }

  TEST_CASE("an address to which there is no way is an error before the first tick") {
    DatagramTarget target;
    target.length = sizeof target.address.v4;
    target.address.v4.sin_family = AF_INET;
    target.address.v4.sin_port = htons(9000);
    target.address.v4.sin_addr.s_addr = INADDR_BROADCAST;
    LoopUnderTest test(flow::Mode::type1, {.rings_of_ball = 8});
    DatagramPublisher sender("udp:255.255.255.255:9000", target);
    const auto begun = sender.begin(test::outline_of(test));
    REQUIRE_FALSE(begun);
    const std::string& why = begun.error().message; // which, why, and what to do, in that order
    CHECK(why.starts_with("--publish udp:255.255.255.255:9000: no way to that address: "));
    CHECK(why.ends_with("; see ip route"));
  }
}

} // namespace datagrams_test
