#include <nendo/driver/open_glove.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "lucidgloves/lucidgloves_driver.hpp"
#include "support/glove_facts.hpp"
#include "support/required.hpp"
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
    for (const std::byte byte : bytes)
      heard_.push_back(std::to_integer<char>(byte));
  }
  std::string heard() const { return heard_; }
  void advance(Time /*now*/) override { send(std::as_bytes(std::span(line_))); }
  std::optional<Time> next_due() const noexcept override { return std::nullopt; }

private:
  const std::string line_;
  std::string heard_;
};

/// What happens at a scripted port, and how it behaves.
struct Wire {
  std::mutex mutex;
  std::vector<std::string> chunks{"A1B2C3D4E5\n"}; ///< one a read, again and again; empty: silence
  std::size_t reads = 0;
  std::vector<std::string> written;
  std::chrono::milliseconds longest_write{0}; ///< that a writer was ready to wait
  bool unplugged = false;                     ///< until it is opened again
  bool takes_nothing = false;
  bool takes_all_brakes = true; ///< false: of the next brake command only a part

  void restart() {
    const std::lock_guard lock(mutex);
    reads = 0;
    written.clear();
    longest_write = {};
  }
  std::size_t count_of(std::string_view text) {
    const std::lock_guard lock(mutex);
    return static_cast<std::size_t>(std::count(written.begin(), written.end(), text));
  }
  std::size_t reads_so_far() {
    const std::lock_guard lock(mutex);
    return reads;
  }
};

class ScriptedPort final : public Transport {
public:
  explicit ScriptedPort(Wire& wire) : wire_(wire) {}
  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds time) noexcept override {
    if (time == 0ms) return {};
    std::this_thread::sleep_for(std::min(time, 2ms));
    const std::lock_guard lock(wire_.mutex);
    if (wire_.unplugged) return {IoStatus::gone, 0};
    const std::string& chunk = wire_.chunks[wire_.reads++ % wire_.chunks.size()];
    std::memcpy(buffer.data(), chunk.data(), chunk.size());
    return {chunk.empty() ? IoStatus::timeout : IoStatus::done, chunk.size()};
  }
  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds time) noexcept override {
    std::string text;
    for (const std::byte byte : bytes)
      text.push_back(std::to_integer<char>(byte));
    const std::lock_guard lock(wire_.mutex);
    wire_.written.push_back(text);
    wire_.longest_write = std::max(wire_.longest_write, time);
    const bool brakes = text.find('B') != std::string::npos;
    const bool cut = brakes && !std::exchange(wire_.takes_all_brakes, true);
    return cut || wire_.takes_nothing ? IoStatus::timeout : IoStatus::done;
  }
  void discard_input() noexcept override {}

private:
  Wire& wire_;
};

std::unique_ptr<Glove> glove_at(Wire& wire) {
  const auto open_port = [&]() -> Result<std::unique_ptr<Transport>> {
    const std::lock_guard lock(wire.mutex);
    wire.unplugged = false;
    return std::unique_ptr<Transport>(std::make_unique<ScriptedPort>(wire));
  };
  return required(lucidgloves::open_lucidgloves_by("a scripted glove", open_port, 4095, {}));
}

std::unique_ptr<EmulatedUnit> unit_with(LucidGlovesFirmware firmware) {
  LucidGlovesUnitOptions options;
  options.firmware = firmware;
  return std::make_unique<LucidGlovesUnit>(options);
}

Feedback resistance(std::array<std::uint16_t, 5> fingers) {
  Feedback feedback;
  feedback.resistance = fingers;
  return feedback;
}

