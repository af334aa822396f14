#include "cyberglove/cyberglove_dialogue.hpp"

#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/canned_transport.hpp"

namespace cyberglove_commands_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::cyberglove;
using nendo::test::CannedTransport;
using nendo::test::Script;
using nendo::test::UnitTransport;
using namespace std::chrono_literals;
using namespace std::string_literals;
using namespace std::string_view_literals;

namespace {

/// A unit that answers with `reply`, and the bytes sent to it.
struct Desk {
  explicit Desk(std::string_view reply) : transport(reply) {}
  explicit Desk(std::vector<std::string> replies) : transport(std::move(replies)) {}

  CannedTransport transport;
  Dialogue dialogue{transport, HostClock::now() + 1s};
  Commands commands{dialogue, 250ms};
};

/// What a command that is answered by `reply` says, and what it returns.
template <class Call>
auto say(std::string_view sent, std::string_view reply, Call&& call) {
  Desk desk(reply);
  auto result = call(desk.commands);
  CHECK(desk.transport.written == sent);
  return result;
}

template <class T>
Reply<T> say(std::string_view sent, std::string_view reply, Query<T> query) {
  return say(sent, reply, [&](Commands& c) { return c.ask(query); });
}

} // namespace

TEST_SUITE("cyberglove_commands") {
  TEST_CASE("queries and their replies are those of the reference") {
    CHECK(say("?S", "?S\x16\0"sv, ask_sensor_count).value == 22);
    CHECK(say("?K", "?K\x7F\xFF\x7F\0"sv, ask_hardware_mask).value == sensors_22);
    CHECK(say("?M", "?M\x3F\xBB\x7B\0"sv, ask_software_mask).value == sensors_18);
    CHECK(say("?N", "?N\x12\0"sv, ask_value_count).value == 18);
    CHECK(say("?R", "?R\x01\0"sv, ask_side).value == Side::right);
    CHECK(say("?R", "?R\0\0"sv, ask_side).value == Side::left);
    CHECK(say("?B", "?B\x10\0"sv, ask_baud).value == 0x10);

    const auto state = say("?G", "?G\x01\0"sv, ask_state);
    CHECK(state.value.initialised);
    CHECK_FALSE(state.value.connected);
    CHECK(say("?G", "?G\x02\0"sv, ask_state).value.connected);

    const auto off =
        say("?W", "?W\0\0"sv, [](Commands& c) { return c.get(Setting::wrist_switch); });
    CHECK(off.answer == Answer::good);
    CHECK_FALSE(off.value);
    CHECK(say("?F", "?F\x01\0"sv, [](Commands& c) { return c.get(Setting::filter); }).value);
    // An ASCII digit is not 0 either; one driver sent it so for years.
    CHECK(say("?F", "?F0\0"sv, [](Commands& c) { return c.get(Setting::filter); }).value);
  }

  TEST_CASE("versions, calibrations and vibrations may hold NUL anywhere") {
    const auto version = say("?V", "?V\x02\0\0\x01\0"sv, ask_firmware);
    CHECK(version.value == std::array<std::uint8_t, 4>{2, 0, 0, 1});
    CHECK(say("?v", "?v 2.1\r\n\0"sv, [](Commands& c) { return c.firmware_text(); }).value ==
          " 2.1\r\n");
    CHECK(say("?i", "?i \r\nCG\r\n\0"sv, [](Commands& c) { return c.information(); }).value ==
          " \r\nCG\r\n");
    const auto vibration = say("?A", "?A\0\x01\0\x03\0\xFF\0"sv, ask_vibration);
    CHECK(vibration.value == Vibration{0, 1, 0, 3, 0, 255});
    const auto calibration =
        say("?C", "?C\0\x64\x0A\0\0"sv, [](Commands& c) { return c.hardware_calibration(2); });
    REQUIRE(calibration);
    CHECK(calibration.value.offset[1] == 0x64);
    CHECK(calibration.value.gain[0] == 0x0A);
    CHECK(calibration.value.gain[1] == 0);
  }

  TEST_CASE("settings are the letter and raw bytes, and are confirmed by the letter") {
    struct Case {
      std::string_view sent, reply;
      Answer (*call)(Commands&);
    };
    const std::vector<Case> cases{
        {"F\0"sv, "F\0"sv, [](Commands& c) { return c.set(Setting::filter, false); }},
        {"U\x01"sv, "U\0"sv, [](Commands& c) { return c.set(Setting::status_byte, true); }},
        {"D\x01"sv, "D\x01\0"sv, [](Commands& c) { return c.set(Setting::time_stamp, true); }},
        {"J\0"sv, "J\0"sv, [](Commands& c) { return c.set(Setting::switch_drives_light, false); }},
        {"L\x01"sv, "L\0"sv, [](Commands& c) { return c.set(Setting::light, true); }},
        {"W\x01"sv, "W\0"sv, [](Commands& c) { return c.set(Setting::wrist_switch, true); }},
        {"Q\x01"sv, "Q\0"sv, [](Commands& c) { return c.set(Setting::quantised, true); }},
        {"M\x7F\xFF\x7F"sv, "M\0"sv, [](Commands& c) { return c.set_software_mask(sensors_22); }},
        {"N\x12"sv, "N\0"sv, [](Commands& c) { return c.send(set_value_count, 18); }},
        {"Y\x01"sv, "Y\0"sv, [](Commands& c) { return c.send(set_sync, 1); }},
        {"A\xFF\x01\x02\x03\x04\x05\xFF"sv, "A\0"sv,
         [](Commands& c) { return c.set_vibration({1, 2, 3, 4, 5, 255}); }},
        {"\x09"sv, "\x09\0"sv, [](Commands& c) { return c.send(reread_glove); }},
        {"1eu"sv, "1eu\0"sv, [](Commands& c) { return c.send(third_enable_usb); }},
        {"1m\x03"sv, "1m\0"sv, [](Commands& c) { return c.send(third_frame_rate, 3); }},
    };
    for (const Case& one : cases) {
      CAPTURE(one.sent);
      CHECK(say(one.sent, one.reply, one.call) == Answer::good);
    }
  }

  TEST_CASE("each error is reported as what it is") {
    // After a refusal the unit is interrupted: it may take an argument for another command.
    const auto sync = [](Commands& c) { return c.send(set_sync, 1); };
    CHECK(say("Y\x01\x03", "ey\0"sv, sync) == Answer::bad_sync_rate);
    CHECK(say("Y\x01\x03", "e?\0e?\0"sv, sync) == Answer::unknown);
    CHECK(say("Y\x01\x03", "en\0"sv, sync) == Answer::bad_number);
    CHECK(say("Y\x01\x03", "eg\0"sv, sync) == Answer::no_glove);
    CHECK(say("Y\x01\x03", "", sync) == Answer::silent);
    CHECK(say("1eu\x03", "e?\0e?\0"sv, [](Commands& c) { return c.send(third_enable_usb); }) ==
          Answer::unknown);
    CHECK(say("t 1280 1\r\x03", "es\0"sv, [](Commands& c) {
            return c.set_period({1280, 1});
          }).answer == Answer::bad_rate);
    CHECK(say("?S", "?S\x16", ask_sensor_count).answer == Answer::nonsense);
    CHECK(say("?K", "e?\0"sv, ask_hardware_mask).answer == Answer::unknown);
  }

  TEST_CASE("a cancelled command says nothing and does not wait") {
    const auto source = std::make_unique<std::stop_source>(); // GCC 12 misjudges one on the stack
    source->request_stop();
    CannedTransport transport("F\0"sv);
    Dialogue dialogue(transport, HostClock::now() + 10s, source->get_token());
    Commands commands(dialogue, 10s);
    CHECK(commands.set(Setting::filter, true) == Answer::silent);
    CHECK(commands.information().answer == Answer::silent);
    CHECK(commands.set_period({1280, 1}).answer == Answer::silent);
    CHECK(transport.written.empty());
  }

  TEST_CASE("the period is set in text, and its reply shows the byte order") {
    Desk high({"t\0"s, "?T\x05\0\0\x01\0"s});
    auto reply = high.commands.set_period({1280, 1});
    CHECK(high.transport.written == "t 1280 1\r?T");
    CHECK(reply.answer == Answer::good);
    CHECK(reply.value == WordOrder::high_first);

    Desk low({"t\0"s, "?T\0\x05\x01\0\0"s});
    reply = low.commands.set_period({1280, 1});
    CHECK(reply.answer == Answer::good);
    CHECK(reply.value == WordOrder::low_first);

    Desk other({"t\0"s, "?T\x02\x80\0\x01\0"s}); // 640, 1
    CHECK(other.commands.set_period({1280, 1}).answer == Answer::other_value);

    Desk garbled({"?%\0"s, "?T\x05\0\0\x01\0"s}); // done, whatever the confirmation says
    CHECK(garbled.commands.set_period({1280, 1}).answer == Answer::good);

    Desk does_not_reply({"t\0"s, "e?\0"s});
    reply = does_not_reply.commands.set_period({65535, 65535});
    CHECK(does_not_reply.transport.written == "t 65535 65535\r?T");
    CHECK(reply.answer == Answer::good);
    CHECK_FALSE(reply.value);
  }

  TEST_CASE("parameter flags are the reference's bits") {
    // Power-up of a working right glove: filter, switch drives light, right hand, valid, plugged
    // in.
    const auto reply = say("?P", "?P\x81\xD8\0\0"sv, ask_parameters);
    REQUIRE(reply);
    CHECK(reply.value == (0xC081U | 1U << flag_filter | 1U << flag_switch_drives_light));
    const auto touch = say("?P", "?P\x87\x27\x03\0"sv, ask_parameters);
    CHECK(touch.value ==
          (0x0381U | 1U << flag_cybertouch | 1U << flag_quantised | 1U << flag_wrist_switch |
           1U << flag_light | 1U << flag_status_byte | 1U << flag_time_stamp));

    CHECK(wrist_switch_of(0x87) == WristSwitch::on);
    CHECK(wrist_switch_of(0x85) == WristSwitch::off);
    CHECK(wrist_switch_of(0) == WristSwitch::unknown);
  }

  TEST_CASE("twenty-five settings take no longer than their replies") {
    Script script;
    script.knows_all = true;
    UnitTransport transport(script);
    Dialogue dialogue(transport, HostClock::now() + 10s);
    Commands commands(dialogue, 1s);
    const HostTime start = HostClock::now();
    for (int k = 0; k < 25; ++k)
      CHECK(commands.set(Setting::filter, k % 2 == 0) == Answer::good);
    CHECK(HostClock::now() - start < 1s);
  }
}

} // namespace cyberglove_commands_test
