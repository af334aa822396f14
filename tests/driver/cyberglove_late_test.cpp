// Gloves that answer late: a link that was asleep, or one that is slow throughout.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <doctest/doctest.h>

#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_driver.hpp"
#include "cyberglove/cyberglove_identity.hpp"
#include "support/eventually.hpp"
#include "support/required.hpp"
#include "support/scripted_unit.hpp"

namespace cyberglove_late_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::cyberglove;
using nendo::test::eventually;
using nendo::test::required;
using nendo::test::Script;
using nendo::test::ScriptedUnit;
using namespace std::chrono_literals;

namespace {

/// A ScriptedUnit whose answers to some commands arrive late; those to later ones not before.
class LateTransport final : public Transport {
public:
  /// `slow` are the commands, by their beginning; an empty one is all.
  LateTransport(const Script& script, std::string slow, std::chrono::milliseconds delay)
      : unit(script), slow_(std::move(slow)), delay_(delay) {}

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const HostTime until = HostClock::now() + timeout;
    if (coming_.empty() && unit.streaming) {
      std::this_thread::sleep_for(2ms);
      coming_.push_back({HostClock::now(), unit.record()});
    }
    if (coming_.empty() || coming_.front().due > until) {
      std::this_thread::sleep_until(until);
      return {IoStatus::timeout, 0};
    }
    std::this_thread::sleep_until(coming_.front().due);
    std::string& bytes = coming_.front().bytes;
    const std::size_t count = std::min(buffer.size(), bytes.size());
    for (std::size_t k = 0; k < count; ++k)
      buffer[k] = static_cast<std::byte>(bytes[k]);
    bytes.erase(0, count);
    if (bytes.empty()) coming_.pop_front();
    return {IoStatus::done, count};
  }
  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds) noexcept override {
    if (deaf_until && HostClock::now() < deaf_until->load()) return IoStatus::done;
    std::string input = std::exchange(unit.held, {});
    for (const std::byte byte : bytes)
      input.push_back(std::to_integer<char>(byte));
    HostTime due = HostClock::now();
    if (input.starts_with(slow_)) due += delay_;
    if (!coming_.empty()) due = std::max(due, coming_.back().due);
    for (std::string_view rest = input; !rest.empty();) {
      std::string answer = unit.answer(rest);
      if (!answer.empty()) coming_.push_back({due, std::move(answer)});
    }
    std::this_thread::sleep_for(host_sleeps);
    return IoStatus::done;
  }
  void discard_input() noexcept override {}

  ScriptedUnit unit;
  std::chrono::milliseconds host_sleeps{0};                ///< after each command
  std::shared_ptr<const std::atomic<HostTime>> deaf_until; ///< what is sent before is lost

private:
  struct Coming {
    HostTime due;
    std::string bytes;
  };
  std::deque<Coming> coming_;
  const std::string slow_;
  const std::chrono::milliseconds delay_;
};

