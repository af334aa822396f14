// The table of all drivers. To add one: its function in drivers.hpp, and a line here.

#include <nendo/driver/open_glove.hpp>

#include <array>

#include "cyberglove/cyberglove_driver.hpp"
#include "cyberglove/cyberglove_options.hpp"
#include "drivers.hpp"
#include "lucidgloves/lucidgloves_driver.hpp"

namespace nendo::driver {
namespace {

/// For the drivers that need no GloveContext.
template <Result<std::unique_ptr<Glove>> (*open)(const DeviceSpec&, std::optional<Side>)>
Result<std::unique_ptr<Glove>> alone(const DeviceSpec& spec, std::optional<Side> side,
                                     const GloveContext& /*context*/) {
  return open(spec, side);
}

constexpr std::array own_drivers{
    GloveDriver{"serial", cyberglove::options_grammar,
                "a CyberGlove at a serial, USB or Bluetooth port", alone<cyberglove::open_serial>},
    GloveDriver{"lucidgloves", "lucidgloves:PATH[?baud=N&range=4095|1023&hand=left|right]",
                "LucidGloves, or another glove with OpenGloves' encoding, at a serial port",
                alone<lucidgloves::open_lucidgloves>},
    GloveDriver{"5dt", "5dt:PATH[?baud=19200|9600&hand=left|right]",
                "a 5DT Data Glove 5 at a serial port; 9600: a wireless one",
                alone<fivedt::open_fivedt>},
    GloveDriver{"forte", "forte:PATH[?link=usb|bluetooth&baud=460800|115200&hand=left|right]",
                "a BeBop Forte Data Glove at a serial port, by USB or Bluetooth",
                alone<forte::open_forte>},
    GloveDriver{"usb", "usb:VID:PID[?serial=TEXT&hand=left|right]",
                "a P5 (0d7f:0100) or 5DT Ultra (5d70:....) at USB", alone<open_usb_glove>},
    GloveDriver{"serve", "serve[:NAME][?hand=left|right]",
                "a glove that nendo serve shares on this machine",
                alone<served::open_served_glove>},
    GloveDriver{"auto", "auto[:left|right]", "the glove that its name or a udev rule identifies",
                alone<open_auto>},
    GloveDriver{"sim", "sim[:MOTION][?seed=N&rate=HZ&hand=left|right&sensors=18|22]",
                "a simulated glove", open_simulated},
};

/// Adds the glove's name as it was typed: the port alone is ambiguous with two gloves or `auto`.
Error of_glove(const DeviceSpec& spec, const Error& error) {
  const bool is_of_port = error.code == Errc::no_device || error.code == Errc::no_permission;
  if (!is_of_port || error.message.find(spec.text) != std::string::npos) return error;
  return {error.code, spec.text + ": " + error.message};
}

} // namespace

Result<std::unique_ptr<Glove>> open_glove(std::string_view text, std::optional<Side> side,
                                          const GloveContext& context) {
  const auto spec = parse_device_spec(text);
  if (!spec) return spec.error();
  std::string known;
  for (const GloveDriver& driver : glove_drivers(context)) {
    if (driver.kind == spec->kind) {
      auto glove = driver.open(*spec, side, context);
      if (!glove) return of_glove(*spec, glove.error());
      return glove;
    }
    known += (known.empty() ? "" : ", ") + std::string(driver.kind);
  }
  return Error{Errc::usage,
               "glove \"" + spec->text + "\": unknown kind " + spec->kind + "; known: " + known};
}

std::vector<GloveDriver> glove_drivers(const GloveContext& context) {
  std::vector<GloveDriver> drivers(own_drivers.begin(), own_drivers.end());
  drivers.insert(drivers.end(), context.drivers.begin(), context.drivers.end());
  return drivers;
}

} // namespace nendo::driver
