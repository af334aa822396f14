#include "cyberglove/cyberglove_dialogue.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::driver::cyberglove;
using namespace std::chrono_literals;
using namespace std::string_view_literals;

namespace {

/// Answers whatever is written with fixed bytes, one at a time; then time is up at once.
class CannedTransport final : public Transport {
public:
  explicit CannedTransport(std::string_view reply) : reply_(reply) {}
  ReadResult read_some(std::span<std::byte> buffer, std::chrono::milliseconds) noexcept override {
    if (gone) return {IoStatus::gone, 0};
    if (unread_.empty()) return {IoStatus::timeout, 0};
    buffer[0] = static_cast<std::byte>(unread_.front());
    unread_.remove_prefix(1);
    return {IoStatus::done, 1};
  }
  IoStatus write_all(std::span<const std::byte> bytes,
                     std::chrono::milliseconds) noexcept override {
    for (const std::byte byte : bytes)
      written.push_back(std::to_integer<char>(byte));
    unread_ = reply_;
    return gone ? IoStatus::gone : IoStatus::done;
  }
  void discard_input() noexcept override { unread_ = {}; }

  std::string written;
  bool gone = false;

private:
  const std::string_view reply_;
  std::string_view unread_;
};

struct Exchange {
  Answer answer;
  std::array<std::byte, 3> data{};
  std::string written;
};

Exchange ask_mask(std::string_view reply) {
  CannedTransport transport(reply);
  Dialogue dialogue(transport, HostClock::now() + 20ms);
  Exchange exchange{};
  exchange.answer = dialogue.ask(ask_hardware_mask, exchange.data, 1s);
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

  TEST_CASE("what stands before a reply is skipped") {
    CHECK(ask_mask("junk?\x00"
                   "e?\x01?K\x7F\xFF\x7F\x00"sv)
              .answer == Answer::good);
  }

  TEST_CASE("errors are told apart") {
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

  TEST_CASE("a setting is confirmed in two bytes or in three") {
    for (const std::string_view reply : {"D\0"sv, "D\x01\0"sv, "\0D\0"sv}) {
      CannedTransport transport(reply);
      Dialogue dialogue(transport, HostClock::now() + 20ms);
      CHECK(dialogue.set('D', true, 1s) == Answer::good);
      CHECK(transport.written == "D\x01");
    }
    for (const std::string_view reply : {"D"sv, "D\x01\x02\0"sv, "S\0"sv}) {
      CannedTransport transport(reply);
      Dialogue dialogue(transport, HostClock::now() + 20ms);
      CHECK(dialogue.set('D', true, 1s) == Answer::nonsense);
    }
    CannedTransport transport("e?\0"sv);
    Dialogue dialogue(transport, HostClock::now() + 20ms);
    CHECK(dialogue.set('D', true, 1s) == Answer::unknown);
  }

  TEST_CASE("text ends at NUL and is bounded") {
    std::string text;
    CannedTransport good("?i CyberGlove\0more"sv);
    CHECK(Dialogue(good, HostClock::now() + 20ms).ask_text('i', text, 1s) == Answer::good);
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
    CHECK(lost.ask(ask_state, data, 10s) == Answer::gone);
    CHECK(lost.set('D', true, 10s) == Answer::gone);
    CHECK(lost.stop_stream() == Answer::gone);

    transport.gone = false;
    std::stop_source source;
    source.request_stop();
    Dialogue cancelled(transport, HostClock::now() + 10s, source.get_token());
    const HostTime start = HostClock::now();
    CHECK(cancelled.ask(ask_state, data, 10s) == Answer::silent);
    CHECK(HostClock::now() - start < 1s);
  }
}
