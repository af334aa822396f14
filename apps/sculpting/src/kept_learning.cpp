#include <nendo/sculpting/kept_learning.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>

#include <nendo/base/text.hpp>
#include <nendo/hand/calibration_store.hpp>

#include <nendo/sculpting/find_wearer.hpp>

namespace nendo::sculpting {
namespace {

constexpr const char* method = "adapted";
/// The number of turns that make a sensor's confidence a half.
constexpr double half_sure_turns = 8.0;

double confidence_of(std::uint64_t turns) noexcept {
  const auto number = static_cast<double>(turns);
  return number / (number + half_sure_turns);
}

std::uint64_t turns_of(double confidence) noexcept {
  constexpr double max_turns = 1e6;
  const double left = std::max(1.0 - confidence, half_sure_turns / max_turns);
  return static_cast<std::uint64_t>(std::llround(half_sure_turns * confidence / left));
}

Result<std::optional<hand::WearerCalibration>> kept(const std::filesystem::path& path,
                                                    CountScale counts) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::optional<hand::WearerCalibration>();
  auto wearer = hand::read_calibration(path);
  if (!wearer) return wearer.error();
  if (!is_kept_ranges(*wearer))
    return Error{Errc::bad_input, printable(path.string()) +
                                      ": was made by poses, which know the hand better; leave out "
                                      "--adapt to use it, or name another --user"};
  if (wearer->counts != counts)
    return Error{Errc::bad_input,
                 printable(path.string()) + ": is of another kind of glove; name another --user"};
  return std::optional(*std::move(wearer));
}

} // namespace

bool is_kept_ranges(const hand::WearerCalibration& wearer) {
  return wearer.method == method;
}

Result<std::optional<hand::LearnedRanges>> kept_ranges(const driver::GloveInfo& glove, Side side,
                                                       const std::string& user) {
  if (user.empty()) return std::optional<hand::LearnedRanges>();
  const auto path = hand::own_calibration_path(user, serial_of(glove), side);
  if (!path) return path.error();
  const auto wearer = kept(*path, glove.counts);
  if (!wearer) return wearer.error();
  if (!*wearer) return std::optional<hand::LearnedRanges>();
  hand::SensorRanges ranges{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot)
    if (const auto& quality = (*wearer)->quality[slot])
      ranges[slot] = {quality->min_counts, quality->max_counts, turns_of(quality->confidence)};
  return std::optional(hand::learned_from(ranges, side));
}

Result<std::filesystem::path> keep_ranges(const driver::GloveInfo& glove, Side side,
                                          const std::string& user,
                                          const hand::SensorRanges& ranges) {
  const bool is_any = std::any_of(ranges.begin(), ranges.end(),
                                  [](const hand::SensorRange& range) { return range.turns > 0; });
  if (!is_any) return std::filesystem::path();
  auto path = hand::own_calibration_path(user, serial_of(glove), side);
  if (!path) return path;
  if (const auto before = kept(*path, glove.counts); !before) return before.error();
  hand::WearerCalibration wearer;
  wearer.user = user;
  wearer.glove_model = glove.model;
  wearer.glove_serial = serial_of(glove);
  wearer.counts = glove.counts;
  wearer.side = side;
  wearer.made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  wearer.method = method;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    wearer.calibration.sensors[slot] = hand::line_of(slot, ranges[slot]);
    if (wearer.calibration.sensors[slot].gain_rad_per_count == 0.0) continue;
    wearer.quality[slot] = hand::SensorQuality{
        0.0, ranges[slot].low_counts, ranges[slot].high_counts, confidence_of(ranges[slot].turns)};
  }
  const auto written = hand::write_calibration(*path, wearer);
  if (!written) return written.error();
  return path;
}

Result<hand::CalibratedRange> ends_of(const hand::StoredCalibration& file,
                                      const driver::GloveInfo& glove) {
  const std::string path = printable(file.path.string());
  if (file.wearer.counts != glove.counts)
    return Error{Errc::bad_input, path + ": counts otherwise than " + printable(glove.source) +
                                      ", so that its slips cannot be learned; leave out --adapt"};
  const hand::CalibratedRange ends{file.wearer.side, hand::reached_ends(file.wearer)};
  if (ends.counts.present.bits == 0)
    return Error{Errc::bad_input, path + ": does not have the ranges of its sensors, so that slips "
                                         "cannot be learned; leave out --adapt, or make one by "
                                         "`nendo calibrate`"};
  return ends;
}

Result<KeptSlips> keep_slips(const driver::GloveInfo& glove, Side side, const std::string& user,
                             const hand::SensorAngles& slips_counts) {
  const auto stored = hand::list_calibrations(hand::calibration_folders());
  const auto choice = best_calibration(stored, glove, side, user);
  if (!choice)
    return Error{Errc::bad_input, "--user " + printable(user) +
                                      ": the calibration is gone, so that its slips are not kept"};
  hand::WearerCalibration wearer = choice->file->wearer;
  const auto own = hand::own_calibration_path(user, wearer.glove_serial, side);
  if (!own) return own.error();
  KeptSlips kept{choice->file->path, false};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (!(std::abs(slips_counts[slot]) >= hand::min_slip_counts(glove.counts))) continue;
    kept.is_changed = true;
    wearer.calibration.sensors[slot].offset_counts += slips_counts[slot];
    if (auto& quality = wearer.quality[slot])
      hand::move_ends(*quality, slips_counts[slot], wearer.counts);
  }
  if (!kept.is_changed) return kept;
  wearer.made = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  kept.path = *own;
  const auto written = hand::write_calibration(*own, wearer);
  if (!written) return written.error();
  return kept;
}

} // namespace nendo::sculpting
