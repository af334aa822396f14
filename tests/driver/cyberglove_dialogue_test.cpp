#include "cyberglove/cyberglove_dialogue.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

#include "support/canned_transport.hpp"

namespace cyberglove_dialogue_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::cyberglove;
using nendo::test::CannedTransport;
using namespace std::chrono_literals;
using namespace std::string_view_literals;

namespace {

/// Time for an answer that is there already, on a busy machine; silence takes all of it.
constexpr auto max_wait = 250ms;

struct Exchange {
  Answer answer;
  std::array<std::byte, 3> data{};
  std::string written;
};

Exchange ask_mask(std::string_view reply) {
  CannedTransport transport(reply);
  Dialogue dialogue(transport, HostClock::now() + max_wait);
  Exchange exchange{};
  exchange.answer = dialogue.ask(ask_hardware_mask.letter, exchange.data, 1s);
  exchange.written = transport.written;
  return exchange;
}

} // namespace

TEST_SUITE("cyberglove_dialogue") {
  TEST_CASE("a reply is read by its length, since its data may contain NUL") {
    const Exchange zeros = ask_mask("?K\x00\x00\x01\x00"sv);
    CHECK(zeros.written == "?K");
    CHECK(zeros.answer == Answer::good);
    CHECK(zeros.data == std::array{std::byte{0}, std::byte{0}, std::byte{1}});
  }

  TEST_CASE("bytes before a reply are skipped") {
    CHECK(ask_mask("junk?\x00"
                   "e?\x01?K\x7F\xFF\x7F\x00"sv)
              .answer == Answer::good);
  }

  TEST_CASE("errors are distinguished") {
    CHECK(ask_mask("e?\0"sv).answer == Answer::unknown);
    CHECK(ask_mask("en\0"sv).answer == Answer::bad_number);
    CHECK(ask_mask("ey\0"sv).answer == Answer::bad_sync_rate);
    CHECK(ask_mask("eg\0"sv).answer == Answer::no_glove);
    CHECK(ask_mask("es\0"sv).answer == Answer::bad_rate);
    CHECK(ask_mask("ex\0"sv).answer == Answer::nonsense);
  }

  TEST_CASE("silence, half a reply and a wrong end are not answers") {
    CHECK(ask_mask("").answer == Answer::silent);
    CHECK(ask_mask("?K\x7F"sv).answer == Answer::nonsense);
    CHECK(ask_mask("?K\x7F\xFF\x7F"sv).answer == Answer::nonsense);
    CHECK(ask_mask("?K\x7F\xFF\x7F\x7F"sv).answer == Answer::nonsense);
    CHECK(ask_mask("?K").answer == Answer::nonsense); // an echo
    CHECK(ask_mask(std::string(100'000, 'x')).answer == Answer::nonsense);
  }

  TEST_CASE("a command is confirmed in two bytes or in three, and by its own echo only") {
    struct Case {
      std::string_view echo, reply;
      Answer answer;
    };
    for (const Case& one : {
             Case{"D", "D\0"sv, Answer::good},
             Case{"D", "D\x01\0"sv, Answer::good},
             Case{"D", "\0D\0"sv, Answer::good},
             Case{"D", "junk\0D\0"sv, Answer::good},
             Case{"t", "t\r\n\0"sv, Answer::good},
             Case{"D", ""sv, Answer::silent},
             Case{"D", "D"sv, Answer::nonsense},
             Case{"D", "D\x01\x02\0"sv, Answer::nonsense},
             Case{"D", "S\0"sv, Answer::nonsense},
             Case{"D", "e?\0"sv, Answer::unknown},
             Case{"t", "en\0"sv, Answer::bad_number},
             Case{"t", "tes\0"sv, Answer::bad_rate},
             Case{"D", "eg\0"sv, Answer::no_glove},
             Case{"y", "ey\0"sv, Answer::bad_sync_rate}, // not its echo
             Case{"y", "y\0"sv, Answer::good},
             Case{"1es", "1es\0"sv, Answer::good}, // no error, though it ends like one
             Case{"1es", "es\0"sv, Answer::bad_rate},
             Case{"CA", "CA\0"sv, Answer::good},
             Case{"CA", "A\0"sv, Answer::nonsense},
         }) {
      CAPTURE(one.echo);
      CAPTURE(one.reply);
      CannedTransport transport(one.reply);
      Dialogue dialogue(transport, HostClock::now() + max_wait);
      CHECK(dialogue.command(std::as_bytes(std::span("D\x01"sv)), one.echo, 1s) == one.answer);
      CHECK(transport.written == "D\x01");
    }
  }

  TEST_CASE("a pause ends with the answer to it, not with a value that looks like it") {
    const auto pause = [](std::string_view reply) {
      CannedTransport transport(reply);
      Dialogue dialogue(transport, HostClock::now() + 200ms);
      const Answer answer = dialogue.pause_stream(100ms);
      CHECK(transport.written == "\x03");
      return std::pair(answer, dialogue.bytes_received());
    };
    CHECK(pause("\x03\0rest"sv) == std::pair(Answer::good, std::uint64_t{2}));
    CHECK(pause("S\x11\x22\0\x03\0rest"sv) == std::pair(Answer::good, std::uint64_t{6}));
    CHECK(pause("S\x11\x03\0\x03\0rest"sv) == std::pair(Answer::good, std::uint64_t{6}));
    CHECK(pause("S\x11\x03\0"sv) == std::pair(Answer::good, std::uint64_t{4})); // broken off
    CHECK(pause("S\x11\x22\0"sv).first == Answer::silent);
    // A CyberGlove III ends a stream of 12-bit records so.
    CHECK(pause("10:20\r\n\0\x03"sv) == std::pair(Answer::good, std::uint64_t{9}));
    CHECK(pause("\x03"sv) == std::pair(Answer::good, std::uint64_t{1}));
    CHECK(pause("\x03\x11\0\x03\0rest"sv) == std::pair(Answer::good, std::uint64_t{5}));
    CHECK(pause("").first == Answer::silent);
  }

  TEST_CASE("text ends at NUL and is bounded") {
    std::string text;
    CannedTransport good("?i CyberGlove\0more"sv);
    CHECK(Dialogue(good, HostClock::now() + max_wait).ask_text('i', text, 1s) == Answer::good);
    CHECK(text == " CyberGlove");
    const std::string endless = "?i" + std::string(10'000, 'x');
    CannedTransport flood(endless);
    CHECK(Dialogue(flood, HostClock::now() + 1s).ask_text('i', text, 1s) == Answer::good);
    CHECK(text.size() == 2048);
  }

  TEST_CASE("a lost device and a cancelled dialogue end every call at once") {
    CannedTransport transport("");
    transport.gone = true;
    Dialogue lost(transport, HostClock::now() + 10s);
    std::array<std::byte, 1> data{};
    CHECK(lost.ask(ask_state.letter, data, 10s) == Answer::gone);
    CHECK(lost.command(data, "D", 10s) == Answer::gone);
    CHECK(lost.pause_stream(10s) == Answer::gone);
    CHECK(lost.stop_stream() == Answer::gone);

    transport.gone = false;
    std::stop_source source;
    source.request_stop();
    Dialogue cancelled(transport, HostClock::now() + 10s, source.get_token());
    const HostTime start = HostClock::now();
    CHECK(cancelled.ask(ask_state.letter, data, 10s) == Answer::silent);
    CHECK(cancelled.pause_stream(10s) == Answer::silent);
    CHECK(HostClock::now() - start < 1s);
  }
}

} // namespace cyberglove_dialogue_test
