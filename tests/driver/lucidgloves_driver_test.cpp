#include <nendo/driver/open_glove.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "lucidgloves/lucidgloves_driver.hpp"
#include "support/glove_facts.hpp"
#include "support/stream_laws.hpp"
#include "units/lucidgloves_unit.hpp"

namespace lucidgloves_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::emulator;
using namespace nendo::test;

namespace {

/// One line for ever, in answer to nothing.
class Listener final : public EmulatedUnit {
public:
  explicit Listener(std::string line) : line_(std::move(line)) {}
  void receive(std::span<const std::byte> bytes, Time /*now*/) override {
    received_ += bytes.size();
  }
  std::size_t received() const { return received_; } ///< bytes
  void advance(Time /*now*/) override { send(std::as_bytes(std::span(line_))); }
  std::optional<Time> next_due() const noexcept override { return std::nullopt; }

private:
  const std::string line_;
  std::size_t received_ = 0;
};

struct Written {
  std::mutex mutex;
  std::vector<std::string> commands;

  std::string last() {
    const std::lock_guard lock(mutex);
    return commands.empty() ? std::string() : commands.back();
  }
};

/// A port that sends one line for ever, and takes only the first bytes of the first brake command.
class HalfDeafPort final : public Transport {
public:
  explicit HalfDeafPort(Written& written) : written_(written) {}
  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds time) noexcept override {
    constexpr std::string_view line = "A1B2C3D4E5\n";
    std::this_thread::sleep_for(std::min(time, 2ms));
    if (time == 0ms) return {};
    std::memcpy(buffer.data(), line.data(), line.size());
    return {IoStatus::done, line.size()};
  }
  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds) noexcept override {
    std::string text;
    for (const std::byte byte : bytes)
      text.push_back(std::to_integer<char>(byte));
    const std::lock_guard lock(written_.mutex);
    written_.commands.push_back(text);
    const bool cut = text.find('B') != std::string::npos && !std::exchange(hears_, true);
    return cut ? IoStatus::timeout : IoStatus::done;
  }
  void discard_input() noexcept override {}

private:
  Written& written_;
  bool hears_ = false;
};

Kind lucidgloves() {
  return {[](Side side) {
            LucidGlovesUnitOptions options;
            options.side = side;
            return make_lucidgloves_unit(options);
          },
          [](const std::string& path) { return "lucidgloves:" + path; }, 256};
}

std::array<int, 5> brakes_of(PtyUnit& port) {
  return port.look<LucidGlovesUnit>([](const LucidGlovesUnit& unit) { return unit.brakes(); });
}

Result<std::unique_ptr<Glove>> open_one_line(const std::string& line, const std::string& options,
                                             std::optional<Side> side = std::nullopt) {
  const PtyUnit port(std::make_unique<Listener>(line));
  return open_glove("lucidgloves:" + port.path() + options, side);
}

} // namespace

