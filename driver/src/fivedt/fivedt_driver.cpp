#include <array>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/driver/glove_options.hpp>

#include "drivers.hpp"
#include "fivedt/fivedt_parser.hpp"
#include "stream/listen.hpp"
#include "stream/stream_glove.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::fivedt {
namespace {

using namespace std::chrono_literals;

constexpr auto write_timeout = 100ms;
constexpr auto answer_time = 800ms; ///< twice for each of two questions: less than open_budget
constexpr int tries = 2;
constexpr auto quiet_time = 50ms; ///< longer than any gap within an answer
constexpr auto max_drain = 300ms;

constexpr std::array<Sensor, fingers> slots{
    Sensor::thumb_mcp, Sensor::index_mcp, Sensor::middle_mcp, Sensor::ring_mcp, Sensor::little_mcp};

constexpr SensorMask sensors = mask_of(slots);

/// The user's options.
struct Wishes {
  bool wireless = false;
  bool left_little_first = false;
  SideOptions hands;
};

class FiveDtProtocol final : public GloveProtocol {
public:
  explicit FiveDtProtocol(const Wishes& wishes) noexcept
      : wireless_(wishes.wireless), left_little_first_(wishes.left_little_first),
        hands_(wishes.hands) {}

  Result<GloveInfo> identify(Transport& transport, const std::string& source,
                             IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    return wireless_ ? recognise(transport, source, limit) : ask(transport, source, limit);
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& /*limit*/) override {
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    if (!wireless_ && send(transport, stream_command) == IoStatus::gone) return went_away(source);
    return {};
  }

