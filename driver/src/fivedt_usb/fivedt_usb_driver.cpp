#include <cassert>
#include <optional>
#include <string>

#include <spdlog/spdlog.h>

#include "drivers.hpp"
#include "fivedt_usb/fivedt_usb_parser.hpp"
#include "usb/usb_glove.hpp"

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

class FivedtUsbProtocol final : public UsbGloveProtocol<Parser> {
public:
  FivedtUsbProtocol(const Model& model, std::optional<Side> hand) noexcept
      : model_(model), hand_{hand, std::nullopt},
        step_(model.five_sensors ? values_per_finger : 1) {}

  Result<GloveInfo> identify(Transport& transport, const std::string& source, IdentifyReason reason,
                             const ReplyDeadline& limit) override {
    if (auto alive = await_report(transport, source, limit); !alive) return alive.error();
    GloveInfo info;
    info.model = std::string("5DT Data Glove ") + (model_.five_sensors ? "5" : "14") + " Ultra";
    const ChosenHand hand = choose_hand(model_.side, hand_);
    if (const auto note = hand_override(model_.side, hand_);
        !note.empty() && reason == IdentifyReason::opening)
      spdlog::warn("device: {}: {}", source, note);
    info.side = hand.side;
    info.sensors = sensors();
    info.counts = {max_count, true};
    info.facts = facts_of(usb(transport).identity());
    info.facts.push_back({"link", std::string(name_of_link(model_.link))});
    info.facts.push_back({"hand_source", std::string(hand.source)});
    return info;
  }

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/, Sink& sink) noexcept override {
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
};

} // namespace

Result<std::unique_ptr<Glove>> open_fivedt_usb(const DeviceSpec& spec, const UsbWanted& wanted,
                                               HostTime deadline) {
  const auto model = model_of(wanted.id.product);
  assert(model);
  return open_report_glove(
      spec, wanted, {interface_number, report_bytes}, deadline,
      [&](std::optional<Side> hand) { return std::make_unique<FivedtUsbProtocol>(*model, hand); });
}

} // namespace nendo::driver::fivedt_usb
