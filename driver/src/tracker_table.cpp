// The table of all drivers of trackers. To add one: its function in drivers.hpp, and a line here.

#include <nendo/driver/open_tracker.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <nendo/base/number_in.hpp>

#include "drivers.hpp"

namespace nendo::driver {
namespace {

/// Takes the option `station=N`, a number of at least 1; 1 if it is missing.
Result<std::uint16_t> take_numbered_station(DeviceSpec& spec) {
  const auto option = spec.options.extract("station");
  if (option.empty()) {
    spec.text = with_option(spec.text, "station=1");
    return std::uint16_t{1};
  }
  const auto station = number_in<std::uint16_t>(option.mapped());
  if (station && *station >= 1 && *station <= 16) return *station;
  return Error{Errc::usage, spec.text + ": option station must be a whole number from 1 to 16"};
}

/// Takes the option `sensor=N`, a number of VRPN; 0 if it is missing.
Result<std::uint16_t> take_sensor(DeviceSpec& spec) {
  const auto option = spec.options.extract("sensor");
  if (option.empty()) {
    spec.text = with_option(spec.text, "sensor=0");
    return std::uint16_t{0};
  }
  if (const auto sensor = number_in<std::uint16_t>(option.mapped())) return *sensor;
  return Error{Errc::usage, spec.text + ": option sensor must be a whole number from 0 to 65535"};
}

/// For trackers of one station, whose specifications do not name it.
Result<std::uint16_t> take_only_station(DeviceSpec& /*spec*/) {
  return std::uint16_t{1};
}

constexpr std::array own_drivers{
    TrackerDriver{"evdev", "evdev:NAME[?speed=M_PER_S&turn=RAD_PER_S]",
                  "a SpaceMouse, a gamepad or a second mouse", take_only_station,
                  evdev::open_evdev},
    TrackerDriver{"sim", "sim[:MOTION][?station=N&rate=HZ&seed=N]", "a simulated tracker",
                  take_numbered_station, open_simulated_tracker},
    TrackerDriver{"fastrak", "fastrak:PATH[?station=N&baud=N&hemisphere=X,Y,Z&filter=on|off]",
                  "Polhemus FASTRAK, InterSense IS-300, IS-600, IS-900", take_numbered_station,
                  fastrak::open_fastrak},
    TrackerDriver{"vrpn", "vrpn:NAME@HOST[:PORT][?sensor=N&up=y|z]",
                  "a tracker of a VRPN server in the network", take_sensor, vrpn::open_vrpn},
    TrackerDriver{"osc", "osc:[ADDRESS:]PORT/left|right[?position=/ADDR&rotation=/ADDR]",
                  "a phone or a program that sends poses by OSC over UDP", osc::take_osc_side,
                  osc::open_osc},
    TrackerDriver{"serve", "serve[:NAME][?hand=left|right]",
                  "a tracker that nendo serve shares on this machine", take_only_station,
                  served::open_served_tracker},
    TrackerDriver{"liberty", "liberty:PATH[?station=N&baud=N&hemisphere=X,Y,Z&filter=on|off]",
                  "Polhemus LIBERTY, PATRIOT, Latus at a serial port", take_numbered_station,
                  liberty::open_liberty},
    TrackerDriver{"isotrak", "isotrak:PATH[?station=N&baud=N&hemisphere=X,Y,Z&filter=on|off]",
                  "Polhemus ISOTRAK II", take_numbered_station, isotrak::open_isotrak},
    TrackerDriver{"flock",
                  "flock:PATH[?station=N&baud=N&hemisphere=forward|aft|right|left|lower|upper]",
                  "Ascension Flock of Birds, miniBIRD", take_numbered_station, flock::open_flock},
};

Result<TrackerDriver> find_driver(const DeviceSpec& spec, std::span<const TrackerDriver> more) {
  std::string known;
  for (const TrackerDriver& driver : tracker_drivers(more)) {
    if (driver.kind == spec.kind) return driver;
    known += (known.empty() ? "" : ", ") + std::string(driver.kind);
  }
  return Error{Errc::usage,
               "tracker \"" + spec.text + "\": unknown kind " + spec.kind + "; known: " + known};
}

/// A tracker to be opened, and the stations that are wanted of it.
struct Wanted {
  DeviceSpec spec; ///< without a station
  TrackerDriver driver;
  std::vector<std::uint16_t> stations;

