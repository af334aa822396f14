#pragma once
// What the drivers of USB gloves share.

#include <memory>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/driver/glove_options.hpp>

#include "stream/listen.hpp"
#include "stream/stream_glove.hpp"
#include "stream/stream_parser.hpp"
#include "transport/usb_transport.hpp"

namespace nendo::driver {

/// Returns a function that opens the device that is `wanted`. Later calls open the same device
/// wherever it is plugged in, by its serial number, or by its port if it has none.
OpenPort usb_opener(UsbWanted wanted, const UsbInterface& interface);

/// Returns the kernel's data about the device: numbers, port, maker, product and serial number.
std::vector<DeviceFact> facts_of(const UsbIdentity& identity);

/// A glove that sends reports whenever they are read. `Parser` is a ReportParser.
template <class Parser>
class UsbGloveProtocol : public GloveProtocol {
public:
  const StreamCounters& counters() const noexcept override { return parser_.counters(); }

protected:
  /// open_report_glove() passes no other transport.
  static UsbTransport& usb(Transport& transport) noexcept {
    return static_cast<UsbTransport&>(transport);
  }
  /// Waits for a report, for 2 s at most, because the receiver of a wireless glove answers even if
  /// the glove is switched off. Error: no_device.
  Result<void> await_report(Transport& transport, const std::string& source,
                            const ReplyDeadline& limit) {
    bool sends = false;
    std::uint64_t bytes = 0;
    const auto take = [&](std::span<const std::byte> report) {
      bytes += report.size();
      sends = true;
      return Parser::decodes(report);
    };
    const IoStatus status = listen(transport, limit, std::chrono::seconds(2), take);
    parser_.count_discarded(bytes);
    if (status == IoStatus::done) return {};
    if (status == IoStatus::gone) return went_away(source);
    return Error{Errc::no_device,
                 source + (sends ? " does not send what such a glove sends; is it another device?"
                                 : " sends nothing; is the glove switched on, and plugged into its "
                                   "receiver?")};
  }

  Parser parser_;
};

/// Opens a glove with the options `serial` and `hand`, by `deadline`; `make(hand)` returns its
/// protocol. Errors: usage (option), those of open_usb(), no_device (it sends nothing).
template <class Make>
Result<std::unique_ptr<Glove>> open_report_glove(const DeviceSpec& spec, const UsbWanted& wanted,
                                                 const UsbInterface& interface, HostTime deadline,
                                                 Make&& make) {
  if (auto allowed = allow_options(spec, {"serial", "hand"}); !allowed) return allowed.error();
  const auto hand = hand_option(spec);
  if (!hand) return hand.error();
  return open_stream_glove(spec.text, usb_opener(wanted, interface), make(*hand), deadline);
}

} // namespace nendo::driver