  void end_stream(Transport& transport, const ReplyDeadline& limit) noexcept override {
    if (!wireless_) reset(transport, limit, quiet_time);
  }

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/, Sink& sink) noexcept override {
    const auto take = [&](const Record& record) {
      GloveSample sample;
      for (std::size_t k = 0; k < fingers; ++k)
        sample.set(slots[little_first() ? fingers - 1 - k : k], RawCount{record.flexion[k]});
      sample.side = side_;
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  static IoStatus send(Transport& transport, char command) noexcept {
    return transport.write_all(std::as_bytes(std::span(&command, 1)), write_timeout);
  }
  Error stranger(const std::string& source, std::uint64_t bytes_heard) const {
    const std::string what =
        wireless_ ? (bytes_heard == 0 ? ": nothing comes from it"
                                      : ": what comes from it are no samples of a 5DT glove")
                  : (bytes_heard == 0 ? ": no answer to A and G within 3 s"
                                      : ": what is there does not answer G like a 5DT glove");
    return {Errc::no_device,
            source + what +
                "; is the glove switched on, is this its port, and is baud right (19200, wireless "
                "9600)?"};
  }

  /// Throws away what comes until nothing has come for quiet_time: timeout, as hoped. Done: it
  /// never stopped.
  IoStatus fall_quiet(Transport& transport, const ReplyDeadline& limit) noexcept {
    const HostTime until = HostClock::now() + max_drain;
    IoStatus heard = IoStatus::done;
    while (heard == IoStatus::done && HostClock::now() < until)
      heard = hear(transport, limit, quiet_time);
    return heard;
  }
  IoStatus hear(Transport& transport, const ReplyDeadline& limit,
                std::chrono::milliseconds longest) noexcept {
    return listen(transport, limit, longest, [&](std::span<const std::byte> chunk) {
      parser_.count_discarded(chunk.size());
      return true;
    });
  }

  /// Ends whatever streams; waits `answer` for the first byte of the reply. Where a stream ran, the
  /// reply is somewhere among its last samples.
  IoStatus reset(Transport& transport, const ReplyDeadline& limit,
                 std::chrono::milliseconds answer) noexcept {
    if (send(transport, reset_command) == IoStatus::gone) return IoStatus::gone;
    const IoStatus heard = hear(transport, limit, answer);
    return heard == IoStatus::done ? fall_quiet(transport, limit) : heard;
  }

  /// A glove that was reset says what it is asked and no more.
  IoStatus ask_information(Transport& transport, const ReplyDeadline& limit,
                           InformationFinder& finder) {
    finder = {};
    if (send(transport, information_command) == IoStatus::gone) return IoStatus::gone;
    const IoStatus heard =
        listen(transport, limit, answer_time, [&](std::span<const std::byte> chunk) {
          parser_.count_discarded(chunk.size());
          return finder.push(chunk);
        });
    if (heard != IoStatus::done) return heard;
    return fall_quiet(transport, limit) == IoStatus::timeout ? IoStatus::done : IoStatus::timeout;
  }

  Result<GloveInfo> ask(Transport& transport, const std::string& source,
                        const ReplyDeadline& limit) {
    const std::uint64_t before = parser_.counters().bytes;
    InformationFinder finder;
    IoStatus heard = IoStatus::timeout;
    for (int k = 0; k < tries && heard == IoStatus::timeout; ++k) {
      heard = reset(transport, limit, answer_time);
      if (heard != IoStatus::gone) heard = ask_information(transport, limit, finder);
    }
    if (heard == IoStatus::gone) return went_away(source);
    const auto information =
        heard == IoStatus::done ? decode_information(finder.answer()) : std::nullopt;
    if (!information) return stranger(source, parser_.counters().bytes - before);
    if (const auto note = hand_override(information->side, hands_);
        !note.empty() && !std::exchange(warned_of_hand_, true))
      spdlog::warn("device: {}: {}", source, note);
    GloveInfo info = describe(choose_hand(information->side, hands_));
    if (!information->name.empty()) info.model = information->name + ", 5 sensors";
    info.facts.push_back({"firmware", std::to_string(information->version_major) + "." +
                                          std::to_string(information->version_minor)});
    info.facts.push_back({"tilt_sensor", information->tilt_sensor ? "yes" : "no"});
    return info;
  }

  /// One sample may be noise; two of them, one right after the other, are no noise.
  Result<GloveInfo> recognise(Transport& transport, const std::string& source,
                              const ReplyDeadline& limit) {
    Parser parser;
    bool seen_one = false;
    bool proven = false;
    FindingSink take{[&](const Record&) { proven = std::exchange(seen_one, true) || proven; },
                     [&](BadRecord) { seen_one = false; }};
    const IoStatus heard =
        listen(transport, limit, open_budget, [&](std::span<const std::byte> chunk) {
          parser.push(chunk, take);
          return proven;
        });
    parser_.count_discarded(parser.counters().bytes);
    if (heard == IoStatus::gone) return went_away(source);
    if (heard == IoStatus::timeout) return stranger(source, parser.counters().bytes);
    return describe(choose_hand(std::nullopt, hands_));
  }

  bool little_first() const noexcept { return left_little_first_ && side_ == Side::left; }
  /// For people: which finger comes first, and what to do if it is another one.
  std::string finger_order() const {
    if (side_ == Side::right) return "thumb first";
    return little_first() ? "little finger first, as left_first=little says"
                          : "thumb first; if that is the wrong way round, use left_first=little";
  }

  GloveInfo describe(const ChosenHand& hand) {
    side_ = hand.side;
    GloveInfo info;
    info.model = "5DT Data Glove 5, 5 sensors";
    info.side = hand.side;
    info.sensors = sensors;
    info.counts = {255, true};
    info.facts = {{"link", wireless_ ? "wireless" : "wired"},
                  {"hand_source", std::string(hand.source)},
                  {"finger_order", finger_order()}};
    return info;
  }

  const bool wireless_;
  const bool left_little_first_;
  const SideOptions hands_;
  Side side_ = Side::right;
  bool warned_of_hand_ = false;
  Parser parser_;
};

} // namespace

Result<std::unique_ptr<Glove>> open_fivedt(const DeviceSpec& spec, std::optional<Side> side) {
  if (auto allowed = allow_options(spec, {"baud", "hand", "left_first"}); !allowed)
    return allowed.error();
  const auto baud = number_option(spec, "baud", {wired_baud, wireless_baud});
  if (!baud) return baud.error();
  const auto hand = hand_option(spec);
  if (!hand) return hand.error();
  const auto left_first = word_option(spec, "left_first", {"thumb", "little"});
  if (!left_first) return left_first.error();
  if (auto named = require_port(spec, "5dt:/dev/ttyUSB0"); !named) return named.error();
  auto protocol = std::make_unique<FiveDtProtocol>(
      Wishes{*baud == wireless_baud, *left_first == "little", SideOptions{*hand, side}});
  return open_stream_glove(spec.text, follow_port(spec.target, *baud), std::move(protocol),
                           HostClock::now() + open_budget);
}

} // namespace nendo::driver::fivedt
