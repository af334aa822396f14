#include "python/samples.hpp"

#include <limits>

#include "python/arrays.hpp"

namespace nendo::python {
namespace {

template <class Sample>
double device_seconds(const Sample& sample) {
  return sample.has_device_time ? to_seconds(sample.device_time)
                                : std::numeric_limits<double>::quiet_NaN();
}

HostTime host_time(double seconds) {
  return HostTime(from_seconds(seconds));
}

SampleRow row_of(const GloveSample& sample) {
  SampleRow row{};
  row.time_s = seconds_of(sample.time());
  row.arrival_s = seconds_of(sample.arrival);
  row.device_s = device_seconds(sample);
  row.sequence = sample.sequence;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    row.counts[slot] = sample.raw[slot].value;
    row.present[slot] = sample.present.has(static_cast<Sensor>(slot));
  }
  row.side = static_cast<std::int32_t>(sample.side);
  row.wrist_switch = static_cast<std::int16_t>(static_cast<int>(sample.wrist_switch) - 1);
  row.sampled_too_fast = sample.sampled_too_fast;
  row.is_replayed = sample.is_replayed;
  return row;
}

PoseRow row_of(const PoseSample& pose) {
  PoseRow row{};
  row.time_s = seconds_of(pose.measured);
  row.arrival_s = seconds_of(pose.arrival);
  row.device_s = device_seconds(pose);
  row.sequence = pose.sequence;
  std::copy(pose.position_m.begin(), pose.position_m.end(), row.position_m);
  std::copy(pose.turn_xyzw.begin(), pose.turn_xyzw.end(), row.turn_xyzw);
  row.station = pose.station;
  row.error[0] = pose.error;
  return row;
}

/// Python can put any byte into an array of booleans.
bool is_set(const bool& element) noexcept {
  return *reinterpret_cast<const unsigned char*>(&element) != 0;
}

GloveSample sample_of(const SampleRow& row, const char* name) {
  if (row.side != 0 && row.side != 1)
    throw py::value_error(std::string(name) + ": a side is neither 0, left, nor 1, right");
  GloveSample sample;
  sample.arrival = host_time(row.arrival_s);
  sample.measured = host_time(row.time_s);
  sample.has_device_time = !std::isnan(row.device_s);
  if (sample.has_device_time) sample.device_time = from_seconds(row.device_s);
  sample.sequence = row.sequence;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (is_set(row.present[slot]))
      sample.set(static_cast<Sensor>(slot), RawCount{row.counts[slot]});
  sample.side = static_cast<Side>(row.side);
  sample.wrist_switch = row.wrist_switch < 0    ? WristSwitch::unknown
                        : row.wrist_switch == 0 ? WristSwitch::off
                                                : WristSwitch::on;
  sample.sampled_too_fast = is_set(row.sampled_too_fast);
  return sample;
}

template <class Row, class Sample>
py::array rows_of(const std::vector<Sample>& samples) {
  py::array_t<Row> rows(static_cast<py::ssize_t>(samples.size()));
  Row* const out = rows.mutable_data();
  for (std::size_t at = 0; at < samples.size(); ++at)
    out[at] = row_of(samples[at]);
  return rows;
}

} // namespace

py::array array_of(const std::vector<GloveSample>& samples) {
  return rows_of<SampleRow>(samples);
}
py::array array_of(const std::vector<PoseSample>& poses) {
  return rows_of<PoseRow>(poses);
}

std::vector<GloveSample> samples_of(const py::handle& object, const char* name) {
  const py::array array = records_of(object, name, py::dtype::of<SampleRow>());
  const auto* const rows = static_cast<const SampleRow*>(array.data());
  std::vector<GloveSample> samples;
  samples.reserve(static_cast<std::size_t>(array.size()));
  for (py::ssize_t at = 0; at < array.size(); ++at)
    samples.push_back(sample_of(rows[at], name));
  return samples;
}

void add_samples(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(SampleRow, time_s, arrival_s, device_s, sequence, counts, present, side,
                       wrist_switch, sampled_too_fast, is_replayed);
  PYBIND11_NUMPY_DTYPE(PoseRow, time_s, arrival_s, device_s, sequence, position_m, turn_xyzw,
                       station, error);
  module.attr("sample_dtype") = py::dtype::of<SampleRow>();
  module.attr("pose_dtype") = py::dtype::of<PoseRow>();
  py::tuple names(sensor_slots);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    names[slot] = to_str(sensor_names[slot]);
  module.attr("SENSOR_NAMES") = names;
}

} // namespace nendo::python
