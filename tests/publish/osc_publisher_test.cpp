#include <algorithm>
#include <map>
#include <set>

#include "publish/osc_datagrams.hpp"
#include "publish/osc_publisher.hpp"
#include "publish/publish_fixtures.hpp"

namespace osc_publisher_test {

using namespace nendo;
using namespace nendo::publish;
using test::LoopUnderTest;
using test::OscMessage;
using test::OscReceiver;

namespace {

OscTarget with(const OscReceiver& receiver, OscFormat format,
               const std::optional<double>& rate_hz = {}) {
  OscTarget target = receiver.target();
  target.format = format;
  target.rate_hz = rate_hz;
  return target;
}

std::vector<OscMessage> all_messages(OscReceiver& receiver) {
  std::vector<OscMessage> messages;
  while (const auto datagram = receiver.take())
    for (OscMessage& message : test::messages_in(*datagram))
      messages.push_back(std::move(message));
  return messages;
}

std::array<float, 3> tip_of(const flow::Frame& frame, std::size_t side, hand::Joint tip) {
  const Eigen::Vector3f place = frame.hands[side].pose[tip].translation().cast<float>();
  return {place.x(), place.y(), place.z()};
}

void check_counts(const OscCounts& counts, std::uint64_t records) {
  CHECK(counts.records == records);
  CHECK(counts.sent + counts.skipped + counts.lost == records);
}

} // namespace

TEST_SUITE("osc_publisher") {
  TEST_CASE("the messages of each sent tick have the hands of that tick") {
    for (const int family : {AF_INET, AF_INET6}) {
      OscReceiver receiver(family);
      if (!receiver.is_bound()) continue; // no IPv6 here
      LoopUnderTest test(flow::Mode::type1, {.rings_of_ball = 8});
      OscPublisher sender("osc:port", with(receiver, OscFormat::nendo));
      test::attach(test, {&sender});
      REQUIRE(sender.begin(test::outline_of(test)));
      test::Player player(test);
      constexpr std::uint64_t ticks = 100;
      std::set<std::array<float, 3>> tips; // of the right index finger
      std::set<float> yaws;
      for (std::uint64_t tick = 0; tick < ticks; ++tick) {
        const flow::Frame& frame = player.next();
        tips.insert(tip_of(frame, 1, hand::Joint::index_tip));
        yaws.insert(static_cast<float>(frame.hands[1].angles[hand::Angle::index_pip_flexion]));
      }
      sender.end();
      check_counts(sender.counts(), ticks);
      CHECK(sender.counts().skipped == 0);
      CHECK(sender.counts().sent > 0);
      std::map<std::string, std::uint64_t> seen;
      for (const OscMessage& message : all_messages(receiver)) {
        ++seen[message.address];
        if (message.address == "/nendo/right/index/tip") {
          REQUIRE(message.types == "fff");
          CHECK(tips.count({message.numbers[0], message.numbers[1], message.numbers[2]}) == 1);
        }
        if (message.address == "/nendo/right/angles") {
          REQUIRE(message.numbers.size() == hand::angle_count);
          CHECK(yaws.count(message.numbers[hand::index_of(hand::Angle::index_pip_flexion)]) == 1);
        }
        if (message.address.ends_with("/flexion") || message.address.ends_with("/touch") ||
            message.address.ends_with("/pinch")) {
          REQUIRE(message.types == "f");
          CHECK(message.numbers[0] >= 0.0F);
          CHECK(message.numbers[0] <= 1.0F);
        }
      }
      // Each side: live, wrist, palm, pinch, angles, and three of each digit.
      CHECK(seen.size() == 2 * (5 + 3 * 5));
      for (const auto& [address, count] : seen)
        CHECK(count <= sender.counts().sent);
      CHECK(seen["/nendo/left/wrist"] > 0);
    }
  }

  TEST_CASE("a rate leaves ticks out, and counts them") {
    OscReceiver receiver;
    LoopUnderTest test(flow::Mode::type1, {.rings_of_ball = 8});
    OscPublisher sender("vmc:port", with(receiver, OscFormat::vmc, 0.1));
    test::attach(test, {&sender});
    REQUIRE(sender.begin(test::outline_of(test)));
    test::Player player(test);
    for (int tick = 0; tick < 50; ++tick) // which take less than ten seconds
      player.next();
    sender.end();
    check_counts(sender.counts(), 50);
    CHECK(sender.counts().sent <= 1);
    CHECK(sender.counts().skipped >= 48);
  }

  TEST_CASE(
      "a rate is kept while ticks are early and late, and nothing is caught up after a pause") {
    constexpr std::int64_t tick_ns = 1'000'000'000 / 90;
    Pace pace(30.0);
    int passed = 0;
    std::int64_t time_ns = 77 * tick_ns;
    for (int tick = 0; tick < 900; ++tick, time_ns += tick_ns)
      passed += pace.is_due(time_ns + (tick % 2 == 0 ? 400'000 : -400'000)) ? 1 : 0;
    CHECK(passed >= 295);
    CHECK(passed <= 301);
    time_ns += 100 * tick_ns;
    CHECK(pace.is_due(time_ns));
    CHECK_FALSE(pace.is_due(time_ns + 1));
    CHECK(pace.is_due(time_ns + 3 * tick_ns + 1'000'000));
    Pace all({});
    CHECK(all.is_due(5));
    CHECK(all.is_due(5));
  }

  TEST_CASE("an avatar gets 16 bones of each hand, and nothing that is no float") {
    OscReceiver receiver;
    LoopUnderTest test(flow::Mode::type1, {.rings_of_ball = 8});
    OscPublisher sender("vmc:port", with(receiver, OscFormat::vmc));
    test::attach(test, {&sender});
    REQUIRE(sender.begin(test::outline_of(test)));
    test::Player player(test);
    for (int tick = 0; tick < 20; ++tick)
      player.next();
    sender.end();
    std::map<std::string, int> bones;
    float time_s = -1.0F;
    for (const OscMessage& message : all_messages(receiver)) {
      if (message.address == "/VMC/Ext/OK") CHECK(message.whole == std::vector<std::int32_t>{1});
      if (message.address == "/VMC/Ext/T") {
        REQUIRE(message.types == "f");
        CHECK(message.numbers[0] >= time_s);
        time_s = message.numbers[0];
      }
      if (message.address != "/VMC/Ext/Bone/Pos") continue;
      REQUIRE(message.types == "sfffffff");
      ++bones[message.text];
      float squares = 0.0F;
      for (std::size_t at = 3; at < 7; ++at)
        squares += message.numbers[at] * message.numbers[at];
      CHECK(squares == doctest::Approx(1.0).epsilon(1e-5));
    }
    CHECK(bones.size() == 32);
    for (const auto& [name, count] : bones)
      CHECK(count == bones["RightHand"]);
    CHECK(bones.count("LeftThumbIntermediate") == 1);
  }

  TEST_CASE("a missing listener is no loss, and a second loop is sent as well") {
    OscTarget target;
    {
      const OscReceiver gone; // its port is free again
      target = gone.target();
    }
    LoopUnderTest test(flow::Mode::type2, {.rings_of_ball = 8});
    OscPublisher sender("osc:9", target);
    test::attach(test, {&sender});
    for (int loop = 0; loop < 2; ++loop) {
      REQUIRE(sender.begin(test::outline_of(test)));
      test::Player player(test);
      for (int tick = 0; tick < 30; ++tick)
        player.next();
    }
    sender.end();
    check_counts(sender.counts(), 60);
    CHECK(sender.counts().datagrams == 2 * sender.counts().sent);
    CHECK(sender.counts().refused == 0);
  }

  TEST_CASE("an address to which there is no way is an error before the first tick") {
    OscTarget target;
    target.endpoint = {"255.255.255.255", 9000};
    LoopUnderTest test(flow::Mode::type1, {.rings_of_ball = 8});
    OscPublisher sender("osc:255.255.255.255:9000", target);
    const auto begun = sender.begin(test::outline_of(test));
    REQUIRE_FALSE(begun);
    const std::string& why = begun.error().message; // which, why, and what to do, in that order
    CHECK(why.starts_with("--to osc:255.255.255.255:9000: no way to that address: "));
    CHECK(why.ends_with("; see ip route"));
  }
}

} // namespace osc_publisher_test
