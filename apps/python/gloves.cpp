#include "python/gloves.hpp"

#include <pybind11/stl.h>

#include <nendo/driver/devices.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/recording/replay_driver.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "python/device.hpp"
#include "python/hands.hpp"

namespace nendo::python {
namespace {

/// A hand at the time of a sample.
struct Hand {
  double time_s = 0.0;
  std::uint64_t sequence = 0;
  Side side = Side::right;
  std::array<double, hand::angle_count> angles{};
  JointMatrices joints{};
};

/// An open glove and its wearer.
class PyGlove {
public:
  PyGlove(std::unique_ptr<driver::Glove> glove, hand::Wearer worn, std::vector<std::string> said,
          std::size_t capacity)
      : info(glove->info()), wearer(worn), notes(std::move(said)),
        device(std::move(glove), capacity) {}

  void start() {
    device.start([](driver::Glove& glove, SampleRing& ring) { return glove.start(ring); });
  }
  /// Returns the hand of the newest sample, after all earlier ones have passed the gate.
  Hand next() {
    const auto samples = device.take(std::numeric_limits<double>::infinity());
    if (samples.empty()) throw py::stop_iteration();
    for (const GloveSample& sample : samples) {
      if (!hand_)
        hand_.emplace(flow::HandInput{.side = info.side, .wearer = wearer, .first = sample},
                      flow::Placement{}, false);
      hand_->update(sample);
    }
    Hand hand{seconds_of(samples.back().time()), samples.back().sequence, samples.back().side};
    write_angles(hand_->angles, hand.angles.data());
    write_joints(hand_->skeleton().pose(hand_->angles, Eigen::Isometry3d::Identity()),
                 hand.joints.data());
    return hand;
  }

