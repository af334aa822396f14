#include "cyberglove/cyberglove_driver.hpp"

#include <array>
#include <utility>

#include "cyberglove/cyberglove_dialogue.hpp"
#include "cyberglove/cyberglove_identity.hpp"
#include "cyberglove/cyberglove_parser.hpp"
#include "glove_spec.hpp"
#include "transport/open_transport.hpp"

namespace nendo::driver {
namespace {

using namespace cyberglove;

class CyberGloveProtocol final : public GloveProtocol {
public:
  Result<GloveInfo> identify(Transport& transport, const std::string& source, Occasion occasion,
                             const Patience& patience) override {
    Dialogue dialogue(transport, patience.deadline, patience.cancelled);
    if (occasion == Occasion::damaged && dialogue.stop_stream() != Answer::gone) {
      dialogue.reread_glove();
    }
    auto identity = cyberglove::identify(dialogue, source);
    parser_.count_discarded(dialogue.bytes_received());
    if (identity) identity_ = *std::move(identity);
    parser_.reset(identity_.shape);
    if (!identity) return identity.error();
    GloveInfo info;
    info.model = identity_.model;
    info.side = identity_.side;
    info.sensors = identity_.channels.sensors();
    info.rate_hz = identity_.rate_hz;
    return info;
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const Patience& patience) override {
    Dialogue dialogue(transport, patience.deadline, patience.cancelled);
    dialogue.stop_stream();
    const auto ready = check_state(dialogue, source);
    const Answer answer = ready ? dialogue.start_stream() : Answer::silent;
    parser_.count_discarded(dialogue.bytes_received());
    parser_.reset(identity_.shape);
    if (!ready) return ready.error();
    if (answer != Answer::good) {
      return Error{Errc::no_device, source + " went away; is the cable loose?"};
    }
    return {};
  }

  void end_stream(Transport& transport, const Patience& patience) noexcept override {
    Dialogue dialogue(transport, patience.deadline, patience.cancelled);
    dialogue.stop_stream();
    parser_.count_discarded(dialogue.bytes_received());
  }

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/,
            SampleSink& sink) noexcept override {
    parser_.push(chunk, [&](const Record& record) { deliver(record, sink); });
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  void deliver(const Record& record, SampleSink& sink) const noexcept {
    GloveSample sample;
    const ChannelMap& channels = identity_.channels;
    for (std::size_t k = 0; k < channels.count; ++k) {
      sample.raw[channels.slot[k]] = RawCount{record.values[k]};
    }
    sample.present = channels.sensors();
    sample.device_time = std::chrono::nanoseconds(record.ticks * std::uint64_t{78125} / 9);
    sample.sampled_too_fast = record.sampled_too_fast;
    sample.has_device_time = identity_.shape.time_stamp;
    sample.side = identity_.side;
    sink.deliver(sample);
  }

  Identity identity_;
  Parser parser_{RecordShape{}};
};

Result<int> baud_of(const GloveSpec& spec) {
  constexpr std::array known{115'200, 57'600, 38'400, 19'200, 9'600};
  const auto option = spec.options.find("baud");
  if (option == spec.options.end()) return known.front();
  for (const int baud : known) {
    if (option->second == std::to_string(baud)) return baud;
  }
  return Error{Errc::usage, spec.text + ": baud=" + option->second +
                                " is none of 115200, 57600, 38400, 19200, 9600"};
}

} // namespace

Result<std::unique_ptr<Glove>> open_cyberglove(const std::string& source, OpenPort open_port,
                                               HostTime deadline) {
  return open_stream_glove(source, std::move(open_port), std::make_unique<CyberGloveProtocol>(),
                           deadline);
}

Result<std::unique_ptr<Glove>> open_serial_by(const GloveSpec& spec, HostTime deadline) {
  if (auto allowed = allow_options(spec, {"baud"}); !allowed) return allowed.error();
  const auto baud = baud_of(spec);
  if (!baud) return baud.error();
  if (spec.target.empty()) {
    return Error{Errc::usage, spec.text + ": name the port, e.g. serial:/dev/ttyUSB0"};
  }
  const auto open_port = [path = spec.target, rate = *baud] { return open_transport(path, rate); };
  return open_cyberglove(spec.text, open_port, deadline);
}

Result<std::unique_ptr<Glove>> open_serial(const GloveSpec& spec, std::optional<Side> /*side*/) {
  return open_serial_by(spec, HostClock::now() + open_budget);
}

} // namespace nendo::driver