  bool is_of(const DeviceSpec& other) const {
    return spec.kind == other.kind && spec.target == other.target && spec.options == other.options;
  }
};

/// Which tracker, and which of its stations.
struct Place {
  std::size_t tracker = 0;
  std::uint16_t station = 0;
  std::string source; ///< TrackerStation::source
};

Result<Place> place_in(std::vector<Wanted>& trackers, std::string_view text,
                       std::span<const TrackerDriver> more) {
  auto spec = parse_device_spec(text);
  if (!spec) return spec.error();
  const auto driver = find_driver(*spec, more);
  if (!driver) return driver.error();
  const auto station = driver->take_station(*spec);
  if (!station) return station.error();
  std::string source = std::exchange(spec->text, std::string(text));
  auto found = std::find_if(trackers.begin(), trackers.end(),
                            [&](const Wanted& wanted) { return wanted.is_of(*spec); });
  if (found == trackers.end())
    found = trackers.insert(found, Wanted{*std::move(spec), *driver, {}});
  if (std::find(found->stations.begin(), found->stations.end(), *station) == found->stations.end())
    found->stations.push_back(*station);
  return Place{static_cast<std::size_t>(found - trackers.begin()), *station, std::move(source)};
}

/// Adds the tracker's name as it was typed.
Error of_tracker(const DeviceSpec& spec, const Error& error) {
  const bool is_of_port = error.code == Errc::no_device || error.code == Errc::no_permission;
  if (!is_of_port || error.message.find(spec.text) != std::string::npos) return error;
  return {error.code, spec.text + ": " + error.message};
}

} // namespace

Result<std::vector<TrackerStation>> open_trackers(std::span<const std::string> specs,
                                                  std::span<const TrackerDriver> more) {
  std::vector<Wanted> wanted;
  std::vector<Place> places;
  for (const std::string& text : specs) {
    const auto place = place_in(wanted, text, more);
    if (!place) return place.error();
    places.push_back(*place);
  }
  std::vector<std::shared_ptr<Tracker>> trackers;
  for (const Wanted& tracker : wanted) {
    auto opened = tracker.driver.open(tracker.spec, tracker.stations);
    if (!opened) return of_tracker(tracker.spec, opened.error());
    trackers.push_back(*std::move(opened));
  }
  std::vector<TrackerStation> stations;
  for (const auto& [tracker, station, source] : places)
    stations.push_back({trackers[tracker], station, source});
  return stations;
}

Result<void> start_trackers(std::span<const TrackerStation> stations,
                            std::span<PoseRing* const> rings) {
  std::vector<Tracker*> started;
  for (const TrackerStation& first : stations) {
    Tracker* const tracker = first.tracker.get();
    if (std::find(started.begin(), started.end(), tracker) != started.end()) continue;
    std::vector<StationRing> of_tracker;
    for (std::size_t at = 0; at < stations.size(); ++at)
      if (stations[at].tracker.get() == tracker)
        of_tracker.push_back({stations[at].station, rings[at]});
    if (const auto begun = tracker->start(of_tracker); !begun) {
      for (Tracker* const before : started)
        before->stop();
      return begun.error();
    }
    started.push_back(tracker);
  }
  return {};
}

std::vector<TrackerDriver> tracker_drivers(std::span<const TrackerDriver> more) {
  std::vector<TrackerDriver> drivers(own_drivers.begin(), own_drivers.end());
  drivers.insert(drivers.end(), more.begin(), more.end());
  return drivers;
}

} // namespace nendo::driver
