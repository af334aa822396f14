#include <array>
#include <utility>

#include "drivers.hpp"
#include "p5/p5_parser.hpp"
#include "usb/usb_glove.hpp"

namespace nendo::driver::p5 {
namespace {

using namespace std::chrono_literals;

constexpr auto control_timeout = 100ms;

class P5Protocol final : public UsbGloveProtocol<Parser> {
public:
  explicit P5Protocol(Side side) noexcept : side_(side) {}

  Result<GloveInfo> identify(Transport& transport, const std::string& source,
                             IdentifyReason /*reason*/, const ReplyDeadline& limit) override {
    if (auto alive = await_report(transport, source, limit); !alive) return alive.error();
    GloveInfo info;
    info.model = "Essential Reality P5, 5 sensors";
    info.side = side_;
    info.sensors = mask_of(bend_sensors);
    info.counts = {max_bend, true};
    info.abilities.wrist_switch = true;
    info.facts = facts_of(usb(transport).identity());
    return info;
  }

  Result<void> start_stream(Transport& transport, const std::string& source,
                            const ReplyDeadline& /*limit*/) override {
    std::array mouse{mouse_report, std::byte{0}};
    std::size_t received = 0;
    auto status = usb(transport).get_feature(mouse, received, control_timeout);
    // A mode that cannot be read stays: it could not be restored.
    if (status == ControlStatus::done && received == mouse.size() && mouse[1] == mouse_on) {
      mouse_was_on_ = true; // also if the stream is started again after a silence
      status = set_mouse(transport, mouse_off);
    }
    return status == ControlStatus::gone ? went_away(source) : Result<void>();
  }

  void end_stream(Transport& transport, const ReplyDeadline& /*limit*/) noexcept override {
    if (std::exchange(mouse_was_on_, false)) set_mouse(transport, mouse_on);
  }

  void push(std::span<const std::byte> chunk, HostTime /*arrival*/, Sink& sink) noexcept override {
    const auto report = parser_.push(chunk);
    if (!report) return sink.reject();
    GloveSample sample;
    for (std::size_t k = 0; k < bend_sensors.size(); ++k)
      sample.set(bend_sensors[k], RawCount{report->bends[k]});
    sample.wrist_switch = report->button_a ? WristSwitch::on : WristSwitch::off;
    sample.side = side_;
    sink.deliver(sample);
  }

private:
  static ControlStatus set_mouse(Transport& transport, std::byte mode) noexcept {
    return usb(transport).set_feature(std::array{mouse_report, mode}, control_timeout);
  }

  const Side side_;
  bool mouse_was_on_ = false; ///< and this driver switched it off
};

} // namespace

Result<std::unique_ptr<Glove>> open_p5(const DeviceSpec& spec, const UsbWanted& wanted,
                                       HostTime deadline) {
  return open_report_glove(spec, wanted, {interface_number, report_bytes}, deadline,
                           [](std::optional<Side> hand) {
                             return std::make_unique<P5Protocol>(hand.value_or(Side::right));
                           });
}

} // namespace nendo::driver::p5
