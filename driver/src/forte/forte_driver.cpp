#include <string>

#include <nendo/driver/glove_options.hpp>

#include "drivers.hpp"
#include "forte/forte_parser.hpp"
#include "stream/listen.hpp"
#include "stream/stream_glove.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver::forte {
namespace {

using namespace std::chrono_literals;

constexpr auto write_timeout = 100ms;
constexpr auto answer_time = 1100ms; ///< three times: less than open_budget
constexpr int tries = 3;

constexpr SensorMask sensors = mask_of(slots);

class ForteProtocol final : public GloveProtocol {
public:
  ForteProtocol(bool bluetooth, const SideOptions& hands) noexcept
      : bluetooth_(bluetooth), hand_(choose_hand(std::nullopt, hands)) {}

  /// A glove that streams already gets the commands again: another program may have chosen the
  /// other link.
  Result<GloveInfo> identify(Transport& transport, const std::string& source,
                             IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    Parser parser;
    std::optional<Record> record;
    const auto take = [&](std::span<const std::byte> chunk) {
      parser.push(chunk, [&](const Record& heard) { record = heard; });
      return record.has_value();
    };
    IoStatus heard = IoStatus::timeout;
    for (int k = 0; k < tries && heard == IoStatus::timeout; ++k) {
      heard = command_to_send(transport);
      if (heard != IoStatus::gone) heard = listen(transport, limit, answer_time, take);
    }
    parser_.count_discarded(parser.counters().bytes);
    if (heard == IoStatus::gone) return went_away(source);
    if (!record) return stranger(source, parser.counters().bytes);
    return describe(*record);
  }

  /// It streams already, and no command is known that ends the stream. Earlier bytes are old.
  Result<void> start_stream(Transport& transport, const std::string& /*source*/,
                            const ReplyDeadline& /*limit*/) override {
    parser_.count_discarded(drop_waiting(transport));
    parser_.reset();
    return {};
  }

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/, Sink& sink) noexcept override {
    const auto take = [&](const Record& record) {
      GloveSample sample;
      for (std::size_t k = 0; k < slots.size(); ++k)
        sample.set(slots[k], RawCount{record.flexion[k]});
      sample.side = hand_.side;
      sink.deliver(sample);
    };
    parser_.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  IoStatus command_to_send(Transport& transport) const noexcept {
    const IoStatus sent = transport.write_all(std::as_bytes(std::span(data_on)), write_timeout);
    if (sent == IoStatus::gone) return sent;
    const Command& link = bluetooth_ ? to_bluetooth : to_usb;
    return transport.write_all(std::as_bytes(std::span(link)), write_timeout);
  }
  static Error stranger(const std::string& source, std::uint64_t bytes_heard) {
    if (bytes_heard == 0) {
      return {Errc::no_device, source + ": nothing comes from it; is the glove switched on, is "
                                        "this its port, and is link (usb, bluetooth) right?"};
    }
    return {Errc::no_device, source + ": what comes from it are no records of a Forte glove; is "
                                      "this its port, and is baud (460800, 115200) right?"};
  }
  GloveInfo describe(const Record& record) const {
    GloveInfo info;
    info.model = "Forte Data Glove, 10 sensors";
    info.side = hand_.side;
    info.sensors = sensors;
    info.counts = {max_count, true};
    info.facts = {{"link", bluetooth_ ? "bluetooth" : "usb"},
                  {"hand_source", std::string(hand_.source)},
                  {"battery_raw", std::to_string(record.battery)}};
    return info;
  }

  const bool bluetooth_;
  const ChosenHand hand_;
  Parser parser_;
};

} // namespace

Result<std::unique_ptr<Glove>> open_forte(const DeviceSpec& spec, std::optional<Side> side) {
  if (auto allowed = allow_options(spec, {"baud", "hand", "link"}); !allowed)
    return allowed.error();
  const auto rate = number_option(spec, "baud", {baud, other_baud});
  if (!rate) return rate.error();
  const auto hand = hand_option(spec);
  if (!hand) return hand.error();
  const auto link = word_option(spec, "link", {"usb", "bluetooth"});
  if (!link) return link.error();
  if (auto named = require_port(spec, "forte:/dev/ttyACM0"); !named) return named.error();
  return open_stream_glove(
      spec.text, follow_port(spec.target, *rate),
      std::make_unique<ForteProtocol>(*link == "bluetooth", SideOptions{*hand, side}),
      HostClock::now() + open_budget);
}

} // namespace nendo::driver::forte