  const driver::GloveInfo info;
  const hand::Wearer wearer;
  const std::vector<std::string> notes;
  Device<driver::Glove, GloveSample> device;

private:
  std::optional<flow::GloveHand> hand_; ///< from the first sample on
};

py::object open(const std::string& spec, const std::optional<std::string>& side,
                const std::string& user, const std::string& calibration, std::int64_t capacity) {
  const auto wanted = side_of(side);
  const auto most = capacity_of(capacity);
  auto glove = value_of(without_gil([&] {
    driver::GloveContext context;
    context.drivers.push_back(recording::replay_driver());
    return driver::open_glove(spec, wanted, context);
  }));
  std::vector<std::string> notes;
  sculpting::CalibrationOptions options;
  options.user = user;
  options.calibration = calibration;
  auto wearer = value_of(
      sculpting::find_wearer(glove->info(), glove->info().side, options,
                             [&notes](std::string_view note) { notes.emplace_back(note); }));
  const py::object opened =
      py::cast(std::make_unique<PyGlove>(std::move(glove), wearer, std::move(notes), most));
  close_at_exit(opened);
  return opened;
}

CalibrationFile calibration_of(const PyGlove& glove) {
  const hand::WearerHand& worn = glove.wearer.of(glove.info.side);
  CalibrationFile file;
  file.wearer.glove_model = glove.info.model;
  file.wearer.glove_serial = sculpting::serial_of(glove.info);
  file.wearer.counts = glove.info.counts;
  file.wearer.side = glove.info.side;
  file.wearer.size = worn.size;
  file.wearer.calibration = worn.calibration;
  file.wearer.left_out = worn.left_out;
  return file;
}

void add_info(py::module_& module) {
  using Info = driver::GloveInfo;
  py::class_<Info>(module, "GloveInfo", "The properties that a glove had when it was opened.")
      .def("__repr__",
           [](const Info& own) {
             return to_str("<nendo.GloveInfo " + own.source + ": " + own.model + ", " +
                           std::string(name_of(own.side)) + " hand>");
           })
      .def_readonly("source", &Info::source, "The argument for open() that opened it.")
      .def_readonly("model", &Info::model, "The model that it reports.")
      .def_property_readonly(
          "side", [](const Info& own) { return name_of(own.side); }, "\"left\" or \"right\".")
      .def_property_readonly(
          "sensors",
          [](const Info& own) {
            py::list names;
            for (const Sensor sensor : own.sensors)
              names.append(to_str(name_of(sensor)));
            return py::tuple(names);
          },
          "The names of its sensors, from SENSOR_NAMES.")
      .def_readonly("rate_hz", &Info::rate_hz, "Nominal samples per second; 0 if unknown.")
      .def_property_readonly(
          "max_count", [](const Info& own) { return own.counts.max_count; }, "The largest count.")
      .def_property_readonly(
          "self_calibrated", [](const Info& own) { return own.counts.self_calibrated; },
          "Whether 0 is a straight joint, and max_count a bent one.")
      .def_property_readonly(
          "kind",
          [](const Info& own) {
            return driver::source_kind_names[static_cast<std::size_t>(own.kind)];
          },
          "\"device\", \"simulated\" or \"recorded\".")
      .def_property_readonly(
          "facts", [](const Info& own) { return facts_of(own.facts); },
          "What else it reports: {name: text}.");
}

void add_devices(py::module_& module) {
  using Found = driver::DeviceCandidate;
  py::class_<Found>(module, "FoundDevice", "A port or device that may be a glove or a tracker.")
      .def("__repr__",
           [](const Found& own) {
             return to_str("<nendo.FoundDevice " + own.device + ": " + own.description + ">");
           })
      .def_readonly("device", &Found::device, "Its file, such as /dev/ttyUSB0.")
      .def_readonly("spec", &Found::spec, "The argument for open(); empty if no driver fits.")
      .def_readonly("tracker_spec", &Found::tracker_spec,
                    "The argument for open_tracker(), of an input device; empty for others.")
      .def_readonly("description", &Found::description, "Its own description.")
      .def_readonly("reason", &Found::reason, "Why it may be a glove or a tracker.")
      .def_readonly("identified", &Found::identified,
                    "Whether the device itself or a udev rule says that it is one.")
      .def_readonly("may_open", &Found::may_open, "Whether you have permission.")
      .def_readonly("remedy", &Found::remedy, "What lets you open it; empty if may_open.");
  module.def(
      "devices", [] { return without_gil([] { return driver::find_devices(); }); },
      "Returns the devices that may be gloves or trackers, identified ones first. Opens none of "
      "them. Blocks for less than a second.");
}

void add_glove(py::module_& module) {
  py::class_<Hand>(module, "Hand", "A hand at the time of a sample.")
      .def_readonly("time_s", &Hand::time_s, "When it was measured, by time.monotonic().")
      .def_readonly("sequence", &Hand::sequence, "The number of the sample.")
      .def_property_readonly(
          "side", [](const Hand& own) { return name_of(own.side); }, "\"left\" or \"right\".")
      .def_property_readonly(
          "angles",
          [](const Hand& own) { return array_of(own.angles.data(), {hand::angle_count}); },
          "(23,) in radians, in the order of ANGLE_NAMES.")
      .def_property_readonly(
          "joints",
          [](const Hand& own) { return array_of(own.joints.data(), {hand::joint_count, 4, 4}); },
          "(26, 4, 4) in metres from the wrist, as HandSkeleton.pose().");
  py::class_<PyGlove>(module, "Glove",
                      "An open glove, from open(). Iteration starts it, and yields the Hand of the "
                      "newest sample, until a recording ends; older samples that wait are passed "
                      "over. Any thread may use it.")
      .def_readonly("info", &PyGlove::info, "Its GloveInfo, as it was when the glove was opened.")
      .def_readonly("notes", &PyGlove::notes,
                    "Messages for the user, such as which calibration it has.")
      .def_property_readonly("calibration", &calibration_of, "The Calibration of its wearer.")
      .def("start", &PyGlove::start, "Starts the stream. May block for two seconds. Raises Error.")
      .def(
          "close", [](PyGlove& own) { own.device.close(); },
          "Ends the stream, and closes the device. May block for a second.")
      .def(
          "read", [](PyGlove& own, double timeout) { return own.device.read(timeout); },
          py::arg("timeout") = 0.0,
          "Returns the samples since the last read() as an array (n,) of sample_dtype, oldest "
          "first. It does not wait, unless `timeout` is given: then it waits as many seconds for "
          "the first sample, without the GIL.")
      .def_property_readonly(
          "stats", [](PyGlove& own) { return own.device.stats(); },
          "Counts since start(): records, missed (None if unknown), bad_records, "
          "clamped, refused, dropped, silences, reopened; and rate_hz. `dropped` "
          "samples were the oldest ones when `capacity` was reached.")
      .def("__enter__",
           [](const py::object& self) {
             self.attr("start")();
             return self;
           })
      .def("__exit__", [](PyGlove& own, const py::args&) { own.device.close(); })
      .def("__iter__",
           [](const py::object& self) {
             self.attr("start")();
             return self;
           })
      .def("__next__", &PyGlove::next);
  module.def(
      "open", &open, py::arg("spec") = "auto", py::arg("side") = py::none(), py::kw_only(),
      py::arg("user") = "", py::arg("calibration") = "", py::arg("capacity") = usual_capacity,
      "Opens a glove: \"auto\", \"auto:left\", \"serial:/dev/ttyUSB0\", \"sim\", "
      "\"sim:grasp?rate=500\", \"replay:take.nendo\" or any other GLOVE of `nendo run`. `side` is "
      "\"left\" or \"right\". Its calibration is that of `nendo run`: the stored one of `user`, "
      "the file or wearer that `calibration` names, or that of an average hand (also with "
      "\"none\"). At most `capacity` samples wait for read(). Blocks for up to 5 seconds. "
      "Raises Error; NotFoundError (no glove), AccessError.");
}

} // namespace

void add_gloves(py::module_& module) {
  add_info(module);
  add_devices(module);
  add_glove(module);
}

} // namespace nendo::python