Kind lucidgloves() {
  return {[](Side side) {
            LucidGlovesUnitOptions options;
            options.side = side;
            return std::make_unique<LucidGlovesUnit>(options);
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
      // Its own word goes before what the caller wishes.
      const auto glove = required(open_glove("lucidgloves:" + port.path(), Side::right));
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
            Sensor::little_mcp, Sensor::thumb_abduction, Sensor::index_middle_abduction,
            Sensor::middle_ring_abduction, Sensor::ring_little_abduction}) {
        CHECK(info.sensors.has(sensor));
      }
    }
  }

  TEST_CASE("a firmware that answers nothing is known by its stream") {
    const PtyUnit port(unit_with(LucidGlovesFirmware::streaming));
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

  TEST_CASE("the option goes before the glove's own word, early or late") {
    const PtyUnit port(lucidgloves().make(Side::right));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path() + "?hand=left"));
    CHECK(glove->info().side == Side::left);
    CHECK(fact(glove->info(), "hand_source") == "option");
    test::require_ok(glove->start(ring));
    GloveSample sample;
    REQUIRE(eventually([&] { return ring.try_pop(sample); }));
    CHECK(sample.side == Side::left);
    glove->stop();
  }

  TEST_CASE("a glove that reports its hand late is that hand from then on") {
    Wire wire;
    const auto glove = glove_at(wire);
    CHECK(glove->info().side == Side::right); // assumed
    SampleRing ring(1U << 14U);
    test::require_ok(glove->start(ring));
    GloveSample sample;
    REQUIRE(eventually([&] { return ring.try_pop(sample); }));
    CHECK(sample.side == Side::right);
    {
      const std::lock_guard lock(wire.mutex);
      wire.chunks.insert(wire.chunks.begin(), "(ZH)0\n");
    }
    CHECK(eventually([&] { return ring.try_pop(sample) && sample.side == Side::left; }));
    glove->stop();
  }

  TEST_CASE("a glove that reported its hand is waited for when it comes back, however many lines "
            "it sends") {
    Wire wire;
    wire.chunks.insert(wire.chunks.begin(), "(ZH)0\n");
    const auto glove = glove_at(wire);
    CHECK(glove->info().side == Side::left);
    SampleRing ring(1U << 14U);
    test::require_ok(glove->start(ring));
    {
      const std::lock_guard lock(wire.mutex);
      wire.chunks.assign(400, "A1B2C3D4E5\n"); // 0.8 s of them: it is asked for 0.3 s otherwise
      wire.chunks.emplace_back("(ZH)0\n");
      wire.reads = 0;
      wire.unplugged = true;
    }
    REQUIRE(eventually([&] { return glove->stats().reopened == 1; }));
    ring.drain([](const GloveSample&) {});
    GloveSample sample;
    for (int k = 0; k < 300; ++k) {
      REQUIRE(eventually([&] { return ring.try_pop(sample); }));
      CHECK(sample.side == Side::left);
    }
    glove->stop();
  }

  TEST_CASE("a stopped glove is started") {
    const PtyUnit port(lucidgloves().make(Side::left));
    const int other = ::open(port.path().c_str(), O_RDWR | O_NOCTTY);
    REQUIRE(::write(other, "(ZZ)\n", 5) == 5);
    ::close(other);
    const auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(glove->info().side == Side::left);
  }

  TEST_CASE("a legacy firmware gets empty lines only, since it takes any other for brakes") {
    const auto unit = [](const Listener& listener) { return listener.heard(); };
    PtyUnit port(std::make_unique<Listener>("1&2&3&4&5&6&7&0&0&0&0&0&0\n"));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(fact(glove->info(), "encoding") == "legacy");
    CHECK(glove->info().model == "LucidGloves, 5 sensors");
    CHECK_FALSE(glove->info().abilities.resistance);
    test::require_ok(glove->start(ring));
    Feedback feedback;
    feedback.resistance = {1, 2, 3, 4, 5};
    glove->set_feedback(feedback);
    CHECK(eventually([&] { return ring.size() > 100; }));
    glove->stop();
    const std::string heard = port.look<Listener>(unit);
    CHECK(heard.find_first_not_of('\n') == std::string::npos);
  }

  TEST_CASE("a legacy firmware that waits for an answer to each line gets one at once") {
    PtyUnit port(unit_with(LucidGlovesFirmware::legacy_waiting));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(fact(glove->info(), "encoding") == "legacy");
    test::require_ok(glove->start(ring));
    const auto start = HostClock::now();
    REQUIRE(eventually([&] { return glove->stats().records >= 300; }));
    CHECK(HostClock::now() - start < 30s); // a host that says nothing needs 25 minutes
    glove->set_feedback(resistance({1, 2, 3, 4, 5}));
    const std::uint64_t before = glove->stats().records;
    REQUIRE(eventually([&] { return glove->stats().records >= before + 100; }));
    CHECK(brakes_of(port) == std::array{0, 0, 0, 0, 0});
    glove->stop();
    CHECK(glove->stats().silences == 0);
    CHECK(glove->stats().bad_records == 0);
  }

  TEST_CASE("a glove that waits for an answer to an unread line is woken") {
    for (const auto firmware :
         {LucidGlovesFirmware::legacy_waiting, LucidGlovesFirmware::waiting}) {
      PtyUnit port(unit_with(firmware));
      std::this_thread::sleep_for(200ms); // it has sent its line, which opening throws away
      const auto start = HostClock::now();
      const auto glove = required(open_glove("lucidgloves:" + port.path()));
      CHECK(HostClock::now() - start < 4s);
      CHECK(brakes_of(port) == std::array{0, 0, 0, 0, 0});
    }
  }

  TEST_CASE("a glove of one line per second is read, in both encodings") {
    for (const auto firmware : {LucidGlovesFirmware::streaming, LucidGlovesFirmware::legacy}) {
      LucidGlovesUnitOptions options;
      options.firmware = firmware;
      options.rate_hz = 1.0;
      PtyUnit port(std::make_unique<LucidGlovesUnit>(options));
      SampleRing ring(1U << 14U);
      auto glove = required(open_glove("lucidgloves:" + port.path()));
      test::require_ok(glove->start(ring));
      CHECK(eventually([&] { return glove->stats().records >= 3; }));
      glove->stop();
      CHECK(glove->stats().silences == 0);
      CHECK(glove->stats().bad_records == 0);
      CHECK_FALSE(glove->stats().counts_missed);
    }
  }

  TEST_CASE("an unclamped firmware is read, and what was out of range is counted") {
    for (const auto firmware :
         {LucidGlovesFirmware::unclamped, LucidGlovesFirmware::legacy_unclamped}) {
      LucidGlovesUnitOptions options;
      options.firmware = firmware;
      options.motion = Motion::grasp;
      PtyUnit port(std::make_unique<LucidGlovesUnit>(options));
      SampleRing ring(1U << 14U);
      auto glove = required(open_glove("lucidgloves:" + port.path()));
      test::require_ok(glove->start(ring));
      CHECK(
          eventually([&] { return glove->stats().clamped > 0 && glove->stats().records >= 300; }));
      glove->stop();
      CHECK(glove->stats().bad_records == 0);
      CHECK(glove->stats().clamped > 0);
      CHECK(glove->stats().clamped <= 10 * glove->stats().records);
    }
  }

  TEST_CASE("what the first lines show is what it has") {
    const auto joints =
        required(open_one_line("A1(AAB)2(AAC)3B4(BAB)5(BAC)6(BAD)7\r\n", "?range=1023"));
    CHECK(joints->info().sensors.bits ==
          ((1U << 1U) | (1U << 2U) | (1U << 4U) | (1U << 5U) | (1U << 6U)));
    CHECK(joints->info().counts == CountScale{1023, true});
  }

  TEST_CASE("numbers beyond the range count as the range, and the glove's facts have that") {
    const PtyUnit port(std::make_unique<Listener>("A4095B2C1023D1024E5\n"));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path() + "?range=1023"));
    CHECK(fact(glove->info(), "above_range").find("1023") != std::string::npos);
    test::require_ok(glove->start(ring));
    GloveSample sample;
    REQUIRE(eventually([&] { return ring.try_pop(sample); }));
    glove->stop();
    CHECK(sample[Sensor::thumb_mcp].value == 1023);
    CHECK(sample[Sensor::index_mcp].value == 2);
    CHECK(sample[Sensor::middle_mcp].value == 1023);
    CHECK(sample[Sensor::ring_mcp].value == 1023);
    CHECK(glove->stats().bad_records == 0);
    const auto within = required(open_one_line("A1023B2C3D4E5\n", "?range=1023"));
    CHECK(fact(within->info(), "above_range").empty());
  }

  TEST_CASE("negative numbers count as 0, and the glove's facts have that") {
    const auto below = required(open_one_line("A-5B2C3D4E5\n", ""));
    CHECK(fact(below->info(), "below_range").find("0") != std::string::npos);
    CHECK(fact(below->info(), "above_range").empty());
    const auto within = required(open_one_line("A1B2C3D4E5\n", ""));
    CHECK(fact(within->info(), "below_range").empty());
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
    test::require_ok(glove->start(ring));
    Feedback feedback;
    feedback.resistance = {0, 1, 500, 1000, 65535};
    glove->set_feedback(feedback);
    CHECK(eventually([&] { return brakes_of(port) == std::array{0, 1, 500, 1000, 1000}; }));
    glove->stop();
    CHECK(eventually([&] { return brakes_of(port) == std::array{0, 0, 0, 0, 0}; }));
    CHECK(glove->stats().bad_records == 0);
  }

  TEST_CASE("a firmware that waits for an answer to each line gets one at once") {
    PtyUnit port(unit_with(LucidGlovesFirmware::waiting));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(fact(glove->info(), "encoding") == "alpha");
    test::require_ok(glove->start(ring));
    const auto start = HostClock::now();
    REQUIRE(eventually([&] { return glove->stats().records >= 300; }));
    CHECK(HostClock::now() - start < 3s); // a host that says nothing needs five minutes
    CHECK(brakes_of(port) == std::array{0, 0, 0, 0, 0});
    glove->set_feedback(resistance({0, 1, 500, 1000, 65535}));
    CHECK(eventually([&] { return brakes_of(port) == std::array{0, 1, 500, 1000, 1000}; }));
    const std::uint64_t before = glove->stats().records;
    REQUIRE(eventually([&] { return glove->stats().records >= before + 100; }));
    CHECK(brakes_of(port) == std::array{0, 1, 500, 1000, 1000});
    glove->stop();
    CHECK(eventually([&] { return brakes_of(port) == std::array{0, 0, 0, 0, 0}; }));
    CHECK(glove->stats().silences == 0);
    CHECK(glove->stats().bad_records == 0);
  }

  TEST_CASE("feedback that changes with each tick makes no line more than there are answers") {
    Wire wire;
    const auto glove = glove_at(wire);
    SampleRing ring(1U << 14U);
    wire.restart();
    test::require_ok(glove->start(ring));
    for (std::uint16_t k = 1; wire.reads_so_far() < 50; ++k) {
      glove->set_feedback(resistance({k, k, k, k, k}));
      std::this_thread::sleep_for(100us);
    }
    glove->stop();
    CHECK(wire.written.size() == wire.reads + 1); // and the last one frees them
    CHECK(wire.written.back() == "A0B0C0D0E0\n");
  }

  TEST_CASE("brakes are repeated with each answer, since a lost line must not leave them set") {
    Wire wire;
    const auto glove = glove_at(wire);
    SampleRing ring(1U << 14U);
    wire.restart();
    test::require_ok(glove->start(ring));
    REQUIRE(eventually([&] { return wire.count_of("\n") > 5; }));
    glove->set_feedback(resistance({1, 2, 3, 4, 5}));
    REQUIRE(eventually([&] { return wire.count_of("A1B2C3D4E5\n") > 5; }));
    glove->set_feedback({});
    REQUIRE(eventually([&] { return wire.count_of("A0B0C0D0E0\n") > 5; }));
    glove->stop();
    std::vector<std::string> in_order = wire.written;
    in_order.erase(std::unique(in_order.begin(), in_order.end()), in_order.end());
    CHECK(in_order == std::vector<std::string>{"\n", "A1B2C3D4E5\n", "A0B0C0D0E0\n"});
  }

  TEST_CASE("lines that come together get one answer, and half of a line gets none") {
    const std::string line = "A1B2C3D4E5\n";
    const std::string damaged = "A1B2C%D4E5\n";
    struct Case {
      std::vector<std::string> chunks;
      std::size_t answers; ///< to as many reads
    };
    for (const Case& c :
         {Case{{line}, 1}, Case{{line + line + line}, 1}, Case{{"A1B2", "C3D4E5\n"}, 1},
          Case{{line, "A1B2C3", "D4E5\nA1", "B2C3D4E5\n"}, 3}, Case{{line, damaged}, 2}}) {
      Wire wire;
      const auto glove = glove_at(wire);
      SampleRing ring(1U << 14U);
      wire.restart();
      wire.chunks = c.chunks;
      test::require_ok(glove->start(ring));
      CHECK(eventually([&] { return wire.reads_so_far() > 80; }));
      glove->stop();
      const std::size_t expected = wire.reads * c.answers / c.chunks.size();
      CHECK(wire.written.size() <= expected + 1);
      CHECK(wire.written.size() + 1 >= expected);
    }
  }

  TEST_CASE("a glove that says nothing is answered once more, as the last answer may be lost") {
    Wire wire;
    const auto glove = glove_at(wire);
    SampleRing ring(1U << 14U);
    wire.restart();
    wire.chunks = {""};
    test::require_ok(glove->start(ring));
    CHECK(eventually([&] { return wire.count_of("\n") > 3; }));
    glove->stop();
    CHECK(wire.written.size() == wire.count_of("\n"));
  }

  TEST_CASE("a glove that takes nothing holds no reader up") {
    Wire wire;
    const auto glove = glove_at(wire);
    SampleRing ring(1U << 14U);
    wire.restart();
    wire.takes_nothing = true;
    test::require_ok(glove->start(ring));
    glove->set_feedback(resistance({1, 2, 3, 4, 5}));
    CHECK(eventually([&] { return wire.count_of("\nA1B2C3D4E5\n") > 20; }));
    CHECK(eventually([&] { return ring.size() > 20; }));
    {
      const std::lock_guard lock(wire.mutex);
      CHECK(wire.longest_write == 0ms);
    }
    glove->stop();
  }

  TEST_CASE("what was cut off is ended before the next command, lest they run into one") {
    Wire wire;
    const auto glove = glove_at(wire);
    SampleRing ring(1U << 14U);
    wire.restart();
    wire.takes_all_brakes = false;
    test::require_ok(glove->start(ring));
    glove->set_feedback(resistance({1, 2, 3, 4, 5}));
    CHECK(eventually([&] { return wire.count_of("A1B2C3D4E5\n") > 3; }));
    glove->stop();
    const auto first = std::find(wire.written.begin(), wire.written.end(), "A1B2C3D4E5\n");
    REQUIRE(wire.written.end() - first > 2);
    CHECK(first[1] == "\nA1B2C3D4E5\n"); // of the first one the glove took a part
    CHECK(first[2] == "A1B2C3D4E5\n");
    CHECK(wire.written.back() == "A0B0C0D0E0\n");
  }

  TEST_CASE("a legacy glove that comes to the port of another gets empty lines only") {
    const TemporaryFolder folder;
    const auto link = folder.path() / "glove";
    auto first = std::make_unique<PtyUnit>(unit_with(LucidGlovesFirmware::waiting));
    std::filesystem::create_symlink(first->path(), link);
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + link.string()));
    test::require_ok(glove->start(ring));
    glove->set_feedback(resistance({900, 900, 900, 900, 900}));
    REQUIRE(eventually([&] { return brakes_of(*first)[0] == 900; }));
    first.reset();
    std::filesystem::remove(link);
    PtyUnit second(std::make_unique<Listener>("1&2&3&4&5&6&7&0&0&0&0&0&0\n"));
    std::filesystem::create_symlink(second.path(), link);
    REQUIRE(eventually([&] { return glove->stats().reopened == 1; }));
    ring.drain([](const GloveSample&) {});
    CHECK(eventually([&] { return ring.size() > 100; }));
    glove->stop();
    const auto heard = second.look<Listener>([](const Listener& unit) { return unit.heard(); });
    CHECK(heard.find_first_not_of('\n') == std::string::npos);
  }

  TEST_CASE("an emulated legacy firmware's brakes stay as they are") {
    PtyUnit port(unit_with(LucidGlovesFirmware::legacy));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    CHECK(fact(glove->info(), "encoding") == "legacy");
    test::require_ok(glove->start(ring));
    glove->set_feedback(resistance({1, 2, 3, 4, 5}));
    CHECK(eventually([&] { return ring.size() > 30; }));
    glove->stop();
    CHECK(brakes_of(port) == std::array{0, 0, 0, 0, 0});
    CHECK(glove->stats().silences == 0);
  }

  TEST_CASE("feedback is shown again after a silence") {
    PtyUnit port(lucidgloves().make(Side::right));
    SampleRing ring(1U << 14U);
    auto glove = required(open_glove("lucidgloves:" + port.path()));
    test::require_ok(glove->start(ring));
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
    const GloveSample sample =
        sample_at_rest(std::make_unique<LucidGlovesUnit>(options), "lucidgloves");
    check_at_rest(sample, resting_knuckles, 4095.0, 2.0); // tremor
    constexpr std::array splays{RestingJoint{Sensor::thumb_abduction, 30, 40},
                                RestingJoint{Sensor::index_middle_abduction, 7, 20},
                                RestingJoint{Sensor::middle_ring_abduction, 6, 20},
                                RestingJoint{Sensor::ring_little_abduction, 8, 20}};
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
