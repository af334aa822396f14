#include "lucidgloves/lucidgloves_driver.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/driver/glove_options.hpp>

#include "lucidgloves/lucidgloves_parser.hpp"
#include "stream/listen.hpp"
#include "stream/stream_glove.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::lucidgloves {
namespace {

using namespace std::chrono_literals;

constexpr auto write_timeout = 100ms;
constexpr auto at_once = 0ms;          ///< the reader must not wait
constexpr auto slowest_lines = 3500ms; ///< one line per second, the first of which is skipped
constexpr auto starting_time = 2500ms; ///< a board that restarts at opening, boot loader included
constexpr auto waking_time = 300ms;    ///< from the end of a wait to the next line
constexpr auto learning_time = 300ms;  ///< time for an answer, and for lines with all slots

std::optional<Side> hand_in(const Line& line) noexcept {
  if (line.hand == hand_left) return Side::left;
  if (line.hand == hand_right) return Side::right;
  return std::nullopt;
}

/// The properties of the glove in its first lines.
struct FirstLines {
  SensorMask sensors;
  std::optional<Side> hand;
  std::optional<std::uint32_t> firmware;
  std::optional<std::uint32_t> device;
  bool legacy = false;
  bool above_range = false;
  bool below_range = false;

  void add(const Line& line, std::uint16_t range) noexcept {
    GloveSample sample;
    fill_slots(line, range, sample);
    sensors.bits |= sample.present.bits;
    legacy = legacy || line.legacy;
    above_range = above_range || line.above_range > 0;
    below_range = below_range || line.below_range > 0;
    if (line.firmware) firmware = line.firmware;
    if (line.device) device = line.device;
    if (const auto side = hand_in(line)) hand = side;
  }
};

class LucidGlovesProtocol final : public GloveProtocol {
public:
  LucidGlovesProtocol(std::uint16_t range, const SideOptions& hands) noexcept
      : range_(range), hands_(hands), parser_(range) {}

  Result<GloveInfo> identify(Transport& transport, const std::string& source,
                             IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    Parser parser(range_, FirstPiece::take_if_whole);
    FirstLines glove;
    const auto take = [&](std::span<const std::byte> chunk) {
      parser.push(chunk, [&](const Line& line) { glove.add(line, range_); });
      return glove.sensors.bits != 0;
    };
    const auto learn = [&](std::span<const std::byte> chunk) { return take(chunk), false; };
    const auto learn_hand = [&](std::span<const std::byte> chunk) {
      return take(chunk), glove.hand.has_value();
    };
    IoStatus heard = listen(transport, limit, starting_time, take);
    const auto is_mute = [&] { return heard == IoStatus::timeout && parser.counters().bytes == 0; };
    if (is_mute()) { // it may wait for an answer to an earlier line
      heard = send(transport, empty_line);
      if (heard != IoStatus::gone) heard = listen(transport, limit, waking_time, take);
    }
    if (is_mute() && !legacy_) heard = send(transport, start_streaming); // a program stopped it
    if (heard != IoStatus::gone && glove.sensors.bits == 0)
      heard = listen(transport, limit, open_budget, take);
    if (heard == IoStatus::done && !glove.legacy) {
      heard = send(transport, ask_information);
      if (heard != IoStatus::gone) heard = listen(transport, limit, learning_time, learn);
      // What answered before answers again, if late, and its first sample shall be the right
      // hand's.
      if (heard != IoStatus::gone && reports_hand_ && !glove.hand)
        heard = listen(transport, limit, starting_time, learn_hand);
    }
    parser_.count_discarded(parser.counters().bytes);
    if (heard == IoStatus::gone) return went_away(source);
    if (glove.sensors.bits == 0) return stranger(source, parser.counters());
    const ChosenHand hand = choose_hand(glove.hand, hands_);
    if (const auto note = hand_override(glove.hand, hands_);
        !note.empty() && !std::exchange(warned_of_hand_, true))
      spdlog::warn("device: {}: {}", source, note);
    side_ = hand.side;
    reports_hand_ = glove.hand.has_value();
    legacy_ = glove.legacy;
    if (glove.above_range && !std::exchange(warned_of_above_, true)) {
      spdlog::warn("device: {} sends numbers above {}, which count as {}{}", source, range_, range_,
                   range_ < esp32_range ? "; the boards with larger ones have range=4095" : "");
    }
    if (glove.below_range && !std::exchange(warned_of_below_, true)) {
      spdlog::warn("device: {} sends negative numbers, which count as 0; a firmware that was built "
                   "with CLAMP_ANALOG_MAP does not",
                   source);
    }
    return describe(glove, hand);
  }

  /// It streams all the time; what it said before now is old.
  Result<void> start_stream(Transport& transport, const std::string& /*source*/,
                            const ReplyDeadline& /*limit*/) override {
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    return {};
  }

