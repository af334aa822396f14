#pragma once
// The functions that open the kinds of gloves and trackers, for the tables of drivers. All block
// for 4 s at most (open_auto: 5 s) unless they take a deadline. Errors: usage (option), no_device,
// no_permission.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <nendo/base/result.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>

namespace nendo::driver {

struct UsbWanted;

/// Opens `auto[:left|right]`: tries the ports that are identified as gloves one after the other,
/// until one is the wanted hand's.
Result<std::unique_ptr<Glove>> open_auto(const DeviceSpec& spec, std::optional<Side> side);

/// Opens a glove without hardware, in this process, with the options of simulated_glove_options()
/// and one of the motions of hand_motion.hpp or of `context`. The motion begins with start(). No
/// record is ever lost. Errors: usage; that of the motion.
Result<std::unique_ptr<Glove>> open_simulated(const DeviceSpec& spec, std::optional<Side> side,
                                              const GloveContext& context = {});

/// Opens `sim[:MOTION][?rate=HZ&seed=N]`, a tracker without hardware, in this process, with one of
/// the motions of wrist_motion.hpp, which begins with start(). Stations are numbers from 1 on. No
/// record is ever lost. Error: usage.
Result<std::unique_ptr<Tracker>> open_simulated_tracker(const DeviceSpec& spec,
                                                        std::span<const std::uint16_t> stations);

namespace evdev {

/// Opens `evdev:NAME[?speed=M_PER_S&turn=RAD_PER_S]`, an input device of the kernel as a tracker
/// with one station, see evdev_motion.hpp. NAME is as for find_input_device(). While it streams,
/// no other program gets its events.
Result<std::unique_ptr<Tracker>> open_evdev(const DeviceSpec& spec,
                                            std::span<const std::uint16_t> stations);

} // namespace evdev

/// Opens `usb:VID:PID[?serial=TEXT&hand=left|right]`, a glove that is a USB device of its own.
/// `side` is not used: the glove, or the option, determines the hand.
Result<std::unique_ptr<Glove>> open_usb_glove(const DeviceSpec& spec, std::optional<Side> side);
/// Does the same, and gives up at `deadline`.
Result<std::unique_ptr<Glove>> open_usb_glove_by(const DeviceSpec& spec, HostTime deadline);

namespace p5 {

/// Opens the Essential Reality P5 that `wanted` names, which has five bend sensors. Its button A is
/// the wrist switch. `hand` is an option, because a P5 does not report it; it was sold for the
/// right hand. While it streams it does not move the mouse.
Result<std::unique_ptr<Glove>> open_p5(const DeviceSpec& spec, const UsbWanted& wanted,
                                       HostTime deadline);

} // namespace p5

namespace fivedt_usb {

/// Opens the 5DT Data Glove Ultra that `wanted` names, with 5 or 14 sensors, by cable or wireless;
/// its product number is that of its model.
Result<std::unique_ptr<Glove>> open_fivedt_usb(const DeviceSpec& spec, const UsbWanted& wanted,
                                               HostTime deadline);

} // namespace fivedt_usb

namespace fivedt {

/// Opens `5dt:PATH?baud=19200|9600&hand=left|right&left_first=thumb|little`, a 5DT Data Glove 5 at
/// a serial port. `left_first` is the finger with which the samples of left gloves begin, see
/// fivedt_parser.hpp; those of right ones begin with the thumb. At 19200 baud the glove is asked
/// for its hand and its name. At 9600 it is a wireless one, to which nothing is ever sent: it is
/// recognised by its samples, and `hand`, or else `side`, determines the hand. Each finger has one
/// flexion, in the slot of its MCP.
Result<std::unique_ptr<Glove>> open_fivedt(const DeviceSpec& spec, std::optional<Side> side);

} // namespace fivedt

namespace forte {

/// Opens `forte:PATH?link=usb|bluetooth&baud=460800|115200&hand=left|right`, a BeBop Forte Data
/// Glove at a serial port. The glove is set to send over `link`, and recognised by its records.
/// `hand`, or else `side`, determines the hand. Each finger has two sensors, in the slots of its
/// MCP and PIP joints (the thumb's MCP and IP).
Result<std::unique_ptr<Glove>> open_forte(const DeviceSpec& spec, std::optional<Side> side);

} // namespace forte

namespace fastrak {

/// Opens `fastrak:PATH[?station=N&baud=N&hemisphere=x,y,z&filter=on|off]`, a Polhemus FASTRAK, or
/// an InterSense tracker that speaks as one, at a serial port. All stations of `stations` are
/// switched on, the others off. Without `baud` each rate is tried; one that is too slow for the
/// records is refused. `hemisphere` is the direction, from the transmitter, in which the receivers
/// are.
Result<std::unique_ptr<Tracker>> open_fastrak(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations);

} // namespace fastrak

namespace vrpn {

/// Opens `vrpn:NAME@HOST[:PORT][?up=y|z]`, a tracker of a VRPN server in the network, by TCP.
/// `stations` are numbers of its sensors, from 0 on. `up` is the tracker's axis that points up. A
/// sensor that sends nothing yet is a warning, since the server sends nothing of a body that it
/// does not see.
Result<std::unique_ptr<Tracker>> open_vrpn(const DeviceSpec& spec,
                                           std::span<const std::uint16_t> stations);

} // namespace vrpn

namespace osc {

/// Removes the hand from `osc:[ADDRESS:]PORT/left|right[?listen=ADDRESS]`, and gives the target the
/// one form ADDRESS:PORT. Returns the station: 1 left, 2 right. Error: usage.
Result<std::uint16_t> take_osc_side(DeviceSpec& spec);

/// Opens `osc:ADDRESS:PORT[?position=ADDRESS&rotation=ADDRESS]`, a port of UDP at which programs
/// send poses by OSC, to the addresses of osc_parser.hpp, or, for one hand, to the two addresses
/// that the options name. Both hands share the port. Opening does not wait for a sender; one that
/// is missing or silent shows as a silence in the counts, and one line of log. Axes are those of
/// the stage (y up). Does not block. Errors: usage; those of open_udp().
Result<std::unique_ptr<Tracker>> open_osc(const DeviceSpec& spec,
                                          std::span<const std::uint16_t> stations);

} // namespace osc

namespace served {

/// Opens `serve[:NAME][?hand=left|right]`, a glove that `nendo serve` shares with other programs of
/// this machine: the one that moves the hand of the option, or else that of `side`. Without both,
/// it must have gloves of one hand only. Samples have the server's times. Feedback is ignored.
Result<std::unique_ptr<Glove>> open_served_glove(const DeviceSpec& spec, std::optional<Side> side);

/// Opens `serve[:NAME][?hand=left|right]`, the station of a tracker that moves a hand there.
/// Without the option, the server must have a tracker for one hand only. `stations` has one number,
/// which the poses get.
Result<std::unique_ptr<Tracker>> open_served_tracker(const DeviceSpec& spec,
                                                     std::span<const std::uint16_t> stations);

} // namespace served

namespace liberty {

/// Opens `liberty:PATH[?station=N&baud=N&hemisphere=x,y,z&filter=on|off]`, a Polhemus LIBERTY,
/// PATRIOT or Latus at a serial port. Each of its stations sends, also those that are not wanted.
/// Otherwise as open_fastrak().
Result<std::unique_ptr<Tracker>> open_liberty(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations);

} // namespace liberty

namespace isotrak {

/// Opens `isotrak:PATH[?station=N&baud=N&hemisphere=x,y,z&filter=on|off]`, a Polhemus ISOTRAK II at
/// a serial port, which has the stations 1 and 2. Otherwise as open_fastrak().
Result<std::unique_ptr<Tracker>> open_isotrak(const DeviceSpec& spec,
                                              std::span<const std::uint16_t> stations);

} // namespace isotrak

namespace flock {

/// Opens `flock:PATH[?station=N&baud=N&hemisphere=NAME]`, an Ascension Flock of Birds or miniBIRD
/// at a serial port. A station is a bird's address. Without `baud` each rate is tried; one that is
/// too slow for all birds is refused. `hemisphere` is where the receivers are from the transmitter.
/// Blocks for 5 s at most, because opening a port can reset the units.
Result<std::unique_ptr<Tracker>> open_flock(const DeviceSpec& spec,
                                            std::span<const std::uint16_t> stations);

} // namespace flock
} // namespace nendo::driver
