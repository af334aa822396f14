// A glove that `nendo serve` shares, see served_protocol.hpp.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "drivers.hpp"
#include "served/served_dialogue.hpp"
#include "stream/stream_glove.hpp"

namespace nendo::driver::served {
namespace {

class ServedGloveProtocol final : public GloveProtocol {
public:
  ServedGloveProtocol(ServePlace place, std::optional<Side> wanted)
      : dialogue_(std::move(place)), wanted_(wanted) {}

  /// A restarted server may have another glove.
  Result<GloveInfo> identify(Transport& transport, const std::string& source,
                             IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    if (auto asked = dialogue_.ask(transport, limit); !asked) return asked.error();
    auto line = device_of(dialogue_.gloves(), wanted_, source, "glove");
    if (!line) return line.error();
    glove_ = {WantedDevice::Kind::glove, line->index};
    GloveInfo info = std::move(line->info);
    for (DeviceFact& fact : dialogue_.facts(info.source))
      info.facts.push_back(std::move(fact));
    return info;
  }

  Result<void> start_stream(Transport& transport, const std::string& /*source*/,
                            const ReplyDeadline& limit) override {
    dialogue_.start(transport, glove_, limit);
    return {};
  }
  void end_stream(Transport& transport, const ReplyDeadline& /*limit*/) noexcept override {
    dialogue_.end(transport);
  }

  // The reader of JSON throws for lack of memory alone. NOLINTNEXTLINE(bugprone-exception-escape)
  void push(std::span<const std::byte> chunk, HostTime arrival, Sink& sink) noexcept override {
    const auto take = [&](GloveSample sample) { sink.deliver(sample); };
    Parser& parser = dialogue_.parser();
    parser.set_arrival(arrival);
    parser.push(chunk, FindingSink{take, [&](BadRecord) { sink.reject(); }});
  }

  const StreamCounters& counters() const noexcept override { return dialogue_.parser().counters(); }
  /// The server counts what it drops.
  bool counts_missed() const noexcept override { return true; }

private:
  ServedDialogue dialogue_;
  const std::optional<Side> wanted_;
  WantedDevice glove_;
};

} // namespace

Result<std::unique_ptr<Glove>> open_served_glove(const DeviceSpec& spec, std::optional<Side> side) {
  auto place = parse_serve_place(spec);
  if (!place) return place.error();
  const auto wanted = place->hand ? place->hand : side;
  const auto server = place->server;
  return open_stream_glove(
      spec.text, [server] { return server->connect(); },
      std::make_unique<ServedGloveProtocol>(*std::move(place), wanted),
      HostClock::now() + open_budget);
}

} // namespace nendo::driver::served