  /// The stream continues, since a stopped glove looks dead to programs that do not know (ZA).
  /// But no finger must stay locked.
  void end_stream(Transport& transport, const ReplyDeadline& /*limit*/) noexcept override {
    brakes_ = {};
    if (std::exchange(has_braked_, false) && !legacy_) show_brakes(transport, write_timeout);
  }

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/, Sink& sink) noexcept override {
    const auto take = [&](const Line& line) {
      if (!hands_.option) // an answer may be later than identify() waits
        side_ = hand_in(line).value_or(side_);
      if (!line.measures()) return;
      legacy_ = line.legacy; // another glove may have come to the same port
      GloveSample sample;
      fill_slots(line, range_, sample);
      sample.side = side_;
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
    its_turn_ = chunk.empty() || std::find(chunk.begin(), chunk.end(), line_end) != chunk.end();
  }

  /// One answer to whatever lines came together, however many: so those that wait in the glove
  /// become fewer where the host was late, and brakes take effect soon. Damaged lines count,
  /// and a glove that says nothing for 0.1 s is waiting for an answer that was lost.
  void answer(Transport& transport) noexcept override {
    if (!std::exchange(its_turn_, false)) return;
    if (has_braked_ && !legacy_) {
      show_brakes(transport, at_once);
    } else {
      send(transport, empty_line, at_once);
    }
  }

  /// The next answer has them, and all later ones do: a lost line must not leave a finger locked.
  void set_feedback(Transport& /*transport*/, const Feedback& feedback,
                    const ReplyDeadline& /*limit*/) noexcept override {
    if (legacy_) return;
    for (std::size_t k = 0; k < fingers; ++k)
      brakes_[k] = std::min(feedback.resistance[k], max_resistance);
    has_braked_ = has_braked_ || brakes_ != std::array<unsigned, fingers>{};
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

  HostClock::duration max_pause() const noexcept override { return slowest_lines; }

private:
  static IoStatus send(Transport& transport, std::string_view command,
                       std::chrono::milliseconds timeout = write_timeout) noexcept {
    return transport.write_all(std::as_bytes(std::span(command)), timeout);
  }
  void show_brakes(Transport& transport, std::chrono::milliseconds timeout) noexcept {
    std::array<char, 40> text{};
    const int length = std::snprintf(text.data(), text.size(), "\nA%uB%uC%uD%uE%u\n", brakes_[0],
                                     brakes_[1], brakes_[2], brakes_[3], brakes_[4]);
    std::string_view command(text.data(), static_cast<std::size_t>(length));
    if (!cut_off_) command.remove_prefix(1); // the LF that ends what was cut off
    cut_off_ = send(transport, command, timeout) == IoStatus::timeout;
  }
  static Error stranger(const std::string& source, const StreamCounters& heard) {
    if (heard.bytes == 0) {
      return {Errc::no_device,
              source + ": nothing comes from it; is the glove switched on, and is this its port?"};
    }
    return {Errc::no_device, source + ": what comes from it are no lines of a LucidGlove; is this "
                                      "its port, and is baud right?"};
  }
  GloveInfo describe(const FirstLines& glove, const ChosenHand& hand) const {
    GloveInfo info;
    info.model = "LucidGloves, " + std::to_string(std::popcount(glove.sensors.bits)) + " sensors";
    info.side = hand.side;
    info.sensors = glove.sensors;
    info.counts = {range_, true};
    info.abilities.resistance = !glove.legacy;
    info.facts = {{"encoding", glove.legacy ? "legacy" : "alpha"},
                  {"hand_source", std::string(hand.source)}};
    if (glove.firmware) info.facts.push_back({"firmware", std::to_string(*glove.firmware)});
    if (glove.device) info.facts.push_back({"device_type", std::to_string(*glove.device)});
    if (glove.above_range)
      info.facts.push_back({"above_range", "some values; they count as " + std::to_string(range_)});
    if (glove.below_range) info.facts.push_back({"below_range", "some values; they count as 0"});
    return info;
  }

  const std::uint16_t range_;
  const SideOptions hands_;
  Side side_ = Side::right;
  bool legacy_ = false;
  bool reports_hand_ = false; ///< the last glove did
  bool its_turn_ = false;     ///< the glove may be waiting for an answer
  bool has_braked_ = false;   ///< since it was started
  bool warned_of_hand_ = false;
  bool warned_of_above_ = false;
  bool warned_of_below_ = false;
  bool cut_off_ = false; ///< the glove took the last command only in part
  std::array<unsigned, fingers> brakes_{};
  Parser parser_;
};

} // namespace

Result<std::unique_ptr<Glove>> open_lucidgloves_by(const std::string& source, OpenPort open_port,
                                                   std::uint16_t range, const SideOptions& hands) {
  return open_stream_glove(source, std::move(open_port),
                           std::make_unique<LucidGlovesProtocol>(range, hands),
                           HostClock::now() + open_budget);
}

Result<std::unique_ptr<Glove>> open_lucidgloves(const DeviceSpec& spec, std::optional<Side> side) {
  if (auto allowed = allow_options(spec, {"baud", "hand", "range"}); !allowed)
    return allowed.error();
  const auto rate = number_option(spec, "baud", {baud, 57'600, 38'400, 19'200, 9'600});
  if (!rate) return rate.error();
  const auto range = number_option(spec, "range", {esp32_range, avr_range});
  if (!range) return range.error();
  const auto hand = hand_option(spec);
  if (!hand) return hand.error();
  if (auto named = require_port(spec, "lucidgloves:/dev/ttyUSB0"); !named) return named.error();
  return open_lucidgloves_by(spec.text, follow_port(spec.target, *rate),
                             static_cast<std::uint16_t>(*range), {*hand, side});
}

} // namespace nendo::driver::lucidgloves