struct Meeting {
  explicit Meeting(const std::string& slow, std::chrono::milliseconds delay = 600ms)
      : transport(Script(), slow, delay),
        greeting(greet(transport, dialogue, bauds_to_try(115'200, true))),
        identity(identify(dialogue, "port", {{}, greeting.baud, {}})) {}

  LateTransport transport;
  Dialogue dialogue{transport, HostClock::now() + 4s};
  Greeting greeting;
  Result<Identity> identity;
};

} // namespace

TEST_SUITE("cyberglove_late") {
  TEST_CASE("an answer that is 600 ms late, on a line that is quiet until then, is waited for") {
    for (const char* slow : {"?S", "?M", "?R", "D\x01", "U\x01"}) {
      CAPTURE(slow);
      const HostTime start = HostClock::now();
      const Meeting met(slow);
      CHECK(HostClock::now() - start < 2s);
      REQUIRE_MESSAGE(met.identity, met.identity.error().message);
      CHECK(met.identity->channels.sensors() == sensors_22);
      CHECK(met.identity->shape.time_stamp);
      CHECK(met.identity->shape.status);
      // It was not asked again in vain.
      const std::string& heard = met.transport.unit.heard;
      CHECK(heard.find(slow) != std::string::npos);
      CHECK(heard.find(slow, heard.find(slow) + 1) == std::string::npos);
    }
  }

  TEST_CASE("what babbles instead of an answer is not waited for any longer") {
    LateTransport transport(Script(), "?", 600ms);
    Dialogue dialogue(transport, HostClock::now() + 4s);
    dialogue.wait_on_quiet_line(1000ms);
    // A record is no answer.
    CHECK(dialogue.start_stream("S") == Answer::good);
    std::byte data{};
    const HostTime start = HostClock::now();
    CHECK(dialogue.ask(ask_sensor_count.letter, std::span(&data, 1), 200ms) == Answer::nonsense);
    CHECK(HostClock::now() - start < 500ms);
  }

  TEST_CASE("the delay of answers is learnt, and passed to the next dialogue") {
    LateTransport transport(Script(), "?", 300ms);
    std::byte data{};
    Dialogue first(transport, HostClock::now() + 4s);
    CHECK(first.ask(ask_sensor_count.letter, std::span(&data, 1), 100ms) == Answer::silent);
    CHECK(first.ask(ask_state.letter, std::span(&data, 1), 500ms) == Answer::good);
    CHECK(first.slowest_answer() >= 300ms);
    CHECK(first.ask(ask_sensor_count.letter, std::span(&data, 1), 100ms) == Answer::good);
    Dialogue second(transport, HostClock::now() + 4s);
    second.expect_late_answers(first.slowest_answer());
    CHECK(second.ask(ask_sensor_count.letter, std::span(&data, 1), 100ms) == Answer::good);
    Dialogue third(transport, HostClock::now() + 4s);
    CHECK(third.ask(ask_sensor_count.letter, std::span(&data, 1), 100ms) == Answer::silent);
  }

  TEST_CASE("a glove that is late with each answer opens and streams") {
    const std::string source = "serial:late";
    auto glove = required(open_cyberglove(
        source,
        []() -> Result<std::unique_ptr<Transport>> {
          return std::unique_ptr<Transport>(std::make_unique<LateTransport>(Script(), "", 450ms));
        },
        Options(), HostClock::now() + 4s));
    CHECK(glove->info().sensors == sensors_22);
    CHECK(glove->info().abilities.wrist_switch);
    SampleRing ring(1024);
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return ring.size() > 20; }));
    glove->stop();
    CHECK(glove->stats().silences == 0);
    CHECK(glove->stats().bad_records <= 2);
  }

  TEST_CASE("a glove that is held up for 0.8 s after it was opened streams") {
    const auto deaf_until = std::make_shared<std::atomic<HostTime>>(HostTime{});
    auto glove = required(open_cyberglove(
        "serial:held up",
        [&]() -> Result<std::unique_ptr<Transport>> {
          auto transport = std::make_unique<LateTransport>(Script(), "", 1ms);
          transport->deaf_until = deaf_until;
          return std::unique_ptr<Transport>(std::move(transport));
        },
        Options(), HostClock::now() + 4s));
    SampleRing ring(1024);
    deaf_until->store(HostClock::now() + 800ms);
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return ring.size() > 20; }));
    glove->stop();
  }

  TEST_CASE("an answer counts that came in time, where the host looks too late") {
    LateTransport transport(Script(), "", 1ms);
    transport.host_sleeps = 250ms;
    Dialogue dialogue(transport, HostClock::now() + 4s);
    std::byte data{};
    CHECK(dialogue.ask(ask_sensor_count.letter, std::span(&data, 1), 100ms) == Answer::good);
    CHECK(std::to_integer<int>(data) == 22);
  }
}

} // namespace cyberglove_late_test