TEST_SUITE("lucidgloves_driver") {
  TEST_CASE("a glove that answers says who it is, of either hand") {
    for (const Side side : {Side::left, Side::right}) {
      const PtyUnit port(lucidgloves().make(side));
      // Its own word goes before what the user says.
      const auto glove =
          required(open_glove("lucidgloves:" + port.path() + "?hand=right", Side::right));
      const GloveInfo& info = glove->info();
      CHECK(info.side == side);
      CHECK(info.model == "LucidGloves, 9 sensors");
      CHECK(info.counts == CountScale{4095, true});
      CHECK(info.abilities.resistance);
      CHECK_FALSE(info.abilities.wrist_switch);
      CHECK(info.rate_hz == 0.0);
      CHECK(fact(info, "hand_source") == "glove");
      CHECK(fact(info, "encoding") == "alpha");
      CHECK(fact(info, "firmware") == "5");
      CHECK(fact(info, "device_type") == "0");
      for (const Sensor sensor :
           {Sensor::thumb_mcp, Sensor::index_mcp, Sensor::middle_mcp, Sensor::ring_mcp,
            Sensor::pinky_mcp, Sensor::thumb_abduction, Sensor::index_middle_abduction,
            Sensor::middle_ring_abduction, Sensor::ring_pinky_abduction}) {
        CHECK(info.sensors.has(sensor));
      }
    }
  }

  TEST_CASE("a firmware that answers nothing is known by its stream") {
    LucidGlovesUnitOptions options;
    options.answers = false;
    const PtyUnit port(make_lucidgloves_unit(options));
    const auto glove = required(open_glove("lucidgloves:" + port.path(), Side::left));
    CHECK(glove->info().side == Side::left);
    CHECK(fact(glove->info(), "hand_source") == "caller");
    CHECK(fact(glove->info(), "firmware").empty());
  }

  TEST_CASE("the hand is the option's, else the caller's, else right") {
    const std::string line = "A1B2C3D4E5\n";
    const auto option = required(open_one_line(line, "?hand=left", Side::right));
    CHECK(option->info().side == Side::left);
    CHECK(fact(option->info(), "hand_source") == "option");
    const auto assumed = required(open_one_line(line, ""));
    CHECK(assumed->info().side == Side::right);
    CHECK(fact(assumed->info(), "hand_source") == "assumed");
  }

  TEST_CASE("a glove that somebody stopped is started") {
    const PtyUnit port(lucidgloves().make(Side::left));
    const int other = ::open(port.path().c_str(), O_RDWR | O_NOCTTY);
    REQUIRE(::write(other, "(ZZ)\n", 5) == 5);
    ::close(other);
    const auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(glove->info().side == Side::left);
  }

  TEST_CASE("a legacy firmware is told nothing, since it takes any line for brakes") {
    const auto unit = [](const Listener& listener) { return listener.received(); };
    PtyUnit port(std::make_unique<Listener>("1&2&3&4&5&6&7&0&0&0&0&0&0\n"));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(fact(glove->info(), "encoding") == "legacy");
    CHECK(glove->info().model == "LucidGloves, 5 sensors");
    CHECK_FALSE(glove->info().abilities.resistance);
    REQUIRE(glove->start(ring));
    Feedback feedback;
    feedback.resistance = {1, 2, 3, 4, 5};
    glove->set_feedback(feedback);
    CHECK(eventually([&] { return ring.size() > 100; }));
    glove->stop();
    CHECK(port.look<Listener>(unit) == 0);
  }

  TEST_CASE("what the first lines show is what it has") {
    const auto joints =
        required(open_one_line("A1(AAB)2(AAC)3B4(BAB)5(BAC)6(BAD)7\r\n", "?range=1023"));
    CHECK(joints->info().sensors.bits ==
          ((1U << 1U) | (1U << 2U) | (1U << 4U) | (1U << 5U) | (1U << 6U)));
    CHECK(joints->info().counts == CountScale{1023, true});
  }

  TEST_CASE("numbers beyond the range that was named are an error that names it") {
    const auto glove = open_one_line("A4095B2C3D4E5\n", "?range=1023");
    REQUIRE_FALSE(glove);
    CHECK(glove.error().code == Errc::no_device);
    CHECK(glove.error().message.find("1023") != std::string::npos);
    CHECK(glove.error().message.find("range") != std::string::npos);
  }

  TEST_CASE("a LucidGlove's options that are none are usage errors that name what there is") {
    wrong_options_are_usage_errors("lucidgloves", {{"?rate=9", "range"},
                                                   {"?range=4096", "4095, 1023"},
                                                   {"?hand=both", "left"},
                                                   {"?baud=1", "115200"},
                                                   {"?baud=115200x", "115200"},
                                                   {"?hand=Left", "left"}});
  }

  TEST_CASE("feedback reaches the brakes, at most locked, and its end frees them") {
    PtyUnit port(lucidgloves().make(Side::right));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    REQUIRE(glove->start(ring));
    Feedback feedback;
    feedback.resistance = {0, 1, 500, 1000, 65535};
    glove->set_feedback(feedback);
    CHECK(eventually([&] { return brakes_of(port) == std::array{0, 1, 500, 1000, 1000}; }));
    glove->stop();
    CHECK(eventually([&] { return brakes_of(port) == std::array{0, 0, 0, 0, 0}; }));
    CHECK(glove->stats().bad_records == 0);
  }

  TEST_CASE("what was cut off is ended before the next command, lest they run into one") {
    Written written;
    const auto open_port = [&]() -> Result<std::unique_ptr<Transport>> {
      return std::unique_ptr<Transport>(std::make_unique<HalfDeafPort>(written));
    };
    auto glove =
        required(lucidgloves::open_lucidgloves_by("a half-deaf glove", open_port, 4095, {}));
    SampleRing ring(8);
    REQUIRE(glove->start(ring));
    Feedback feedback;
    feedback.resistance = {1, 2, 3, 4, 5};
    glove->set_feedback(feedback);
    CHECK(eventually([&] { return written.last() == "A1B2C3D4E5\n"; })); // of which it takes a part
    feedback.resistance[0] = 9;
    glove->set_feedback(feedback);
    CHECK(eventually([&] { return written.last() == "\nA9B2C3D4E5\n"; }));
    glove->stop();
    CHECK(written.last() == "A0B0C0D0E0\n");
  }

  TEST_CASE("feedback is shown again after a silence") {
    PtyUnit port(lucidgloves().make(Side::right));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    REQUIRE(glove->start(ring));
    Feedback feedback;
    feedback.resistance = {700, 600, 500, 400, 300};
    glove->set_feedback(feedback);
    REQUIRE(eventually([&] { return brakes_of(port)[0] == 700; }));
    port.mute = true;
    REQUIRE(eventually([&] { return glove->stats().silences >= 1; }));
    feedback.resistance[0] = 650; // given while it is silent
    glove->set_feedback(feedback);
    port.mute = false;
    CHECK(eventually([&] { return brakes_of(port) == std::array{650, 600, 500, 400, 300}; }));
  }

  TEST_CASE("a hand at rest arrives in the slots of the joints that it bends") {
    LucidGlovesUnitOptions options;
    options.motion = Motion::rest;
    const GloveSample sample = sample_at_rest(make_lucidgloves_unit(options), "lucidgloves");
    check_at_rest(sample, resting_knuckles, 4095.0, 2.0); // tremor
    constexpr std::array splays{RestingJoint{Sensor::thumb_abduction, 30, 40},
                                RestingJoint{Sensor::index_middle_abduction, 7, 20},
                                RestingJoint{Sensor::middle_ring_abduction, 6, 20},
                                RestingJoint{Sensor::ring_pinky_abduction, 8, 20}};
    check_at_rest(sample, splays, 4095.0, 2.0);
  }

  TEST_CASE(
      "whatever else is at a LucidGlove's port is an error that says so within five seconds") {
    no_glove_is_an_error_that_says_so(lucidgloves(), "x7 noise\nA1 B2\r\n\x01\x02");
  }
  TEST_CASE("a LucidGlove's samples are in order and add up") {
    samples_are_in_order_and_add_up(lucidgloves());
  }
  TEST_CASE("a full ring refuses a LucidGlove's samples and they are counted") {
    a_full_ring_refuses_and_counts(lucidgloves());
  }
  TEST_CASE("a LucidGlove stops promptly and starts again") {
    stop_is_prompt_and_start_works_again(lucidgloves());
  }
  TEST_CASE("a LucidGlove that falls silent is started again") {
    a_silent_stream_is_started_again(lucidgloves());
  }
  TEST_CASE("a LucidGlove stops promptly while it is silent or away") {
    stop_is_prompt_while_silent_or_away(lucidgloves());
  }
  TEST_CASE("a LucidGlove that vanishes is found again, even if it is the other hand's") {
    a_glove_that_vanishes_is_found_again(lucidgloves(), true);
  }
}

} // namespace lucidgloves_driver_test
