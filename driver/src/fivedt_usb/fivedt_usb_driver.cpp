#include "fivedt_usb/fivedt_usb_driver.hpp"

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include <nendo/driver/glove_options.hpp>

#include "fivedt_usb/fivedt_usb_parser.hpp"
#include "usb/await_report.hpp"
#include "usb/usb_opener.hpp"

namespace nendo::driver::fivedt_usb {
namespace {

std::string_view name_of_link(Link link) noexcept {
  switch (link) {
  case Link::wireless_a:
    return "wireless, port A";
  case Link::wireless_b:
    return "wireless, port B";
  default:
    return "cable";
  }
}

class FivedtUsbProtocol final : public GloveProtocol {
public:
  FivedtUsbProtocol(const Model& model, std::optional<Side> hand) noexcept
      : model_(model), hand_{hand, std::nullopt}, step_(model.five_sensors ? values_a_finger : 1) {}

  Result<GloveInfo> identify(Transport& transport, const std::string& source,
                             IdentifyReason occasion, const ReplyDeadline& patience) override {
    std::uint64_t bytes = 0;
    const auto alive = await_report(transport, source, patience, bytes,
                                    [](auto report) { return decode_report(report).has_value(); });
    parser_.count_discarded(bytes);
    if (!alive) return alive.error();
    GloveInfo info;
    info.model = std::string("5DT Data Glove ") + (model_.five_sensors ? "5" : "14") + " Ultra";
    const ChosenHand hand = choose_hand(model_.side, hand_);
    if (const auto note = hand_override(model_.side, hand_);
        !note.empty() && occasion == IdentifyReason::opening)
      spdlog::warn("device: {}: {}", source, note);
    info.side = hand.side;
    info.sensors = sensors();
    info.counts = {max_count, true};
    info.facts = facts_of(static_cast<UsbTransport&>(transport).identity());
    info.facts.push_back({"link", std::string(name_of_link(model_.link))});
    info.facts.push_back({"hand_source", std::string(hand.source)});
    return info;
  }

  // It streams whenever somebody reads.
  Result<void> start_stream(Transport& /*transport*/, const std::string& /*source*/,
                            const ReplyDeadline& /*patience*/) override {
    return {};
  }
  void end_stream(Transport& /*transport*/, const ReplyDeadline& /*patience*/) noexcept override {}

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/,
            SampleSink& sink) noexcept override {
    const auto report = parser_.push(chunk);
    if (!report) return sink.reject();
    GloveSample sample;
    int clamped = 0;
    for (std::size_t k = 0; k < value_sensors.size(); k += step_) {
      sample.set(value_sensors[k], RawCount{report->values[k]});
      clamped += report->clamped[k] ? 1 : 0;
    }
    parser_.count_clamped(clamped);
    sample.side = hand_.option.value_or(model_.side);
    sink.deliver(sample);
  }

  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

private:
  SensorMask sensors() const noexcept {
    SensorMask mask;
    for (std::size_t k = 0; k < value_sensors.size(); k += step_)
      mask.add(value_sensors[k]);
    return mask;
  }

  const Model model_;
  const SideOptions hand_;
  const std::size_t step_; ///< from one measured value to the next
  Parser parser_;
};

} // namespace

Result<std::unique_ptr<Glove>> open_fivedt_usb(const GloveSpec& spec, const UsbWanted& wanted,
                                               HostTime deadline) {
  if (auto allowed = allow_options(spec, {"serial", "hand"}); !allowed) return allowed.error();
  const auto hand = hand_option(spec);
  if (!hand) return hand.error();
  const auto model = model_of(wanted.id.product);
  assert(model);
  return open_stream_glove(spec.text, usb_opener(wanted, {interface_number, report_bytes}),
                           std::make_unique<FivedtUsbProtocol>(*model, *hand), deadline);
}

} // namespace nendo::driver::fivedt_usb
