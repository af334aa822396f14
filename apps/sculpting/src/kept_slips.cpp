#include <nendo/sculpting/kept_slips.hpp>

#include <chrono>
#include <cmath>

#include <nendo/base/text.hpp>

#include <nendo/sculpting/find_wearer.hpp>

namespace nendo::sculpting {

Result<hand::CalibratedRange> ends_of(const hand::StoredCalibration& file,
                                      const driver::GloveInfo& glove) {
  const std::string path = printable(file.path.string());
  if (file.wearer.counts != glove.counts)
    return Error{Errc::bad_input, path + ": counts otherwise than " + printable(glove.source) +
                                      ", so that its slips cannot be learned; leave out --adapt"};
  const hand::CalibratedRange ends{file.wearer.side, hand::reached_ends(file.wearer)};
  if (ends.counts.present.bits == 0)
    return Error{Errc::bad_input, path + ": does not tell how far its sensors went, so that slips "
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
