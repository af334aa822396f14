#include <chrono>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/calibration_store.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "python/hands.hpp"
#include "python/samples.hpp"

namespace nendo::python {
namespace {

constexpr std::size_t min_samples_of_pose = 10;

CountScale scale_of(int max_count, bool self_calibrated) {
  constexpr int largest = std::numeric_limits<std::uint16_t>::max();
  if (max_count < 1 || max_count > largest)
    throw py::value_error("max_count: use 1 to " + std::to_string(largest));
  return {static_cast<std::uint16_t>(max_count), self_calibrated};
}

CalibrationFile average(const std::string& side, int max_count, bool self_calibrated,
                        const std::string& user) {
  CalibrationFile made;
  made.wearer.user = user;
  made.wearer.side = *side_of(side);
  made.wearer.counts = scale_of(max_count, self_calibrated);
  made.wearer.method = "average";
  made.wearer.calibration = hand::default_calibration(made.wearer.counts);
  return made;
}

/// Calls with a receiver of notes, and issues them as warnings afterwards, because that may throw.
template <class Call>
auto with_warnings(Call call) {
  std::vector<std::string> notes;
  auto result = call([&notes](std::string_view note) { notes.emplace_back(note); });
  for (const std::string& note : notes)
    warn(note);
  return result;
}

CalibrationFile load(const std::filesystem::path& name) {
  if (name.string().find('/') != std::string::npos || name.extension() == ".toml")
    check_readable(name);
  auto stored = value_of(with_warnings([&](const sculpting::Note& note) {
    return sculpting::named_calibration(name.string(), note);
  }));
  return {std::move(stored.wearer), stored.path.string()};
}

std::vector<CalibrationFile> stored() {
  std::vector<CalibrationFile> all;
  for (auto& file : with_warnings(&sculpting::stored_calibrations).files)
    all.push_back({std::move(file.wearer), file.path.string()});
  return all;
}

std::filesystem::path save(CalibrationFile& own, const std::optional<std::filesystem::path>& to) {
  const auto path = to ? *to
                       : value_of(hand::own_calibration_path(
                             own.wearer.user, own.wearer.glove_serial, own.wearer.side));
  value_of(hand::write_calibration(path, own.wearer));
  own.path = path.string();
  return path;
}

/// The mean and the standard deviation of each sensor that all samples have.
hand::HeldPose held_pose(const std::vector<GloveSample>& samples, const std::string& name) {
  if (samples.size() < min_samples_of_pose)
    throw py::value_error("poses: " + name + " needs at least " +
                          std::to_string(min_samples_of_pose) + " samples");
  const double count = static_cast<double>(samples.size());
  hand::HeldPose held;
  held.present = samples.front().present;
  for (const GloveSample& sample : samples)
    held.present.bits &= sample.present.bits;
  for (const Sensor sensor : held.present) {
    const std::size_t slot = index_of(sensor);
    double mean = 0.0, variance = 0.0;
    for (const GloveSample& sample : samples)
      mean += static_cast<double>(sample[sensor].value) / count;
    for (const GloveSample& sample : samples)
      variance += std::pow(static_cast<double>(sample[sensor].value) - mean, 2) / count;
    held.mean_counts[slot] = mean;
    held.noise_counts[slot] = std::sqrt(variance);
  }
  return held;
}

CalibrationFile fit(const py::iterable& poses, const std::string& side, const std::string& mode,
                    const std::string& user, int max_count) {
  const Side hand_side = *side_of(side);
  if (mode != "quick" && mode != "full") throw py::value_error("mode: use \"quick\" or \"full\"");
  std::vector<hand::PoseReading> readings;
  SensorMask sensors;
  for (const py::handle item : poses) {
    const auto [name, samples] = argument_as<std::pair<std::string, py::object>>(
        item, "poses", "pairs of a name and samples");
    const auto pose = hand::pose_named(name);
    if (!pose) throw py::value_error("poses: " + name + ": there is no such pose; see POSE_NAMES");
    const hand::HeldPose held = held_pose(samples_of(samples, "poses"), name);
    if (readings.empty()) sensors = held.present;
    sensors.bits &= held.present.bits;
    readings.push_back({*pose, held});
  }
  hand::FitOptions options;
  options.scale = scale_of(max_count, false);
  options.mode = mode == "quick" ? hand::FitMode::quick : hand::FitMode::full;
  auto made = value_of(
      without_gil([&] { return hand::fit_calibration(readings, hand_side, sensors, options); }));
  CalibrationFile file;
  file.wearer.user = user;
  file.wearer.side = hand_side;
  file.wearer.counts = options.scale;
  file.wearer.made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  file.wearer.method = mode;
  file.wearer.size = made.size;
  file.wearer.calibration = made.calibration;
  return file;
}

py::array joint_angles(const CalibrationFile& own, const py::object& array) {
  const auto samples = samples_of(array, "samples");
  py::array_t<double> angles(Shape{static_cast<py::ssize_t>(samples.size()), hand::angle_count});
  double* out = angles.mutable_data();
  for (const GloveSample& sample : samples) {
    write_angles(hand::joint_angles(sample, own.wearer.calibration, own.wearer.left_out), out);
    out += hand::angle_count;
  }
  return angles;
}

template <double hand::SensorCalibration::* member>
py::array by_sensor(const CalibrationFile& own) {
  py::array_t<double> numbers(static_cast<py::ssize_t>(sensor_slots));
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    numbers.mutable_data()[slot] = own.wearer.calibration.sensors[slot].*member;
  return numbers;
}

void add_properties(py::class_<CalibrationFile>& calibration) {
  using File = CalibrationFile;
  const auto add = [&calibration](const char* name, auto get, const char* doc) {
    calibration.def_property_readonly(name, get, doc);
  };
  add("user", [](const File& own) { return to_str(own.wearer.user); }, "The wearer.");
  add("side", [](const File& own) { return name_of(own.wearer.side); }, "\"left\" or \"right\".");
  add(
      "method", [](const File& own) { return to_str(own.wearer.method); },
      "\"full\", \"quick\", \"imported\", \"average\" and so on.");
  add(
      "made", [](const File& own) { return to_str(hand::rfc3339(own.wearer.made)); },
      "The time in UTC, as \"2026-11-21T19:27:05Z\".");
  add(
      "glove_model", [](const File& own) { return to_str(own.wearer.glove_model); },
      "The model of its glove; empty: any.");
  add(
      "max_count", [](const File& own) { return own.wearer.counts.max_count; },
      "The largest count of its glove.");
  add("path", [](const File& own) { return own.path; }, "Its file, or None.");
  add("gains_rad_per_count", &by_sensor<&hand::SensorCalibration::gain_rad_per_count>,
      "(24,), in the order of SENSOR_NAMES: angle = gain * (count - offset).");
  add("offsets_counts", &by_sensor<&hand::SensorCalibration::offset_counts>,
      "(24,), in the order of SENSOR_NAMES.");
}

} // namespace

void add_calibrations(py::module_& module) {
  py::tuple poses(hand::pose_count);
  for (std::size_t at = 0; at < hand::pose_count; ++at)
    poses[at] = to_str(hand::pose_of(static_cast<hand::PoseId>(at)).name);
  module.attr("POSE_NAMES") = poses;

  py::class_<CalibrationFile> calibration(
      module, "Calibration",
      "A wearer's calibration of one hand: it converts counts to joint angles. One thread at a "
      "time may use it.");
  calibration
      .def_static(
          "load", &load, py::arg("name"),
          "Reads a calibration: `name` is a path (with a slash, or ending with .toml), or a "
          "wearer with one stored calibration. Blocks. Raises Error.")
      .def_static("stored", &stored,
                  "Returns the calibrations that `nendo calibrate` has stored. Blocks. A file that "
                  "cannot be read gives a UserWarning.")
      .def_static("average", &average, py::arg("side") = "right", py::arg("max_count") = 255,
                  py::arg("self_calibrated") = false, py::arg("user") = "",
                  "Returns the calibration of an average hand. `max_count` is the glove's largest "
                  "count; a self-calibrated glove sends 0 for a straight joint and max_count for a "
                  "bent one.")
      .def_static(
          "fit", &fit, py::arg("poses"), py::kw_only(), py::arg("side"), py::arg("mode") = "full",
          py::arg("user") = "", py::arg("max_count") = 255,
          "Fits a calibration to held poses: pairs of a name in POSE_NAMES and its samples "
          "(n,), n >= 10; \"flat\" and \"fist\" are needed, and a pose may come several times. "
          "\"quick\" uses only these two. Takes up to a second, without the GIL. Raises "
          "Error if the poses contradict each other.")
      .def("save", &save, py::arg("path") = py::none(),
           "Writes the file, and returns its path. Without a path, it is where `nendo` finds this "
           "wearer's calibration. A file that it replaces is kept beside it. Blocks.")
      .def("joint_angles", &joint_angles, py::arg("samples"),
           "Converts samples (n,) to joint angles (n, 23) in radians, in the order of ANGLE_NAMES. "
           "Angles without a sensor are estimated.")
      .def(
          "skeleton",
          [](const CalibrationFile& own) {
            return Skeleton{own.wearer.size, hand::HandSkeleton(own.wearer.side, own.wearer.size)};
          },
          "Returns the HandSkeleton of this wearer.");
  add_properties(calibration);
}

} // namespace nendo::python
