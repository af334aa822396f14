#include "export/motion_files.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/base/units.hpp>
#include <nendo/hand/bvh_file.hpp>
#include <nendo/hand/joint_angles.hpp>

#include "export/chosen_frames.hpp"
#include "takes/recorded_frames.hpp"

namespace nendo::exporting {
namespace {

/// A row of a CSV table, cell by cell. All cells are numbers, so that numpy and others read the
/// table without options.
class CsvRow {
public:
  void put(std::string_view text) {
    if (std::exchange(begun_, true)) text_ += ',';
    text_ += text;
  }
  /// `nan` if the number is not finite. The decimal point is a point in every locale.
  void put(double value, int decimals) {
    char digits[400]; // the largest double has 309 before the point
    if (!std::isfinite(value)) return put_nothing();
    const char* const end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals)
            .ptr;
    put(std::string_view(digits, static_cast<std::size_t>(end - digits)));
  }
  void put(std::uint64_t count) { put(std::string_view(std::to_string(count))); }
  void put_flag(bool flag) { put(std::string_view(flag ? "1" : "0")); }
  /// The number that is not there: `nan`, which readers of numbers take without any option.
  void put_nothing() { put(std::string_view("nan")); }

  /// Returns the row with its line end, and begins the next one.
  std::string take() {
    begun_ = false;
    text_ += '\n';
    return std::exchange(text_, {});
  }

private:
  std::string text_;
  bool begun_ = false;
};

constexpr std::array<Side, 2> sides{Side::left, Side::right};

/// The page of exports lists them in this order.
std::uint64_t code_of(deform::FieldStatus status) {
  static_assert(static_cast<int>(deform::FieldStatus::not_finite) == 4);
  return static_cast<std::uint64_t>(status);
}

const flow::HandFrame& hand_of(const flow::Frame& frame, Side side) {
  return frame.hands[flow::Placement::index_of(side)];
}

std::string head_for(const flow::Frame& frame) {
  std::string head = "time_s,tick,held,commits,undos,status";
  for (const Side side : sides) {
    if (!hand_of(frame, side).present) continue;
    const std::string hand = "," + std::string(name_of(side)) + "_";
    head += hand + "samples" + hand + "silent" + hand + "calibrated";
    for (const auto angle : hand::angle_names)
      head += hand + std::string(angle) + "_deg";
    for (const hand::Joint tip : hand::fingertips)
      for (const char* axis : {"x", "y", "z"})
        head.append(hand).append(name_of(tip)).append("_").append(axis).append("_m");
  }
  return head + "\n";
}

void put_hand(const flow::HandFrame& hand, std::optional<bool> is_calibrated, CsvRow& row) {
  row.put(hand.samples);
  row.put_flag(hand.silent);
  if (is_calibrated)
    row.put_flag(*is_calibrated);
  else
    row.put_nothing();
  for (std::size_t at = 0; at < hand::angle_count; ++at)
    row.put(to_degrees(hand.angles[hand::angle_at(at)]), 4);
  const auto tips_m = hand.pose.fingertip_positions();
  for (const double metres : tips_m.reshaped())
    row.put(metres, 7);
}

std::string row_for(const ChosenFrames& frames, const std::array<bool, 2>& present) {
  const flow::Frame& frame = frames.frame();
  CsvRow row;
  row.put(frames.time_s(), 6);
  for (const std::uint64_t count :
       {frame.tick, std::uint64_t{frame.held}, frame.commits, frame.undos})
    row.put(count);
  row.put(code_of(frame.status));
  for (const Side side : sides)
    if (present[flow::Placement::index_of(side)])
      put_hand(hand_of(frame, side), frames.source().is_calibrated(side), row);
  return row.take();
}

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

struct HandFile {
  std::size_t slot;
  std::filesystem::path path;
  hand::BvhFormat format;
  FileReplacement file;
};

Result<std::vector<HandFile>> begin(const ChosenFrames& frames, const Skeletons& skeletons,
                                    const std::filesystem::path& path) {
  const bool alone = !(skeletons[0] && skeletons[1]);
  std::vector<HandFile> files;
  for (std::size_t slot = 0; slot < skeletons.size(); ++slot) {
    if (!skeletons[slot]) continue;
    const auto named = alone ? path : path_of_hand(path, skeletons[slot]->side());
    auto file = FileReplacement::begin(named);
    if (!file) return file.error();
    hand::BvhFormat format(*skeletons[slot]);
    const std::string head =
        format.hierarchy() + hand::BvhFormat::motion_head(*frames.count(), 1.0 / frames.period_s());
    if (const auto written = file->write(head); !written) return written.error();
    files.push_back({slot, named, std::move(format), *std::move(file)});
  }
  if (files.empty())
    return Error{Errc::bad_input, path.string() + ": there is no hand in the take"};
  return files;
}

} // namespace

Result<Exported> export_motion_csv(ChosenFrames& frames, const std::filesystem::path& path) {
  std::array<bool, 2> present{};
  return export_to_one_file(frames, path, [&](FileReplacement& file) {
    const flow::Frame& frame = frames.frame();
    std::string text;
    if (frames.made() == 1) {
      text = head_for(frame);
      for (std::size_t slot = 0; slot < present.size(); ++slot)
        present[slot] = frame.hands[slot].present;
    }
    return file.write(text + row_for(frames, present));
  });
}

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

std::filesystem::path path_of_hand(const std::filesystem::path& path, Side side) {
  auto name = path.parent_path() / path.stem();
  name += "-" + std::string(name_of(side));
  name += path.extension();
  return name;
}

Result<Exported> export_hands_bvh(ChosenFrames& frames, const Skeletons& skeletons,
                                  const std::filesystem::path& path) {
  assert(frames.count());
  auto files = begin(frames, skeletons, path);
  if (!files) return files.error();
  std::string line;
  const auto written = frames.for_each([&]() -> Result<void> {
    for (HandFile& hand : *files) {
      line.clear();
      if (!hand.format.append_frame(frames.frame().hands[hand.slot].pose, line)) {
        return Error{Errc::bad_input, hand.path.string() + ": a pose at " +
                                          std::to_string(frames.time_s()) + " s is not finite"};
      }
      if (auto fine = hand.file.write(line); !fine) return fine;
    }
    return {};
  });
  if (!written) return written.error();
  for (HandFile& hand : *files) // both hands, or what was there stays
    if (const auto synced = hand.file.sync(); !synced) return synced.error();
  Exported done = frames.report();
  for (HandFile& hand : *files) {
    if (const auto finished = hand.file.finish(); !finished) return finished.error();
    done.files.push_back(hand.path.string());
    done.bytes += hand.file.size();
  }
  return done;
}

} // namespace nendo::exporting
