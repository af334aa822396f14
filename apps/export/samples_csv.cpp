#include "export/samples_csv.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>
#include <string_view>

#include <nendo/base/file_replacement.hpp>
#include <nendo/base/units.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "export/csv_row.hpp"
#include "takes/glove_samples.hpp"

namespace nendo::exporting {
namespace {

constexpr int time_decimals = 9; // clocks count nanoseconds
constexpr int angle_decimals = 4;

/// Makes the rows of the samples.
class SampleTable {
public:
  explicit SampleTable(const takes::GloveSamples& samples)
      : samples_(samples), sensors_(samples.sensors()) {}

  std::string head() {
    for (const char* name :
         {"time_s", "measured_s", "device_time_s", "hand", "sequence", "switch", "calibrated"})
      row_.put(std::string_view(name));
    for (const char* kind : {"_count", "_deg"})
      for_each_sensor([&](Sensor sensor) { row_.put(std::string(name_of(sensor)) + kind); });
    return row_.take();
  }

  /// Of the latest sample.
  std::string row() {
    const GloveSample& sample = samples_.sample();
    row_.put(time_s(), time_decimals);
    row_.put(seconds_between(samples_.setup().begun_host, sample.measured), time_decimals);
    row_.put(sample.has_device_time ? to_seconds(sample.device_time)
                                    : std::numeric_limits<double>::quiet_NaN(),
             time_decimals);
    row_.put_flag(sample.side == Side::right);
    row_.put(sample.sequence);
    put_switch(sample.wrist_switch);
    row_.put_flag(samples_.is_calibrated());
    for_each_sensor([&](Sensor sensor) {
      if (!sample.present.has(sensor)) return row_.put_nothing();
      row_.put(std::uint64_t{sample[sensor].value});
    });
    // Angles of an average hand would look like this wearer's.
    put_angles(sample, samples_.is_calibrated() ? samples_.calibration() : nullptr);
    return row_.take();
  }

  double time_s() const {
    return seconds_between(samples_.setup().begun_host, samples_.sample().arrival);
  }

private:
  template <class Visit>
  void for_each_sensor(const Visit& visit) const {
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (const auto sensor = static_cast<Sensor>(slot); sensors_.has(sensor)) visit(sensor);
  }

  void put_switch(WristSwitch position) {
    if (position == WristSwitch::unknown) return row_.put_nothing();
    row_.put_flag(position == WristSwitch::on);
  }

  void put_angles(const GloveSample& sample, const hand::Calibration* calibration) {
    hand::SensorAngles angles_rad{};
    if (calibration != nullptr)
      angles_rad = hand::filled_angles_rad(sample, *calibration, samples_.left_out());
    for_each_sensor([&](Sensor sensor) {
      const bool known = calibration != nullptr && sample.present.has(sensor) &&
                         (*calibration)[sensor].gain_rad_per_count != 0.0 &&
                         !samples_.left_out().has(sensor); // it measures nothing
      if (!known) return row_.put_nothing();
      row_.put(to_degrees(angles_rad[static_cast<std::size_t>(sensor)]), angle_decimals);
    });
  }

  const takes::GloveSamples& samples_;
  SensorMask sensors_;
  CsvRow row_;
};

/// Writes the chosen samples' rows. What came before the recording began counts as its beginning.
Result<Exported> write_rows(takes::GloveSamples& samples, const Choice& choice,
                            FileReplacement& file) {
  SampleTable table(samples);
  Exported done;
  if (const auto written = file.write(table.head()); !written) return written.error();
  while (samples.next()) {
    if (choice.stop != nullptr && *choice.stop)
      return Error{Errc::failed, "stopped before the end"};
    const double time_s = table.time_s();
    if (std::max(0.0, time_s) < choice.from_s ||
        time_s > choice.to_s.value_or(std::numeric_limits<double>::infinity()))
      continue;
    if (const auto written = file.write(table.row()); !written) return written.error();
    if (done.frames++ == 0) done.first_s = time_s;
    done.last_s = time_s;
  }
  done.exact = samples.is_exact();
  return done;
}

} // namespace

Result<Exported> export_samples_csv(const std::filesystem::path& take, const Choice& choice,
                                    const std::filesystem::path& path) {
  assert(!choice.rate_hz);
  if (const auto fine = check(choice); !fine) return fine.error();
  auto samples = takes::GloveSamples::open(take);
  if (!samples) return samples.error();
  auto file = FileReplacement::begin(path);
  if (!file) return file.error();
  auto done = write_rows(*samples, choice, *file);
  if (!done) return done.error();
  if (done->frames == 0)
    return Error{Errc::bad_input, take.string() + ": there is no sample of a glove from --from to "
                                                  "--to"};
  if (const auto finished = file->finish(); !finished) return finished.error();
  done->files = {path.string()};
  done->bytes = file->size();
  return done;
}

} // namespace nendo::exporting
