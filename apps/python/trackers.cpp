#include <array>

#include <nendo/driver/open_tracker.hpp>
#include <nendo/recording/replay_driver.hpp>

#include "python/device.hpp"
#include "python/gloves.hpp"

namespace nendo::python {
namespace {

/// A station of an open tracker.
class PyTracker {
public:
  PyTracker(driver::TrackerStation opened, std::size_t capacity)
      : info(opened.tracker->info()), source(opened.source), station(opened.station),
        device(std::move(opened.tracker), capacity) {}

  void start() {
    device.start([this](driver::Tracker& tracker, PoseRing& ring) {
      return tracker.start(std::array{driver::StationRing{station, &ring}});
    });
  }

  const driver::TrackerInfo info;
  const std::string source; ///< the specification that names the station
  const std::uint16_t station;
  Device<driver::Tracker, PoseSample> device;
};

py::object open_tracker(const std::string& spec, std::int64_t capacity) {
  const auto most = capacity_of(capacity);
  auto stations = value_of(without_gil([&] {
    return driver::open_trackers(std::array{spec}, std::array{recording::replay_tracker_driver()});
  }));
  const py::object opened =
      py::cast(std::make_unique<PyTracker>(std::move(stations.front()), most));
  close_at_exit(opened);
  return opened;
}

} // namespace

void add_trackers(py::module_& module) {
  py::class_<PyTracker>(module, "Tracker",
                        "A station of an open tracker, from open_tracker(). Any thread may use it.")
      .def_readonly("source", &PyTracker::source,
                    "The argument for open_tracker() of this station.")
      .def_property_readonly(
          "model", [](const PyTracker& own) { return to_str(own.info.model); },
          "The model that it reports.")
      .def_property_readonly(
          "rate_hz", [](const PyTracker& own) { return own.info.rate_hz; },
          "Nominal poses per second of all stations together; 0 if unknown.")
      .def_property_readonly(
          "facts", [](const PyTracker& own) { return facts_of(own.info.facts); },
          "What else it reports: {name: text}.")
      .def_property_readonly(
          "stage_from_tracker_xyzw",
          [](const PyTracker& own) {
            return array_of(own.info.stage_from_tracker_xyzw.data(), {4});
          },
          "(4,), the usual turn from the tracker's axes to x right, y up, z towards you.")
      .def_readonly("station", &PyTracker::station, "Its number, as the device counts.")
      .def("start", &PyTracker::start, "As Glove.start().")
      .def(
          "close", [](PyTracker& own) { own.device.close(); }, "As Glove.close().")
      .def(
          "read", [](PyTracker& own, double timeout) { return own.device.read(timeout); },
          py::arg("timeout") = 0.0,
          "Returns the poses since the last read() as an array (n,) of pose_dtype, in the "
          "tracker's "
          "own frame: metres, and quaternions x, y, z, w. Waits as Glove.read() does.")
      .def_property_readonly(
          "stats", [](PyTracker& own) { return own.device.stats(); }, "As Glove.stats.")
      .def("__enter__",
           [](const py::object& self) {
             self.attr("start")();
             return self;
           })
      .def("__exit__", [](PyTracker& own, const py::args&) { own.device.close(); });
  module.def(
      "open_tracker", &open_tracker, py::arg("spec"), py::kw_only(),
      py::arg("capacity") = usual_capacity,
      "Opens a station of a tracker: \"fastrak:/dev/ttyUSB2?station=1\", "
      "\"vrpn:Tracker0@host?sensor=0\", \"osc:9000/left\", \"sim:orbit\" or any other TRACKER of "
      "`nendo run`. Blocks for up to 5 seconds. Raises as open() does.");
}

} // namespace nendo::python
